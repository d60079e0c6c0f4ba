#include "picture/atlas_panel.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace asperity::picture {
namespace {

// Texels whose middle lies in the triangle, edges included, with its barycentric coordinates there.
template <class Visit>
void for_each_texel(const haptic_texture& texture, const std::array<vec2, 3>& uv, const Visit& visit) {
  const vec2 side{texture.width, texture.height};
  const std::array<vec2, 3> p{side * uv[0] - 0.5, side * uv[1] - 0.5, side * uv[2] - 0.5};
  const auto cross = [](const vec2& a, const vec2& b, const vec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  };
  const double area = cross(p[0], p[1], p[2]);
  if (!(std::fabs(area) > 0.0)) return;
  const vec2 low = glm::max(glm::min(glm::min(p[0], p[1]), p[2]), vec2(0.0));
  const vec2 high = glm::min(glm::max(glm::max(p[0], p[1]), p[2]), side - 1.0);
  for (double y = std::ceil(low.y); y <= high.y; ++y) {
    for (double x = std::ceil(low.x); x <= high.x; ++x) {
      const vec2 at{x, y};
      const std::array<double, 3> w{cross(p[1], p[2], at) / area, cross(p[2], p[0], at) / area,
                                    cross(p[0], p[1], at) / area};
      if (w[0] >= 0.0 && w[1] >= 0.0 && w[2] >= 0.0) {
        visit(static_cast<std::size_t>(y) * texture.width + static_cast<std::size_t>(x), w);
      }
    }
  }
}

}  // namespace

std::size_t texel_map::count(texel_use what) const noexcept {
  return static_cast<std::size_t>(std::count(use.begin(), use.end(), what));
}

texel_map map_texels(const textured_model& model) {
  const std::size_t texels = model.texture.texels.size();
  texel_map map{model.texture.width, model.texture.height, std::vector<texel_use>(texels, texel_use::unused),
                std::vector<float>(texels, 0.0F)};
  for (std::size_t i = 0; i < texels; ++i) {
    const glm::vec3& p = model.texture.texels[i];
    if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) map.use[i] = texel_use::gutter;
  }
  for (std::size_t t = 0; t < model.mesh.triangles.size(); ++t) {
    const std::array<vec3, 3> c = corners(model.mesh, t);
    const vec3 n = area_normal(c);
    const vec3 normal = n / std::max(glm::length(n), 1e-300);
    for_each_texel(model.texture, model.mesh.triangles[t].uv, [&](std::size_t i, const std::array<double, 3>& w) {
      if (map.use[i] == texel_use::unused) return;
      map.use[i] = texel_use::chart;
      const vec3 coarse = w[0] * c[0] + w[1] * c[1] + w[2] * c[2];
      map.heights[i] = static_cast<float>(glm::dot(vec3(model.texture.texels[i]) - coarse, normal));
    });
  }
  return map;
}

texel_window informative_window(const texel_map& map, std::size_t side, const value_range& range) {
  texel_window best{0, 0, std::min(side, map.width), std::min(side, map.height)};
  const std::size_t stride = std::max<std::size_t>(1, side / 3);
  double best_score = -1.0;
  for (std::size_t top = 0; top + best.height <= map.height; top += stride) {
    for (std::size_t left = 0; left + best.width <= map.width; left += stride) {
      std::array<double, 3> share{};
      double relief = 0.0;
      for (std::size_t y = top; y < top + best.height; ++y) {
        for (std::size_t x = left; x < left + best.width; ++x) {
          share[static_cast<std::size_t>(map.use[y * map.width + x])] += 1.0;
          relief += std::min(1.0, std::fabs(static_cast<double>(map.heights[y * map.width + x])) / range.high);
        }
      }
      const auto all = static_cast<double>(best.width * best.height);
      for (double& s : share) s /= all;
      // Charts are what it is about: half of the window is enough for them, a fifth for each of the others.
      const double score =
          std::min(share[2], 0.5) + std::min(share[1], 0.2) + std::min(share[0], 0.2) + 0.3 * relief / all;
      if (score <= best_score) continue;
      best_score = score;
      best.left = left;
      best.top = top;
    }
  }
  return best;
}

pixmap draw_texels(const texel_map& map, const texel_window& window, const value_range& range,
                   const colour_scale& scale, std::size_t width, std::size_t height) {
  const double texels_per_pixel = std::max(static_cast<double>(window.width) / static_cast<double>(width),
                                           static_cast<double>(window.height) / static_cast<double>(height));
  const auto fineness = static_cast<std::size_t>(std::clamp(std::ceil(2.0 * texels_per_pixel), 3.0, 32.0));
  const float share = 1.0F / static_cast<float>(fineness * fineness);
  const auto colour_of = [&](std::size_t x, std::size_t y) {
    const std::size_t i = (window.top + y) * map.width + window.left + x;
    if (map.use[i] == texel_use::unused) return unused_texel;
    if (map.use[i] == texel_use::gutter) return gutter_texel;
    return scale.at(range.share(static_cast<double>(map.heights[i])));
  };
  pixmap out{width, height, {}};
  out.rgb.reserve(3 * width * height);
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      colour sum;
      for (std::size_t j = 0; j < fineness; ++j) {
        for (std::size_t i = 0; i < fineness; ++i) {
          sum = sum + colour_of((2 * (x * fineness + i) + 1) * window.width / (2 * width * fineness),
                                (2 * (y * fineness + j) + 1) * window.height / (2 * height * fineness));
        }
      }
      for (const float channel : {sum.r, sum.g, sum.b}) out.rgb.push_back(to_srgb8(share * channel));
    }
  }
  return out;
}

}  // namespace asperity::picture
