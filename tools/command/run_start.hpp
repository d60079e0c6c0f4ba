// How a session begins: where the bodies are, where the handle is, and what the simulated hand means to do.
#pragma once

#include <optional>
#include <vector>

#include "asperity/control/workspace_map.hpp"
#include "asperity/device/any_device.hpp"
#include "asperity/device/simulated/motion_script.hpp"
#include "asperity/render/any_renderer.hpp"
#include "run_command.hpp"

namespace asperity::command {

/// Where the bodies are; the probe's start is found later where nobody gave it.
struct given_poses {
  std::optional<pose> T_wa;
  std::vector<pose> T_wb;
};

/// Poses of `count` fixed bodies, in their order; the origin where none is given.
/// @return invalid_argument
[[nodiscard]] result<std::vector<pose>> read_fixed_poses(const std::vector<std::string>& texts, std::size_t count);

/// @return invalid_argument
[[nodiscard]] result<given_poses> read_poses(const run_command& options);

/// Where the probe first touches when it comes straight down over the first fixed body.
[[nodiscard]] result<pose> first_touch(any_renderer& feel, const std::vector<pose>& T_wb);

/// The probe's pose just above its first touch, or at the touch for a motion that has no approach.
[[nodiscard]] pose start_above(const run_command& options, pose touch_T_wa);

/// The simulated hand's: the handle sits at the probe's centre of mass, and its torque is then the one that turns the
/// probe in the hand.
/// @param scale metres of the world for a metre of the device
[[nodiscard]] workspace_map map_of(const pose& T_wa_start, const vec3& centre_of_mass_a, double scale);

/// That of a device of one's own: its axes are the world's; the probe is taken up in the pose in which the hand holds
/// the handle.
[[nodiscard]] workspace_map map_of(const pose& T_wa_start, const vec3& centre_of_mass_a, double scale,
                                   const pose& T_dh_start);

/// Where the handle is: a device needs a moment for its first measurement. @return io_failed after a second |
/// cancelled
[[nodiscard]] result<pose> first_pose(any_device& device);

/// What the simulated hand means to do with these bodies.
[[nodiscard]] motion_settings motion_of(const run_command& options, const scene& bodies);

}  // namespace asperity::command
