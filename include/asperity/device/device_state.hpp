// The life of a device: states, events, and the one table that says what follows what.
#pragma once

#include <cstdint>
#include <optional>

namespace asperity {

/// Where a device is in its life. Output other than zero is possible in armed and active only.
enum class device_state : std::uint8_t {
  absent,   ///< not there
  present,  ///< seen on its bus
  open,     ///< handle held, identity and limits being read
  ready,    ///< measures; its output is forced to zero
  armed,    ///< may put out a wrench, and puts out zero
  active,   ///< puts out a wrench
  fault,    ///< output zero, latched: only a person's cleared leaves it
  closed,   ///< handle given back
};
inline constexpr int device_state_count = 8;

/// What can happen to a device.
enum class device_event : std::uint8_t {
  arrived,   ///< seen on the bus
  departed,  ///< gone from the bus
  opened,    ///< handle taken
  prepared,  ///< homed, limits known, samples flow
  armed,     ///< a person (or the application in a person's name) allowed output
  engaged,   ///< first command that is not zero
  released,  ///< command is zero again
  disarmed,  ///< output forbidden
  failed,    ///< any error
  cleared,   ///< a person has seen the fault
  closed,    ///< handle given back
};
inline constexpr int device_event_count = 11;

[[nodiscard]] constexpr const char* to_string(device_state s) noexcept {
  switch (s) {
    case device_state::absent:
      return "absent";
    case device_state::present:
      return "present";
    case device_state::open:
      return "open";
    case device_state::ready:
      return "ready";
    case device_state::armed:
      return "armed";
    case device_state::active:
      return "active";
    case device_state::fault:
      return "fault";
    case device_state::closed:
      return "closed";
  }
  return "unknown state";
}

/// State after an event, or nothing where the event is refused in that state.
/// - Arming is possible from ready only, so a device that returns, or whose fault was cleared, is never armed by
/// itself.
/// - A device that vanishes while it may put out a wrench is a fault, not an absence: somebody has to look.
/// - A cleared fault leads to closed: everything is opened, prepared and armed anew.
/// @rt safe
[[nodiscard]] constexpr std::optional<device_state> next_state(device_state s, device_event e) noexcept {
  using S = device_state;
  using E = device_event;
  switch (s) {
    case S::absent:
      if (e == E::arrived) return S::present;
      break;
    case S::present:
      if (e == E::opened) return S::open;
      if (e == E::departed) return S::absent;
      break;
    case S::open:
      if (e == E::prepared) return S::ready;
      if (e == E::departed) return S::absent;
      if (e == E::failed) return S::fault;
      if (e == E::closed) return S::closed;
      break;
    case S::ready:
      if (e == E::armed) return S::armed;
      if (e == E::disarmed) return S::ready;
      if (e == E::departed) return S::absent;
      if (e == E::failed) return S::fault;
      if (e == E::closed) return S::closed;
      break;
    case S::armed:
      if (e == E::engaged) return S::active;
      if (e == E::disarmed) return S::ready;
      if (e == E::departed || e == E::failed) return S::fault;
      if (e == E::closed) return S::closed;
      break;
    case S::active:
      if (e == E::released) return S::armed;
      if (e == E::disarmed) return S::ready;
      if (e == E::departed || e == E::failed) return S::fault;
      if (e == E::closed) return S::closed;
      break;
    case S::fault:
      if (e == E::cleared) return S::closed;
      break;
    case S::closed:
      if (e == E::arrived) return S::present;
      if (e == E::departed) return S::absent;
      break;
  }
  return std::nullopt;
}

/// Whether a device in this state may put out anything but zero.
/// @rt safe
[[nodiscard]] constexpr bool may_put_out(device_state s) noexcept {
  return s == device_state::armed || s == device_state::active;
}

/// Whether a device in this state answers read() with a sample.
/// @rt safe
[[nodiscard]] constexpr bool measures(device_state s) noexcept { return s == device_state::ready || may_put_out(s); }

/// A state that can change through the table only.
class device_state_machine {
 public:
  constexpr explicit device_state_machine(device_state initial = device_state::absent) noexcept : state_(initial) {}

  [[nodiscard]] constexpr device_state state() const noexcept { return state_; }

  /// @return false where the table refuses the event; the state is then unchanged
  /// @rt safe
  constexpr bool apply(device_event e) noexcept {
    const std::optional<device_state> next = next_state(state_, e);
    if (next) state_ = *next;
    return next.has_value();
  }

 private:
  device_state state_;
};

}  // namespace asperity
