// The fine surface as heights over a cell's plane.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "asperity/cells/cell_grid.hpp"
#include "asperity/cells/cell_outline.hpp"
#include "asperity/depth/surface_index.hpp"
#include "asperity/model/textured_model.hpp"

namespace asperity::detail {

/// Texel columns or rows that a triangle's corners span, widened by `extra` and kept inside the image.
struct texel_range {
  std::size_t first, last;
  texel_range(double a, double b, double c, double extra, std::uint32_t size) noexcept
      : first(static_cast<std::size_t>(std::clamp<double>(std::floor(std::min({a, b, c}) - extra), 0.0, size))),
        last(static_cast<std::size_t>(std::clamp(std::ceil(std::max({a, b, c}) + extra), 0.0, size - 1.0))) {}
};

/// Heights of the textured surface over the nodes of a map.
///
/// Every quad of four texels is drawn into the grid. Over its own coarse triangle a texel counts before all others:
/// those of a neighbouring chart reach a little over the common edge, but what they hold there is made up. Where the
/// surface folds over itself the upper sheet counts. Nodes that no quad reaches take the mean of their neighbours.
/// Walls are leant on by a slope, outwards, so that nothing is lost that could be touched.
/// @param under of each node: the place in outline.shown of the triangle over it, or none
[[nodiscard]] inline std::vector<float> draw_relief(const cell_grid& grid, const cell_outline& outline,
                                                    const std::vector<std::uint32_t>& under,
                                                    const textured_model& model, const surface_index& index,
                                                    double steepest) {
  constexpr float unset = -1e30F;
  std::vector<float> height(grid.size(), unset), beside(grid.size(), unset);
  const haptic_texture& texture = model.texture;
  for (std::size_t n = 0; n < outline.shown.size(); ++n) {
    const texel_triangle& z = index.texels[outline.shown[n]];
    if (!z.usable) continue;
    const auto put = [&](std::size_t i, double h) {
      float& best = under[i] == n ? height[i] : beside[i];
      best = std::max(best, static_cast<float>(h));
    };
    const texel_range columns(z.corner[0].x, z.corner[1].x, z.corner[2].x, 1.0, texture.width);
    const texel_range rows(z.corner[0].y, z.corner[1].y, z.corner[2].y, 1.0, texture.height);
    for (std::size_t j = rows.first; j < rows.last; ++j) {
      for (std::size_t i = columns.first; i < columns.last; ++i) {
        const vec3 bary = z.barycentric({static_cast<double>(i) + 0.5, static_cast<double>(j) + 0.5});
        const double outside = std::min({bary.x * z.altitude[0], bary.y * z.altitude[1], bary.z * z.altitude[2]});
        if (outside < -0.75) continue;  // texels; the quads of neighbouring triangles then overlap by half a texel
        const vec3 a = texture.at(i, j), b = texture.at(i + 1, j), c = texture.at(i, j + 1),
                   d = texture.at(i + 1, j + 1);
        if (!is_finite(a + b + c + d)) continue;
        const vec3 ga = grid.to_grid(a), gd = grid.to_grid(d);
        grid.fill(ga, grid.to_grid(b), gd, put);
        grid.fill(ga, gd, grid.to_grid(c), put);
      }
    }
  }

  for (std::size_t i = 0; i < height.size(); ++i) {
    if (height[i] == unset) height[i] = beside[i];
  }

  // Outwards from what is known, one ring of nodes per round.
  const auto nx = static_cast<std::ptrdiff_t>(grid.cell->columns), ny = static_cast<std::ptrdiff_t>(grid.cell->rows);
  std::vector<std::size_t> ring, next;
  std::vector<char> waiting(height.size(), 0);
  const auto neighbours = [&](std::size_t i, auto&& visit) {
    const auto x = static_cast<std::ptrdiff_t>(i) % nx, y = static_cast<std::ptrdiff_t>(i) / nx;
    for (std::ptrdiff_t b = std::max<std::ptrdiff_t>(0, y - 1); b <= std::min(ny - 1, y + 1); ++b) {
      for (std::ptrdiff_t a = std::max<std::ptrdiff_t>(0, x - 1); a <= std::min(nx - 1, x + 1); ++a) {
        visit(static_cast<std::size_t>(b * nx + a));
      }
    }
  };
  const auto add_ring = [&](std::size_t i) {
    neighbours(i, [&](std::size_t n) {
      if (height[n] == unset && waiting[n] == 0) {
        waiting[n] = 1;
        next.push_back(n);
      }
    });
  };
  for (std::size_t i = 0; i < height.size(); ++i) {
    if (height[i] != unset) add_ring(i);
  }
  std::vector<float> mean;
  while (!next.empty()) {
    ring.swap(next);
    next.clear();
    mean.assign(ring.size(), 0.0F);
    for (std::size_t r = 0; r < ring.size(); ++r) {
      float sum = 0.0F;
      int count = 0;
      neighbours(ring[r], [&](std::size_t n) {
        if (height[n] == unset) return;
        sum += height[n];
        ++count;
      });
      mean[r] = sum / static_cast<float>(count);
    }
    for (std::size_t r = 0; r < ring.size(); ++r) height[ring[r]] = mean[r];
    for (const std::size_t i : ring) add_ring(i);
  }
  for (float& h : height) {
    if (h == unset) h = 0.0F;  // a region without a single texel lies on its plane
  }
  grid.limit_slope(height, steepest, -1.0F);
  return height;
}

}  // namespace asperity::detail
