// Length scales of a textured model.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "model/surface_index.hpp"
#include "model/texture_tap.hpp"

namespace asperity::detail {

/// Scales of one model's relief.
struct texture_scale {
  double peak_to_valley_m = 0.0;      ///< of the sine with the same mean square height
  double wavelength_m = 0.0;          ///< of the sine with the same mean square height and slope; 0 without relief
  double peak_curvature_per_m = 0.0;  ///< of that sine's peaks; at least that of a ball of half the body's diagonal
  double texel_m = 0.0;               ///< typical distance between texels on the coarse surface
};

/// Measures a model by some 4000 points spread evenly over its surface. Not for a tick.
[[nodiscard]] inline texture_scale measure_texture(const textured_model& model, const surface_index& index) {
  texture_scale out;
  const double diagonal = model.box.diagonal();
  double area = 0.0;
  for (std::size_t t = 0; t < model.mesh.triangles.size(); ++t) {
    const vec3 n = area_normal(corners(model.mesh, t));
    area += 0.5 * std::sqrt(glm::dot(n, n));
  }
  double count = 0.0, height = 0.0, height2 = 0.0, slope2 = 0.0, texel2 = 0.0;
  for (std::size_t t = 0; t < model.mesh.triangles.size(); ++t) {
    if (!index.texels[t].usable) continue;
    const auto c = corners(model.mesh, t);
    const texel_triangle& z = index.texels[t];
    const vec3 n = index.normal[t];
    const auto [per_x, per_y] = z.per_texel(c);
    const double e = glm::dot(per_x, per_x), f = glm::dot(per_x, per_y), g = glm::dot(per_y, per_y);
    const double det = e * g - f * f;
    if (!(det > 0.0)) continue;
    const vec3 doubled = area_normal(c);
    const double share = 0.5 * std::sqrt(glm::dot(doubled, doubled)) / area;
    const int points = 1 + static_cast<int>(4000.0 * share);
    for (int i = 0; i < points; ++i) {
      // The R2 sequence, folded into the triangle: even coverage without a generator.
      double a = std::fmod(0.5 + 0.7548776662466927 * i, 1.0);
      double b = std::fmod(0.5 + 0.5698402909980532 * i, 1.0);
      if (a + b > 1.0) {
        a = 1.0 - a;
        b = 1.0 - b;
      }
      const surface_tap tap = read(model.texture, (1.0 - a - b) * z.corner[0] + a * z.corner[1] + b * z.corner[2]);
      if (!is_finite(tap.point)) continue;
      const double h = glm::dot(n, tap.point - ((1.0 - a - b) * c[0] + a * c[1] + b * c[2]));
      const double hx = glm::dot(n, tap.along_x - per_x), hy = glm::dot(n, tap.along_y - per_y);
      const double w = share / points;
      count += w;
      height += w * h;
      height2 += w * h * h;
      slope2 += w * (g * hx * hx - 2.0 * f * hx * hy + e * hy * hy) / det;
      texel2 += w * std::sqrt(det);
    }
  }
  const double ball = diagonal > 0.0 ? 2.0 / diagonal : 0.0;
  out.peak_curvature_per_m = ball;
  if (!(count > 0.0)) return out;
  out.texel_m = std::sqrt(texel2 / count);
  const double variance = height2 / count - (height / count) * (height / count);
  // Relief below a millionth of the body is the rounding of float32 texels.
  if (!(variance > 1e-12 * diagonal * diagonal) || !(slope2 > 0.0)) return out;
  // Not the bake's own peak to valley: one badly fitted corner of the coarse mesh would soften the whole surface.
  out.peak_to_valley_m = 2.0 * std::numbers::sqrt2 * std::sqrt(variance);
  const double per_length = std::sqrt(slope2 / count / variance);
  out.wavelength_m = 2.0 * std::numbers::pi / per_length;
  out.peak_curvature_per_m = std::max(ball, std::sqrt(2.0 * variance) * per_length * per_length);
  return out;
}

}  // namespace asperity::detail
