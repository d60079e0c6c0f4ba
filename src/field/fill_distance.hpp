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
#include "field/fine_surface.hpp"
#include "field/inside_columns.hpp"
#include "field/threads.hpp"

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

/// Distances by sweeping: nodes beside a triangle measure it, all others the triangles nearest to their neighbours.
class distance_sweep {
 public:
  distance_sweep(std::span<const fine_triangle> surface, const coarse_grid& grid, unsigned threads)
      : surface_(surface),
        grid_(grid),
        threads_(threads),
        pitch_(static_cast<float>(grid.pitch_m)),
        nearest_(grid.nodes[0] * grid.nodes[1] * grid.nodes[2], none),
        distance_(nearest_.size(), 1.75F * pitch_) {
    around_.resize(surface.size());
    beside_.resize(surface.size());
    for_each_part(surface.size(), threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        around_[i] = disc_around(surface[i]);
        beside_[i] = nodes_beside(surface[i]);
      }
    });
  }

  /// Measures each triangle from the nodes in its box, a pitch wider: exact within a pitch of the surface. A thread has
  /// some layers of nodes for itself and asks about all triangles in their order, so that each node is asked in it.
  void ask_beside() {
    const std::size_t parts = std::min<std::size_t>(grid_.nodes[2], threads_ > 1 ? std::size_t{2} * threads_ : 1);
    for_each_task(parts, threads_, [&](std::size_t part) {
      ask_beside(part_begin(grid_.nodes[2], parts, part), part_begin(grid_.nodes[2], parts, part + 1));
    });
    beside_ = std::vector<node_box>();
  }

  /// Hands the nearest triangles on, by the distance of their middles alone: from neighbour to neighbour along all
  /// three axes, up and down. @source Danielsson, Euclidean distance mapping, 1980
  void hand_on() {
    const std::size_t count = nearest_.size();
    const auto [nx, ny, nz] = grid_.nodes;
    handed_ = nearest_;
    // Distances of the nodes beside the surface are exact and stay.
    square_.assign(count, std::numeric_limits<float>::max());
    for (std::vector<float>& m : middle_) m.assign(count, 1e18F);
    for (std::size_t n = 0; n < count; ++n) {
      if (nearest_[n] == none) continue;
      const glm::vec3& m = around_[nearest_[n]].middle;
      for (std::size_t k = 0; k < 3; ++k) middle_[k][n] = m[static_cast<int>(k)];
      if (distance_[n] <= pitch_) {
        square_[n] = -1.0F;
        continue;
      }
      const glm::vec3 away = place(n % nx, n / nx % ny, n / (nx * ny)) - m;
      square_[n] = glm::dot(away, away);
      nearest_[n] = none;
    }
    for (std::size_t k = 0; k < nz; ++k) sweep_layer(k, k > 0 ? nx * ny : 0, false);
    for (std::size_t k = nz; k-- > 0;) sweep_layer(k, k + 1 < nz ? nx * ny : 0, true);
    middle_ = {};
    square_ = std::vector<float>();
  }

  /// Of the triangles handed to a node and to those around it, the one that is nearest. From three pitches on those of
  /// the six neighbours alone are wrong by some micrometres: good enough for gaps, but not for depths.
  /// @param votes of vote_inside()
  void ask_around(std::span<const std::int8_t> votes) {
    for_each_part(grid_.nodes[2], threads_, [&](std::size_t begin, std::size_t end) { ask_around(votes, begin, end); });
  }

  /// Gives the distances their signs and hands them over. @param votes of vote_inside()
  [[nodiscard]] std::vector<float> finish(std::span<const std::int8_t> votes) {
    for_each_part(distance_.size(), threads_, [&](std::size_t begin, std::size_t end) { sign(votes, begin, end); });
    return std::move(distance_);
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffU;
  struct disc {  // around a triangle; from the grid's first node
    glm::vec3 middle;
    float radius;
    glm::vec3 n;
  };
  struct node_box {  // beside a triangle
    std::array<std::uint32_t, 3> first, end;
  };

  [[nodiscard]] disc disc_around(const fine_triangle& t) const noexcept {
    const vec3 m = (t[0] + t[1] + t[2]) / 3.0, n = area_normal(t);
    const double length = std::sqrt(glm::dot(n, n));
    double r2 = 0.0;
    for (const vec3& p : t) r2 = std::max(r2, glm::dot(p - m, p - m));
    return {glm::vec3(m - grid_.low), 1.0001F * static_cast<float>(std::sqrt(r2)),
            length > 0.0 ? glm::vec3(n / length) : glm::vec3(0.0F)};
  }

  [[nodiscard]] node_box nodes_beside(const fine_triangle& f) const noexcept {
    const vec3 low = (glm::min(f[0], glm::min(f[1], f[2])) - grid_.low) / grid_.pitch_m - 1.0;
    const vec3 high = (glm::max(f[0], glm::max(f[1], f[2])) - grid_.low) / grid_.pitch_m + 1.0;
    node_box out{};
    for (std::size_t k = 0; k < 3; ++k) {
      const int axis = static_cast<int>(k);
      const auto most = static_cast<double>(grid_.nodes[k]);
      out.first[k] = static_cast<std::uint32_t>(std::clamp(std::ceil(low[axis]), 0.0, most));
      out.end[k] = static_cast<std::uint32_t>(std::clamp(std::floor(high[axis]) + 1.0, 0.0, most));
    }
    return out;
  }

  void ask_beside(std::size_t first_layer, std::size_t end_layer) noexcept {
    for (std::uint32_t t = 0; t < surface_.size(); ++t) {
      const node_box& in = beside_[t];
      const std::size_t end = std::min<std::size_t>(in.end[2], end_layer);
      for (std::size_t k = std::max<std::size_t>(in.first[2], first_layer); k < end; ++k) {
        for (std::size_t j = in.first[1]; j < in.end[1]; ++j) {
          for (std::size_t i = in.first[0]; i < in.end[0]; ++i) ask(grid_.at(i, j, k), place(i, j, k), t);
        }
      }
    }
  }

  void ask_around(std::span<const std::int8_t> votes, std::size_t first_layer, std::size_t end_layer) noexcept {
    const auto [nx, ny, nz] = grid_.nodes;
    for (std::size_t k = first_layer; k < end_layer; ++k) {
      for (std::size_t j = 0; j < ny; ++j) {
        for (std::size_t i = 0; i < nx; ++i) {
          const std::size_t node = grid_.at(i, j, k);
          if (nearest_[node] != none || handed_[node] == none) continue;
          distance_[node] = std::numeric_limits<float>::max();
          const glm::vec3 p = place(i, j, k);
          ask(node, p, handed_[node]);
          if (distance_[node] > 6.0F * pitch_) continue;  // which of two triangles is taken hardly matters there
          if (i > 0) ask_of(node, p, node - 1);
          if (i + 1 < nx) ask_of(node, p, node + 1);
          if (j > 0) ask_of(node, p, node - nx);
          if (j + 1 < ny) ask_of(node, p, node + nx);
          if (k > 0) ask_of(node, p, node - nx * ny);
          if (k + 1 < nz) ask_of(node, p, node + nx * ny);
          // Near the surface triangles are large as seen from the node, and inside the depth of a press is read here.
          // The grid has at least one node more on each side, in both cases.
          if (distance_[node] > 3.0F * pitch_ && votes[node] <= 0) continue;
          for (const std::size_t layer : {node - nx * ny, node, node + nx * ny}) {
            for (const std::size_t row : {layer - nx, layer, layer + nx}) {
              ask_of(node, p, row - 1);
              ask_of(node, p, row);
              ask_of(node, p, row + 1);
            }
          }
        }
      }
    }
  }

  void sign(std::span<const std::int8_t> votes, std::size_t begin, std::size_t end) noexcept {
    for (std::size_t n = begin; n < end; ++n) {
      bool inside = votes[n] > 0;
      if (votes[n] == 0 && nearest_[n] != none) {
        const fine_triangle& t = surface_[nearest_[n]];
        const std::size_t nx = grid_.nodes[0], ny = grid_.nodes[1];
        const vec3 p = grid_.low + vec3(place(n % nx, n / nx % ny, n / (nx * ny)));
        inside = glm::dot(area_normal(t), p - closest_on_triangle(t, p)) < 0.0;
      }
      if (!inside) distance_[n] = -distance_[n];
    }
  }

  /// From the grid's first node.
  [[nodiscard]] glm::vec3 place(std::size_t i, std::size_t j, std::size_t k) const noexcept {
    return pitch_ * glm::vec3(static_cast<float>(i), static_cast<float>(j), static_cast<float>(k));
  }

  /// Offers the triangles of one row of nodes to the row beside it.
  void take_from(std::size_t row, std::size_t other, const glm::vec3& p) noexcept {
    float *const x = middle_[0].data() + row, *const y = middle_[1].data() + row, *const z = middle_[2].data() + row;
    const float *const ox = middle_[0].data() + other, *const oy = middle_[1].data() + other;
    const float* const oz = middle_[2].data() + other;
    float* const square = square_.data() + row;
    std::uint32_t* const tri = handed_.data() + row;
    const std::uint32_t* const other_tri = handed_.data() + other;
    const std::size_t count = grid_.nodes[0];
    for (std::size_t i = 0; i < count; ++i) {
      const float dx = static_cast<float>(static_cast<std::int32_t>(i)) * pitch_ - ox[i], dy = p.y - oy[i],
                  dz = p.z - oz[i];
      const float d2 = dx * dx + dy * dy + dz * dz;
      const bool nearer = d2 < square[i];
      square[i] = nearer ? d2 : square[i];
      x[i] = nearer ? ox[i] : x[i];
      y[i] = nearer ? oy[i] : y[i];
      z[i] = nearer ? oz[i] : z[i];
      tri[i] = nearer ? other_tri[i] : tri[i];
    }
  }

  void pass_along(std::size_t node, std::size_t from, const glm::vec3& p) noexcept {
    const glm::vec3 m(middle_[0][from], middle_[1][from], middle_[2][from]);
    const float d2 = glm::dot(p - m, p - m);
    if (d2 >= square_[node]) return;
    square_[node] = d2;
    for (std::size_t k = 0; k < 3; ++k) middle_[k][node] = m[static_cast<int>(k)];
    handed_[node] = handed_[from];
  }

  void sweep_row(std::size_t j, std::size_t k) noexcept {
    const std::size_t row = grid_.at(0, j, k), nx = grid_.nodes[0];
    glm::vec3 p = place(0, j, k);
    for (std::size_t i = 1; i < nx; ++i) {
      p.x = static_cast<float>(i) * pitch_;
      pass_along(row + i, row + i - 1, p);
    }
    for (std::size_t i = nx - 1; i-- > 0;) {
      p.x = static_cast<float>(i) * pitch_;
      pass_along(row + i, row + i + 1, p);
    }
  }

  /// @param layer  nodes to the layer before, 0 where there is none   @param down  whether that one is above
  void sweep_layer(std::size_t k, std::size_t layer, bool down) noexcept {
    const auto [nx, ny, nz] = grid_.nodes;
    for (std::size_t j = 0; j < ny; ++j) {
      const std::size_t row = grid_.at(0, j, k);
      if (layer > 0) take_from(row, down ? row + layer : row - layer, place(0, j, k));
      if (j > 0) take_from(row, row - nx, place(0, j, k));
      sweep_row(j, k);
    }
    for (std::size_t j = ny - 1; j-- > 0;) {
      const std::size_t row = grid_.at(0, j, k);
      take_from(row, row + nx, place(0, j, k));
      sweep_row(j, k);
    }
  }

  void ask_of(std::size_t node, const glm::vec3& p, std::size_t other) noexcept {
    const std::uint32_t t = handed_[other];
    if (t != none && t != nearest_[node]) ask(node, p, t);
  }

  void ask(std::size_t node, const glm::vec3& place, std::uint32_t t) noexcept {
    // No point of the disc around the triangle is nearer than what is known? A little slack for rounding.
    const disc& b = around_[t];
    const glm::vec3 m = place - b.middle;
    const float known = distance_[node], over = glm::dot(m, b.n);
    if (std::fabs(over) > 1.00001F * known + 1e-5F * pitch_) return;
    const float m2 = glm::dot(m, m), beside2 = m2 - over * over, r2 = b.radius * b.radius;
    const float spare = m2 + r2 - known * known - 1e-5F * (m2 + pitch_ * pitch_);
    if (spare > 0.0F && beside2 > r2 && 4.0F * beside2 * r2 < spare * spare) return;
    const vec3 p = grid_.low + vec3(place), d = p - closest_on_triangle(surface_[t], p);
    const auto distance = static_cast<float>(std::sqrt(glm::dot(d, d)));
    if (distance >= known) return;
    distance_[node] = distance;
    nearest_[node] = t;
  }

  std::span<const fine_triangle> surface_;
  const coarse_grid& grid_;
  unsigned threads_;
  float pitch_;
  std::vector<std::uint32_t> nearest_;  // triangle; within a pitch of the surface from the beginning
  std::vector<float> distance_;
  std::vector<disc> around_;
  std::vector<node_box> beside_;
  std::vector<std::uint32_t> handed_;           // triangles, while they are handed on,
  std::array<std::vector<float>, 3> middle_{};  // their middles, from the grid's first node,
  std::vector<float> square_;                   // and the distances of these, squared; below zero: known already
};

/// Fills a grid with signed distances to a surface, positive inside. @param crossings of the grid's lines
inline void fill_distance(std::span<const fine_triangle> surface, const axis_crossings& crossings, coarse_grid& grid,
                          unsigned threads) {
  std::vector<std::int8_t> votes;
  distance_sweep sweep(surface, grid, threads);
  for_each_task(2, threads, [&](std::size_t task) {
    if (task == 0) {
      sweep.ask_beside();
      sweep.hand_on();
    } else {
      votes = vote_inside(crossings, grid);
    }
  });
  sweep.ask_around(votes);
  grid.value = sweep.finish(votes);
}

}  // namespace asperity::detail
