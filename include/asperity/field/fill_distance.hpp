// Signed distances to a fine surface at the nodes of a grid.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "asperity/field/coarse_grid.hpp"
#include "asperity/field/fine_surface.hpp"
#include "asperity/field/inside_columns.hpp"

namespace asperity::detail {

/// Closest point of a triangle. @source Ericson, Real-Time Collision Detection, 5.1.5
[[nodiscard]] inline vec3 closest_on_triangle(const fine_triangle& t, const vec3& p) noexcept {
  const vec3 ab = t[1] - t[0], ac = t[2] - t[0], ap = p - t[0];
  const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
  if (d1 <= 0.0 && d2 <= 0.0) return t[0];
  const vec3 bp = p - t[1];
  const double d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
  if (d3 >= 0.0 && d4 <= d3) return t[1];
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return t[0] + d1 / (d1 - d3) * ab;
  const vec3 cp = p - t[2];
  const double d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
  if (d6 >= 0.0 && d5 <= d6) return t[2];
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return t[0] + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) return t[1] + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (t[2] - t[1]);
  const double per_sum = 1.0 / (va + vb + vc);
  return t[0] + vb * per_sum * ab + vc * per_sum * ac;
}

/// Distances by sweeping: nodes beside a triangle ask it, all others ask those that their neighbours are nearest to.
class distance_sweep {
 public:
  distance_sweep(std::span<const fine_triangle> surface, const coarse_grid& grid)
      : surface_(surface),
        grid_(grid),
        nearest_(grid.nodes[0] * grid.nodes[1] * grid.nodes[2], none),
        distance_(nearest_.size(), std::numeric_limits<float>::max()) {
    middle_.reserve(surface.size());
    for (const fine_triangle& t : surface) {
      const vec3 m = (t[0] + t[1] + t[2]) / 3.0;
      double r2 = 0.0;
      for (const vec3& p : t) r2 = std::max(r2, glm::dot(p - m, p - m));
      middle_.push_back({m, std::sqrt(r2)});
    }
  }

  void ask_beside() {
    for (std::uint32_t t = 0; t < surface_.size(); ++t) {
      const fine_triangle& f = surface_[t];
      const vec3 low = (glm::min(f[0], glm::min(f[1], f[2])) - grid_.low) / grid_.pitch_m - 1.0;
      const vec3 high = (glm::max(f[0], glm::max(f[1], f[2])) - grid_.low) / grid_.pitch_m + 1.0;
      std::array<std::size_t, 3> first{}, end{};
      for (std::size_t k = 0; k < 3; ++k) {
        const int axis = static_cast<int>(k);
        first[k] = static_cast<std::size_t>(std::max(0.0, std::ceil(low[axis])));
        end[k] = static_cast<std::size_t>(
            std::clamp(std::floor(high[axis]) + 1.0, 0.0, static_cast<double>(grid_.nodes[k])));
      }
      for (std::size_t k = first[2]; k < end[2]; ++k) {
        for (std::size_t j = first[1]; j < end[1]; ++j) {
          for (std::size_t i = first[0]; i < end[0]; ++i) ask(grid_.at(i, j, k), position(i, j, k), t);
        }
      }
    }
  }

  /// Hands the nearest triangles on, by the distance of their middles alone: over all nodes and back.
  void hand_on() {
    const std::array<std::ptrdiff_t, 3> n{static_cast<std::ptrdiff_t>(grid_.nodes[0]),
                                          static_cast<std::ptrdiff_t>(grid_.nodes[1]),
                                          static_cast<std::ptrdiff_t>(grid_.nodes[2])};
    // A node within a pitch of a triangle was in its box: what it knows is exact. Beyond, a nearer triangle may have
    // passed it by.
    beside_.resize(nearest_.size());
    for (std::size_t i = 0; i < nearest_.size(); ++i) {
      beside_[i] = static_cast<double>(distance_[i]) <= grid_.pitch_m ? 1 : 0;
      if (beside_[i] != 0 || nearest_[i] == none) continue;
      const vec3 m = position_of(i) - middle_[nearest_[i]].middle;
      distance_[i] = static_cast<float>(glm::dot(m, m));
    }
    for (const std::ptrdiff_t way : {1, -1}) {
      for (std::ptrdiff_t c = 0; c < n[2]; ++c) {
        const std::ptrdiff_t k = way > 0 ? c : n[2] - 1 - c;
        for (std::ptrdiff_t b = 0; b < n[1]; ++b) {
          const std::ptrdiff_t j = way > 0 ? b : n[1] - 1 - b;
          for (std::ptrdiff_t a = 0; a < n[0]; ++a) {
            const std::ptrdiff_t i = way > 0 ? a : n[0] - 1 - a, at = (k * n[1] + j) * n[0] + i;
            const auto node = static_cast<std::size_t>(at);
            if (beside_[node] != 0) continue;
            const vec3 p =
                position(static_cast<std::size_t>(i), static_cast<std::size_t>(j), static_cast<std::size_t>(k));
            // The thirteen neighbours that this pass has seen already.
            for (std::ptrdiff_t o = 0; o < 13; ++o) {
              const std::ptrdiff_t x = i + way * (o % 3 - 1), y = j + way * (o / 3 % 3 - 1), z = k + way * (o / 9 - 1);
              if (x < 0 || y < 0 || z < 0 || x >= n[0] || y >= n[1] || z >= n[2]) continue;
              const std::uint32_t t = nearest_[static_cast<std::size_t>((z * n[1] + y) * n[0] + x)];
              if (t == none || t == nearest_[node]) continue;
              const vec3 m = p - middle_[t].middle;
              const auto d2 = static_cast<float>(glm::dot(m, m));
              if (d2 >= distance_[node]) continue;
              distance_[node] = d2;
              nearest_[node] = t;
            }
          }
        }
      }
    }
  }

  /// Of the triangles handed to a node and to those around it, the one that is nearest.
  void ask_around() {
    for (std::size_t i = 0; i < nearest_.size(); ++i) {
      if (beside_[i] == 0) distance_[i] = std::numeric_limits<float>::max();
    }
    const auto [nx, ny, nz] = grid_.nodes;
    for (std::size_t k = 0; k < nz; ++k) {
      for (std::size_t j = 0; j < ny; ++j) {
        for (std::size_t i = 0; i < nx; ++i) {
          const std::size_t node = grid_.at(i, j, k);
          if (beside_[node] != 0 || nearest_[node] == none) continue;
          const vec3 p = position(i, j, k);
          ask(node, p, nearest_[node]);
          if (i > 0) ask_of(node, p, node - 1);
          if (i + 1 < nx) ask_of(node, p, node + 1);
          if (j > 0) ask_of(node, p, node - nx);
          if (j + 1 < ny) ask_of(node, p, node + nx);
          if (k > 0) ask_of(node, p, node - nx * ny);
          if (k + 1 < nz) ask_of(node, p, node + nx * ny);
        }
      }
    }
  }

  /// Signs the distances and gives them out. @param votes of vote_inside()
  [[nodiscard]] std::vector<float> finish(std::span<const std::int8_t> votes) {
    for (std::size_t n = 0; n < distance_.size(); ++n) {
      bool inside = votes[n] > 0;
      if (votes[n] == 0 && nearest_[n] != none) {
        const fine_triangle& t = surface_[nearest_[n]];
        const vec3 p = position_of(n);
        inside = glm::dot(area_normal(t), p - closest_on_triangle(t, p)) < 0.0;
      }
      if (!inside) distance_[n] = -distance_[n];
    }
    return std::move(distance_);
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffU;
  struct ball {
    vec3 middle;
    double radius;
  };

  [[nodiscard]] vec3 position(std::size_t i, std::size_t j, std::size_t k) const noexcept {
    return grid_.low + grid_.pitch_m * vec3(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k));
  }

  [[nodiscard]] vec3 position_of(std::size_t node) const noexcept {
    return position(node % grid_.nodes[0], node / grid_.nodes[0] % grid_.nodes[1],
                    node / (grid_.nodes[0] * grid_.nodes[1]));
  }

  void ask_of(std::size_t node, const vec3& p, std::size_t other) noexcept {
    const std::uint32_t t = nearest_[other];
    if (t != none && t != nearest_[node]) ask(node, p, t);
  }

  void ask(std::size_t node, const vec3& p, std::uint32_t t) noexcept {
    const ball& b = middle_[t];
    const vec3 m = p - b.middle;
    const double known = static_cast<double>(distance_[node]), within = known + b.radius;
    if (glm::dot(m, m) >= within * within) return;
    const vec3 d = p - closest_on_triangle(surface_[t], p);
    const double d2 = glm::dot(d, d);
    if (d2 >= known * known) return;
    distance_[node] = static_cast<float>(std::sqrt(d2));
    nearest_[node] = t;
  }

  std::span<const fine_triangle> surface_;
  const coarse_grid& grid_;
  std::vector<std::uint32_t> nearest_;
  std::vector<float> distance_;
  std::vector<ball> middle_;
  std::vector<char> beside_;  // within a pitch of the surface
};

/// Fills a grid with signed distances to a surface, positive inside.
inline void fill_distance(std::span<const fine_triangle> surface, coarse_grid& grid) {
  distance_sweep sweep(surface, grid);
  sweep.ask_beside();
  sweep.hand_on();
  sweep.ask_around();
  grid.value = sweep.finish(vote_inside(surface, grid));
}

}  // namespace asperity::detail
