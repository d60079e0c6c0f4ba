// Surfaces in closed form as low-poly meshes with texture coordinates, and their maps.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "asperity/model/map_image.hpp"
#include "shapes.hpp"

namespace asperity::bake::shapes {

inline constexpr double two_pi = 2.0 * std::numbers::pi;

/// A map whose pixels are values(u, v), v downwards, as a file of so many bits holds it (0: floating point).
inline map_image make_map(std::uint32_t side, std::uint32_t channels, std::uint32_t bits,
                          const std::function<std::array<double, 3>(double u, double v)>& values) {
  map_image out{side, side, channels, bits, {}};
  const double white = bits == 0 ? 0.0 : std::pow(2.0, bits) - 1.0;
  for (std::uint32_t j = 0; j < side; ++j)
    for (std::uint32_t i = 0; i < side; ++i) {
      const auto value = values((i + 0.5) / side, (j + 0.5) / side);
      for (std::size_t c = 0; c < channels; ++c)
        out.samples.push_back(static_cast<float>(bits == 0 ? value[c] : std::floor(value[c] * white + 0.5) / white));
    }
  return out;
}

/// The colour of a normal, from the slopes along increasing u and along decreasing v.
inline std::array<double, 3> normal_colour(double slope_u, double slope_up) {
  const double length = std::sqrt(1.0 + slope_u * slope_u + slope_up * slope_up);
  return {0.5 - 0.5 * slope_u / length, 0.5 - 0.5 * slope_up / length, 0.5 + 0.5 / length};
}

/// A slab of 40 x 40 x 8 mm about the origin with waves on its top and bottom that fade towards the border, texture
/// coordinates straight from above: on the bottom they are mirrored, on the sides they span no area.
struct wavy_slab {
  static constexpr double side_m = 0.04;
  static constexpr double half_thickness_m = 0.004;
  double amplitude_m = 0.0002;
  double wave_m = 0.008;

  [[nodiscard]] static double fade(double x) { return std::pow(std::cos(std::numbers::pi * x / side_m), 2); }
  [[nodiscard]] double height(double x, double y) const {
    if (std::max(std::abs(x), std::abs(y)) > 0.5 * side_m) return 0.0;
    return amplitude_m * std::sin(two_pi * x / wave_m) * std::sin(two_pi * y / wave_m) * fade(x) * fade(y);
  }
  [[nodiscard]] triangle_mesh mesh(int cells) const {
    triangle_mesh out = box({side_m, side_m, 2.0 * half_thickness_m}, {cells, cells, 1});
    for (const auto& t : out.triangles) {
      auto& uv = out.uvs.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) {
        const vec3& p = out.positions[t[k]];
        uv[k] = {0.5 + p.x / side_m, 0.5 - p.y / side_m};
      }
    }
    return out;
  }
  /// The slab with its waves in its triangles.
  [[nodiscard]] triangle_mesh fine_mesh(int cells) const {
    return box({side_m, side_m, 2.0 * half_thickness_m}, {cells, cells, 1}, [this](vec3 p) {
      p.z += (p.z > 0.0 ? 1.0 : -1.0) * height(p.x, p.y);
      return p;
    });
  }
  /// The slab without waves, each of its faces a chart of its own: top and bottom side by side, the four walls in two
  /// rows next to them, gap_m between any two and margin_m around them. Some are mirrored.
  [[nodiscard]] static triangle_mesh unwrapped(int cells, double gap_m, double margin_m) {
    triangle_mesh out = box({side_m, side_m, 2.0 * half_thickness_m}, {cells, cells, 1});
    const double per_m = 1.0 / (2.0 * side_m + gap_m + 2.0 * margin_m);
    for (const auto& t : out.triangles) {
      const vec3 n = glm::cross(out.positions[t[1]] - out.positions[t[0]], out.positions[t[2]] - out.positions[t[0]]);
      const std::size_t axis = std::abs(n.x) > 0.0 ? 0 : std::abs(n.y) > 0.0 ? 1 : 2;
      const double right = n[static_cast<int>(axis)] < 0.0 ? side_m + gap_m : 0.0;
      const double low =
          axis == 2 ? 0.0 : side_m + gap_m + static_cast<double>(axis) * (2.0 * half_thickness_m + gap_m);
      auto& uv = out.uvs.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) {
        const vec3 p = out.positions[t[k]] + vec3(0.5 * side_m, 0.5 * side_m, half_thickness_m);
        const vec2 on_face = axis == 2 ? vec2(p.x, p.y) : axis == 1 ? vec2(p.x, p.z) : vec2(p.y, p.z);
        uv[k] = per_m * (vec2(margin_m + right, margin_m + low) + on_face);
      }
    }
    return out;
  }
  /// White is amplitude_m above the slab, black as much below.
  [[nodiscard]] map_image height_map(std::uint32_t side, std::uint32_t bits) const {
    return make_map(side, 1, bits, [&](double u, double v) -> std::array<double, 3> {
      return {0.5 + 0.5 * height(side_m * (u - 0.5), side_m * (0.5 - v)) / amplitude_m, 0.0, 0.0};
    });
  }
  [[nodiscard]] map_image normal_map(std::uint32_t side, std::uint32_t bits) const {
    constexpr double step = 1e-6;
    return make_map(side, 3, bits, [&](double u, double v) {
      const double x = side_m * (u - 0.5), y = side_m * (0.5 - v);
      return normal_colour((height(x + step, y) - height(x - step, y)) / (2.0 * step),
                           (height(x, y + step) - height(x, y - step)) / (2.0 * step));
    });
  }
};

/// A torus unwrapped into the unit square, v upwards across the tube: texels are stretched more than twice as far on
/// its outside as on its inside, and the map's border is a seam on the surface.
struct mapped_torus {
  double major_m = 0.05;
  double minor_m = 0.02;
  double amplitude_m = 0.0003;
  int waves_around = 12;
  int waves_across = 5;

  /// By the texture coordinates, v downwards.
  [[nodiscard]] double height(double u, double v) const {
    return amplitude_m * std::sin(two_pi * waves_around * u) * std::cos(two_pi * waves_across * v);
  }
  [[nodiscard]] triangle_mesh mesh(std::uint32_t around, std::uint32_t across) const {
    triangle_mesh out = wavy_torus{major_m, minor_m, 0.0, 1, 1}.mesh(around, across);
    for (std::uint32_t i = 0; i < around; ++i)
      for (std::uint32_t j = 0; j < across; ++j) {
        const auto at = [&](std::uint32_t di, std::uint32_t dj) {
          return vec2((i + di) / static_cast<double>(around), 1.0 - (j + dj) / static_cast<double>(across));
        };
        out.uvs.push_back({at(0, 0), at(1, 0), at(1, 1)});
        out.uvs.push_back({at(0, 0), at(1, 1), at(0, 1)});
      }
    return out;
  }
  [[nodiscard]] map_image normal_map(std::uint32_t side, std::uint32_t bits) const {
    return make_map(side, 3, bits, [&](double u, double v) {
      const double per_u = two_pi * (major_m + minor_m * std::cos(two_pi * (1.0 - v)));
      const double per_v = two_pi * minor_m;
      const double a = two_pi * waves_around, b = two_pi * waves_across;
      return normal_colour(amplitude_m * a * std::cos(a * u) * std::cos(b * v) / per_u,
                           amplitude_m * b * std::sin(a * u) * std::sin(b * v) / per_v);
    });
  }
};

}  // namespace asperity::bake::shapes
