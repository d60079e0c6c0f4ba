// The serial line behind an FTDI chip, as far as a driver needs it.
//
// Control requests of type 0x40 set the line. Every packet from the chip begins with two bytes of line status, so that
// a transfer of more than one packet has two in every 64 bytes, and a packet of two bytes says that nothing came.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "asperity/core/export.hpp"
#include "asperity/transport/usb_link.hpp"

namespace asperity {

inline constexpr std::size_t ftdi_packet_size = 64;
inline constexpr std::size_t ftdi_status_size = 2;
/// Most payload of one packet to the host.
inline constexpr std::size_t ftdi_payload_size = ftdi_packet_size - ftdi_status_size;

/// Control requests to an FTDI chip.
enum class ftdi_request : std::uint8_t { reset = 0, modem = 1, flow = 2, baud = 3, data = 4, latency = 9 };

inline constexpr std::uint16_t ftdi_purge_receive = 1;
inline constexpr std::uint16_t ftdi_purge_transmit = 2;
inline constexpr std::uint16_t ftdi_dtr_low = 0x0100;
inline constexpr std::uint16_t ftdi_dtr_high = 0x0101;
inline constexpr std::uint16_t ftdi_rts_low = 0x0200;
inline constexpr std::uint16_t ftdi_no_flow_control = 0;
inline constexpr std::uint16_t ftdi_8n1 = 8;

/// One request and its value.
struct ftdi_setting {
  ftdi_request request = ftdi_request::reset;
  std::uint16_t value = 0;
};

/// Sends settings in order, until one fails. Waits for the device; never inside a tick.
[[nodiscard]] ASPERITY_API io_status apply_ftdi(usb_link& link, std::span<const ftdi_setting> settings,
                                                std::int64_t timeout_ns) noexcept;

/// Calls `take` for every byte of payload in a transfer, one packet or several.
/// @return packets whose status says that the line lost or spoilt a byte (overrun, parity or framing error)
/// @rt safe where `take` is
template <class Take>
std::size_t for_each_ftdi_byte(std::span<const std::uint8_t> transfer, Take&& take) noexcept {
  constexpr unsigned line_errors = 0x0e;
  std::size_t errors = 0;
  for (std::size_t at = 0; at < transfer.size(); at += ftdi_packet_size) {
    const std::span<const std::uint8_t> rest = transfer.subspan(at);
    const std::span<const std::uint8_t> packet =
        rest.first(rest.size() < ftdi_packet_size ? rest.size() : ftdi_packet_size);
    if (packet.size() < ftdi_status_size) return errors;
    if ((packet[1] & line_errors) != 0) ++errors;
    for (const std::uint8_t byte : packet.subspan(ftdi_status_size)) take(byte);
  }
  return errors;
}

}  // namespace asperity
