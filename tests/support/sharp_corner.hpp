// A face that is hard on a search in texture space: an acute corner, and a fine surface far beside the coarse one.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include "asperity/model/textured_model.hpp"

namespace asperity::test_support {

/// A face of one triangle with a corner of 12 degrees. Its chart ends two texels outside; beyond lies `other`. The
/// textured surface stands 8 texels further from the corner than the coarse one, so that what lies over the samples
/// near the corner would have to be read beyond it.
[[nodiscard]] inline model_ptr sharp_corner(const vec3& other) {
  constexpr double texel_m = 5e-5, length = 160.0;
  const double half_width = length * std::tan(0.5 * 12.0 * std::numbers::pi / 180.0);
  const vec2 corner(40.0, 32.0);
  const std::array<vec2, 3> z{corner, corner + vec2(length, -half_width), corner + vec2(length, half_width)};
  textured_model m;
  m.texture.width = 256;
  m.texture.height = 64;
  for (const vec2& at : z) m.mesh.positions.emplace_back(texel_m * vec3(at - corner, 0.0));
  coarse_triangle t{.vertex = {0, 1, 2}, .uv = {}};
  for (std::size_t k = 0; k < 3; ++k) t.uv[k] = (z[k] + 0.5) / vec2(256.0, 64.0);
  m.mesh.triangles.push_back(t);
  const auto outside = [&](const vec2& at) {
    double nearest = std::numeric_limits<double>::infinity();
    bool inside = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const vec2 from = z[k], along = z[(k + 1) % 3] - from;
      const double share = std::clamp(glm::dot(at - from, along) / glm::dot(along, along), 0.0, 1.0);
      nearest = std::min(nearest, glm::length(at - from - share * along));
      inside = inside && along.x * (at - from).y - along.y * (at - from).x >= 0.0;
    }
    return inside ? 0.0 : nearest;
  };
  for (int j = 0; j < 64; ++j) {
    for (int i = 0; i < 256; ++i) {
      const vec2 at(i, j);
      const vec3 fine = texel_m * vec3(at - corner + vec2(8.0, 0.0), 2.0);
      m.texture.texels.emplace_back(outside(at) <= 2.0 ? fine : fine + other);
    }
  }
  m.box = {m.mesh.positions.front(), m.mesh.positions.front()};
  for (const vec3& p : m.mesh.positions) {
    m.box.low = glm::min(m.box.low, p);
    m.box.high = glm::max(m.box.high, p);
  }
  return std::make_shared<const textured_model>(std::move(m));
}

}  // namespace asperity::test_support
