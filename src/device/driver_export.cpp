#include "asperity/device/driver_export.hpp"

#include <cstdint>
#include <string_view>

namespace asperity::detail {

void put_error(char* error, std::uint32_t error_size, std::string_view text) noexcept {
  if (error != nullptr) abi::put_text({error, error_size}, text);
}

std::int32_t failure(const error& e, char* text, std::uint32_t text_size) noexcept {
  put_error(text, text_size, e.message);
  switch (e.code) {
    case error_code::invalid_argument:
      return ASPERITY_INVALID;
    case error_code::unsupported:
      return ASPERITY_UNSUPPORTED;
    default:
      return ASPERITY_FAILED;
  }
}

asperity_listing to_abi(const device_listing& d, const asperity_capabilities* c) noexcept {
  auto out = abi::blank<asperity_listing>();
  out.maturity = static_cast<std::uint32_t>(d.maturity);
  abi::put_text(out.identity, d.identity);
  abi::put_text(out.path, d.path);
  abi::put_text(out.name, d.name);
  if (d.not_openable) abi::put_text(out.not_openable, d.not_openable->empty() ? "no reason given" : *d.not_openable);
  out.capabilities = c;
  return out;
}

}  // namespace asperity::detail
