// Between the structs of driver_abi.h and the types of this library, for both sides of the border.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>

#include "asperity/core/export.hpp"
#include "asperity/core/status.hpp"
#include "asperity/device/capabilities.hpp"
#include "asperity/device/device_state.hpp"
#include "asperity/device/driver_abi.h"
#include "asperity/device/sample.hpp"

namespace asperity::abi {

static_assert(ASPERITY_STATE_ABSENT == static_cast<int>(device_state::absent));
static_assert(ASPERITY_STATE_PRESENT == static_cast<int>(device_state::present));
static_assert(ASPERITY_STATE_OPEN == static_cast<int>(device_state::open));
static_assert(ASPERITY_STATE_READY == static_cast<int>(device_state::ready));
static_assert(ASPERITY_STATE_ARMED == static_cast<int>(device_state::armed));
static_assert(ASPERITY_STATE_ACTIVE == static_cast<int>(device_state::active));
static_assert(ASPERITY_STATE_FAULT == static_cast<int>(device_state::fault));
static_assert(ASPERITY_STATE_CLOSED == static_cast<int>(device_state::closed));

/// A struct of the interface, zero but for its size, ready to be filled in by the other side.
/// @rt safe
template <class Struct>
[[nodiscard]] Struct blank() noexcept {
  Struct s{};
  s.struct_size = sizeof(Struct);
  return s;
}

/// Writes `from` into a struct of the other side, whose version may be older or newer: never beyond its struct_size,
/// which stays. @rt safe
template <class Struct>
void copy_out(const Struct& from, Struct& to) noexcept {
  static_assert(std::is_trivially_copyable_v<Struct>);
  constexpr std::size_t first = sizeof(std::uint32_t);
  const std::size_t size = std::min<std::size_t>(to.struct_size, sizeof(Struct));
  if (size <= first) return;
  std::memcpy(reinterpret_cast<std::byte*>(&to) + first, reinterpret_cast<const std::byte*>(&from) + first,
              size - first);
}

/// What this side knows of a struct of the other side; what the other side does not know is zero. struct_size is how
/// much came. @rt safe
template <class Struct>
[[nodiscard]] Struct copy_in(const Struct& from) noexcept {
  static_assert(std::is_trivially_copyable_v<Struct>);
  Struct s{};
  const std::size_t size = std::min<std::size_t>(from.struct_size, sizeof(Struct));
  std::memcpy(&s, &from, size);
  s.struct_size = static_cast<std::uint32_t>(size);
  return s;
}

/// Copies text into a fixed field, cut at a character's border, zero bytes after it.
ASPERITY_API void put_text(std::span<char> field, std::string_view text) noexcept;

/// The text of a fixed field, or nothing where no zero byte ends it.
[[nodiscard]] ASPERITY_API std::optional<std::string_view> get_text(std::span<const char> field) noexcept;

/// @rt safe
[[nodiscard]] constexpr std::int32_t to_code(status s) noexcept {
  switch (s) {
    case status::ok:
    case status::capacity_reached:
      return ASPERITY_OK;
    case status::invalid_pose:
    case status::not_finite:
      return ASPERITY_NOT_FINITE;
    case status::stale_input:
      return ASPERITY_STALE;
    case status::not_ready:
      return ASPERITY_NOT_READY;
    case status::backend_failed:
    case status::gate_shut:
      break;
  }
  return ASPERITY_FAILED;
}

/// @rt safe
[[nodiscard]] constexpr status to_status(std::int32_t code) noexcept {
  switch (code) {
    case ASPERITY_OK:
      return status::ok;
    case ASPERITY_NOT_READY:
      return status::not_ready;
    case ASPERITY_NOT_FINITE:
      return status::not_finite;
    case ASPERITY_STALE:
      return status::stale_input;
    default:
      return status::backend_failed;
  }
}

/// The state, or nothing where the number is none. @rt safe
[[nodiscard]] constexpr std::optional<device_state> to_state(std::int32_t state) noexcept {
  if (state < ASPERITY_STATE_ABSENT || state > ASPERITY_STATE_CLOSED) return std::nullopt;
  return static_cast<device_state>(state);
}

[[nodiscard]] ASPERITY_API asperity_capabilities to_abi(const device_capabilities& c) noexcept;

/// @pre the name in `c` is ended by a zero byte, and `c` outlives the result, whose name points into it
[[nodiscard]] ASPERITY_API device_capabilities from_abi(const asperity_capabilities& c) noexcept;

/// @rt safe
[[nodiscard]] ASPERITY_API asperity_sample to_abi(const device_sample& s) noexcept;

/// @rt safe
[[nodiscard]] ASPERITY_API device_sample from_abi(const asperity_sample& s) noexcept;

/// @rt safe
[[nodiscard]] ASPERITY_API asperity_command to_abi(const device_command& c) noexcept;

/// @rt safe
[[nodiscard]] ASPERITY_API device_command from_abi(const asperity_command& c) noexcept;

/// @rt safe
[[nodiscard]] ASPERITY_API asperity_applied to_abi(const wrench& w) noexcept;

/// @rt safe
[[nodiscard]] ASPERITY_API wrench from_abi(const asperity_applied& a) noexcept;

}  // namespace asperity::abi
