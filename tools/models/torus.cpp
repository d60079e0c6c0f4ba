// The wrinkled torus.
#include <cmath>
#include <cstdint>

#include "shapes.hpp"

namespace asperity::models {
namespace {

constexpr double two_pi = 6.283185307179586;
constexpr std::uint32_t around = 400;  ///< vertices around the axis
constexpr std::uint32_t across = 160;  ///< vertices around the tube
constexpr double ring_radius = 45e-3;
constexpr double tube_radius = 18e-3;
constexpr double wrinkle_amplitude = 0.4e-3;

/// Wrinkles that wander: each wave's phase sways along the other direction. About ten edges to a wave.
double wrinkles(double u, double v) {
  const double radial = std::sin(36.0 * u + 1.5 * std::sin(3.0 * v) + std::sin(5.0 * u));
  const double along = std::sin(14.0 * v + 2.0 * std::sin(5.0 * u) + std::sin(2.0 * v));
  return wrinkle_amplitude * (0.6 * radial + 0.4 * along);
}

}  // namespace

triangle_mesh make_torus() {
  triangle_mesh mesh;
  mesh.positions.reserve(std::size_t{around} * across);
  for (std::uint32_t i = 0; i < around; ++i) {
    const double u = two_pi * i / around;
    for (std::uint32_t j = 0; j < across; ++j) {
      const double v = two_pi * j / across;
      // Displaced along its normal by far less than its radii of curvature, a torus does not meet itself.
      const double tube = tube_radius + wrinkles(u, v);
      const double distance = ring_radius + tube * std::cos(v);
      mesh.positions.emplace_back(distance * std::cos(u), distance * std::sin(u), tube * std::sin(v));
    }
  }
  for (std::uint32_t i = 0; i < around; ++i)
    for (std::uint32_t j = 0; j < across; ++j) {
      const std::uint32_t i1 = (i + 1) % around;
      const std::uint32_t j1 = (j + 1) % across;
      const std::uint32_t a = i * across + j;
      const std::uint32_t b = i1 * across + j;
      const std::uint32_t c = i1 * across + j1;
      const std::uint32_t d = i * across + j1;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  return mesh;
}

}  // namespace asperity::models
