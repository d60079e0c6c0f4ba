// The law of least motion at one pose: energy, wrench and stiffness from all ways out that compete.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>

#include "asperity/core/memory.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/least_motion/least_motion_settings.hpp"
#include "least_motion/bed.hpp"
#include "least_motion/exit_rule.hpp"
#include "least_motion/mix.hpp"
#include "least_motion/posed_samples.hpp"
#include "least_motion/way_finder.hpp"
#include "least_motion/way_out.hpp"

namespace asperity::exits {

/// Solves, for one pose q (least_motion.cpp),
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

  /// @pre one pose per fixed body
  /// @param by_body of each fixed body, or empty: its part of the wrench is added. The pivot's part, and what pulls at a
  /// way out that did not settle, is of the body that holds the deepest sample.
  /// @rt safe
  void solve(const scene_pose& at, std::span<wrench> by_body = {}) noexcept;

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

  // Adds up the wrench and the stiffness of the ways out that have weight.
  void add_up(std::span<wrench> by_body) noexcept;
  // Adds the spring's pull, at the deepest sample, for a way out that did not settle: the bed's push, which equals the
  // pull in balance, may be anything there.
  void pull_out(way_out& w, std::span<wrench> by_body) noexcept;
  // Adds to the wrench, to the part of a way out, and to what one body does.
  void push(const wrench& part, way_out& by, std::uint32_t body, std::span<wrench> by_body) noexcept {
    wrench_ += part;
    by.on_probe_w += part;
    if (body < by_body.size()) by_body[body] += part;
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
