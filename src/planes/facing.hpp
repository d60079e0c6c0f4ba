// How far a sample counts whose surface looks away from the way that a field would push it in.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "asperity/model/scene.hpp"

namespace asperity::facing {

/// Half way through a body no way out is shorter than another: a sample where the field's slope is shorter holds nothing.
inline constexpr double least_slope = 0.05;

/// Cosines of the angle between a sample's axis and the slope: the sample counts in full from `full` on and not at all
/// up to `none`. Between them it has a share.
struct cosines {
  double full = -1.0, none = -1.0;
};

/// In full up to 2 degrees beyond its cone and not at all from 8 degrees on. Where the surface about a sample is plain,
/// a field that would push it elsewhere is that of a rounded edge: the samples of that edge tell the contact, and this one
/// would plough. @rt safe
[[nodiscard]] inline cosines cosines_of(double cone_rad) noexcept {
  constexpr double full_rad = 2.0 * std::numbers::pi / 180.0, none_rad = 8.0 * std::numbers::pi / 180.0;
  return {std::cos(std::min(cone_rad + full_rad, std::numbers::pi)),
          std::cos(std::min(cone_rad + none_rad, std::numbers::pi))};
}

/// A sample with less than this share tells no plane where it is shallow.
inline constexpr double least_share = 0.03;

/// What a sample counts of its depth, m: its share of what is shallow, and all that lies further in, so that nothing
/// passes a body whose field it faces sidelong. Gaps count in full. @rt safe
[[nodiscard]] inline double counted_m(double depth_m, double share, double shallow_m) noexcept {
  if (!(depth_m > 0.0)) return depth_m;
  return share * std::min(depth_m, shallow_m) + std::max(0.0, depth_m - shallow_m);
}

/// How deep a sample is shallow, m, where the smallest body's box has this diagonal.
[[nodiscard]] inline double shallow_m(double smallest_diagonal_m) noexcept {
  constexpr double of_the_diagonal = 0.03;
  return of_the_diagonal * smallest_diagonal_m;
}

/// How deep a sample of a scene is shallow, m: see plane_depth.
[[nodiscard]] inline double shallow_m(const scene& of) noexcept {
  double smallest_m = of.probe->box.diagonal();
  for (const model_ptr& b : of.fixed) smallest_m = std::min(smallest_m, b->box.diagonal());
  return shallow_m(smallest_m);
}

}  // namespace asperity::facing
