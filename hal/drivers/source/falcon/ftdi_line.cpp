#include "asperity/drivers/falcon/ftdi_line.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

namespace asperity {

io_status apply_ftdi(usb_link& link, std::span<const ftdi_setting> settings, std::int64_t timeout_ns) noexcept {
  for (const ftdi_setting& s : settings) {
    std::size_t done = 0;
    const usb_setup setup{
        .request_type = 0x40, .request = static_cast<std::uint8_t>(s.request), .value = s.value, .index = 0};
    const io_status answer = link.control(setup, {}, done, timeout_ns);
    if (answer != io_status::ok) return answer;
  }
  return io_status::ok;
}

}  // namespace asperity
