// The law of least motion at one pose: energy, wrench and stiffness from all ways out that compete.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>

#include "asperity/core/memory.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/least_motion/least_motion_settings.hpp"
#include "least_motion/bed.hpp"
#include "least_motion/exit_rule.hpp"
#include "least_motion/mix.hpp"
#include "least_motion/posed_samples.hpp"
#include "least_motion/stiffness.hpp"
#include "least_motion/way_finder.hpp"
#include "least_motion/way_out.hpp"

namespace asperity::exits {

/// Solves, for one pose q,
///
///     U(q) = min over ways out z and weights w of   sum w (K/2 z^2 + bed(q, z)) + K^2 / (2 (C - K)) (sum w z)^2
///
/// the least motion that clears, with the regularisation of Lasry and Lions: the force of one way out is k times the
/// motion, and where several compete it changes by no more than C per metre. W = -dU/dq at the minimum: the derivative
/// of the bed by the pose alone, since everything else is at its best (the envelope theorem).
/// Keeps nothing from pose to pose: the wrench is a function of the pose. All memory is taken when it is made.
/// @source J.-M. Lasry and P.-L. Lions, A remark on regularization in Hilbert spaces (1986), for the regularisation
class exit_solver {
 public:
  exit_solver(std::shared_ptr<const exit_scene> bodies, const vec3& centre_of_mass_a, const exit_rule& rule)
      : rule_(rule),
        springs_(rule.springs()),
        bed_(rule.bed_of_samples()),
        finder_(std::move(bodies), centre_of_mass_a, rule) {}

  // A copy would have no room for marks.
  exit_solver(const exit_solver&) = delete;
  exit_solver& operator=(const exit_solver&) = delete;
  exit_solver(exit_solver&&) noexcept = default;
  exit_solver& operator=(exit_solver&&) noexcept = default;
  ~exit_solver() = default;

  /// @pre one pose per fixed body   @rt safe
  void solve(const scene_pose& at) noexcept {
    energy_j_ = 0.0;
    wrench_ = {};
    stiffness_ = {};
    const bool any = finder_.find(at);
    hit_ = finder_.hit();
    if (!any) return;
    posed().count.most += rule_.most_readings / 4;
    add_up();
    hit_.readings |= posed().count.cut;
  }

  [[nodiscard]] const wrench& on_probe_w() const noexcept { return wrench_; }
  /// dW/dq; the weights count as fixed.
  [[nodiscard]] const mat6& stiffness() const noexcept { return stiffness_; }
  [[nodiscard]] double energy_j() const noexcept { return energy_j_; }
  [[nodiscard]] double deepest_m() const noexcept { return finder_.deepest_m(); }  ///< sample at the pose as given
  [[nodiscard]] const ways_out& ways() const noexcept { return finder_.ways(); }
  [[nodiscard]] const posed_samples& samples() const noexcept { return finder_.samples(); }
  [[nodiscard]] const exit_limits_hit& hit() const noexcept { return hit_; }
  [[nodiscard]] std::size_t readings() const noexcept { return samples().count.spent; }
  [[nodiscard]] std::size_t heap_bytes() const noexcept { return finder_.heap_bytes(); }

 private:
  [[nodiscard]] posed_samples& posed() noexcept { return finder_.samples(); }

  void add_up() noexcept {
    energy_j_ = mixed_energy_j(finder_.ways(), springs_);
    unsettled_stiffness_ = {};
    mixed_stiffness stiffness(springs_);
    for (const way_out& w : finder_.ways()) {
      if (!(w.weight > 0.0)) continue;
      bed_patch& patch = finder_.gathered_at(w.moved());
      const double share = w.weight;
      if (!w.settled) {
        pull_out(w);
        continue;
      }
      way_out_stiffness own;
      const pivot& about = posed().about();
      vec3 pushed_n(0.0);
      patch.for_each_inside(w.moved(), posed(), [&](const mark& m, const coarse_reading& d) noexcept {
        const bool of_probe = posed().meeting_of(m).of_probe;
        const vec3 rest = posed().lever_w(m), arm = rest - about.centre, relief = posed().relief_slope(m);
        const vec3 turned_slope = glm::cross(d.slope, w.turn_w);
        // Where the sample meets the field, as seen from the probe as given; a fixed one comes nearer by the motion.
        const vec3 lever = of_probe ? rest : rest - w.z_w - glm::cross(w.turn_w, arm);
        vec6 by_pose{d.slope + relief, glm::cross(lever, d.slope) + glm::cross(rest, relief)};
        if (of_probe) {
          by_pose.angular += glm::cross(rest, turned_slope);
        } else {
          by_pose.linear -= turned_slope;
        }
        for (int i = 0; i < 3; ++i) by_pose += (-turned_slope[i]) * about.centre_by_pose[i];
        const double push_n = bed_.push_n(d.value_m);
        pushed_n += push_n * d.slope;
        wrench_ += to_wrench((-share * push_n) * by_pose);
        own.add(bed_.rise_n_per_m(d.value_m), push_n, {by_pose, d.slope, d.hessian_per_m, arm, rest, lever, of_probe});
      });
      wrench_ += to_wrench((-0.5 * share * rule_.stiffness_n_per_m * glm::dot(w.turn_w, w.turn_w)) *
                           about.arm_squared_by_pose);
      own.add_pivot(about, rule_.stiffness_n_per_m, w.turn_w, pushed_n);
      stiffness.add(share, own);
    }
    stiffness_ = stiffness.sum() + unsettled_stiffness_;
  }

  // Where an iteration was cut short the bed's push may be anything. In balance it is the spring's pull: that, at the
  // deepest sample.
  void pull_out(const way_out& w) noexcept {
    const vec3 pull_n = (w.weight * springs_.one) * w.z_w, lever = posed().lever_w(finder_.deepest());
    wrench_ += wrench{pull_n, glm::cross(lever, pull_n)};
    const double length = glm::length(w.z_w);
    if (!(length > 0.0)) return;
    const vec3 along = w.z_w / length;
    add_outer(unsettled_stiffness_, -w.weight * rule_.stiffness_n_per_m, {along, glm::cross(lever, along)});
  }

  exit_rule rule_;
  exit_springs springs_;
  bed_rule bed_;
  way_finder finder_;
  wrench wrench_;
  mat6 stiffness_, unsettled_stiffness_;
  double energy_j_ = 0.0;
  exit_limits_hit hit_;
};

}  // namespace asperity::exits
