// Searches for other ways out, as near as those that are known, by rays from one place.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include "asperity/core/fixed_vector.hpp"
#include "asperity/core/math.hpp"
#include "least_motion/descent.hpp"
#include "least_motion/posed_samples.hpp"
#include "least_motion/way_out.hpp"

namespace asperity::exits {

/// The region to search: within most_m of y_w; a place counts as outside where no sample is deeper than deepest_m.
/// A way out is of use within useful_m of y_w: a ray may come out beside one, further away.
struct search_region {
  vec3 y_w{0.0};
  double most_m = 0.0, deepest_m = 0.0, useful_m = 0.0;
};

/// Places near ways out that are not known yet.
using found_places = fixed_vector<vec3, 24>;

/// A search with its memory. A sample that is deep at a place is deep in a ball about it, because depths change by a
/// metre per metre at most. So a ray steps from ball to ball, each of the sample that is deepest among a few witnesses.
/// Where no witness is inside, it asks for the deepest sample of all. Where no sample is inside, the ray is outside,
/// and a descent from there leads to a way out. A ray ends where the witnesses alone would lead to a known way out.
class other_ways_out {
 public:
  explicit other_ways_out(const descent_rule& rule) noexcept : rule_(rule) {}

  /// @rt safe: as many readings as are left
  void search(const search_region& in, std::span<const way_out> known, std::span<const vec3> directions,
              posed_samples& samples, found_places& out) noexcept {
    out.clear();
    met_.clear();
    leads_to_.clear();
    mark m;
    if (!samples.deep_one(in.y_w, in.deepest_m, m)) {
      static_cast<void>(out.push_back(in.y_w));
      return;
    }
    const double from_m = ball(m.depth_m, in, samples);
    if (from_m >= in.most_m) return;
    static_cast<void>(met_.push_back(m));
    for (const way_out& k : known) {
      for (const mark& t : k.touching) {
        if (met_.size() < witnesses_from_known) static_cast<void>(met_.push_back(t));
      }
    }
    for (const way_out& k : known) {
      const vec3 z = relax(in.y_w, k.z_w, seen(), rule_, {}, 0.0, samples);
      if (glm::length(z - k.z_w) < 5e-5 + 4.0 * in.deepest_m) static_cast<void>(leads_to_.push_back(z));
    }
    for (const vec3& u : directions) {
      for (double r = from_m; r < in.most_m && samples.count.left();) {
        const vec3 x = in.y_w + r * u;
        double go = stride(x, in, samples);
        if (go <= 0.0) {
          const vec3 z = relax(in.y_w, x, seen(), rule_, {leads_to_.data(), leads_to_.size()}, same_m, samples);
          // More samples make a way out longer, never shorter.
          if (leads_to_known(z) || glm::length(z - in.y_w) > in.useful_m) break;
          if (!samples.deep_one(x, in.deepest_m, m)) {
            follow(z, in, known, samples, out);
            break;
          }
          remember(m, in, samples);
          go = ball(m.depth_m, in, samples);
        }
        r += std::max(go, least_step * in.most_m);
      }
    }
  }

 private:
  static constexpr std::size_t witnesses_from_known = 24, most_witnesses = 32;
  static constexpr double same_m = 10e-6, least_step = 0.002;

  // Radius of the ball in which a sample this deep stays inside.
  [[nodiscard]] static double ball(double depth_m, const search_region& in, const posed_samples& samples) noexcept {
    return (depth_m - in.deepest_m) / samples.steepest();
  }

  // The first witness that is inside; witnesses that were of use move to the front.
  [[nodiscard]] double stride(const vec3& x, const search_region& in, posed_samples& samples) noexcept {
    for (std::size_t i = 0; i < met_.size(); ++i) {
      const double d = samples.depth(met_[i], x);
      if (!(d > in.deepest_m)) continue;
      std::swap(met_[i], met_[i / 2]);
      return ball(d, in, samples);
    }
    return 0.0;
  }

  [[nodiscard]] std::span<const mark> seen() const noexcept { return {met_.data(), met_.size()}; }

  // Adds a witness. A way out of the others at which it is inside, or nearly so, has to be found anew.
  void remember(const mark& m, const search_region& in, posed_samples& samples) noexcept {
    constexpr double nearly_m = 2e-6;
    if (met_.size() < most_witnesses) {
      static_cast<void>(met_.push_back(m));
    } else {
      met_[most_witnesses - 1] = m;
    }
    std::swap(met_[0], met_.back());
    for (vec3& z : leads_to_) {
      if (samples.depth(m, z) > -nearly_m) z = relax(in.y_w, z, seen(), rule_, {}, 0.0, samples);
    }
  }

  // From outside to a way out, with witnesses of its own; it remembers those that decide the way out.
  void follow(const vec3& from, const search_region& in, std::span<const way_out> known, posed_samples& samples,
              found_places& out) noexcept {
    own_ = met_;
    const vec3 z = descend(in.y_w, from, rule_, own_, false, in.useful_m, {out.data(), out.size()}, samples);
    fixed_vector<mark, 4> decide;
    for (mark m : own_) {
      m.depth_m = samples.depth(m, z);
      keep_deepest(decide, m);
    }
    for (const mark& m : decide) {
      const bool is_known = std::any_of(met_.begin(), met_.end(),
                                        [&](const mark& o) { return o.sample == m.sample && o.meeting == m.meeting; });
      if (!is_known) remember(m, in, samples);
    }
    const vec3 led = relax(in.y_w, z, seen(), rule_, {}, 0.0, samples);
    static_cast<void>(leads_to_.push_back(led));
    // A descent ends where its last planes make the way too long; from there the witnesses may lead to a shorter one,
    // and no other ray would follow them to it again.
    const bool is_short = glm::length(z - in.y_w) <= in.useful_m;
    if (is_short || glm::length(led - in.y_w) <= in.useful_m) add(is_short ? z : led, known, out);
  }

  [[nodiscard]] bool leads_to_known(const vec3& z) const noexcept {
    return std::any_of(leads_to_.begin(), leads_to_.end(), [&](const vec3& k) { return glm::length(z - k) < same_m; });
  }

  static void add(const vec3& z, std::span<const way_out> known, found_places& out) noexcept {
    constexpr double old_m = 6e-5;
    const auto near = [&](const vec3& p) { return glm::length(p - z) < old_m; };
    const bool old = std::any_of(known.begin(), known.end(), [&](const way_out& k) { return near(k.z_w); }) ||
                     std::any_of(out.begin(), out.end(), near);
    if (!old) static_cast<void>(out.push_back(z));
  }

  descent_rule rule_;
  witnesses met_, own_;
  fixed_vector<vec3, 48> leads_to_;  // the ways out of the witnesses alone, near those that are known
};

}  // namespace asperity::exits
