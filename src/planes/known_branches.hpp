// What earlier ticks know of whole branches of samples: upper bounds of their depths.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "asperity/core/memory.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/field/field_body.hpp"
#include "asperity/field/field_scene.hpp"
#include "asperity/field/sample_tree.hpp"
#include "asperity/model/scene.hpp"
#include "planes/patch_slopes.hpp"

namespace asperity {

/// Upper bounds of how deep the samples of each ball of one body's tree lie in another body's field.
class branch_bounds {
 public:
  branch_bounds() = default;
  /// @param balls most that a tree may have   @param opened most balls that a tick may look into
  branch_bounds(std::size_t balls, std::size_t opened) {
    detail::reserve_resident(kept_m_, balls);
    detail::reserve_resident(opened_, opened);
  }

  /// Nothing is known of a tree of so many balls. @rt safe
  void forget(std::size_t balls) noexcept {
    kept_m_.assign(balls, std::numeric_limits<float>::infinity());
    opened_.clear();
    grown_m_ = 0.0;
  }
  /// No sample of the ball is deeper, m. @rt safe
  [[nodiscard]] double most_m(std::uint32_t ball) const noexcept {
    return static_cast<double>(kept_m_[ball]) + grown_m_;
  }
  /// No bound is kept that is lower than -deepest_m. @rt safe
  void note(std::uint32_t ball, double most_m) noexcept {
    kept_m_[ball] = static_cast<float>(std::max(most_m, -deepest_m) - grown_m_) + rounding_m;
  }
  /// Samples have moved: all bounds grow. @rt safe
  void grow(double by_m) noexcept {
    grown_m_ += by_m;
    // Single precision keeps a bound to a hundredth of a micrometre up to here.
    if (!(grown_m_ < 0.25)) forget(kept_m_.size());
  }
  /// The tick looks at the halves of this ball: fold() takes its bound from theirs. @rt safe
  void open(const sample_tree::branch& b) noexcept {
    if (opened_.size() < opened_.capacity()) opened_.push_back({b.number, b.left, b.right});
  }
  /// A ball is no deeper than its halves. For the end of a tick, when all that it found is noted. @rt safe
  void fold() noexcept {
    for (auto b = opened_.rbegin(); b != opened_.rend(); ++b) {
      kept_m_[b->whole] = std::min(kept_m_[b->whole], std::max(kept_m_[b->left], kept_m_[b->right]));
    }
    opened_.clear();
  }
  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(kept_m_, opened_); }

  static constexpr double deepest_m = 0.02;

 private:
  static constexpr float rounding_m = 3e-8F;
  struct halves {
    std::uint32_t whole, left, right;
  };

  std::vector<float> kept_m_;  // bounds less grown_m_
  std::vector<halves> opened_;
  double grown_m_ = 0.0;
};

/// The branch_bounds of the pairs of bodies that were near last. They spare readings and decide nothing. Only a few
/// pairs have room; where another one comes near, the pair that was not near for the longest time gives its room away.
/// So memory does not grow with the number of bodies.
///
/// A tick moves a sample by less than the slide of the probe's centre of mass and the turn about it times a lever. That
/// is true of samples within the lever. A sample beyond it lies further from the probe's grid than
/// branch_bounds::deepest_m, however the probe turns, and no bound says more than that.
class known_branches {
 public:
  /// Takes all memory.
  /// @param most_balls of the trees of bodies that may come into the scene; 0: it does not change
  known_branches(const field_scene& bodies, const vec3& centre_of_mass_a, std::size_t most_balls = 0)
      : centre_of_mass_a_(centre_of_mass_a) {
    const detail::coarse_grid& grid = bodies.probe->field.smooth;
    vec3 far(0.0);
    for (int k = 0; k < 3; ++k) {
      const double side_m = static_cast<double>(grid.nodes[static_cast<std::size_t>(k)] - 1) * grid.pitch_m;
      far[k] =
          std::max(std::fabs(grid.low[k] - centre_of_mass_a[k]), std::fabs(grid.low[k] + side_m - centre_of_mass_a[k]));
    }
    lever_m_ = std::sqrt(glm::dot(far, far)) + branch_bounds::deepest_m;
    for (const field_body_ptr& b : bodies.fixed) {
      if (b) most_balls = std::max(most_balls, b->samples.balls());
    }
    rooms_.resize(std::min(most_rooms, bodies.fixed.size()));
    for (room& r : rooms_) {
      r.of_probe = branch_bounds(bodies.probe->samples.balls(), most_opened);
      r.of_fixed = branch_bounds(most_balls, most_opened);
    }
  }

  /// Begins a tick. @rt safe
  void begin(const scene_pose& at) noexcept {
    ++tick_;
    for (room& r : rooms_) {
      if (r.body == nobody) continue;
      const pose T_ba = inverse(at.T_wb[r.body]) * at.T_wa;
      const vec3 slid = T_ba * centre_of_mass_a_ - r.T_ba * centre_of_mass_a_;
      const quat turn = glm::conjugate(r.T_ba.rotation) * T_ba.rotation;
      const double slid_m = std::sqrt(glm::dot(slid, slid));
      const double chord = 2.0 * std::sqrt(turn.x * turn.x + turn.y * turn.y + turn.z * turn.z);
      r.T_ba = T_ba;
      const double grown_m = steepest_depth * (slid_m + chord * (lever_m_ + slid_m)) + rounding_m;
      r.of_probe.grow(grown_m);
      r.of_fixed.grow(grown_m);
    }
  }

  /// What is known of a pair that is near in this tick; null where other pairs have all the room.
  struct pair_bounds {
    branch_bounds* of_probe = nullptr;
    branch_bounds* of_fixed = nullptr;
  };
  /// @rt safe
  [[nodiscard]] pair_bounds of(std::uint32_t body, const scene_pose& at, const field_scene& bodies) noexcept {
    room* r = find(body);
    if (r == nullptr) {
      r = unused();
      if (r == nullptr) return {};
      r->body = body;
      r->T_ba = inverse(at.T_wb[body]) * at.T_wa;
      r->of_probe.forget(bodies.probe->samples.balls());
      r->of_fixed.forget(bodies.fixed[body]->samples.balls());
    }
    r->near_in = tick_;
    return {&r->of_probe, &r->of_fixed};
  }

  /// Nothing is known of a body any more: another one is in its place. @rt safe
  void forget(std::uint32_t body) noexcept {
    room* const r = find(body);
    if (r == nullptr) return;
    r->body = nobody;
    r->near_in = 0;
  }

  /// Notes that no sample of a ball is deeper. @rt safe
  void note(std::uint32_t body, bool of_probe, std::uint32_t ball, double most_m) noexcept {
    room* const r = find(body);
    if (r == nullptr) return;
    branch_bounds& bounds = of_probe ? r->of_probe : r->of_fixed;
    if (most_m < bounds.most_m(ball)) bounds.note(ball, most_m);
  }
  /// Ends a tick. @rt safe
  void fold() noexcept {
    for (room& r : rooms_) {
      r.of_probe.fold();
      r.of_fixed.fold();
    }
  }

  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(rooms_); }

 private:
  static constexpr std::size_t most_rooms = 8, most_opened = 16384;
  static constexpr std::uint32_t nobody = std::numeric_limits<std::uint32_t>::max();
  static constexpr double rounding_m = 1e-12;

  struct room {
    std::uint32_t body = nobody;
    std::uint64_t near_in = 0;  // the last tick in which the pair was near
    pose T_ba{};
    branch_bounds of_probe, of_fixed;
    [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(of_probe, of_fixed); }
  };

  [[nodiscard]] room* find(std::uint32_t body) noexcept {
    for (room& r : rooms_) {
      if (r.body == body) return &r;
    }
    return nullptr;
  }
  [[nodiscard]] room* unused() noexcept {
    room* out = nullptr;
    for (room& r : rooms_) {
      if (r.near_in != tick_ && (out == nullptr || r.near_in < out->near_in)) out = &r;
    }
    return out;
  }

  vec3 centre_of_mass_a_;
  double lever_m_ = 0.0;
  std::vector<room> rooms_;
  std::uint64_t tick_ = 0;
};

}  // namespace asperity
