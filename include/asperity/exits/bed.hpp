// The stiff bed that the samples make, and its sum near one place.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "asperity/core/memory.hpp"
#include "asperity/core/reserve_resident.hpp"
#include "asperity/exits/posed_samples.hpp"

namespace asperity::exits {

/// What one sample at depth D costs. Its push rises from zero without a kink: stiffness D^2 / (D + onset).
/// One sample is as good as a face of thousands, since the bed is far stiffer than the spring that presses on it.
struct bed_rule {
  double stiffness_n_per_m = 0.0;
  double onset_m = 0.0;  ///< from several of these on, the push grows by the stiffness

  /// Integral of the push, J.   @pre depth_m >= 0
  [[nodiscard]] double energy_j(double depth_m) const noexcept {
    const double u = depth_m / onset_m, scale = stiffness_n_per_m * onset_m * onset_m;
    // The three terms cancel to third order; below this the series is the more exact.
    if (u < 1e-2) return scale * u * u * u * (1.0 / 3.0 + u * (-0.25 + u * (0.2 - u * (1.0 / 6.0 - u / 7.0))));
    return scale * (0.5 * u * u - u + std::log1p(u));
  }
  [[nodiscard]] double push_n(double depth_m) const noexcept {
    return stiffness_n_per_m * depth_m * depth_m / (depth_m + onset_m);
  }
  /// Derivative of the push, N/m.
  [[nodiscard]] double rise_n_per_m(double depth_m) const noexcept {
    const double d = depth_m + onset_m;
    return stiffness_n_per_m * depth_m * (depth_m + 2.0 * onset_m) / (d * d);
  }
};

/// The bed at one motion of the probe: energy, and its derivatives by the motion, world axes.
struct bed_sum {
  double energy_j = 0.0;
  double deepest_m = 0.0;  ///< 0 where no sample is inside
  vec3 gradient_n{0.0};
  mat3 hessian_n_per_m{0.0};
};

/// The samples that can be inside at motions near one place: gathered once, summed often.
class bed_patch {
 public:
  /// @param most marks that are kept; what is more is left out and told
  explicit bed_patch(std::size_t most) { detail::reserve_resident(marks_, most); }

  /// Forgets what was gathered. @rt safe
  void clear() noexcept {
    marks_.clear();
    gathered_ = false;
    crowded = false;
  }

  /// The bed at x; gathers anew where x is more than reach() from the last place. @rt safe
  [[nodiscard]] bed_sum at(const vec3& x_w, const bed_rule& rule, posed_samples& samples) noexcept {
    if (!covers(x_w)) gather(x_w, samples);
    bed_sum out;
    for_each_inside(x_w, samples, [&](const mark&, const coarse_reading& d) noexcept {
      const double push = rule.push_n(d.value_m), rise = rule.rise_n_per_m(d.value_m);
      out.deepest_m = std::max(out.deepest_m, d.value_m);
      out.energy_j += rule.energy_j(d.value_m);
      out.gradient_n += push * d.slope;
      out.hessian_n_per_m += rise * glm::outerProduct(d.slope, d.slope) + push * d.hessian_per_m;
    });
    return out;
  }

  /// Calls take(mark, its reading at x) for every sample that is inside at x.   @pre covers(x_w)
  template <class Take>
  void for_each_inside(const vec3& x_w, posed_samples& samples, Take&& take) const noexcept {
    const double far_m = samples.steepest() * glm::length(x_w - place_w_);
    for (const mark& m : marks_) {
      if (m.depth_m + far_m <= 0.0) continue;
      const coarse_reading d = samples.read(m, x_w);
      if (d.value_m > 0.0) take(m, d);
    }
  }

  [[nodiscard]] bool covers(const vec3& x_w) const noexcept {
    return gathered_ && glm::length(x_w - place_w_) <= reach_m;
  }
  void gather(const vec3& x_w, posed_samples& samples) noexcept {
    marks_.clear();
    place_w_ = x_w;
    gathered_ = true;
    double above_m = -samples.steepest() * reach_m;
    samples.walk(x_w, above_m, [&](const mark& m) noexcept {
      if (marks_.size() < marks_.capacity()) {
        marks_.push_back(m);
      } else {
        crowded = true;
      }
    });
  }
  [[nodiscard]] std::size_t size() const noexcept { return marks_.size(); }
  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(marks_); }

  /// How far from where samples were gathered the sum is right: several steps of a Newton iteration.
  static constexpr double reach_m = 40e-6;
  bool crowded = false;  ///< samples were left out since clear()

 private:
  std::vector<mark> marks_;
  vec3 place_w_{0.0};
  bool gathered_ = false;
};

}  // namespace asperity::exits
