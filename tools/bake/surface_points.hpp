// Points spread over a mesh, as many per area everywhere.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "asperity/bake/relief.hpp"
#include "bake/geometry.hpp"
#include "bake/map_lookup.hpp"

namespace asperity::bake {

/// Texture coordinates at barycentric coordinates b of triangle t; zero where the mesh has none.
[[nodiscard]] inline vec2 uv_on(const triangle_mesh& mesh, std::uint32_t t, const std::array<double, 3>& b) noexcept {
  return t < mesh.uvs.size() ? mixed(mesh.uvs[t], b) : vec2(0.0);
}

/// The point of a triangle with barycentric coordinates b.
[[nodiscard]] inline relief_point point_on(const triangle_mesh& mesh, std::uint32_t t, const std::array<double, 3>& b) {
  const auto c = corners(mesh.positions, mesh.triangles[t]);
  return {b[0] * c[0] + b[1] * c[1] + b[2] * c[2], unit_normal(c), t, uv_on(mesh, t, b)};
}

/// Point at a share of the area of one triangle, from two numbers in [0, 1).
[[nodiscard]] inline std::array<double, 3> triangle_share(double r, double s) noexcept {
  return r + s <= 1.0 ? std::array{1.0 - r - s, r, s} : std::array{r + s - 1.0, 1.0 - r, 1.0 - s};
}

/// Running sum of the triangles' areas, m^2.
[[nodiscard]] inline std::vector<double> cumulative_areas(const triangle_mesh& mesh) {
  std::vector<double> sums(mesh.triangles.size());
  double sum = 0.0;
  for (std::size_t t = 0; t < sums.size(); ++t)
    sums[t] = sum += 0.5 * glm::length(area_normal(corners(mesh.positions, mesh.triangles[t])));
  return sums;
}

/// The triangle in which a share of the whole area is reached. @pre sums.back() > 0
[[nodiscard]] inline std::uint32_t triangle_at(const std::vector<double>& sums, double share) noexcept {
  const auto found = std::upper_bound(sums.begin(), sums.end(), share * sums.back());
  return static_cast<std::uint32_t>(std::min<std::ptrdiff_t>(found - sums.begin(), std::ssize(sums) - 1));
}

/// A low-discrepancy sequence over the surface: the same points for the same mesh.
/// @source Roberts 2018 (the R2 sequence)
[[nodiscard]] inline std::vector<relief_point> spread_points(const triangle_mesh& mesh, std::size_t count) {
  const std::vector<double> sums = cumulative_areas(mesh);
  std::vector<relief_point> out;
  out.reserve(count);
  const auto fraction = [](double x) { return x - std::floor(x); };
  for (std::size_t i = 0; i < count; ++i) {
    const double at = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const double r = fraction(0.5 + 0.7548776662466927 * static_cast<double>(i + 1));
    const double s = fraction(0.5 + 0.5698402909980532 * static_cast<double>(i + 1));
    out.push_back(point_on(mesh, triangle_at(sums, at), triangle_share(r, s)));
  }
  return out;
}

}  // namespace asperity::bake
