// The stiffness of a mixture of ways out: that of the bed, reduced because the motions follow the pose.
#pragma once

#include <cstddef>

#include "asperity/core/math.hpp"
#include "asperity/core/spatial.hpp"
#include "core/cholesky.hpp"
#include "least_motion/bed.hpp"
#include "least_motion/eigen6.hpp"
#include "least_motion/pivot.hpp"
#include "least_motion/way_out.hpp"

namespace asperity::exits {

/// The depth of one sample and its derivatives, world axes.
struct sample_depth {
  vec6 by_pose;             ///< slope by the pose, relief included; the pivot's way too
  vec3 smooth{0.0};         ///< slope of the smooth part by the sample's place
  mat3 hessian_per_m{0.0};  ///< of the smooth part, by the sample's place
  vec3 arm{0.0};            ///< from the pivot to the sample at the pose as given
  vec3 rest{0.0};           ///< from the probe's centre of mass to the sample at the pose as given
  vec3 lever{0.0};          ///< from the probe's centre of mass to the sample where it meets the field
  bool of_probe = true;     ///< the probe's sample; otherwise the field is the probe's, and turns with it
};

/// Second derivatives of the bed of one way out, by the pose and by the motion.
struct way_out_stiffness {
  mat6 by_pose;
  vec6 by_both[6];  ///< column i: by the pose and the motion's coordinate i, shift and turn
  mat6 by_motion;

  /// Adds one sample. The curvature of the relief is left out.
  /// @param rise_n_per_m of its push by its depth   @param push_n 0 leaves the curvature of the bodies out
  void add(double rise_n_per_m, double push_n, const sample_depth& d) noexcept {
    add_outer(by_pose, rise_n_per_m, d.by_pose);
    const vec6 slope{d.smooth, glm::cross(d.arm, d.smooth)};
    for (std::size_t i = 0; i < 6; ++i) by_both[i] += (rise_n_per_m * slope[i]) * d.by_pose;
    add_outer(by_motion, rise_n_per_m, slope);
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
        by_both[r][c] += push_n * h[j][i];
        by_both[r][c + 3] += push_n * mixed[j][i];
      }
      // A turn of the motion moves the sample by e x arm; the slope there, and the arm, follow the pose.
      vec3 e(0.0);
      e[i] = 1.0;
      const vec3 by = glm::cross(e, d.arm), turned_slope = glm::cross(d.smooth, e);
      vec6& both = by_both[r + 3];
      both.linear += push_n * (h * by);
      both.angular += push_n * (glm::transpose(mixed) * by);
      if (d.of_probe) {
        both.angular += push_n * glm::cross(d.rest, turned_slope);
      } else {
        both.linear -= push_n * turned_slope;
      }
    }
    add_at_arm(by_motion, push_n, h, d.arm);
  }

  /// Adds how the pivot and the spring follow the pose, once for all samples.
  /// @param turn_w of the way out   @param pushed_n sum of push times slope
  void add_pivot(const pivot& about, double k_n_per_m, const vec3& turn_w, const vec3& pushed_n) noexcept {
    for (std::size_t r = 0; r < 3; ++r) {
      vec3 e(0.0);
      e[static_cast<int>(r)] = 1.0;
      const vec3 by = glm::cross(pushed_n, e);
      for (int i = 0; i < 3; ++i) by_both[r + 3] += (-by[i]) * about.centre_by_pose[i];
      by_both[r + 3] += (k_n_per_m * turn_w[static_cast<int>(r)]) * about.arm_squared_by_pose;
      by_motion(r + 3, r + 3) += k_n_per_m * about.arm_squared;
    }
  }
};

/// Adds them up. With M = K + by_motion, the motion eliminated (a Schur complement), each way out has
///
///     v_qq = by_pose - by_both M^-1 by_both^T,   v_yq = K M^-1 by_both^T,   v_yy = K - K^2 M^-1
///
/// and y, where the springs pull to, follows too: U_qq = sum w v_qq + v_yq^T (C - v_yy)^-1 v_yq. The weights count
/// as fixed.
class mixed_stiffness {
 public:
  explicit mixed_stiffness(const exit_springs& k) noexcept : k_(k) {}

  void add(double weight, const way_out_stiffness& of) noexcept {
    mat6 m = of.by_motion;
    for (std::size_t i = 0; i < 3; ++i) m(i, i) += k_.each;
    const cholesky6 factors(m);
    if (!factors.positive()) return;
    vec6 inverse[6], follows[6];  // M^-1, and by_both M^-1
    for (std::size_t i = 0; i < 6; ++i) {
      vec6 axis;
      axis[i] = 1.0;
      inverse[i] = factors.solve(axis);
    }
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t j = 0; j < 6; ++j) follows[i] += inverse[i][j] * of.by_both[j];
    }
    for (std::size_t r = 0; r < 6; ++r) {
      for (std::size_t c = 0; c < 6; ++c) {
        double drop = 0.0;
        for (std::size_t i = 0; i < 6; ++i) drop += follows[i][r] * of.by_both[i][c];
        by_pose_(r, c) += weight * (of.by_pose(r, c) - drop);
      }
    }
    for (std::size_t i = 0; i < 3; ++i) by_place_and_pose_[i] += (weight * k_.each) * follows[i];
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        by_place_[static_cast<int>(j)][static_cast<int>(i)] +=
            weight * k_.each * ((i == j ? 1.0 : 0.0) - k_.each * inverse[i][j]);
      }
    }
  }

  /// dW/dq: symmetric, negative semidefinite. Directions in which the bodies' curvature makes the force fall count as
  /// without stiffness.
  [[nodiscard]] mat6 sum() const noexcept {
    constexpr double length_m = 0.01;  // the lever that compares rotations with translations
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
