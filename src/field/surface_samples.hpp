// Lays out the samples of a body, which contacts are measured with.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "asperity/field/sample_tree.hpp"
#include "asperity/model/textured_model.hpp"
#include "model/surface_index.hpp"

namespace asperity::detail {

/// Texel columns or rows that a triangle's corners span, widened by `extra` and kept inside the image.
struct texel_range {
  std::size_t first, last;
  texel_range(double a, double b, double c, double extra, std::uint32_t size) noexcept
      : first(static_cast<std::size_t>(std::clamp<double>(std::floor(std::min({a, b, c}) - extra), 0.0, size))),
        last(static_cast<std::size_t>(std::clamp(std::ceil(std::max({a, b, c}) + extra), 0.0, size - 1.0))) {}
};

/// Fine surface at a fraction f of edge k of triangle t, from its first corner on: the mean of both charts.
[[nodiscard]] inline vec3 fine_edge_point(const textured_model& model, const surface_index& index, std::uint32_t t,
                                          std::size_t k, double f) noexcept {
  const coarse_triangle& tri = model.mesh.triangles[t];
  const vec3 p = model.texture.sample((1.0 - f) * tri.uv[k] + f * tri.uv[(k + 1) % 3]);
  const std::uint32_t across = index.neighbour[t][k];
  if (across == surface_index::none) return p;
  const coarse_triangle& other = model.mesh.triangles[across];
  std::size_t m = 0;  // the neighbour's corner at the far end of this edge
  while (other.vertex[m] != tri.vertex[(k + 1) % 3]) ++m;
  return 0.5 * (p + model.texture.sample((1.0 - f) * other.uv[(m + 1) % 3] + f * other.uv[m]));
}

/// Lays out a body's samples: on its faces the highest texel of every block a pitch wide, because peaks touch first;
/// along its sharp edges, where no texel centre lies, points a quarter of a pitch apart; and every vertex, because the
/// tip of a cone of many sides touches although it has no sharp edge. Valleys need no samples: only a peak of the other
/// body reaches into them.
///
/// Where an edge crosses another body's edge, the depth along it is a tent, and a sample that lies aside of its ridge has
/// less depth in proportion to the distance; on a face it is less by the square of it. So edges, which are few, have
/// samples four times as dense, and so do the blocks in which the relief is as steep as an edge. Four of them share a place
/// in the tree: as many planes are told as before, of places that are closer to where the bodies touch.
class surface_samples {
 public:
  /// @param pitch_m distance between samples, at least a texel is used
  surface_samples(const textured_model& model, const surface_index& index, double pitch_m)
      : model_(model), index_(index), pitch_m_(pitch_m) {}

  /// All samples, body frame. Points without a surface (NaN texels) are left out.
  [[nodiscard]] placed_samples make() const {
    laid_out out;
    std::vector<double> lean_rad(model_.mesh.triangles.size());
    for (std::uint32_t t = 0; t < model_.mesh.triangles.size(); ++t) lean_rad[t] = add_face(t, out);
    for (std::uint32_t t = 0; t < model_.mesh.triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t across = index_.neighbour[t][k];
        if ((across == surface_index::none || t < across) && is_sharp(t, across)) add_edge(t, k, lean_rad, out);
      }
    }
    add_vertices(lean_rad, out);
    return out.take();
  }

 private:
  static constexpr std::size_t edge_density = 4;  // samples of a place on an edge
  static constexpr double steep_rad = 1.0;
  static_assert(edge_density <= placed_samples::most);

  struct texel_block {
    std::size_t column, row, columns, rows;
  };

  // Samples as they are added, and which of them share a place.
  class laid_out {
   public:
    void add(const vec3& p_b, const vec3& axis_b, double cone_rad) {
      if (is_finite(p_b)) laid_.all.push_back({glm::vec3(p_b), glm::vec3(axis_b), static_cast<float>(cone_rad)});
    }
    // What was added since the last time is one place.
    void end_place() {
      if (laid_.all.size() == placed_) return;
      laid_.at_place.push_back(static_cast<std::uint8_t>(laid_.all.size() - placed_));
      placed_ = laid_.all.size();
    }
    [[nodiscard]] std::size_t size() const noexcept { return laid_.all.size(); }
    [[nodiscard]] placed_samples take() noexcept { return std::move(laid_); }

   private:
    placed_samples laid_;
    std::size_t placed_ = 0;
  };

  // Edges that turn by less lie on a curved surface, where texels are as high as the edge.
  [[nodiscard]] bool is_sharp(std::uint32_t t, std::uint32_t across) const noexcept {
    constexpr double cos_smooth = 0.97;
    return across == surface_index::none || !(glm::dot(index_.normal[t], index_.normal[across]) > cos_smooth);
  }

  // How far the fine surface leans away from a triangle, rad, where its neighbours turn away without an edge.
  [[nodiscard]] double turn_to_neighbours(std::uint32_t t) const noexcept {
    double most = 0.0;
    for (const std::uint32_t across : index_.neighbour[t]) {
      if (!is_sharp(t, across)) most = std::max(most, angle(index_.normal[t], index_.normal[across]));
    }
    return most;
  }

  // The largest angle between a triangle's normal and the fine surface from texel to texel in a block and around it.
  [[nodiscard]] double lean_in(std::uint32_t t, const texel_block& block) const noexcept {
    const texel_triangle& z = index_.texels[t];
    const auto is_inside = [&](std::size_t i, std::size_t j) {
      const vec3 bary = z.barycentric({static_cast<double>(i), static_cast<double>(j)});
      return bary.x >= 0.0 && bary.y >= 0.0 && bary.z >= 0.0;
    };
    double least_cosine = 1.0;
    for (std::size_t j = block.row - std::min<std::size_t>(block.row, 1);
         j < std::min<std::size_t>(block.row + block.rows, model_.texture.height - 1); ++j) {
      for (std::size_t i = block.column - std::min<std::size_t>(block.column, 1);
           i < std::min<std::size_t>(block.column + block.columns, model_.texture.width - 1); ++i) {
        if (!is_inside(i, j) || !is_inside(i + 1, j) || !is_inside(i, j + 1)) continue;
        const vec3 p = model_.texture.at(i, j);
        const vec3 across = glm::cross(model_.texture.at(i + 1, j) - p, model_.texture.at(i, j + 1) - p);
        const double length = glm::length(across);
        if (!(length > 0.0)) continue;  // NaN too
        // Charts may be mirrored.
        least_cosine = std::min(least_cosine, std::fabs(glm::dot(across, index_.normal[t])) / length);
      }
    }
    return std::acos(std::clamp(least_cosine, -1.0, 1.0));
  }

  // @return how far the fine surface leans away from the triangle, rad
  double add_face(std::uint32_t t, laid_out& to) const {
    const texel_triangle& z = index_.texels[t];
    const double turn_rad = turn_to_neighbours(t);
    double most_rad = turn_rad;
    if (!z.usable) return most_rad;
    const auto c = corners(model_.mesh, t);
    const auto [per_x, per_y] = z.per_texel(c);
    const double texel_m = std::sqrt(glm::length(glm::cross(per_x, per_y)));
    const double widest = std::max(model_.texture.width, model_.texture.height);
    const auto block = static_cast<std::size_t>(std::clamp(std::round(pitch_m_ / texel_m), 1.0, widest));
    const texel_range columns(z.corner[0].x, z.corner[1].x, z.corner[2].x, 0.0, model_.texture.width);
    const texel_range rows(z.corner[0].y, z.corner[1].y, z.corner[2].y, 0.0, model_.texture.height);
    const std::size_t before = to.size();
    for (std::size_t row = rows.first / block; row <= rows.last / block; ++row) {
      for (std::size_t column = columns.first / block; column <= columns.last / block; ++column) {
        const texel_block here{column * block, row * block, block, block};
        const double lean_rad = std::max(turn_rad, lean_in(t, here));
        most_rad = std::max(most_rad, lean_rad);
        if (lean_rad > steep_rad && block > 1) {
          add_quarters(t, here, turn_rad, texel_m, to);
        } else {
          add_highest(t, here, texel_m, lean_rad, to);
        }
        to.end_place();
      }
    }
    // A sliver that holds no texel centre gets a sample too.
    if (to.size() == before) {
      const coarse_triangle& tri = model_.mesh.triangles[t];
      to.add(model_.texture.sample((tri.uv[0] + tri.uv[1] + tri.uv[2]) / 3.0), index_.normal[t], most_rad);
      to.end_place();
    }
    return most_rad;
  }

  void add_quarters(std::uint32_t t, const texel_block& whole, double turn_rad, double texel_m, laid_out& to) const {
    const std::size_t columns = (whole.columns + 1) / 2, rows = (whole.rows + 1) / 2;
    for (const bool low : {true, false}) {
      for (const bool left : {true, false}) {
        const texel_block part{left ? whole.column : whole.column + columns, low ? whole.row : whole.row + rows,
                               left ? columns : whole.columns - columns, low ? rows : whole.rows - rows};
        add_highest(t, part, texel_m, std::max(turn_rad, lean_in(t, part)), to);
      }
    }
  }

  // The highest texel of a block; between equals the one nearest to its middle.
  void add_highest(std::uint32_t t, const texel_block& block, double texel_m, double lean_rad, laid_out& to) const {
    const auto c = corners(model_.mesh, t);
    const double middle_x = 0.5 * static_cast<double>(block.columns - 1);
    const double middle_y = 0.5 * static_cast<double>(block.rows - 1);
    double best_score = -1e30;
    vec3 best(0.0);
    for (std::size_t j = block.row; j < std::min<std::size_t>(block.row + block.rows, model_.texture.height); ++j) {
      for (std::size_t i = block.column; i < std::min<std::size_t>(block.column + block.columns, model_.texture.width);
           ++i) {
        const vec3 bary = index_.texels[t].barycentric({static_cast<double>(i), static_cast<double>(j)});
        if (!(bary.x >= 0.0 && bary.y >= 0.0 && bary.z >= 0.0)) continue;
        const vec3 p = model_.texture.at(i, j);
        if (!is_finite(p)) continue;
        const double x = static_cast<double>(i - block.column) - middle_x;
        const double y = static_cast<double>(j - block.row) - middle_y;
        const double height = glm::dot(index_.normal[t], p - (bary.x * c[0] + bary.y * c[1] + bary.z * c[2]));
        const double score = height - 1e-4 * texel_m * (x * x + y * y);
        if (score > best_score) {
          best_score = score;
          best = p;
        }
      }
    }
    if (best_score > -1e30) to.add(best, index_.normal[t], lean_rad);
  }

  void add_edge(std::uint32_t t, std::size_t k, const std::vector<double>& lean_rad, laid_out& to) const {
    const auto c = corners(model_.mesh, t);
    const double length_m = glm::length(c[(k + 1) % 3] - c[k]);
    const std::uint32_t across = index_.neighbour[t][k];
    const vec3 here = index_.normal[t], there = across == surface_index::none ? here : index_.normal[across];
    const vec3 axis = middle_of(here + there, here);
    const double leans_rad = std::max(lean_rad[t], across == surface_index::none ? 0.0 : lean_rad[across]);
    const double cone_rad = angle(axis, here) + leans_rad;
    const auto places = static_cast<std::size_t>(std::max(1.0, std::ceil(length_m / pitch_m_)));
    // Half a pitch from its ends, where the vertices are, no sample is closer to one of these than on a face: a tip that is
    // pressed into something soft is one plane, whatever the density along its edges.
    const std::size_t last = (places - 1) * edge_density;
    for (std::size_t i = 0; i <= last; ++i) {
      const double f = (static_cast<double>(i) / static_cast<double>(edge_density) + 0.5) / static_cast<double>(places);
      to.add(fine_edge_point(model_, index_, t, k, f), axis, cone_rad);
      if (i % edge_density == edge_density - 1 || i == last) to.end_place();
    }
  }

  [[nodiscard]] static vec3 middle_of(const vec3& sum, const vec3& otherwise) noexcept {
    const double squared = glm::dot(sum, sum);
    return squared > 1e-12 ? sum / std::sqrt(squared) : otherwise;
  }
  [[nodiscard]] static double angle(const vec3& a, const vec3& b) noexcept {
    return std::acos(std::clamp(glm::dot(a, b), -1.0, 1.0));
  }

  // At the mean position that the charts around a vertex give it, facing as all its triangles do.
  void add_vertices(const std::vector<double>& lean_rad, laid_out& to) const {
    const std::size_t vertices = model_.mesh.positions.size();
    std::vector<vec3> place(vertices, vec3(0.0)), axis(vertices, vec3(0.0));
    std::vector<std::uint32_t> corners_at(vertices, 0);
    std::vector<double> cone_rad(vertices, 0.0);
    for (std::uint32_t t = 0; t < model_.mesh.triangles.size(); ++t) {
      const coarse_triangle& tri = model_.mesh.triangles[t];
      for (std::size_t k = 0; k < 3; ++k) {
        axis[tri.vertex[k]] += index_.normal[t];
        const vec3 p = model_.texture.sample(tri.uv[k]);
        if (!is_finite(p)) continue;
        place[tri.vertex[k]] += p;
        ++corners_at[tri.vertex[k]];
      }
    }
    for (std::uint32_t t = 0; t < model_.mesh.triangles.size(); ++t) {
      for (const std::uint32_t v : model_.mesh.triangles[t].vertex) {
        const vec3 middle = middle_of(axis[v], index_.normal[t]);
        cone_rad[v] = std::max(cone_rad[v], angle(middle, index_.normal[t]) + lean_rad[t]);
      }
    }
    for (std::size_t v = 0; v < vertices; ++v) {
      if (corners_at[v] == 0) continue;
      to.add(place[v] / static_cast<double>(corners_at[v]), middle_of(axis[v], {0.0, 0.0, 1.0}), cone_rad[v]);
      to.end_place();
    }
  }

  const textured_model& model_;
  const surface_index& index_;
  double pitch_m_;
};

}  // namespace asperity::detail
