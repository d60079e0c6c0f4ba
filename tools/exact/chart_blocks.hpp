// Where the textured surface of each coarse triangle can be: one leaning box for each chart.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "exact/texture_pyramid.hpp"
#include "model/surface_index.hpp"

namespace asperity::detail {

/// A block of the pyramid that a chart's border crosses holds texels of the charts beside it, which may lie anywhere on
/// the body: its box is then as large as the body. The box here holds all that bilinear interpolation makes inside one
/// chart and nothing else; it leans as the coarse triangle does, so it is as thick as the relief.
class chart_blocks {
 public:
  /// Not for a tick. @pre `index` is that of the model
  chart_blocks(const textured_model& model, const surface_index& index) {
    blocks_.reserve(index.texels.size());
    for (std::size_t t = 0; t < index.texels.size(); ++t) {
      blocks_.push_back(fit(model.texture, index.texels[t], corners(model.mesh, t)));
    }
  }

  /// The surface over a triangle's chart, with w the way from texel position `middle`.   @rt safe
  [[nodiscard]] texture_block block(std::uint32_t triangle, const vec2& middle) const noexcept {
    texture_block out = blocks_[triangle];
    out.centre += middle.x * out.along_x + middle.y * out.along_y;
    return out;
  }

  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(blocks_); }

 private:
  /// As seen from texel (0, 0). Empty where the triangle has no area in the texture, or all of its texels are NaN.
  [[nodiscard]] static texture_block fit(const haptic_texture& texture, const texel_triangle& chart,
                                         const std::array<vec3, 3>& corner) noexcept {
    texture_block out;
    if (!chart.usable) return out;
    const auto along = chart.per_texel(corner);
    out.along_x = along[0];
    out.along_y = along[1];
    // The corners of all cells that the chart meets: texels nearer than one along both axes to one of its points.
    constexpr double rounding_texels = 1e-6;
    const auto& z = chart.corner;
    const vec2 first = glm::floor(glm::min(z[0], glm::min(z[1], z[2])) - rounding_texels);
    const vec2 last = glm::ceil(glm::max(z[0], glm::max(z[1], z[2])) + rounding_texels);
    const auto meets = [&](const vec2& texel) {
      const vec3 bary = chart.barycentric(texel);
      for (std::size_t k = 0; k < 3; ++k) {
        const double reach = std::fabs(chart.weight[k].y) + std::fabs(chart.weight[k].z);
        if (bary[static_cast<int>(k)] + reach < -rounding_texels / chart.altitude[k]) return false;
      }
      return true;
    };
    const auto inside = [](double k, std::uint32_t size) {
      return static_cast<std::size_t>(std::clamp(k, 0.0, static_cast<double>(size) - 1.0));
    };
    rest_box box;
    for (double y = first.y; y <= last.y; ++y) {
      for (double x = first.x; x <= last.x; ++x) {
        if (!meets({x, y})) continue;
        const vec3 p = texture.at(inside(x, texture.width), inside(y, texture.height));
        if (!is_finite(p)) continue;
        const vec3 rest = p - x * out.along_x - y * out.along_y;
        box.add(rest);
      }
    }
    box.close(out);
    return out;
  }

  std::vector<texture_block> blocks_;
};

}  // namespace asperity::detail
