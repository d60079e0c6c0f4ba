// A command to a device.
#pragma once

#include <cstdint>

#include "asperity/core/spatial.hpp"

namespace asperity {

/// The frame that a command's wrench is written in. There is one right answer for a device; the tag is carried so that
/// a wrong one is found by the gate and not by a hand.
enum class wrench_frame : std::uint8_t {
  unset,
  device_base,  ///< axes of d, torque about the handle's origin: the only frame that a device takes
  world,        ///< axes of w
  handle,       ///< axes of h
};

/// The wrench that a device shall put on the hand.
struct device_command {
  wrench on_hand{};  ///< N and N m
  wrench_frame frame = wrench_frame::unset;
  std::int64_t valid_until_ns = 0;  ///< a device applies zero after this time (session clock)
  std::uint64_t sequence = 0;       ///< grows by one with every command
};

}  // namespace asperity
