// An arm's chain from a URDF file.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "asperity/core/status.hpp"
#include "asperity/drivers/articulated/serial_chain.hpp"

namespace asperity {

/// Which part of a robot is the device.
struct urdf_chain {
  std::string base_link;    ///< its frame becomes the device's base frame d
  std::string handle_link;  ///< its frame becomes the handle h
  /// Continuous joints have no limits in a URDF, and an arm's joint has to have some: they get these, rad.
  double continuous_range_rad = 6.283185307179586;
};

/// A chain and what URDF calls its joints, from the base outwards.
struct urdf_arm {
  serial_chain chain{};
  std::vector<std::string> joint_names{};
  joint_vector max_speed_rad_per_s{};  ///< limit/@velocity; 0 where there is none
};

/// Reads origins, axes, limits (lower, upper, effort, velocity) and inertials of the links between base_link and
/// handle_link. Fixed joints are merged; so is what is fixed to the chain beside it, with its mass. Prismatic joints in
/// the chain, movable joints beside it that carry mass, mimic joints, and chains of more than most_joints are refused:
/// the error names the joint or link and its line. Visuals, collisions, transmissions and dynamics are not read.
/// Gravity is left at (0, 0, -9.80665) of the base link. Of what is read, an inertia that no body has (not positive
/// semi-definite, or against the triangle inequality) and numbers beyond 10 m, 1000 kg, 1000 N m, 100 rad/s or 100 rad
/// are refused.
/// @param text a whole document of at most 16 MiB, 100,000 elements, 64 attributes in each and 64 levels
/// @source http://wiki.ros.org/urdf/XML
[[nodiscard]] result<urdf_arm> parse_urdf(std::string_view text, const urdf_chain& which);

/// The same from a file.
[[nodiscard]] result<urdf_arm> read_urdf(const std::filesystem::path& file, const urdf_chain& which);

}  // namespace asperity
