// What measuring a depth needs of one body at every pose: normals, neighbours, and where each triangle lies in the
// texture.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "asperity/model/textured_model.hpp"

namespace asperity::detail {

/// A triangle's place in the texture, in texels; texel centres have integer coordinates.
struct texel_triangle {
  std::array<vec2, 3> corner;
  /// Barycentric coordinate k of a texel position z is weight[k].x + weight[k].y * z.x + weight[k].z * z.y.
  std::array<vec3, 3> weight;
  /// Height of the triangle over the edge opposite to corner k, texels: turns barycentric coordinates into distances.
  std::array<double, 3> altitude;
  bool usable = false;  ///< false where the triangle has no area in the texture

  [[nodiscard]] vec3 barycentric(const vec2& z) const noexcept {
    const auto at = [&](std::size_t k) { return weight[k].x + weight[k].y * z.x + weight[k].z * z.y; };
    return {at(0), at(1), at(2)};
  }
  /// How far the coarse surface goes per texel along the image's x and y; `c` are the triangle's corners.
  [[nodiscard]] std::array<vec3, 2> per_texel(const std::array<vec3, 3>& c) const noexcept {
    return {weight[0].y * c[0] + weight[1].y * c[1] + weight[2].y * c[2],
            weight[0].z * c[0] + weight[1].z * c[1] + weight[2].z * c[2]};
  }
  /// Corner whose opposite edge is the one that a position is farthest outside of.
  [[nodiscard]] std::size_t outermost(const vec3& bary) const noexcept {
    const double d0 = bary.x * altitude[0], d1 = bary.y * altitude[1], d2 = bary.z * altitude[2];
    return d0 <= d1 && d0 <= d2 ? 0 : (d1 <= d2 ? 1 : 2);
  }
  /// True up to so many texels outside of the triangle. Its own distance counts, because a limit on the distances from
  /// the edges would reach far beyond an acute corner. @param bary  barycentric(z)
  [[nodiscard]] bool within(const vec2& z, const vec3& bary, double reach_texels) const noexcept {
    bool inside = true;
    for (std::size_t k = 0; k < 3; ++k) {
      if (bary[static_cast<int>(k)] >= 0.0) continue;
      inside = false;
      const vec2 from = corner[(k + 1) % 3], along = corner[(k + 2) % 3] - from;
      const double share = glm::dot(z - from, along) / glm::dot(along, along);
      const vec2 off = z - from - (share < 0.0 ? 0.0 : (share > 1.0 ? 1.0 : share)) * along;
      if (glm::dot(off, off) <= reach_texels * reach_texels) return true;
    }
    return inside;
  }
};

/// Edge k of a triangle runs from corner k to corner k + 1.
struct surface_index {
  static constexpr std::uint32_t none = 0xffffffffU;

  std::vector<vec3> normal;                             ///< unit, outward, body frame; zero for a triangle without area
  std::vector<std::array<std::uint32_t, 3>> neighbour;  ///< triangle across edge k, or none
  std::vector<texel_triangle> texels;

  explicit surface_index(const textured_model& model) {
    const std::size_t count = model.mesh.triangles.size();
    normal.resize(count);
    texels.resize(count);
    for (std::size_t t = 0; t < count; ++t) {
      const vec3 n = area_normal(corners(model.mesh, t));
      const double length = std::sqrt(glm::dot(n, n));
      normal[t] = length > 0.0 ? n / length : vec3(0.0);
      texels[t] = place(model.mesh.triangles[t], model.texture);
    }
    find_neighbours(model.mesh);
  }

  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(normal, neighbour, texels); }

 private:
  [[nodiscard]] static texel_triangle place(const coarse_triangle& t, const haptic_texture& texture) noexcept {
    texel_triangle out;
    const vec2 size(texture.width, texture.height);
    for (std::size_t k = 0; k < 3; ++k) out.corner[k] = t.uv[k] * size - 0.5;
    const vec2 a = out.corner[1] - out.corner[0];
    const vec2 b = out.corner[2] - out.corner[0];
    const double twice_area = a.x * b.y - a.y * b.x;
    out.usable = std::isfinite(twice_area) && std::fabs(twice_area) > 1e-9;
    if (!out.usable) return out;
    for (std::size_t k = 0; k < 3; ++k) {
      const vec2 p = out.corner[(k + 1) % 3];
      const vec2 d = out.corner[(k + 2) % 3] - p;
      out.weight[k] = vec3(d.y * p.x - d.x * p.y, -d.y, d.x) / twice_area;
      out.altitude[k] = std::fabs(twice_area) / std::sqrt(d.x * d.x + d.y * d.y);
    }
    return out;
  }

  void find_neighbours(const coarse_mesh& mesh) {
    struct corner_edge {
      std::uint32_t low, high, triangle, edge;
    };
    std::vector<corner_edge> edges;
    edges.reserve(3 * mesh.triangles.size());
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t a = mesh.triangles[t].vertex[k];
        const std::uint32_t b = mesh.triangles[t].vertex[(k + 1) % 3];
        edges.push_back({std::min(a, b), std::max(a, b), t, k});
      }
    }
    std::sort(edges.begin(), edges.end(), [](const corner_edge& x, const corner_edge& y) {
      return std::array{x.low, x.high, x.triangle, x.edge} < std::array{y.low, y.high, y.triangle, y.edge};
    });
    neighbour.assign(mesh.triangles.size(), {none, none, none});
    for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
      const corner_edge& a = edges[i];
      const corner_edge& b = edges[i + 1];
      if (a.low != b.low || a.high != b.high) continue;
      neighbour[a.triangle][a.edge] = b.triangle;
      neighbour[b.triangle][b.edge] = a.triangle;
    }
  }
};

}  // namespace asperity::detail
