// Which surface a small motion of the probe can meet first: what is hidden behind other surface needs no plane.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include "asperity/core/fixed_vector.hpp"
#include "asperity/core/math.hpp"
#include "field/lanes.hpp"

namespace asperity {

/// How far the probe is moved to try what it meets.
struct trial_motions {
  double tilt_rad = 0.0;  ///< and eight and forty times it
  double slide_m = 0.0;   ///< and five times it
};

/// Keeps, per body and direction, the largest depth known after each of 41 small motions of the probe: none, and in
/// eight directions across the surface three tilts and two slides. The larger ones are those of a loop that is five
/// times slower than its renderer was made for: without them a face at 200 Hz stepped by 1.6 N/ms. The coarse geometry
/// moves and the relief is that of the pose, so a patch of samples is moved by one slope. What is less deep after every
/// motion than something known is met later whatever the probe does.
class first_met {
 public:
  static constexpr std::size_t motions = 41;
  using depths = std::array<float, 44>;  // of a patch after each motion, relative to no motion; three are not used

  explicit first_met(const trial_motions& by) noexcept : by_(by) {}

  /// A direction that surface looks to, with what is known there; null where there are too many.
  struct group {
    std::uint32_t body = 0;
    vec3 axis_w{0.0}, u_w{0.0}, v_w{0.0};
    depths largest_m{};
  };

  void clear() noexcept { groups_.clear(); }

  /// The group of a slope; null where none is near.
  /// @param slope_w of the depth by the probe's position   @rt safe
  [[nodiscard]] group* find_group(std::uint32_t body, const vec3& slope_w) noexcept {
    constexpr double same = 0.94;  // cosine: 20 degrees
    const double squared = glm::dot(slope_w, slope_w);
    for (group& g : groups_) {
      const double along = glm::dot(g.axis_w, slope_w);
      if (g.body == body && along > 0.0 && along * along >= same * same * squared) return &g;
    }
    return nullptr;
  }

  /// A new group of a slope; null where there are too many, and where the slope has no direction. @rt safe
  [[nodiscard]] group* add_group(std::uint32_t body, const vec3& slope_w) noexcept {
    const std::optional<group> made = next_group(body, slope_w);
    return made && groups_.push_back(*made) ? &groups_.back() : nullptr;
  }
  /// The one that add_group() would add; nothing where it would add none. @rt safe
  [[nodiscard]] std::optional<group> next_group(std::uint32_t body, const vec3& slope_w) const noexcept {
    const double squared = glm::dot(slope_w, slope_w);
    if (!(squared > 0.01) || groups_.size() == groups_.capacity()) return std::nullopt;
    group made{.body = body, .axis_w = slope_w / std::sqrt(squared)};
    made.u_w = any_orthogonal(made.axis_w);
    made.v_w = glm::cross(made.axis_w, made.u_w);
    made.largest_m.fill(-std::numeric_limits<float>::infinity());
    return made;
  }

  /// How much deeper each motion takes a patch.
  /// @param r_w from the probe's centre of mass to the patch   @rt safe
  void moved(const group& g, const vec3& slope_w, const vec3& r_w, depths& out) const noexcept {
    const vec3 turn = glm::cross(r_w, slope_w);
    const auto tilt_u = static_cast<float>(by_.tilt_rad * glm::dot(turn, g.u_w));
    const auto tilt_v = static_cast<float>(by_.tilt_rad * glm::dot(turn, g.v_w));
    const auto slide_u = static_cast<float>(by_.slide_m * glm::dot(slope_w, g.u_w));
    const auto slide_v = static_cast<float>(by_.slide_m * glm::dot(slope_w, g.v_w));
    using detail::lanes;
    constexpr float d = 0.70710678F;
    constexpr lanes u[2] = {{1.0F, -1.0F, 0.0F, 0.0F}, {d, -d, -d, d}};
    constexpr lanes v[2] = {{0.0F, 0.0F, 1.0F, -1.0F}, {d, -d, d, -d}};
    for (std::size_t i = 0; i < 2; ++i) {
      const lanes tilt = u[i] * tilt_u + v[i] * tilt_v;
      const lanes slide = u[i] * slide_u + v[i] * slide_v;
      detail::store_lanes(tilt, out.data() + 4 * i);
      detail::store_lanes(8.0F * tilt, out.data() + 8 + 4 * i);
      detail::store_lanes(40.0F * tilt, out.data() + 16 + 4 * i);
      detail::store_lanes(slide, out.data() + 24 + 4 * i);
      detail::store_lanes(5.0F * slide, out.data() + 32 + 4 * i);
    }
    detail::store_lanes(lanes{}, out.data() + 40);
  }

  /// Above which depth a patch is met first after some motion.
  [[nodiscard]] static double least_that_matters_m(const group& g, const depths& moved) noexcept {
    using detail::lanes;
    lanes least = detail::load_lanes(g.largest_m.data()) - detail::load_lanes(moved.data());
    for (std::size_t i = 4; i < moved.size(); i += 4) {
      const lanes other = detail::load_lanes(g.largest_m.data() + i) - detail::load_lanes(moved.data() + i);
      least = other < least ? other : least;
    }
    return static_cast<double>(std::min(std::min(least[0], least[1]), std::min(least[2], least[3])));
  }

  /// Notes that a patch is this deep.
  static void add(group& g, const depths& moved, double depth_m) noexcept {
    for (std::size_t i = 0; i < moved.size(); ++i) {
      g.largest_m[i] = std::max(g.largest_m[i], static_cast<float>(depth_m) + moved[i]);
    }
  }

 private:
  trial_motions by_;
  fixed_vector<group, 64> groups_;
};

}  // namespace asperity
