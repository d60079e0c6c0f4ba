// The gear: a cylinder about x with straight ridges, closed by flat ends.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "benchmark_models.hpp"
#include "shapes.hpp"

namespace asperity::models {
namespace {

constexpr double two_pi = 6.283185307179586;
constexpr double half_x = 0.5 * gear_length_m;
constexpr std::uint32_t cells_per_ridge = 16;

/// A circle of vertices about the x axis. A single vertex is the middle of an end.
struct ring {
  std::uint32_t count;
  double x_m;
  double radius_m;
  double ridge_m = 0.0;  ///< amplitude of the ridges on it
};

vec3 point_on(const ring& r, std::uint32_t i) {
  if (r.count == 1) return {r.x_m, 0.0, 0.0};
  // The phase is taken from the place within its ridge: all ridges are the same to the last bit.
  const double phase = two_pi * (i % cells_per_ridge) / cells_per_ridge;
  const double radius = r.radius_m + r.ridge_m * std::cos(phase);
  const double angle = two_pi * i / r.count;
  return {r.x_m, radius * std::sin(angle), radius * std::cos(angle)};
}

/// Closed surface through rings in order, from a single vertex at the low end to one at the high end. Neighbours may
/// differ in count: n and m vertices are joined by n + m triangles, and a single vertex by n.
triangle_mesh surface_through(const std::vector<ring>& rings) {
  triangle_mesh mesh;
  std::uint32_t low = 0;
  for (std::size_t r = 0; r < rings.size(); ++r) {
    const auto high = static_cast<std::uint32_t>(mesh.positions.size());
    for (std::uint32_t i = 0; i < rings[r].count; ++i) mesh.positions.push_back(point_on(rings[r], i));
    if (r == 0) continue;
    const std::uint32_t n = rings[r - 1].count;
    const std::uint32_t m = rings[r].count;
    std::uint32_t i = 0;
    std::uint32_t j = 0;
    while ((n > 1 && i < n) || (m > 1 && j < m)) {
      // Step on the side whose next vertex comes first around the circle: (i + 1) / n against (j + 1) / m.
      const bool step_low = m == 1 || (n > 1 && (i + 1) * m <= (j + 1) * n);
      const std::uint32_t a = low + i % n;
      const std::uint32_t b = high + j % m;
      if (step_low) {
        mesh.triangles.push_back({a, b, low + ++i % n});
      } else {
        mesh.triangles.push_back({b, high + ++j % m, a});
      }
    }
    low = high;
  }
  return mesh;
}

}  // namespace

triangle_mesh make_gear() {
  // Six strips of 2 x 1536 triangles around the side; (1536 + 768) + (768 + 256) + 256 on each end: 25,600.
  constexpr std::uint32_t around = gear_ridges * cells_per_ridge;
  constexpr double full = ridge_amplitude_m;
  constexpr double fade = ridge_fade_m;
  return surface_through({{1, -half_x, 0.0},
                          {around / 6, -half_x, 20e-3},
                          {around / 2, -half_x, 45e-3},
                          {around, -half_x, gear_radius_m},
                          {around, -half_x + 0.5 * fade, gear_radius_m, smoothstep(0.5) * full},
                          {around, -half_x + fade, gear_radius_m, full},
                          {around, 0.0, gear_radius_m, full},
                          {around, half_x - fade, gear_radius_m, full},
                          {around, half_x - 0.5 * fade, gear_radius_m, smoothstep(0.5) * full},
                          {around, half_x, gear_radius_m},
                          {around / 2, half_x, 45e-3},
                          {around / 6, half_x, 20e-3},
                          {1, half_x, 0.0}});
}

triangle_mesh make_coarse_gear() {
  // One facet to a ridge, so that every ridge lies on the coarse mesh in the same way: six strips of 2 x 96 triangles,
  // (96 + 64) + 64 on each end: 1,600. The outermost strips are narrow: normals that are interpolated between side
  // and end are slanted only there.
  constexpr double rim = 2.0 * ridge_fade_m;
  return surface_through({{1, -half_x, 0.0},
                          {64, -half_x, 45e-3},
                          {gear_ridges, -half_x, gear_radius_m},
                          {gear_ridges, -half_x + rim, gear_radius_m},
                          {gear_ridges, -0.5 * half_x, gear_radius_m},
                          {gear_ridges, 0.0, gear_radius_m},
                          {gear_ridges, 0.5 * half_x, gear_radius_m},
                          {gear_ridges, half_x - rim, gear_radius_m},
                          {gear_ridges, half_x, gear_radius_m},
                          {64, half_x, 45e-3},
                          {1, half_x, 0.0}});
}

}  // namespace asperity::models
