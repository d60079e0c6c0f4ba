#include "asperity/transport/hid_finder.hpp"

#include <cstddef>
#include <string>

namespace asperity {
namespace {

std::string four_digits(std::uint16_t number) {
  std::string out(4, '0');
  for (std::size_t i = 0; i < 4; ++i) out[3 - i] = "0123456789abcdef"[(number >> (4 * i)) & 0xf];
  return out;
}

}  // namespace

std::string identity_of(const hid_listing& which) {
  const std::string kind = four_digits(which.vendor_id) + ":" + four_digits(which.product_id);
  return kind + (which.serial.empty() ? "" : ":" + which.serial);
}

}  // namespace asperity
