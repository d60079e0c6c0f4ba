// The samples that a body measures others with: its texels, and points on its sharp edges.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "asperity/cells/cell_relief.hpp"
#include "asperity/cells/coarse_regions.hpp"
#include "asperity/cells/sharp_edges.hpp"
#include "asperity/cells/surface_cells.hpp"

namespace asperity::detail {

/// Adds samples, tiles and origins to a surface_cells.
class surface_sampler {
 public:
  surface_sampler(surface_cells& out, const textured_model& model, const surface_index& index,
                  const coarse_regions& regions)
      : out_(out), model_(model), index_(index), regions_(regions) {}

  /// Samples on the faces, a pitch apart; each stands for the coarse surface around it.
  void sample_regions() {
    for (std::size_t r = 0; r < regions_.members.size(); ++r) {
      std::vector<surface_sample> found;
      for (const std::uint32_t t : regions_.members[r]) sample_triangle(t, found);
      finish({regions_.normal[r], 0, 0}, found);
    }
  }

  /// Samples along every sharp convex edge, and at the vertices where such edges end.
  void sample_edges() {
    const std::size_t vertices = model_.mesh.positions.size();
    std::vector<std::vector<vec3>> leaving(vertices);
    std::vector<vec3> fine(vertices, vec3(0.0));
    std::vector<char> sharp(vertices, 0);
    for (std::uint32_t t = 0; t < model_.mesh.triangles.size(); ++t) {
      const coarse_triangle& c = model_.mesh.triangles[t];
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t from = c.vertex[k], to = c.vertex[(k + 1) % 3];
        const vec3 edge = model_.mesh.positions[to] - model_.mesh.positions[from];
        if (!(glm::dot(edge, edge) > 0.0)) continue;
        leaving[from].push_back(glm::normalize(edge));
        fine[from] += model_.texture.sample(c.uv[k]);
        if (regions_.kind[t][k] != edge_kind::convex) continue;
        sharp[from] = sharp[to] = 1;
        const std::uint32_t across = index_.neighbour[t][k];
        if (across == coarse_regions::none || t < across) sample_edge(t, k);
      }
    }
    const double area = out_.settings.feature_pitch_m * out_.settings.feature_pitch_m;
    for (std::size_t v = 0; v < vertices; ++v) {
      if (sharp[v] == 0 || leaving[v].empty()) continue;
      const vec3 p = fine[v] / static_cast<double>(leaving[v].size());
      std::vector<surface_sample> one;
      add(one, p, area);
      finish(with_outgoing(leaving[v]), one);
    }
  }

 private:
  static void add(std::vector<surface_sample>& to, const vec3& p_b, double area_m2) {
    if (is_finite(p_b)) to.push_back({glm::vec3(p_b), static_cast<float>(area_m2)});
  }

  // One sample per block of texels: the highest, because peaks are what touches; between equals the middle one. Valleys
  // need no samples of their own: what reaches down into one is a peak of the other body, and its sample meets the map.
  void sample_triangle(std::uint32_t t, std::vector<surface_sample>& to) const {
    const texel_triangle& z = index_.texels[t];
    if (!z.usable) return;
    const auto c = corners(model_.mesh, t);
    const auto [per_x, per_y] = z.per_texel(c);
    const double area = glm::length(glm::cross(per_x, per_y));
    const double pitch = out_.settings.sample_pitch_m;
    const double widest = std::max(model_.texture.width, model_.texture.height);
    const auto block = static_cast<std::size_t>(std::clamp(std::round(pitch / std::sqrt(area)), 1.0, widest));
    const double middle = 0.5 * static_cast<double>(block - 1);
    const texel_range columns(z.corner[0].x, z.corner[1].x, z.corner[2].x, 0.0, model_.texture.width);
    const texel_range rows(z.corner[0].y, z.corner[1].y, z.corner[2].y, 0.0, model_.texture.height);
    const std::size_t before = to.size();
    for (std::size_t row = rows.first / block; row <= rows.last / block; ++row) {
      for (std::size_t column = columns.first / block; column <= columns.last / block; ++column) {
        vec3 best(0.0);
        double best_score = -1e30;
        std::size_t texels = 0;
        for (std::size_t j = row * block; j < std::min<std::size_t>((row + 1) * block, model_.texture.height); ++j) {
          for (std::size_t i = column * block; i < std::min<std::size_t>((column + 1) * block, model_.texture.width);
               ++i) {
            const vec3 bary = z.barycentric({static_cast<double>(i), static_cast<double>(j)});
            if (!(bary.x >= 0.0 && bary.y >= 0.0 && bary.z >= 0.0)) continue;
            const vec3 p = model_.texture.at(i, j);
            if (!is_finite(p)) continue;
            ++texels;
            const double x = static_cast<double>(i - column * block) - middle;
            const double y = static_cast<double>(j - row * block) - middle;
            const double height = glm::dot(index_.normal[t], p - (bary.x * c[0] + bary.y * c[1] + bary.z * c[2]));
            const double score = height - 1e-4 * std::sqrt(area) * (x * x + y * y);
            if (score > best_score) {
              best_score = score;
              best = p;
            }
          }
        }
        if (texels > 0) add(to, best, static_cast<double>(texels) * area);
      }
    }
    // A sliver that holds no texel centre still is a piece of surface.
    if (to.size() == before) {
      const coarse_triangle& tri = model_.mesh.triangles[t];
      add(to, model_.texture.sample((tri.uv[0] + tri.uv[1] + tri.uv[2]) / 3.0), 0.5 * glm::length(area_normal(c)));
    }
  }

  void sample_edge(std::uint32_t t, std::size_t k) {
    const auto c = corners(model_.mesh, t);
    const vec3 edge = c[(k + 1) % 3] - c[k];
    const double length = glm::length(edge);
    const vec3 along = edge / length;
    std::vector<vec3> leaving{along, -along, glm::cross(index_.normal[t], along)};
    const std::uint32_t across = index_.neighbour[t][k];
    if (across != coarse_regions::none) leaving.push_back(glm::cross(index_.normal[across], -along));
    const auto count = static_cast<std::size_t>(std::max(1.0, std::ceil(length / out_.settings.feature_pitch_m)));
    std::vector<surface_sample> found;
    for (std::size_t i = 0; i < count; ++i) {
      const double f = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
      add(found, fine_edge_point(model_, index_, t, k, f),
          length / static_cast<double>(count) * out_.settings.feature_pitch_m);
    }
    finish(with_outgoing(leaving), found);
  }

  [[nodiscard]] sample_origin with_outgoing(std::span<const vec3> directions) {
    sample_origin out;
    out.first_outgoing = static_cast<std::uint32_t>(out_.outgoing.size());
    out.outgoing = static_cast<std::uint32_t>(directions.size());
    out_.outgoing.insert(out_.outgoing.end(), directions.begin(), directions.end());
    return out;
  }

  // Halves along the longest side until a tile is small enough to be skipped as one.
  void finish(const sample_origin& origin, std::span<surface_sample> samples) {
    constexpr std::size_t most = 16;
    if (samples.empty()) return;
    const auto id = static_cast<std::uint32_t>(out_.origins.size());
    out_.origins.push_back(origin);
    std::vector<std::span<surface_sample>> waiting{samples};
    while (!waiting.empty()) {
      const std::span<surface_sample> part = waiting.back();
      waiting.pop_back();
      glm::vec3 low = part[0].position_b, high = low;
      for (const surface_sample& s : part) {
        low = glm::min(low, s.position_b);
        high = glm::max(high, s.position_b);
      }
      if (part.size() <= most) {
        sample_tile tile{static_cast<std::uint32_t>(out_.samples.size()), static_cast<std::uint32_t>(part.size()), id,
                         0.5 * (vec3(low) + vec3(high)), 0.0};
        for (const surface_sample& s : part) {
          tile.radius_m = std::max(tile.radius_m, glm::length(vec3(s.position_b) - tile.centre_b));
        }
        out_.samples.insert(out_.samples.end(), part.begin(), part.end());
        out_.tiles.push_back(tile);
        continue;
      }
      const glm::vec3 size = high - low;
      const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
      // Ties by the other axes: the layout must not depend on the standard library's sort.
      std::sort(part.begin(), part.end(), [axis](const surface_sample& a, const surface_sample& b) {
        const glm::vec3 &p = a.position_b, &q = b.position_b;
        for (int i = 0; i < 3; ++i) {
          const int x = (axis + i) % 3;
          if (p[x] != q[x]) return p[x] < q[x];
        }
        return a.area_m2 < b.area_m2;
      });
      waiting.push_back(part.subspan(part.size() / 2));
      waiting.push_back(part.first(part.size() / 2));
    }
  }

  surface_cells& out_;
  const textured_model& model_;
  const surface_index& index_;
  const coarse_regions& regions_;
};

}  // namespace asperity::detail
