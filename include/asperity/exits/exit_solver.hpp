// The law of least motion at one pose: energy, wrench and stiffness from all ways out that compete.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
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
  double stiffness_n_per_m = 2000.0;    ///< k: of a contact
  double onset_m = 15e-6;               ///< see bed_rule
  double bed = 50.0;                    ///< stiffness of the bed for each sample, in units of k
  double mixed = 12.0;                  ///< bound of the force's slope where ways out are mixed, in units of k
  std::size_t most_readings = 400'000;  ///< of the search; the sum at its end may take a quarter more
  std::size_t most_marks = 16'384;      ///< samples that may touch at one way out

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
        patch_(rule.most_marks) {}

  // A copy would have no room for marks.
  exit_solver(const exit_solver&) = delete;
  exit_solver& operator=(const exit_solver&) = delete;
  exit_solver(exit_solver&&) noexcept = default;
  exit_solver& operator=(exit_solver&&) noexcept = default;
  ~exit_solver() = default;

  /// @pre one pose per fixed body   @rt safe
  void solve(const scene_pose& at) noexcept {
    samples_.place(at, rule_.most_readings);
    ways_.clear();
    energy_j_ = deepest_m_ = 0.0;
    wrench_ = {};
    stiffness_ = {};
    hit_ = {};
    if (find_first()) {
      find_others();
      for (const way_out& w : ways_) hit_.unsettled |= w.weight > 0.0 && !w.settled;
      hit_.readings = samples_.count.cut;
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
  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(directions_, samples_, patch_); }

 private:
  // The nearest way out, as if it were alone. False where nothing overlaps.
  [[nodiscard]] bool find_first() noexcept {
    constexpr double shallow_m = 30e-6;  // from here the iteration finds its way alone
    mark m;
    if (!samples_.deepest(vec3(0.0), 0.0, m)) return false;
    deepest_m_ = m.depth_m;
    vec3 z(0.0);
    if (m.depth_m > shallow_m) {
      met_.clear();
      static_cast<void>(met_.push_back(m));
      z = descend(vec3(0.0), z, descent_, met_, samples_);
    }
    way_out first = settle_from(springs_.one, vec3(0.0), z);
    if (samples_.count.cut) {
      // Too little to settle: what the descent has come to, and in add_up() no more push than the spring's pull.
      first = {};
      first.z_w = z;
      first.settled = false;
    } else if (!(first.bed.deepest_m > 0.0)) {
      return false;
    }
    first.weight = 1.0;
    static_cast<void>(ways_.push_back(first));
    return true;
  }

  // Adds ways out until none is missing that would be cheaper than the mixture of those there are.
  void find_others() noexcept {
    constexpr int most_rounds = 40, settling_rounds = 12;
    constexpr double beyond = 1.2;       // descents end a little off
    constexpr double clear_of_m = 2e-6;  // outside: not deeper than the bed gives way, and this
    vec3 y = mix(ways_, springs_);
    for (int round = 0;; ++round) {
      if (round == most_rounds) {
        hit_.rounds = true;
        return;
      }
      double least_j = ways_[0].cost_j(springs_, y), sunk_m = 0.0;
      for (const way_out& w : ways_) {
        least_j = std::min(least_j, w.cost_j(springs_, y));
        sunk_m = std::max(sunk_m, w.bed.deepest_m);
      }
      bool added = false;
      const std::size_t known = ways_.size();
      if (round > 0 || known > 1) {
        for (std::size_t i = 0; i < known; ++i) {
          if (ways_[i].weight > 1e-9) added |= add(settle_from(springs_.each, y, ways_[i].z_w), y, least_j);
        }
      }
      // First the known ones come to rest, then others are looked for.
      if (!added || round >= settling_rounds) {
        const double most_m = beyond * std::sqrt(2.0 * least_j / springs_.each);
        others_.search({y, most_m, sunk_m + clear_of_m}, {ways_.data(), ways_.size()}, directions_, samples_, found_);
        for (const vec3& z : found_) added |= add(settle_from(springs_.each, y, z), y, least_j);
      }
      if (!added) return;
      y = mix(ways_, springs_);
    }
  }

  [[nodiscard]] way_out settle_from(double k_n_per_m, const vec3& y, const vec3& z) noexcept {
    patch_.clear();
    const way_out out = settle(k_n_per_m, y, z, bed_, patch_, samples_);
    hit_.marks |= patch_.crowded;
    return out;
  }

  // True where it is new and cheaper than all there are.
  bool add(way_out w, const vec3& y, double least_j) noexcept {
    constexpr double same_m = 1e-9, cheaper = 1.0 - 1e-10;
    if (samples_.count.cut) return false;  // its bed may lack samples
    if (!(w.cost_j(springs_, y) < cheaper * least_j)) return false;
    for (const way_out& k : ways_) {
      if (glm::length(k.z_w - w.z_w) < same_m) return false;
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
    mixed_stiffness stiffness(springs_);
    for (const way_out& w : ways_) {
      if (!(w.weight > 0.0)) continue;
      if (!patch_.covers(w.z_w)) patch_.gather(w.z_w, samples_);
      const double share = w.settled ? w.weight : w.weight * bounded_share(w.z_w);
      way_out_stiffness own;
      patch_.for_each_inside(w.z_w, samples_, [&](const mark& m, const coarse_reading& d) noexcept {
        const vec3 smooth = d.slope, relief = samples_.relief_slope(m);
        const vec6 by_pose{smooth + relief,
                           glm::cross(samples_.lever_w(m, w.z_w), smooth) + glm::cross(samples_.lever_w(m), relief)};
        wrench_ += to_wrench((-share * bed_.push_n(d.value_m)) * by_pose);
        own.add(bed_.rise_n_per_m(d.value_m), by_pose, smooth);
      });
      stiffness.add(share, own);
    }
    stiffness_ = stiffness.sum();
  }

  // Balance says that the bed pushes as hard as the spring pulls. Where an iteration was cut short the bed may push
  // much harder: it then counts with what the spring would pull.
  [[nodiscard]] double bounded_share(const vec3& z) noexcept {
    const double pushed_n = glm::length(patch_.at(z, bed_, samples_).gradient_n);
    const double pulled_n = springs_.one * glm::length(z);
    return pushed_n <= pulled_n ? 1.0 : pulled_n / pushed_n;
  }

  exit_rule rule_;
  exit_springs springs_;
  bed_rule bed_;
  descent_rule descent_;
  std::vector<vec3> directions_;
  posed_samples samples_;
  other_ways_out others_;
  bed_patch patch_;
  witnesses met_;
  ways_out ways_;
  found_places found_;
  wrench wrench_;
  mat6 stiffness_;
  double energy_j_ = 0.0, deepest_m_ = 0.0;
  exit_limits_hit hit_;
};

}  // namespace asperity::exits
