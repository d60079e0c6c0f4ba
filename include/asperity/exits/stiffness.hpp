// The stiffness of a mixture of ways out: what is left of the bed's when the motions follow the pose.
#pragma once

#include <cstddef>

#include "asperity/core/math.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/exits/eigen6.hpp"
#include "asperity/exits/way_out.hpp"

namespace asperity::exits {

/// The depth of one sample and its derivatives, world axes.
struct sample_depth {
  vec6 by_pose;             ///< slope by the pose, relief included
  vec3 smooth{0.0};         ///< slope of the smooth part by the motion
  mat3 hessian_per_m{0.0};  ///< of the smooth part, by the motion
  vec3 lever{0.0};          ///< from the probe's centre of mass to the sample where it meets the field
  bool of_probe = true;     ///< the probe's sample; otherwise the field is the probe's, and turns with it
};

/// Second derivatives of the bed of one way out, by the pose and by the motion.
struct way_out_stiffness {
  mat6 by_pose;
  vec6 by_both[3];  ///< column i: by the pose and the motion's axis i
  mat3 by_motion{0.0};

  /// One sample's share. The curvature of the relief is left out.
  /// @param rise_n_per_m of its push by its depth   @param push_n 0 leaves the curvature of the bodies out
  void add(double rise_n_per_m, double push_n, const sample_depth& d) noexcept {
    add_outer(by_pose, rise_n_per_m, d.by_pose);
    for (int i = 0; i < 3; ++i) by_both[i] += (rise_n_per_m * d.smooth[i]) * d.by_pose;
    by_motion += rise_n_per_m * glm::outerProduct(d.smooth, d.smooth);
    if (!(push_n > 0.0)) return;
    // By a translation u and a rotation phi about the centre of mass, to second order: the sample moves by
    // u + phi x r + phi x (phi x r) / 2; where the field turns instead, it moves against it, and u is turned as well.
    const mat3 &h = d.hessian_per_m, turned = -1.0 * skew(d.lever);
    mat3 mixed = h * turned;
    if (!d.of_probe) mixed -= skew(d.smooth);
    const double sign = d.of_probe ? 1.0 : -1.0;
    const mat3 half = 0.5 * glm::outerProduct(d.smooth, d.lever);
    mat3 turns = glm::transpose(turned) * h * turned;
    turns += sign * (half + glm::transpose(half) - glm::dot(d.smooth, d.lever) * mat3(1.0));
    for (std::size_t r = 0; r < 3; ++r) {
      const int i = static_cast<int>(r);
      for (std::size_t c = 0; c < 3; ++c) {
        const int j = static_cast<int>(c);
        by_pose(r, c) += push_n * h[j][i];
        by_pose(r, c + 3) += push_n * mixed[j][i];
        by_pose(c + 3, r) += push_n * mixed[j][i];
        by_pose(r + 3, c + 3) += push_n * turns[j][i];
        by_both[i][c] += push_n * h[j][i];
        by_both[i][c + 3] += push_n * mixed[j][i];
      }
    }
    by_motion += push_n * h;
  }
};

/// Adds them up. With M = K + by_motion, the motion eliminated (a Schur complement), each way out has
///
///     v_qq = by_pose - by_both M^-1 by_both^T,   v_yq = K M^-1 by_both^T,   v_yy = K - K^2 M^-1
///
/// and y, the place that they look from, follows too: U_qq = sum w v_qq + v_yq^T (C - v_yy)^-1 v_yq. The weights count
/// as fixed.
class mixed_stiffness {
 public:
  explicit mixed_stiffness(const exit_springs& k) noexcept : k_(k) {}

  void add(double weight, const way_out_stiffness& of) noexcept {
    mat3 m = of.by_motion;
    for (int i = 0; i < 3; ++i) m[i][i] += k_.each;
    const mat3 inverse = glm::inverse(m);
    vec6 follows[3];  // by_both M^-1
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) follows[i] += inverse[i][j] * of.by_both[j];
    }
    for (std::size_t r = 0; r < 6; ++r) {
      for (std::size_t c = 0; c < 6; ++c) {
        double drop = 0.0;
        for (int i = 0; i < 3; ++i) drop += follows[i][r] * of.by_both[i][c];
        by_pose_(r, c) += weight * (of.by_pose(r, c) - drop);
      }
    }
    for (int i = 0; i < 3; ++i) by_place_and_pose_[i] += (weight * k_.each) * follows[i];
    by_place_ += weight * k_.each * (mat3(1.0) - k_.each * inverse);
  }

  /// dW/dq: symmetric, negative semidefinite. Directions in which the bodies' curvature makes the force fall count as
  /// without stiffness.
  [[nodiscard]] mat6 sum() const noexcept {
    constexpr double length_m = 0.01;  // a lever: what rotations are compared with translations by
    const mat3 inverse = glm::inverse(k_.mixed * mat3(1.0) - by_place_);
    mat6 out;
    for (std::size_t r = 0; r < 6; ++r) {
      for (std::size_t c = r; c < 6; ++c) {
        double more = 0.0;
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; j < 3; ++j) more += by_place_and_pose_[i][r] * inverse[i][j] * by_place_and_pose_[j][c];
        }
        out(r, c) = out(c, r) = -(0.5 * (by_pose_(r, c) + by_pose_(c, r)) + more);
      }
    }
    return negative_part(out, length_m);
  }

 private:
  exit_springs k_;
  mat6 by_pose_;
  vec6 by_place_and_pose_[3];
  mat3 by_place_{0.0};
};

}  // namespace asperity::exits
