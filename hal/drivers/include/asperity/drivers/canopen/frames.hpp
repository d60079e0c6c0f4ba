// The short frames of CANopen: network management, SYNC, heartbeat, emergency.
#pragma once

#include <cstdint>
#include <optional>

#include "asperity/transport/can_bus.hpp"

namespace asperity::canopen {

/// Identifiers of the pre-defined connection set; where it says so, the node's number (1 to 127) is added.
/// @source CiA 301, section 7.3.3
inline constexpr std::uint32_t nmt_id = 0x000;
inline constexpr std::uint32_t sync_id = 0x080;
inline constexpr std::uint32_t emergency_id = 0x080;     ///< + node
inline constexpr std::uint32_t tpdo1_id = 0x180;         ///< + node; from the node
inline constexpr std::uint32_t rpdo1_id = 0x200;         ///< + node; to the node
inline constexpr std::uint32_t tpdo2_id = 0x280;         ///< + node
inline constexpr std::uint32_t rpdo2_id = 0x300;         ///< + node
inline constexpr std::uint32_t tpdo3_id = 0x380;         ///< + node
inline constexpr std::uint32_t rpdo3_id = 0x400;         ///< + node
inline constexpr std::uint32_t tpdo4_id = 0x480;         ///< + node
inline constexpr std::uint32_t rpdo4_id = 0x500;         ///< + node
inline constexpr std::uint32_t sdo_response_id = 0x580;  ///< + node
inline constexpr std::uint32_t sdo_request_id = 0x600;   ///< + node
inline constexpr std::uint32_t heartbeat_id = 0x700;     ///< + node

inline constexpr std::uint8_t lowest_node = 1;
inline constexpr std::uint8_t highest_node = 127;

/// Commands of network management to a node.
enum class nmt_command : std::uint8_t {
  start = 1,
  stop = 2,
  pre_operational = 128,
  reset_node = 129,
  reset_communication = 130,
};

/// State of a node, as its heartbeat says.
enum class nmt_state : std::uint8_t {
  boot_up = 0,
  stopped = 4,
  operational = 5,
  pre_operational = 127,
};

/// A classic data frame without data.
[[nodiscard]] constexpr can_frame empty_frame(std::uint32_t id, std::uint8_t size) noexcept {
  can_frame f;
  f.id = id;
  f.size = size;
  return f;
}

/// Whether a frame is a classic data frame with an 11-bit identifier: nothing else is CANopen.
[[nodiscard]] constexpr bool is_plain(const can_frame& f) noexcept {
  return !f.extended && !f.remote && !f.fd && f.size <= 8;
}

/// Little-endian fields of the data. The caller keeps to the size.
template <class Unsigned>
constexpr void put(can_frame& f, std::size_t at, Unsigned value) noexcept {
  for (std::size_t i = 0; i < sizeof(Unsigned); ++i) f.data[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
}
template <class Unsigned>
[[nodiscard]] constexpr Unsigned get(const can_frame& f, std::size_t at) noexcept {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < sizeof(Unsigned); ++i) value |= std::uint64_t{f.data[at + i]} << (8 * i);
  return static_cast<Unsigned>(value);
}

/// @param node 0 for all
[[nodiscard]] constexpr can_frame encode_nmt(nmt_command command, std::uint8_t node) noexcept {
  can_frame f = empty_frame(nmt_id, 2);
  f.data[0] = static_cast<std::uint8_t>(command);
  f.data[1] = node;
  return f;
}

struct nmt_order {
  nmt_command command{};
  std::uint8_t node = 0;  ///< 0 for all
};
[[nodiscard]] constexpr std::optional<nmt_order> decode_nmt(const can_frame& f) noexcept {
  if (!is_plain(f) || f.id != nmt_id || f.size != 2) return std::nullopt;
  switch (f.data[0]) {
    case 1:
    case 2:
    case 128:
    case 129:
    case 130:
      return nmt_order{static_cast<nmt_command>(f.data[0]), f.data[1]};
    default:
      return std::nullopt;
  }
}

/// SYNC without a counter.
[[nodiscard]] constexpr can_frame encode_sync() noexcept { return empty_frame(sync_id, 0); }
[[nodiscard]] constexpr bool is_sync(const can_frame& f) noexcept { return is_plain(f) && f.id == sync_id; }

[[nodiscard]] constexpr can_frame encode_heartbeat(std::uint8_t node, nmt_state state) noexcept {
  can_frame f = empty_frame(heartbeat_id + node, 1);
  f.data[0] = static_cast<std::uint8_t>(state);
  return f;
}
/// State in a heartbeat of that node. Nothing where the frame is none, or the state is not one of the four.
[[nodiscard]] constexpr std::optional<nmt_state> decode_heartbeat(const can_frame& f, std::uint8_t node) noexcept {
  if (!is_plain(f) || f.id != heartbeat_id + node || f.size != 1) return std::nullopt;
  switch (f.data[0] & 0x7f) {  // bit 7 is the toggle of node guarding
    case 0:
      return nmt_state::boot_up;
    case 4:
      return nmt_state::stopped;
    case 5:
      return nmt_state::operational;
    case 127:
      return nmt_state::pre_operational;
    default:
      return std::nullopt;
  }
}

/// An emergency message.
struct emergency {
  std::uint16_t code = 0;           ///< 0: the error is over
  std::uint8_t error_register = 0;  ///< object 1001
  friend bool operator==(const emergency&, const emergency&) = default;
};
[[nodiscard]] constexpr can_frame encode_emergency(std::uint8_t node, const emergency& e) noexcept {
  can_frame f = empty_frame(emergency_id + node, 8);
  put(f, 0, e.code);
  f.data[2] = e.error_register;
  return f;
}
[[nodiscard]] constexpr std::optional<emergency> decode_emergency(const can_frame& f, std::uint8_t node) noexcept {
  if (!is_plain(f) || f.id != emergency_id + node || f.size != 8) return std::nullopt;
  return emergency{get<std::uint16_t>(f, 0), f.data[2]};
}

}  // namespace asperity::canopen
