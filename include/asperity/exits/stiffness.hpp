// The stiffness of a mixture of ways out: what is left of the bed's when the motions follow the pose.
#pragma once

#include <cstddef>

#include "asperity/core/math.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/exits/way_out.hpp"

namespace asperity::exits {

/// Second derivatives of the bed of one way out, by the pose and by the motion, without the bodies' curvature: a sum of
/// outer products.
struct way_out_stiffness {
  mat6 by_pose;
  vec6 by_both[3];  ///< column i: by the pose and the motion's axis i
  mat3 by_motion{0.0};

  /// @param rise_n_per_m of one sample's push by its depth
  void add(double rise_n_per_m, const vec6& depth_by_pose, const vec3& depth_by_motion) noexcept {
    add_outer(by_pose, rise_n_per_m, depth_by_pose);
    for (int i = 0; i < 3; ++i) by_both[i] += (rise_n_per_m * depth_by_motion[i]) * depth_by_pose;
    by_motion += rise_n_per_m * glm::outerProduct(depth_by_motion, depth_by_motion);
  }
};

/// Adds them up. With M = K + by_motion, the motion eliminated (a Schur complement), each way out has
///
///     v_qq = by_pose - by_both M^-1 by_both^T,   v_yq = K M^-1 by_both^T,   v_yy = K - K^2 M^-1
///
/// and y, the place that they look from, follows too: U_qq = sum w v_qq + v_yq^T (C - v_yy)^-1 v_yq. The weights count
/// as fixed, so that the sum is positive semidefinite.
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

  /// dW/dq: symmetric, negative semidefinite.
  [[nodiscard]] mat6 sum() const noexcept {
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
    return out;
  }

 private:
  exit_springs k_;
  mat6 by_pose_;
  vec6 by_place_and_pose_[3];
  mat3 by_place_{0.0};
};

}  // namespace asperity::exits
