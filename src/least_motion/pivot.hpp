// The point about which a way out turns, and the stiffness of the spring that resists the turn.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "asperity/core/math.hpp"
#include "asperity/core/spatial.hpp"

namespace asperity::exits {

/// The middle of where the bodies are close at a pose, its spread, and the derivatives of both by the pose. From the
/// probe's centre of mass, world axes; derivatives by a translation of the probe and a rotation about that centre.
///
/// Where a corner touches, the middle is next to it and a turn about it does not free it: the contact keeps its
/// stiffness. Where a face lies on a face the middle is the face's, and a turn frees a face that rocks.
struct pivot {
  vec3 centre{0.0};
  vec6 centre_by_pose[3];    ///< of each coordinate
  double arm_squared = 1.0;  ///< a turn of 1 / arm costs as much as a shift of 1, m^2
  vec6 arm_squared_by_pose;
};

/// Sums over points that are close, and the pivot that they make.
class pivot_sum {
 public:
  /// @param weight of a point of full depth   @param reach_m how far outside a point counts
  /// @param depth_m of the point, and its slope by the motion of the probe   @param r from the centre of mass
  /// @param of_probe the point moves with the probe
  /// @rt safe
  void add(double weight, double reach_m, double depth_m, const vec3& slope, const vec3& r, bool of_probe) noexcept {
    const double u = 1.0 + depth_m / reach_m;
    if (!(u > 0.0)) return;
    const double w = weight * u * u * u, rise = 3.0 * weight * u * u / reach_m;
    const vec6 dw = rise * vec6{slope, glm::cross(r, slope)};
    sum_ += w;
    by_ += dw;
    square_ += w * glm::dot(r, r);
    // 2 w r . dr: a point of the probe turns about the centre, a fixed one comes nearer by the translation.
    square_by_ += glm::dot(r, r) * dw;
    if (!of_probe) square_by_.linear -= 2.0 * w * r;
    for (int i = 0; i < 3; ++i) {
      first_[i] += w * r[i];
      vec6& d = first_by_[i];
      d += r[i] * dw;
      vec3 axis(0.0);
      axis[i] = 1.0;
      if (of_probe) {
        d.angular += w * glm::cross(r, axis);  // axis . (phi x r)
      } else {
        d.linear -= w * axis;
      }
    }
  }

  /// @param least_m of the arm   @param per_spread the arm's square grows by so many times the spread's
  [[nodiscard]] pivot make(double least_m, double per_spread) const noexcept {
    pivot out;
    out.arm_squared = least_m * least_m;
    if (!(sum_ > 0.0)) return out;
    const double per = 1.0 / sum_;
    vec6 spread_by = per * (square_by_ - (per * square_) * by_);
    double spread = per * square_;
    for (int i = 0; i < 3; ++i) {
      out.centre[i] = per * first_[i];
      out.centre_by_pose[i] = per * (first_by_[i] - out.centre[i] * by_);
      spread -= out.centre[i] * out.centre[i];
      spread_by += (-2.0 * out.centre[i]) * out.centre_by_pose[i];
    }
    out.arm_squared += per_spread * std::max(0.0, spread);
    out.arm_squared_by_pose = per_spread * spread_by;
    return out;
  }

 private:
  double sum_ = 0.0, square_ = 0.0;
  vec3 first_{0.0};
  vec6 by_, square_by_, first_by_[3];
};

}  // namespace asperity::exits
