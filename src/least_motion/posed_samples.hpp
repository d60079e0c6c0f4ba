// The samples of all bodies in each other's fields, at one pose and at motions of the probe from there.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "asperity/core/memory.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/model/scene.hpp"
#include "least_motion/close_branches.hpp"
#include "least_motion/exit_scene.hpp"
#include "least_motion/meeting.hpp"
#include "least_motion/motion.hpp"
#include "least_motion/pivot.hpp"

namespace asperity::exits {

/// The depth that the law of least motion sees,
///
///     D_i(q, x) = S'(place of sample i at pose q, moved by x) + t(place of sample i at pose q)
///
/// x is a motion of the probe, world axes: a translation and a turn about the pivot. The moving shape S' of the field
/// moves with x; the relief t stays as it is at the pose, as far as it is a texture (kept_relief). All memory is taken
/// when it is made.
/// @rt place() and all that follows: safe
class posed_samples {
 public:
  posed_samples(std::shared_ptr<const exit_scene> bodies, const vec3& centre_of_mass_a)
      : bodies_(std::move(bodies)), centre_of_mass_a_(centre_of_mass_a) {
    std::size_t samples = 0, branches = 0;
    for (std::uint32_t b = 0; b < bodies_->fixed.size(); ++b) {
      for (const bool of_probe : {true, false}) {
        meeting m;
        m.of_x = of_probe ? bodies_->probe.get() : bodies_->fixed[b].get();
        m.in_y = of_probe ? bodies_->fixed[b].get() : bodies_->probe.get();
        m.body = b;
        m.of_probe = of_probe;
        m.first_sample = samples;
        m.first_branch = branches;
        samples += m.of_x->marks.samples().size();
        branches += m.of_x->marks.branches().size();
        meetings_.push_back(m);
      }
      steepest_ = std::max(steepest_, bodies_->fixed[b]->bounds.steepest());
    }
    steepest_ = std::max(steepest_, bodies_->probe->bounds.steepest());
    samples_.resize(samples);
    branches_.resize(branches);
    const auto size_of = [](const exit_body& b) {
      return b.marks.branches().empty() ? 0.0 : static_cast<double>(b.marks.branches()[0].radius_m);
    };
    probe_radius_m_ = size_of(*bodies_->probe);
    if (!bodies_->probe->marks.branches().empty()) {
      probe_radius_m_ += glm::length(vec3(bodies_->probe->marks.branches()[0].centre_b) - centre_of_mass_a_);
    }
    double smallest_m = size_of(*bodies_->probe);
    for (const exit_body_ptr& b : bodies_->fixed) {
      const double size_m = size_of(*b);
      if (size_m > 0.0) smallest_m = smallest_m > 0.0 ? std::min(smallest_m, size_m) : size_m;
    }
    patch_m_ = smallest_m / patches_per_radius;
  }

  /// Takes a pose; motions start from here.   @pre one pose per fixed body
  void place(const scene_pose& at, std::size_t most_readings) noexcept {
    count = {0, most_readings, false};
    ++turn_;
    centre_w_ = at.T_wa * centre_of_mass_a_;
    for (meeting& m : meetings_) {
      const pose &T_wa = at.T_wa, &T_wb = at.T_wb[m.body];
      m.T_wx = m.of_probe ? T_wa : T_wb;
      const pose T_yx = inverse(m.of_probe ? T_wb : T_wa) * m.T_wx;
      m.turn_yx = glm::mat3_cast(T_yx.rotation);
      m.shift_y = T_yx.position;
      const mat3 from_w = glm::mat3_cast(glm::conjugate(m.of_probe ? T_wb.rotation : T_wa.rotation));
      m.motion_y = m.of_probe ? from_w : -1.0 * from_w;
      m.pivot_y = vec3(0.0);
    }
    pivot_ = {};
  }

  /// Finds the pivot of the pose that was taken. Before, a motion is a translation.
  /// @param least_arm_m see exit_rule::turn_arm_m; 0: next to no turn
  void find_pivot(double least_arm_m) noexcept {
    constexpr double no_turn_m = 100.0;
    pivot_ = {};
    pivot_.arm_squared = no_turn_m * no_turn_m;
    if (least_arm_m > 0.0) {
      pivot_sum sum;
      for (const meeting& m : meetings_) add_close(m, centre_w_, most_relief(m), patch_m_, count, sum);
      pivot_ = sum.make(least_arm_m, arm_per_spread);
    }
    for (meeting& m : meetings_) {
      m.pivot_y =
          m.turn_yx * (glm::conjugate(m.T_wx.rotation) * (centre_w_ + pivot_.centre - m.T_wx.position)) + m.shift_y;
    }
  }
  [[nodiscard]] const pivot& about() const noexcept { return pivot_; }
  /// No point of the probe is further from the pivot, m.
  [[nodiscard]] double longest_lever_m() const noexcept { return probe_radius_m_ + glm::length(pivot_.centre); }

  [[nodiscard]] const meeting& meeting_of(const mark& m) const noexcept { return meetings_[m.meeting]; }
  /// No shape changes by more per metre of a motion.
  [[nodiscard]] double steepest() const noexcept { return steepest_; }
  [[nodiscard]] const vec3& centre_w() const noexcept { return centre_w_; }

  /// D at a motion x of the probe, m.
  [[nodiscard]] double depth(const mark& m, const motion& x_w) noexcept {
    const meeting& a = meetings_[m.meeting];
    ++count.spent;
    return a.in_y->shape.value_m(moved(a, m.place_y, x_w)) + m.relief_m;
  }

  /// D and its first two derivatives by a translation of the sample, world axes.
  [[nodiscard]] coarse_reading read(const mark& m, const motion& x_w) noexcept {
    const meeting& a = meetings_[m.meeting];
    ++count.spent;
    coarse_reading out = a.in_y->shape.read(moved(a, m.place_y, x_w));
    const mat3 back = glm::transpose(a.motion_y);
    out.value_m += m.relief_m;
    out.slope = back * out.slope;
    out.hessian_per_m = back * out.hessian_per_m * a.motion_y;
    return out;
  }

  /// Slope of the relief by the sample's place at the pose, world axes; as for read(), by a translation of the probe.
  [[nodiscard]] vec3 relief_slope(const mark& m) noexcept {
    const meeting& a = meetings_[m.meeting];
    ++count.spent;
    return glm::transpose(a.motion_y) * relief_at(a, m.place_y).slope;
  }

  /// From the probe's centre of mass to the sample, at the pose as given; world axes.
  [[nodiscard]] vec3 lever_w(const mark& m) const noexcept {
    const meeting& a = meetings_[m.meeting];
    return a.T_wx * vec3(a.of_x->marks.samples()[m.sample].position_b) - centre_w_;
  }
  /// From the pivot to the sample, at the pose as given; world axes. A turn moves the sample by turn x arm.
  [[nodiscard]] vec3 arm_w(const mark& m) const noexcept { return lever_w(m) - pivot_.centre; }

  /// Calls take(mark) for samples that are deeper than above_m at x; take may raise it. Visits the deeper branches
  /// first, so that raising it leaves the others out.
  template <class Take>
  void walk(const motion& x_w, double& above_m, Take&& take) noexcept {
    for (std::uint32_t i = 0; i < meetings_.size(); ++i) walk_meeting(i, x_w, above_m, take);
  }

  /// The deepest sample at x, where one is deeper than above_m.
  [[nodiscard]] bool deepest(const motion& x_w, double above_m, mark& out) noexcept {
    bool any = false;
    walk(x_w, above_m, [&](const mark& m) noexcept {
      out = m;
      above_m = m.depth_m;
      any = true;
    });
    return any;
  }
  /// A sample at x that is deeper than above_m and at least half as deep as the deepest. Where whole faces lie in each
  /// other, thousands are nearly as deep as the deepest; finding the deepest would take a reading of each.
  [[nodiscard]] bool deep_one(const motion& x_w, double above_m, mark& out) noexcept {
    constexpr double beyond = 2.0;
    bool any = false;
    walk(x_w, above_m, [&](const mark& m) noexcept {
      out = m;
      above_m = std::max(m.depth_m, beyond * m.depth_m);
      any = true;
    });
    return any;
  }

  [[nodiscard]] std::size_t heap_bytes() const noexcept {
    return asperity::heap_bytes(meetings_, samples_, branches_) + sizeof(exit_scene) + bodies_->heap_bytes();
  }

  reading_count count;

 private:
  // How the spring that resists a turn grows with the contact, and how finely the contact's middle is found.
  static constexpr double arm_per_spread = 8.0, patches_per_radius = 12.0;

  // A reading of a branch at the pose, where a motion had taken its middle: S' and its slope there bound S' for other
  // motions near by, without another reading.
  struct kept_branch {
    vec3 moved_y{0.0}, place_y{0.0};
    coarse_reading at;
    double bend_per_m = 0.0, bend_within_m = 0.0;
    double relief_m = 0.0;   // no sample of the branch has more
    std::uint64_t turn = 0;  // of the pose that it was read at
  };
  struct kept_sample {
    vec3 moved_y{0.0};
    double smooth_m = 0.0, relief_m = 0.0;
    std::uint64_t turn = 0;
  };

  [[nodiscard]] static field_reading relief_at(const meeting& m, const vec3& place_y) noexcept {
    return m.in_y->relief.read(m.in_y->body->field, place_y);
  }
  [[nodiscard]] static double most_relief(const meeting& m) noexcept {
    return m.in_y->relief.limited(m.in_y->body->field.highest_relief_m);
  }

  // S' at `off_m` or less from where a kept branch was read, where its slope alone would add `along_m`.
  [[nodiscard]] static double most_near(kept_branch& k, double off_m, double along_m,
                                        const field_bounds& bounds) noexcept {
    const double by_steepest = k.at.value_m + bounds.steepest() * off_m;
    learn_bend(k, off_m, bounds);
    return std::min(by_steepest, k.at.value_m + along_m + 0.5 * k.bend_per_m * off_m * off_m);
  }
  static void learn_bend(kept_branch& k, double off_m, const field_bounds& bounds) noexcept {
    if (off_m <= k.bend_within_m) return;
    k.bend_within_m = off_m;
    k.bend_per_m = bounds.bend_per_m(k.place_y, k.bend_within_m);
  }

  // Upper bound of the relief, at the pose, of points within radius_m of where a branch was read. Their feet lie no
  // further apart than the points, but for the turn of the slope. Where the slope is too short for that, the bound
  // stays as it was.
  [[nodiscard]] static double most_relief_near(const meeting& m, kept_branch& k, double radius_m) noexcept {
    constexpr double kept_from = 0.75;  // |grad S|^2, as kept_relief has it
    const double square = glm::dot(k.at.slope, k.at.slope);
    learn_bend(k, radius_m, m.in_y->bounds);
    if (!(square > kept_from) || !(k.bend_per_m * radius_m < 0.3) || m.in_y->shape.is_finer(k.place_y)) {
      return k.relief_m;
    }
    const vec3 foot_y = k.place_y - (k.at.value_m / (square + 1e-3)) * k.at.slope;
    const double turned = k.bend_per_m * radius_m;
    const double deep_m = std::fabs(k.at.value_m) + 1.2 * radius_m;
    const double far_m = radius_m * (1.0 + 0.7 * turned) + (1.6 * turned + 1e-3) * deep_m;
    return m.in_y->relief.limited(m.in_y->body->field.most_relief.most_m(foot_y, far_m));
  }

  // Upper bound of the depth of a branch's samples, moved. Bounds come from the cheap to the sharp: an earlier reading
  // for another motion, the table, and along the branch's planes the slope and the bend.
  [[nodiscard]] double most_in(const meeting& m, std::uint32_t index, const moved_by& by, double most_relief_m,
                               double above_m) noexcept {
    constexpr double table_beyond = 15.0;  // pitches: larger balls are bounded by the table alone
    const branch& b = m.of_x->marks.branches()[index];
    const field_bounds& bounds = m.in_y->bounds;
    const moving_shape& shape = m.in_y->shape;
    const double pitch_m = shape.grid().pitch_m;
    const double radius_m = by.longer * static_cast<double>(b.radius_m);
    kept_branch& k = branches_[m.first_branch + index];
    const bool known = k.turn == turn_;
    const vec3 axis_y = m.turn_yx * vec3(b.axis_b), rest_y = m.turn_yx * vec3(b.centre_b) + m.shift_y;
    const vec3 c_y = by(rest_y), moved_y = c_y - rest_y;
    const auto bound = [&](const vec3& further_y) noexcept {
      const vec3 slope = k.at.slope + glm::cross(k.at.slope, by.turn_y);  // by the place before the turn
      const double along = std::fabs(glm::dot(axis_y, slope));
      const double across = std::sqrt(std::max(0.0, glm::dot(slope, slope) - along * along));
      return most_near(k, radius_m + std::sqrt(glm::dot(further_y, further_y)),
                       glm::dot(k.at.slope, further_y) + along * static_cast<double>(b.half_m) + across * radius_m,
                       bounds);
    };
    double smooth_m = std::numeric_limits<double>::infinity();
    if (known) {
      const vec3 further_y = moved_y - k.moved_y;
      smooth_m = bound(further_y);
      // A reading for every motion would cost more than the halves' own bounds, as long as it is near by.
      const double near_m = std::max(radius_m, pitch_m);
      if (smooth_m + k.relief_m <= above_m || glm::dot(further_y, further_y) < near_m * near_m) {
        return smooth_m + k.relief_m;
      }
    }
    const double relief_m = known ? k.relief_m : most_relief_m;
    ++count.spent;
    smooth_m = std::min(smooth_m, bounds.most_by_table(c_y, radius_m));
    if (smooth_m + relief_m <= above_m || radius_m > table_beyond * pitch_m) return smooth_m + relief_m;
    count.spent += 2;
    k.turn = turn_;
    k.relief_m = relief_m;
    k.moved_y = moved_y;
    k.at = shape.read(c_y);
    k.place_y = c_y;
    k.bend_within_m = -1.0;
    smooth_m = std::min(smooth_m, bound(vec3(0.0)));
    if (!known && moved_y == vec3(0.0)) k.relief_m = std::min(k.relief_m, most_relief_near(m, k, radius_m));
    return smooth_m + k.relief_m;
  }

  template <class Take>
  void walk_meeting(std::uint32_t index, const motion& x_w, double& above_m, Take& take) noexcept {
    const meeting& m = meetings_[index];
    const std::span<const branch> branches = m.of_x->marks.branches();
    if (branches.empty()) return;
    const moved_by by(m, x_w);
    const double relief_m = most_relief(m);
    struct item {
      std::uint32_t branch;
      double most_m;
    };
    // At each of at most 32 levels a sibling waits, and a parent whose bound is updated later.
    std::array<item, 96> waiting;
    constexpr double learns = std::numeric_limits<double>::infinity();
    std::size_t n = 0;
    waiting[n++] = {0, most_in(m, 0, by, relief_m, above_m)};
    while (n > 0) {
      const item it = waiting[--n];
      if (!(it.most_m > above_m)) continue;
      if (!count.left()) return;
      const branch& b = branches[it.branch];
      if (it.most_m == learns) {
        learn_relief(m, it.branch, b.right);
        continue;
      }
      if (b.right == 0) {
        visit_leaf(index, it.branch, by, relief_m, above_m, take);
        continue;
      }
      const kept_branch& parent = branches_[m.first_branch + it.branch];
      const double of_both_m = parent.turn == turn_ ? parent.relief_m : relief_m;
      item near{it.branch + 1, most_in(m, it.branch + 1, by, of_both_m, above_m)};
      item far{b.right, most_in(m, b.right, by, of_both_m, above_m)};
      waiting[n++] = {it.branch, learns};
      if (near.most_m < far.most_m) std::swap(near, far);
      if (far.most_m > above_m) waiting[n++] = far;
      if (near.most_m > above_m) waiting[n++] = near;
    }
  }

  // A branch has no more relief than its halves have.
  void learn_relief(const meeting& m, std::uint32_t parent, std::uint32_t right) noexcept {
    kept_branch& k = branches_[m.first_branch + parent];
    const kept_branch &a = branches_[m.first_branch + parent + 1], &b = branches_[m.first_branch + right];
    if (k.turn == turn_ && a.turn == turn_ && b.turn == turn_) k.relief_m = std::max(a.relief_m, b.relief_m);
  }

  template <class Take>
  void visit_leaf(std::uint32_t index, std::uint32_t leaf, const moved_by& by, double most_relief_m, double& above_m,
                  Take& take) noexcept {
    const meeting& m = meetings_[index];
    const branch& b = m.of_x->marks.branches()[leaf];
    const double steepest = m.in_y->bounds.steepest();
    kept_branch& k = branches_[m.first_branch + leaf];
    const bool bounded = k.turn == turn_;
    if (bounded) most_relief_m = k.relief_m;
    double highest_relief_m = -std::numeric_limits<double>::infinity();
    for (std::uint32_t i = b.first; i < b.first + b.count; ++i) {
      kept_sample& s = samples_[m.first_sample + i];
      const bool known = s.turn == turn_;
      const double relief_m = known ? s.relief_m : most_relief_m;
      highest_relief_m = std::max(highest_relief_m, relief_m);
      const vec3 place_y = m.turn_yx * vec3(m.of_x->marks.samples()[i].position_b) + m.shift_y;
      const vec3 at_y = by(place_y), moved_y = at_y - place_y;
      if (known) {
        const vec3 further_y = moved_y - s.moved_y;
        const double far_m = std::sqrt(glm::dot(further_y, further_y));
        double most_m = s.smooth_m + steepest * far_m;
        if (bounded) {
          const vec3 from_leaf_y = s.moved_y - k.moved_y;
          const double off_m = static_cast<double>(b.radius_m) + std::sqrt(glm::dot(from_leaf_y, from_leaf_y)) + far_m;
          learn_bend(k, off_m, m.in_y->bounds);
          most_m = std::min(most_m, s.smooth_m + glm::dot(k.at.slope, further_y) + k.bend_per_m * off_m * far_m);
        }
        if (!(most_m + relief_m > above_m)) continue;
      }
      if (bounded && !known) {
        const vec3 off_y = at_y - k.place_y;
        const double off_m = std::sqrt(glm::dot(off_y, off_y));
        if (!(most_near(k, off_m, glm::dot(k.at.slope, off_y), m.in_y->bounds) + relief_m > above_m)) continue;
      }
      ++count.spent;
      s.smooth_m = m.in_y->shape.value_m(at_y);
      s.moved_y = moved_y;
      if (!known) {
        if (!(s.smooth_m + most_relief_m > above_m)) continue;
        ++count.spent;
        s.relief_m = relief_at(m, place_y).value_m;
        s.turn = turn_;
      }
      const double depth_m = s.smooth_m + s.relief_m;
      if (depth_m > above_m) take(mark{place_y, s.relief_m, depth_m, i, index});
    }
    if (bounded) k.relief_m = highest_relief_m;
  }

  std::shared_ptr<const exit_scene> bodies_;
  vec3 centre_of_mass_a_, centre_w_{0.0};
  std::vector<meeting> meetings_;
  std::vector<kept_sample> samples_;  // of every meeting, read once per pose where needed
  std::vector<kept_branch> branches_;
  std::uint64_t turn_ = 0;
  double steepest_ = 1.0;
  double patch_m_ = 0.0, probe_radius_m_ = 0.0;
  pivot pivot_;
};

}  // namespace asperity::exits
