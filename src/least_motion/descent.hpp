// From anywhere to near a way out: the least motion over the support planes of the deepest samples met so far.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "asperity/core/fixed_vector.hpp"
#include "asperity/core/math.hpp"
#include "least_motion/posed_samples.hpp"

namespace asperity::exits {

/// Samples that decide a way out, the deepest found so far.
using witnesses = fixed_vector<mark, 40>;

/// A sample's depth near a motion x: depth_m + normal_w . (p - x).
struct exit_plane {
  double depth_m = 0.0;
  vec3 normal_w{0.0};
};
using exit_planes = fixed_vector<exit_plane, 64>;

/// min over p of |p - y|^2 / 2 + stiffness/2 sum (depth + normal . (p - x))+^2: convex, quadratic by parts; Newton's
/// method ends where the planes that push stay the same.
/// @rt safe: at most 25 steps
[[nodiscard]] inline vec3 least_motion_over(const exit_planes& planes, const vec3& x, const vec3& y,
                                            double stiffness) noexcept {
  constexpr int most_steps = 25;
  struct cost {
    double value;
    vec3 slope;
    mat3 bend;
  };
  const auto at = [&](const vec3& p) noexcept {
    cost c{0.5 * glm::dot(p - y, p - y), p - y, mat3(1.0)};
    for (const exit_plane& q : planes) {
      const double d = q.depth_m + glm::dot(q.normal_w, p - x);
      if (!(d > 0.0)) continue;
      c.value += 0.5 * stiffness * d * d;
      c.slope += stiffness * d * q.normal_w;
      c.bend += stiffness * glm::outerProduct(q.normal_w, q.normal_w);
    }
    return c;
  };
  vec3 p = x;
  cost c = at(p);
  for (int i = 0; i < most_steps; ++i) {
    const vec3 step = -(glm::inverse(c.bend) * c.slope);
    double share = 1.0;
    cost next = at(p + step);
    while (share > 1e-3 && !(next.value <= c.value + 1e-4 * share * glm::dot(c.slope, step))) {
      share *= 0.5;
      next = at(p + share * step);
    }
    if (!(next.value < c.value)) break;
    const bool end = c.value - next.value < 1e-12 * c.value;
    p += share * step;
    c = next;
    if (end) break;
  }
  return p;
}

/// What a descent needs besides the samples.
struct descent_rule {
  double stiffness = 50.0;  ///< of a plane, in units of the spring's
  double longest_m = 1e-3;  ///< longest step at first; shorter from the fifth on
};

/// The planes of some witnesses at x. @rt safe
inline void planes_at(const vec3& x, std::span<const mark> of, posed_samples& samples, exit_planes& out) noexcept {
  out.clear();
  for (const mark& m : of) {
    const coarse_reading d = samples.read(m, x);
    static_cast<void>(out.push_back({d.value_m, d.slope}));
  }
  // The least motion over them, which comes next, takes as long as a few more readings of each.
  samples.count.spent += 3 * of.size();
}

/// Planes of earlier steps that still hold. In a notch with a round bottom the plane of one place turns with the place,
/// further each time where the way out is longer than the radius; two planes of one sample, one from each side, enclose
/// the bottom. Where the surface bends the other way, an earlier plane would be a wall that does not exist: it is
/// dropped as soon as the sample is found to be less deep than the plane says.
class earlier_planes {
 public:
  /// Adds those that hold at x to the planes of the witnesses there, and keeps these for later.
  /// @param planes of the witnesses, in their order   @rt safe
  void add_to(exit_planes& planes, const vec3& x, std::span<const mark> of) noexcept {
    constexpr double wrong_m = 1e-6, near_m = 1e-4;
    std::size_t held = 0;
    for (const cut& c : cuts_) {
      const auto same = std::find_if(of.begin(), of.end(),
                                     [&](const mark& m) { return m.sample == c.sample && m.meeting == c.meeting; });
      if (same == of.end()) continue;
      const double depth_m = c.plane.depth_m + glm::dot(c.plane.normal_w, x - c.place_w);
      if (depth_m > planes[static_cast<std::size_t>(same - of.begin())].depth_m + wrong_m) continue;
      cuts_[held++] = c;
    }
    cuts_.truncate(held);
    const std::size_t witnesses_here = of.size();
    for (const cut& c : cuts_) {
      static_cast<void>(
          planes.push_back({c.plane.depth_m + glm::dot(c.plane.normal_w, x - c.place_w), c.plane.normal_w}));
    }
    for (std::size_t i = 0; i < witnesses_here; ++i) {
      if (!(planes[i].depth_m > -near_m)) continue;
      if (cuts_.full()) {
        std::copy(cuts_.begin() + 1, cuts_.end(), cuts_.begin());
        cuts_.truncate(cuts_.size() - 1);
      }
      static_cast<void>(cuts_.push_back({planes[i], x, of[i].sample, of[i].meeting}));
    }
  }

 private:
  struct cut {
    exit_plane plane;
    vec3 place_w{0.0};
    std::uint32_t sample = 0, meeting = 0;
  };
  fixed_vector<cut, 24> cuts_;
};

/// The way out that some witnesses alone make, near x, as seen from y. Ends early within `same_m` of one of `known`.
/// @rt safe: at most 12 readings of each witness
[[nodiscard]] inline vec3 relax(const vec3& y, vec3 x, std::span<const mark> of, const descent_rule& rule,
                                std::span<const vec3> known, double same_m, posed_samples& samples) noexcept {
  double longest_m = rule.longest_m;
  exit_planes planes;
  earlier_planes earlier;
  for (int i = 0; i < 12 && samples.count.left(); ++i) {
    planes_at(x, of, samples, planes);
    earlier.add_to(planes, x, of);
    vec3 step = least_motion_over(planes, x, y, rule.stiffness) - x;
    const double length = glm::length(step);
    if (length > longest_m) step *= longest_m / length;
    x += step;
    if (length < 1e-6) break;
    if (std::any_of(known.begin(), known.end(), [&](const vec3& k) { return glm::length(x - k) < same_m; })) break;
    if (i > 3) longest_m *= 0.7;
  }
  return x;
}

/// From x to near a way out as seen from y. Adds the deepest samples that it meets to the witnesses.
/// @param deepest_known the deepest sample at x is among them
/// @param useful_m ends where their way out is longer
/// @param known ends, after some steps, next to one of these
/// @rt safe: at most 14 steps, each with a search for the deepest sample
[[nodiscard]] inline vec3 descend(const vec3& y, vec3 x, const descent_rule& rule, witnesses& met, bool deepest_known,
                                  double useful_m, std::span<const vec3> known, posed_samples& samples) noexcept {
  constexpr double next_to_m = 60e-6;
  constexpr double near_m = 1e-3;  // how far outside a sample may be for its plane to count
  double longest_m = rule.longest_m;
  exit_planes planes;
  earlier_planes earlier;
  for (int i = 0; i < 14 && samples.count.left(); ++i) {
    double above_m = -near_m;
    for (const mark& m : met) above_m = std::max(above_m, samples.depth(m, x));
    mark m;
    const bool ask = i > 0 || !deepest_known;
    if (ask && samples.deepest(x, above_m + 1e-9, m)) {
      above_m = m.depth_m;
      // The older half stays; the newer half is a queue.
      if (met.full()) {
        std::copy(met.begin() + met.size() / 2 + 1, met.end(), met.begin() + met.size() / 2);
        met.truncate(met.size() - 1);
      }
      static_cast<void>(met.push_back(m));
    }
    planes_at(x, {met.data(), met.size()}, samples, planes);
    earlier.add_to(planes, x, {met.data(), met.size()});
    vec3 step = least_motion_over(planes, x, y, rule.stiffness) - x;
    const double length = glm::length(step), cap_m = std::max(longest_m, 0.7 * above_m);
    if (length > cap_m) step *= cap_m / length;
    x += step;
    if (length < 3e-5 || (length <= cap_m && glm::length(x - y) > useful_m)) break;
    const bool is_known =
        std::any_of(known.begin(), known.end(), [&](const vec3& k) { return glm::length(x - k) < next_to_m; });
    if (i > 2 && is_known) break;
    if (i > 3) longest_m *= 0.7;
  }
  return x;
}

}  // namespace asperity::exits
