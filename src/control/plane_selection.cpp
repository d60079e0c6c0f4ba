#include "asperity/control/plane_selection.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>

#include "asperity/core/fixed_vector.hpp"

namespace asperity {

namespace {

/// The planes of one body that share a direction, and which of them each test motion meets first.
/// Motion 0 is none. The others come in rounds of four directions across the axis: small tilts, slides and large tilts,
/// then the same in the directions between. Early motions matter most: the list may be full before the last.
struct plane_group {
  static constexpr std::size_t motions = 25;
  std::uint32_t body = 0;
  vec3 axis_w{0.0};
  std::array<std::uint32_t, motions> first_met{};

  [[nodiscard]] bool holds(const support_plane& p, double same_direction) const noexcept {
    return p.body == body && glm::dot(p.n_ab_w, axis_w) >= same_direction;
  }

  void find(std::span<const support_plane> planes, const plane_selection& s) noexcept {
    constexpr double diagonal = 0.70710678118654752;
    constexpr std::array<std::array<double, 2>, 8> around{{{1, 0},
                                                           {-1, 0},
                                                           {0, 1},
                                                           {0, -1},
                                                           {diagonal, diagonal},
                                                           {-diagonal, -diagonal},
                                                           {-diagonal, diagonal},
                                                           {diagonal, -diagonal}}};
    constexpr double far_tilt = 8.0;
    const vec3 u = any_orthogonal(axis_w);
    const vec3 w = glm::cross(axis_w, u);
    std::array<double, motions> largest_m;
    largest_m.fill(-std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < planes.size(); ++i) {
      const support_plane& p = planes[i];
      if (!holds(p, s.same_direction)) continue;
      const auto meet = [&](std::size_t motion, double depth_m) {
        if (!(depth_m > largest_m[motion])) return;
        largest_m[motion] = depth_m;
        first_met[motion] = static_cast<std::uint32_t>(i);
      };
      const double tilt_u = s.tilt_rad * glm::dot(p.gradient.angular, u);
      const double tilt_w = s.tilt_rad * glm::dot(p.gradient.angular, w);
      const double slide_u = s.slide_m * glm::dot(p.gradient.linear, u);
      const double slide_w = s.slide_m * glm::dot(p.gradient.linear, w);
      meet(0, p.depth_m);
      for (std::size_t j = 0; j < around.size(); ++j) {
        const std::size_t round = 1 + (j / 4) * 12 + j % 4;
        const double tilt = around[j][0] * tilt_u + around[j][1] * tilt_w;
        meet(round, p.depth_m + tilt);
        meet(round + 4, p.depth_m + around[j][0] * slide_u + around[j][1] * slide_w);
        meet(round + 8, p.depth_m + far_tilt * tilt);
      }
    }
  }
};

}  // namespace

result<void> check(const plane_selection& s) {
  const auto bad = [](std::string what) { return error{error_code::invalid_argument, "plane selection: " + what}; };
  if (!(s.tilt_rad > 0.0 && s.tilt_rad < 0.2)) return bad("tilt_rad must be above 0 and below 0.2");
  if (!(s.slide_m > 0.0 && std::isfinite(s.slide_m))) return bad("slide_m must be a finite length above 0");
  if (!(s.same_direction > 0.0 && s.same_direction < 1.0))
    return bad("same_direction must be a cosine between 0 and 1");
  return {};
}

status select_planes(std::span<const support_plane> candidates, const plane_selection& s, support_planes& out,
                     std::size_t most) noexcept {
  out.clear();
  fixed_vector<plane_group, most_selected_planes> groups;
  for (const support_plane& p : candidates) {
    if (!is_finite(p)) return status::not_finite;
  }
  for (;;) {
    const support_plane* deepest = nullptr;
    for (const support_plane& p : candidates) {
      if (deepest != nullptr && !(p.depth_m > deepest->depth_m)) continue;
      const bool known =
          std::any_of(groups.begin(), groups.end(), [&](const plane_group& g) { return g.holds(p, s.same_direction); });
      if (!known) deepest = &p;
    }
    if (deepest == nullptr) break;
    if (!groups.push_back({.body = deepest->body, .axis_w = deepest->n_ab_w})) break;
    groups.back().find(candidates, s);
  }
  std::array<std::uint32_t, most_support_planes> taken{};
  bool all = groups.dropped() == 0;
  for (std::size_t motion = 0; motion < plane_group::motions; ++motion) {
    for (const plane_group& g : groups) {
      const std::uint32_t chosen = g.first_met[motion];
      const auto end = taken.begin() + static_cast<std::ptrdiff_t>(out.size());
      if (std::find(taken.begin(), end, chosen) != end) continue;
      if (out.size() == most) {
        all = false;
        continue;
      }
      taken[out.size()] = chosen;
      static_cast<void>(out.push_back(candidates[chosen]));
    }
  }
  return all ? status::ok : status::capacity_reached;
}

}  // namespace asperity
