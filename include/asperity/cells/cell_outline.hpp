// What surrounds one coarse region, in its own plane.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "asperity/cells/coarse_regions.hpp"
#include "asperity/cells/surface_cells.hpp"

namespace asperity::detail {

/// A coarse edge in cell coordinates.
struct outline_segment {
  vec2 a{0.0}, b{0.0};
  edge_kind kind = edge_kind::smooth;

  [[nodiscard]] double distance(const vec2& p) const noexcept { return std::sqrt(distance_squared(p)); }
  [[nodiscard]] double distance_squared(const vec2& p) const noexcept {
    const vec2 d = b - a;
    const double l2 = glm::dot(d, d);
    const double t = l2 > 0.0 ? std::clamp(glm::dot(p - a, d) / l2, 0.0, 1.0) : 0.0;
    const vec2 off = p - a - t * d;
    return glm::dot(off, off);
  }

  /// 3/4 of the integral of |p - s|^-5 over the segment. Summed over the outline of a half plane it is the distance to
  /// the power -4; of any outline, a distance without the kinks that "the nearest edge" has.
  [[nodiscard]] double inverse_distance_4(const vec2& p) const noexcept {
    return inverse_distance_4(p, glm::length(b - a));
  }
  /// @param length  of the segment
  [[nodiscard]] double inverse_distance_4(const vec2& p, double length) const noexcept {
    if (!(length > 0.0)) return 0.0;
    const vec2 d = b - a;
    const vec2 from = a - p;
    const double t0 = glm::dot(from, d) / length, t1 = t0 + length;
    const double l = (d.x * from.y - d.y * from.x) / length, l2 = std::max(1e-16, l * l);
    const double r0 = l2 + t0 * t0, r1 = l2 + t1 * t1, s0 = t0 / std::sqrt(r0), s1 = t1 / std::sqrt(r1);
    if (t0 < 0.0 && t1 > 0.0) {
      return 0.25 * (s1 * (1.0 / r1 + 2.0 / l2) - s0 * (1.0 / r0 + 2.0 / l2)) / l2;
    }
    // Beyond an end the two terms are nearly the same, on the segment's own line to the last digit. With the difference
    // worked out, l drops out.
    const double u0 = 1.0 / r0, u1 = 1.0 / r1;
    return 0.25 * length * (t0 + t1) / (s0 + s1) * u0 * u1 * (u0 + u1 + (u0 + u1 - l2 * u0 * u1) / (1.0 + s0 * s1));
  }
};

/// The triangles that a region's map shows, and where they end.
struct cell_outline {
  std::vector<std::uint32_t> shown;     ///< the region's own triangles first, then what its apron may reach
  std::size_t own = 0;                  ///< how many of `shown` are the region's own
  std::vector<outline_segment> rim;     ///< border of all that is shown, in cell coordinates
  std::vector<outline_segment> border;  ///< of the region alone
};

/// Neighbours join over smooth edges while they face the cell's direction and lie within the apron.
[[nodiscard]] inline cell_outline find_outline(const surface_cell& cell, std::uint32_t region, const coarse_mesh& mesh,
                                               const surface_index& index, const coarse_regions& regions,
                                               const cell_settings& settings) {
  cell_outline out;
  out.shown = regions.members[region];
  out.own = out.shown.size();
  const auto segment = [&](std::uint32_t t, std::size_t k) {
    const auto c = corners(mesh, t);
    return outline_segment{vec2(cell.to_cell(c[k])), vec2(cell.to_cell(c[(k + 1) % 3])), regions.kind[t][k]};
  };
  for (const std::uint32_t t : out.shown) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (regions.is_border(index, t, k)) out.border.push_back(segment(t, k));
    }
  }
  const auto within_apron = [&](std::uint32_t t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const outline_segment edge = segment(t, k);
      for (const outline_segment& o : out.border) {
        if (std::min({o.distance(edge.a), edge.distance(o.a), edge.distance(o.b)}) <= settings.apron_m) return true;
      }
    }
    return false;
  };
  const double cos_apron = std::cos(settings.apron_angle_rad);
  std::vector<std::uint32_t> seen = out.shown;  // sorted, for look-up
  std::sort(seen.begin(), seen.end());
  const auto mark = [&](std::uint32_t t) {
    const auto at = std::lower_bound(seen.begin(), seen.end(), t);
    if (at != seen.end() && *at == t) return false;
    seen.insert(at, t);
    return true;
  };
  for (std::size_t i = 0; i < out.shown.size(); ++i) {
    const std::uint32_t t = out.shown[i];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t across = index.neighbour[t][k];
      if (across == coarse_regions::none || regions.kind[t][k] != edge_kind::smooth || !mark(across)) continue;
      if (glm::dot(index.normal[across], cell.n_b) >= cos_apron && within_apron(across)) out.shown.push_back(across);
    }
  }
  std::vector<std::uint32_t> shown = out.shown;
  std::sort(shown.begin(), shown.end());
  for (const std::uint32_t t : out.shown) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t across = index.neighbour[t][k];
      const bool inner = across != coarse_regions::none && regions.kind[t][k] == edge_kind::smooth &&
                         std::binary_search(shown.begin(), shown.end(), across);
      if (!inner) out.rim.push_back(segment(t, k));
    }
  }
  return out;
}

}  // namespace asperity::detail
