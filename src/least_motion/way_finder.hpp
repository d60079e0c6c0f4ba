// Finds the ways out of one pose, and how they share its weight.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "asperity/core/memory.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/least_motion/least_motion_settings.hpp"
#include "core/cholesky.hpp"
#include "least_motion/bed.hpp"
#include "least_motion/descent.hpp"
#include "least_motion/directions.hpp"
#include "least_motion/exit_rule.hpp"
#include "least_motion/mix.hpp"
#include "least_motion/other_ways_out.hpp"
#include "least_motion/posed_samples.hpp"
#include "least_motion/way_out.hpp"

namespace asperity::exits {

/// The ways out of one pose: a first one, then others as long as one is found that is cheaper than the mixture of those
/// known. Keeps nothing from pose to pose. All memory is taken when it is made.
/// @rt find() and all that follows: safe, no more readings than the rule has
class way_finder {
 public:
  way_finder(std::shared_ptr<const exit_scene> bodies, const vec3& centre_of_mass_a, const exit_rule& rule)
      : rule_(rule),
        springs_(rule.springs()),
        bed_(rule.bed_of_samples()),
        directions_(even_directions(4)),
        samples_(std::move(bodies), centre_of_mass_a),
        others_(descent_),
        patches_{bed_patch(rule.most_marks), bed_patch(rule.most_marks), bed_patch(rule.most_marks),
                 bed_patch(rule.most_marks)} {}

  /// False where nothing overlaps.   @pre one pose per fixed body
  [[nodiscard]] bool find(const scene_pose& at) noexcept {
    samples_.place(at, rule_.most_readings);
    forget_patches();
    next_patch_ = 0;
    ways_.clear();
    deepest_m_ = 0.0;
    hit_ = {};
    const bool any = find_first();
    if (any) {
      find_others();
      for (const way_out& w : ways_) hit_.unsettled |= w.weight > 0.0 && !w.settled;
      if (samples_.count.cut) forget_patches();  // a patch that was being gathered lacks samples
    }
    hit_.readings = samples_.count.cut;
    return any;
  }

  [[nodiscard]] const ways_out& ways() const noexcept { return ways_; }
  [[nodiscard]] ways_out& ways() noexcept { return ways_; }
  [[nodiscard]] const mark& deepest() const noexcept { return deepest_; }  ///< at the pose as given
  [[nodiscard]] double deepest_m() const noexcept { return deepest_m_; }   ///< of it; 0 where nothing overlaps
  [[nodiscard]] const exit_limits_hit& hit() const noexcept { return hit_; }
  [[nodiscard]] posed_samples& samples() noexcept { return samples_; }
  [[nodiscard]] const posed_samples& samples() const noexcept { return samples_; }
  /// The samples about a motion of one of the ways out.
  [[nodiscard]] bed_patch& gathered_at(const motion& x) noexcept {
    bed_patch& patch = patch_at(x);
    if (!patch.covers(x, samples_)) patch.gather(x, samples_);
    return patch;
  }

  [[nodiscard]] std::size_t heap_bytes() const noexcept {
    std::size_t bytes = asperity::heap_bytes(directions_, samples_);
    for (const bed_patch& p : patches_) bytes += p.heap_bytes();
    return bytes;
  }

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  // The first way out, settled as if it were alone: the one that a descent from here leads to, or the nearest that a
  // search finds where the descent ends inside, half way between two walls. False where nothing overlaps.
  [[nodiscard]] bool find_first() noexcept {
    constexpr double shallow_m = 30e-6;  // up to here the iteration needs no descent
    mark m;
    if (!samples_.deepest(vec3(0.0), 0.0, m)) return false;
    deepest_ = m;
    deepest_m_ = m.depth_m;
    samples_.find_pivot(rule_.turn_arm_m);
    vec3 z(0.0);
    if (m.depth_m > shallow_m) {
      met_.clear();
      static_cast<void>(met_.push_back(m));
      z = descend(vec3(0.0), z, descent_, met_, true, infinity, {}, samples_);
    }
    way_out first = settle_from(springs_.one, vec3(0.0), z);
    double most_m = 1.5 * m.depth_m;
    for (int wider = 0; wider < 8 && !is_out(first) && samples_.count.left(); ++wider, most_m *= 1.6) {
      others_.search({vec3(0.0), most_m, shallow_m, infinity}, {}, directions_, samples_, found_);
      for (const vec3& start : found_) {
        const way_out w = settle_from(springs_.one, vec3(0.0), start);
        if (is_out(w) && (!is_out(first) || w.cost_j(springs_, vec3(0.0)) < first.cost_j(springs_, vec3(0.0)))) {
          first = w;
        }
      }
    }
    if (samples_.count.cut) {
      // Too few readings to settle. A descent that was cut may end anywhere; out of the deepest sample is near by.
      if (!(first.settled && is_out(first))) {
        first = {};
        first.z_w = out_of(m);
      }
      first.settled = false;
    } else if (!(first.bed.deepest_m > 0.0)) {
      return false;
    }
    first.settled = first.settled && is_out(first);
    first.weight = 1.0;
    static_cast<void>(ways_.push_back(first));
    return true;
  }

  // The motion that takes one sample out of the body, by its plane at the pose.
  [[nodiscard]] vec3 out_of(const mark& m) noexcept {
    const vec3 slope = samples_.read(m, vec3(0.0)).slope;
    const double length = glm::length(slope);
    return length > 0.0 ? (-m.depth_m / length) * slope : vec3(0.0);
  }

  // Where a way out is clear, the bed gives way by a fiftieth of the motion and costs a fiftieth as much. Where it
  // gives way by more than a tenth, or costs as much as the motion, it pushes from both sides: the place is inside.
  [[nodiscard]] bool is_out(const way_out& w) const noexcept {
    const double length = length_m(w.z_w, w.turn_w), light = 4.0 * bed_.onset_m;
    return w.bed.deepest_m <= 0.1 * length + light &&
           w.bed.energy_j <= 0.5 * springs_.one * length * length + bed_.energy_j(light);
  }

  // A turn counts as the way that it moves a point an arm away.
  [[nodiscard]] double length_m(const vec3& z, const vec3& turn) const noexcept {
    return std::sqrt(glm::dot(z, z) + samples_.about().arm_squared * glm::dot(turn, turn));
  }
  [[nodiscard]] double apart_m(const way_out& a, const way_out& b) const noexcept {
    return length_m(a.z_w - b.z_w, a.turn_w - b.turn_w);
  }

  // Adds ways out until none is found that would be cheaper than the mixture of those known.
  void find_others() noexcept {
    constexpr int most_rounds = 60;
    constexpr double beyond = 1.3;       // a ray comes out beside a way out, further away; with 1.1 some are missed
    constexpr double useful = 1.1;       // a turn and the bed make a way out cheaper by up to a sixth
    constexpr double clear_of_m = 2e-6;  // outside: not deeper than the bed gives way, and this
    constexpr int whole_steps = 6, half_steps = 18;
    vec3 y = mix(ways_, springs_);
    bool at_rest = true;  // a single way out was settled as it is
    int settling = 0;
    for (int round = 0; round < most_rounds; ++round) {
      if (!at_rest) {
        at_rest = settle_again(y);
        const vec3 next = mix(ways_, springs_);
        ++settling;
        // Near a crest a way out goes several times as far as the place it is seen from, and that goes a quarter as far
        // the other way: whole steps swing to and fro without end.
        y += (at_rest || settling <= whole_steps ? 1.0 : settling <= half_steps ? 0.5 : 0.25) * (next - y);
        continue;
      }
      settling = 0;
      double least_j = ways_[0].cost_j(springs_, y), sunk_m = 0.0;
      for (const way_out& w : ways_) {
        least_j = std::min(least_j, w.cost_j(springs_, y));
        if (w.weight > 0.0) sunk_m = std::max(sunk_m, w.bed.deepest_m);
      }
      const double least_m = std::sqrt(2.0 * least_j / springs_.each);
      others_.search({y, beyond * least_m, sunk_m + clear_of_m, useful * least_m}, {ways_.data(), ways_.size()},
                     directions_, samples_, found_);
      for (const vec3& z : found_) {
        if (add(settle_from(springs_.each, y, z), y, least_j)) at_rest = false;
      }
      if (at_rest && !samples_.count.cut) at_rest = !look_beside(y, least_j, useful * least_m);
      if (at_rest || samples_.count.cut) return;
      y = mix(ways_, springs_);
    }
    hit_.rounds = true;
  }

  // Finds another way out close beside one past several walls or over a crest, closer than the search can separate, by
  // descents from places beside it. True where there is a new one.
  [[nodiscard]] bool look_beside(const vec3& y, double least_j, double useful_m) noexcept {
    constexpr int starts = 12;                      // around it, near and far in turn
    constexpr double near_by = 0.1, far_by = 0.22;  // of the way; with one of them, or four sides, some are missed
    // Descents cost much where whole faces lie in each other: they may spend as much as the search has so far, and
    // leave an eighth of all readings for settling what they find.
    const std::size_t hard = samples_.count.most, spent = samples_.count.spent;
    samples_.count.most = std::min(hard - hard / 8, spent + std::max<std::size_t>(spent, 60'000));
    bool any = false;
    const std::size_t known = ways_.size();
    for (std::size_t i = 0; i < known && !samples_.count.cut; ++i) {
      if (!(ways_[i].weight > 0.0) || ways_[i].looked_beside) continue;
      ways_[i].looked_beside = true;
      const way_out w = ways_[i];
      const double length = glm::length(w.z_w - y);
      if (!(length > 0.0) || (!has_walls(w) && !is_on_a_crest(w))) continue;
      const vec3 along = (w.z_w - y) / length, u = any_orthogonal(along), v = glm::cross(along, u);
      const std::span<const mark> own(w.touching.data(), w.touching.size());
      const vec3 home = relax(y, w.z_w, own, descent_, {}, 0.0, samples_);
      for (int n = 0; n < starts && samples_.count.left(); ++n) {
        const double turned = 2.0 * std::numbers::pi * n / starts;
        const double beside_m = std::max(60e-6, (n % 2 == 0 ? near_by : far_by) * length);
        const vec3 start = w.z_w + 0.1 * length * along + beside_m * (std::cos(turned) * u + std::sin(turned) * v);
        // Where its own samples lead back to it, further samples could only make another way out longer.
        if (glm::length(relax(y, start, own, descent_, {&home, 1}, 10e-6, samples_) - home) < 10e-6) continue;
        met_.clear();
        for (const mark& m : own) static_cast<void>(met_.push_back(m));
        const vec3 z = descend(y, start, descent_, met_, false, useful_m, {}, samples_);
        if (glm::length(z - w.z_w) > 10e-6 && add(settle_from(springs_.each, y, {z, w.turn_w}), y, least_j)) any = true;
      }
    }
    samples_.count.most = hard;
    if (samples_.count.cut) {
      samples_.count.cut = false;
      forget_patches();  // a patch that was being gathered may lack samples
    }
    return any;
  }
  // Seen from y, whose spring is the weaker one, a way out over a crest slides off to either side.
  [[nodiscard]] bool is_on_a_crest(const way_out& w) const noexcept {
    mat6 h = w.bed.hessian;
    const double arm_m = std::sqrt(samples_.about().arm_squared), steady = springs_.each - 0.25 * springs_.one;
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t j = 0; j < 6; ++j) h(i, j) /= (i < 3 ? 1.0 : arm_m) * (j < 3 ? 1.0 : arm_m);
    }
    for (std::size_t i = 0; i < 3; ++i) h(i, i) += steady;
    return !cholesky6(h).positive();
  }
  [[nodiscard]] bool has_walls(const way_out& w) noexcept {
    vec3 first(0.0);
    for (const mark& m : w.touching) {
      const vec3 n = glm::normalize(samples_.read(m, w.moved()).slope);
      if (first == vec3(0.0)) first = n;
      if (glm::dot(n, first) < 0.995) return true;
    }
    return false;
  }

  // Settles the ways out that have weight, or nearly so, as seen from y. True where none has moved.
  [[nodiscard]] bool settle_again(const vec3& y) noexcept {
    constexpr double still_m = 1e-10, same_m = 50e-6, nearly = 1.05;
    bool at_rest = true;
    double most_j = 0.0;
    for (const way_out& w : ways_) {
      if (w.weight > 0.0) most_j = std::max(most_j, nearly * w.cost_j(springs_, y));
    }
    const std::size_t known = ways_.size();
    for (std::size_t i = 0; i < known && !samples_.count.cut; ++i) {
      if (ways_[i].cost_j(springs_, y) > most_j) continue;
      way_out now = settle_from(springs_.each, y, ways_[i].moved());
      if (samples_.count.cut) return true;
      const double moved_m = apart_m(now, ways_[i]);
      if (moved_m < same_m) {
        now.weight = ways_[i].weight;
        now.looked_beside = ways_[i].looked_beside;
        ways_[i] = now;
        at_rest = at_rest && (moved_m < still_m || now.weight == 0.0);
      } else {
        at_rest = !add(now, y, most_j) && at_rest;
      }
    }
    drop_doubles();
    return at_rest;
  }

  // Two that have come to rest in one place are one.
  void drop_doubles() noexcept {
    constexpr double same_m = 5e-7;
    for (std::size_t i = 0; i < ways_.size(); ++i) {
      for (std::size_t j = ways_.size(); --j > i;) {
        if (!(apart_m(ways_[i], ways_[j]) < same_m)) continue;
        ways_[i].weight += ways_[j].weight;
        ways_[j] = ways_[ways_.size() - 1];
        ways_.truncate(ways_.size() - 1);
      }
    }
  }

  // Resists turns, N m per rad: as a contact of stiffness k an arm away would.
  [[nodiscard]] double turn_stiffness() const noexcept {
    return rule_.stiffness_n_per_m * samples_.about().arm_squared;
  }

  [[nodiscard]] way_out settle_from(double k_n_per_m, const vec3& y, const motion& x) noexcept {
    bed_patch& patch = patch_at(x);
    const way_out out = settle({k_n_per_m, y, turn_stiffness()}, x, bed_, patch, samples_);
    hit_.marks |= patch.crowded;
    return out;
  }

  void forget_patches() noexcept {
    for (bed_patch& p : patches_) p.clear();
  }

  // One that covers x, or the one that was filled first: a few ways out are settled again and again.
  [[nodiscard]] bed_patch& patch_at(const motion& x) noexcept {
    for (bed_patch& p : patches_) {
      if (p.covers(x, samples_)) return p;
    }
    next_patch_ = (next_patch_ + 1) % patches_.size();
    patches_[next_patch_].clear();
    return patches_[next_patch_];
  }

  // True where it is new and cheaper than all known ones.
  bool add(way_out w, const vec3& y, double least_j) noexcept {
    constexpr double same_m = 5e-7, cheaper = 1.0 - 1e-10;
    if (samples_.count.cut || !is_out(w)) return false;  // where the count is cut its bed may lack samples
    if (!(w.cost_j(springs_, y) < cheaper * least_j)) return false;
    for (const way_out& k : ways_) {
      if (apart_m(k, w) < same_m) return false;
    }
    if (ways_.full()) {
      const auto idle = std::remove_if(ways_.begin(), ways_.end(), [](const way_out& k) { return k.weight == 0.0; });
      ways_.truncate(static_cast<std::size_t>(idle - ways_.begin()));
    }
    w.weight = 0.0;
    const bool fits = ways_.push_back(w);
    hit_.rounds |= !fits;
    return fits;
  }

  exit_rule rule_;
  exit_springs springs_;
  bed_rule bed_;
  descent_rule descent_;
  std::vector<vec3> directions_;
  posed_samples samples_;
  other_ways_out others_;
  std::array<bed_patch, 4> patches_;
  std::size_t next_patch_ = 0;
  witnesses met_;
  ways_out ways_;
  found_places found_;
  mark deepest_;
  double deepest_m_ = 0.0;
  exit_limits_hit hit_;
};

}  // namespace asperity::exits
