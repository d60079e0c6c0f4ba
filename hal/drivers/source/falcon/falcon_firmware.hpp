// Wakes a Falcon, which needs its firmware after every power-on before it answers.
//
// The device has no program of its own. Its maker's image is under a licence for noncommercial use and is no part of
// this library: a person has to name a copy of theirs; see docs/how-to/use-a-falcon.md. Outside a tick, all of it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "asperity/core/status.hpp"
#include "asperity/drivers/falcon/ftdi_line.hpp"
#include "asperity/transport/io_clock.hpp"

namespace asperity {

inline constexpr std::int64_t falcon_control_timeout_ns = 1'000'000'000;

/// The line as the running firmware wants it, about 1.5 MBd, with an answer in the next millisecond.
inline constexpr std::array<ftdi_setting, 5> falcon_normal_settings = {{{ftdi_request::latency, 1},
                                                                        {ftdi_request::modem, ftdi_dtr_low},
                                                                        {ftdi_request::baud, 2},
                                                                        {ftdi_request::reset, ftdi_purge_receive},
                                                                        {ftdi_request::reset, ftdi_purge_transmit}}};

/// The image in a file that a person named.
[[nodiscard]] result<std::vector<std::uint8_t>> read_falcon_image(const std::string& path);

/// Sends the image: greeting at 9600 Bd, then the bytes in pieces that the device repeats and that are compared.
/// @return an error that names the step and the byte
[[nodiscard]] result<void> load_falcon_firmware(usb_link& link, io_clock& clock, std::span<const std::uint8_t> image);

}  // namespace asperity
