// The law of least motion at one pose: energy, wrench and stiffness from all ways out that compete.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "asperity/core/memory.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/core/status.hpp"
#include "asperity/exits/bed.hpp"
#include "asperity/exits/descent.hpp"
#include "asperity/exits/directions.hpp"
#include "asperity/exits/mix.hpp"
#include "asperity/exits/other_ways_out.hpp"
#include "asperity/exits/posed_samples.hpp"
#include "asperity/exits/stiffness.hpp"
#include "asperity/exits/way_out.hpp"

namespace asperity::exits {

/// Numbers of the law.
struct exit_rule {
  double stiffness_n_per_m = 2000.0;  ///< k: of a contact
  double onset_m = 15e-6;             ///< see bed_rule
  double bed = 50.0;                  ///< stiffness of the bed for each sample, in units of k
  double mixed = 4.0;                 ///< bound of the force's slope where ways out are mixed, in units of k
  /// Ways out may turn as well, on a spring of k times the square of this arm and more for a wide contact: a face that
  /// rocks is let out. 0: they are translations. With 25 mm some contacts beside the pivot are softer by 2 to 4 %.
  double turn_arm_m = 0.0;
  std::size_t most_readings = 2'000'000;  ///< of the search; the sum at its end may take a quarter more
  std::size_t most_marks = 32'768;        ///< samples that may touch at one way out

  [[nodiscard]] bed_rule bed_of_samples() const noexcept { return {bed * stiffness_n_per_m, onset_m}; }
  /// The springs in series with the bed make k: exactly for a contact of two samples, within 1 % for one and for many.
  [[nodiscard]] exit_springs springs() const noexcept {
    exit_springs out;
    const double compliance = (1.0 - 0.5 / bed) / stiffness_n_per_m;
    out.mixed = mixed * stiffness_n_per_m;
    out.one = 1.0 / compliance;
    out.each = 1.0 / (compliance + 1.0 / out.mixed);
    return out;
  }
};

/// What a solve had to leave out.
struct exit_limits_hit {
  bool readings = false;   ///< exit_rule::most_readings: ways out may be missing
  bool marks = false;      ///< exit_rule::most_marks: the bed of one way out is incomplete
  bool unsettled = false;  ///< a way out with weight did not come to rest
  bool rounds = false;     ///< the weights still changed at the last round

  [[nodiscard]] bool any() const noexcept { return readings || marks || unsettled || rounds; }
};

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
        directions_(even_directions(4)),
        samples_(std::move(bodies), centre_of_mass_a),
        others_(descent_),
        patches_{bed_patch(rule.most_marks), bed_patch(rule.most_marks), bed_patch(rule.most_marks),
                 bed_patch(rule.most_marks)} {}

  // A copy would have no room for marks.
  exit_solver(const exit_solver&) = delete;
  exit_solver& operator=(const exit_solver&) = delete;
  exit_solver(exit_solver&&) noexcept = default;
  exit_solver& operator=(exit_solver&&) noexcept = default;
  ~exit_solver() = default;

  /// @pre one pose per fixed body   @rt safe
  void solve(const scene_pose& at) noexcept {
    samples_.place(at, rule_.most_readings);
    for (bed_patch& p : patches_) p.clear();
    next_patch_ = 0;
    ways_.clear();
    energy_j_ = deepest_m_ = 0.0;
    wrench_ = {};
    stiffness_ = {};
    hit_ = {};
    if (find_first()) {
      find_others();
      for (const way_out& w : ways_) hit_.unsettled |= w.weight > 0.0 && !w.settled;
      hit_.readings = samples_.count.cut;
      if (samples_.count.cut) {  // what was being gathered then lacks samples
        for (bed_patch& p : patches_) p.clear();
      }
      samples_.count.most += rule_.most_readings / 4;
      add_up();
    }
    hit_.readings |= samples_.count.cut;
  }

  [[nodiscard]] const wrench& on_probe_w() const noexcept { return wrench_; }
  /// dW/dq; the weights count as fixed.
  [[nodiscard]] const mat6& stiffness() const noexcept { return stiffness_; }
  [[nodiscard]] double energy_j() const noexcept { return energy_j_; }
  [[nodiscard]] double deepest_m() const noexcept { return deepest_m_; }  ///< sample at the pose as given
  [[nodiscard]] const ways_out& ways() const noexcept { return ways_; }
  [[nodiscard]] const posed_samples& samples() const noexcept { return samples_; }
  [[nodiscard]] const exit_limits_hit& hit() const noexcept { return hit_; }
  [[nodiscard]] std::size_t readings() const noexcept { return samples_.count.spent; }
  [[nodiscard]] std::size_t heap_bytes() const noexcept {
    std::size_t bytes = asperity::heap_bytes(directions_, samples_);
    for (const bed_patch& p : patches_) bytes += p.heap_bytes();
    return bytes;
  }

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  // A way out, as if it were alone: the one that a descent from here leads to, or the nearest that a search finds where
  // the descent ends inside, half way between two walls. False where nothing overlaps.
  [[nodiscard]] bool find_first() noexcept {
    constexpr double shallow_m = 30e-6;  // from here the iteration finds its way alone
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
      // Too little to settle: what the descent has come to, or what a settled way was known.
      if (!(first.settled && is_out(first))) {
        first = {};
        first.z_w = z;
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

  // The bed gives way by a fiftieth of the motion. Deeper than a tenth is a place where it pushes from both sides.
  [[nodiscard]] bool is_out(const way_out& w) const noexcept {
    return w.bed.deepest_m <= 0.1 * length_m(w.z_w, w.turn_w) + 4.0 * bed_.onset_m;
  }

  // A turn counts as the way that it moves a point an arm away.
  [[nodiscard]] double length_m(const vec3& z, const vec3& turn) const noexcept {
    return std::sqrt(glm::dot(z, z) + samples_.about().arm_squared * glm::dot(turn, turn));
  }
  [[nodiscard]] double apart_m(const way_out& a, const way_out& b) const noexcept {
    return length_m(a.z_w - b.z_w, a.turn_w - b.turn_w);
  }

  // Adds ways out until none is missing that would be cheaper than the mixture of those there are.
  void find_others() noexcept {
    constexpr int most_rounds = 60;
    constexpr double beyond = 1.3;       // a ray comes out beside a way out, further away; with 1.1 some are missed
    constexpr double useful = 1.06;      // a turn makes a way out cheaper by an eighth at most
    constexpr double clear_of_m = 2e-6;  // outside: not deeper than the bed gives way, and this
    vec3 y = mix(ways_, springs_);
    bool at_rest = true;  // a single way out was settled as it is
    for (int round = 0; round < most_rounds; ++round) {
      if (!at_rest) {
        at_rest = settle_again(y);
        y = mix(ways_, springs_);
        continue;
      }
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
      if (at_rest || samples_.count.cut) return;
      y = mix(ways_, springs_);
    }
    hit_.rounds = true;
  }

  // Settles the ways out that count, or nearly so, as seen from y. True where none has moved.
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

  // One that covers x, or the one that was filled first: a few ways out are settled again and again.
  [[nodiscard]] bed_patch& patch_at(const motion& x) noexcept {
    for (bed_patch& p : patches_) {
      if (p.covers(x, samples_)) return p;
    }
    next_patch_ = (next_patch_ + 1) % patches_.size();
    patches_[next_patch_].clear();
    return patches_[next_patch_];
  }

  // True where it is new and cheaper than all there are.
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

  void add_up() noexcept {
    energy_j_ = mixed_energy_j(ways_, springs_);
    unsettled_stiffness_ = {};
    mixed_stiffness stiffness(springs_);
    for (const way_out& w : ways_) {
      if (!(w.weight > 0.0)) continue;
      bed_patch& patch = patch_at(w.moved());
      if (!patch.covers(w.moved(), samples_)) patch.gather(w.moved(), samples_);
      const double share = w.weight;
      if (!w.settled) {
        pull_out(w);
        continue;
      }
      way_out_stiffness own;
      const pivot& about = samples_.about();
      vec3 pushed_n(0.0);
      patch.for_each_inside(w.moved(), samples_, [&](const mark& m, const coarse_reading& d) noexcept {
        const bool of_probe = samples_.meeting_of(m).of_probe;
        const vec3 rest = samples_.lever_w(m), arm = rest - about.centre, relief = samples_.relief_slope(m);
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
    const vec3 pull_n = (w.weight * springs_.one) * w.z_w, lever = samples_.lever_w(deepest_);
    wrench_ += wrench{pull_n, glm::cross(lever, pull_n)};
    const double length = glm::length(w.z_w);
    if (!(length > 0.0)) return;
    const vec3 along = w.z_w / length;
    add_outer(unsettled_stiffness_, -w.weight * rule_.stiffness_n_per_m, {along, glm::cross(lever, along)});
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
  wrench wrench_;
  mat6 stiffness_, unsettled_stiffness_;
  mark deepest_;  // at the pose as given
  double energy_j_ = 0.0, deepest_m_ = 0.0;
  exit_limits_hit hit_;
};

}  // namespace asperity::exits
