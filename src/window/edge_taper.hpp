// Weights that let samples fade in from the edges of a patch, so that the sum over samples is smooth while the patch
// moves through the fixed grid.
//
// An edge counts where the triangle beyond it is missing from the patch or turned away from n. Its strength changes
// smoothly with the angle, so the taper at an edge vanishes gradually as the face beyond it comes into view.
// The taper is a weight of the soft maximum, and moves with its body: its gradient belongs to the potential's gradient.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "asperity/core/memory.hpp"
#include "asperity/core/spatial.hpp"
#include "model/surface_index.hpp"
#include "window/height_field.hpp"

namespace asperity::detail {

/// Weight of a triangle by its facing cosine: 0 at the threshold, 1 from twice the threshold on.
struct facing_weight {
  double threshold;
  [[nodiscard]] double value(double cosine) const noexcept { return smoothstep((cosine - threshold) / threshold); }
  [[nodiscard]] double slope(double cosine) const noexcept {
    return smoothstep_slope((cosine - threshold) / threshold) / threshold;
  }
};

/// An edge of the facing patch at which samples fade out.
struct taper_edge {
  vec3 from, to;       ///< window coordinates, m
  double strength;     ///< 1 at a silhouette, 0 where the surface goes on
  vec3 strength_turn;  ///< d strength / d rotation of the body, window axes, 1/rad
};

/// Taper of one body over the window.
class edge_taper {
 public:
  explicit edge_taper(std::size_t max_triangles) { detail::reserve_resident(edges_, 3 * max_triangles); }
  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(edges_); }

  /// Collects the edges of a projected patch that come within `width_m` of the window. @rt safe
  void prepare(const patch_projection& patch, const surface_index& index, const window_map& map, layer which,
               const sample_grid& grid, double width_m, double facing_cosine) noexcept {
    edges_.clear();
    width_m_ = width_m;
    facing_ = {facing_cosine};
    const double reach = grid.half_m + width_m;
    for (const projected_triangle& t : patch.triangles()) {
      const double self = facing_.value(t.facing);
      for (std::size_t k = 0; k < 3; ++k) {
        const projected_triangle* beyond = patch.find(index.neighbour[t.triangle][k]);
        const double other = beyond == nullptr ? 0.0 : facing_.value(beyond->facing);
        if (self * (1.0 - other) <= 0.0) continue;
        taper_edge e{t.corner[k], t.corner[(k + 1) % 3], self * (1.0 - other), {}};
        if (std::min(e.from.x, e.to.x) > reach || std::max(e.from.x, e.to.x) < -reach ||
            std::min(e.from.y, e.to.y) > reach || std::max(e.from.y, e.to.y) < -reach) {
          continue;
        }
        e.strength_turn = (1.0 - other) * facing_turn(t, index, map, which);
        if (beyond != nullptr) e.strength_turn += -self * facing_turn(*beyond, index, map, which);
        edges_.push_back(e);
      }
    }
  }

  /// Multiplies the taper into the weights of the grid's samples. @rt safe
  void apply(const patch_projection& patch, const sample_grid& grid, const height_field& field,
             std::vector<double>& weight) const noexcept {
    for (std::size_t i = 0; i < grid.size(); ++i) {
      if (field.kind[i] != hit::none) weight[i] *= facing_.value(patch.triangles()[field.owner[i]].facing);
    }
    for (const taper_edge& e : edges_) {
      const std::size_t first_column = grid.first_at(std::min(e.from.x, e.to.x) - width_m_);
      const std::size_t end_column = grid.end_at(std::max(e.from.x, e.to.x) + width_m_);
      const std::size_t end_row = grid.end_at(std::max(e.from.y, e.to.y) + width_m_);
      for (std::size_t row = grid.first_at(std::min(e.from.y, e.to.y) - width_m_); row < end_row; ++row) {
        for (std::size_t column = first_column; column < end_column; ++column) {
          weight[grid.index(column, row)] *= at(e, {grid.coordinate(column), grid.coordinate(row)}).value;
        }
      }
    }
  }

  /// Gradient of the logarithm of the taper at a world-fixed sample by a motion of the body, in window axes; arms from
  /// `centre` (window coordinates). @pre the taper is not zero at the sample   @rt safe
  [[nodiscard]] vec6 log_gradient(const projected_triangle& owner, const surface_index& index, const window_map& map,
                                  layer which, const vec2& uv, const vec3& centre) const noexcept {
    vec6 out;
    out.angular += 1.0 / facing_.value(owner.facing) * facing_turn(owner, index, map, which);
    for (const taper_edge& e : edges_) {
      const fade f = at(e, uv);
      if (f.value >= 1.0) continue;
      const vec3 slope(f.per_distance * f.away, 0.0);
      // The nearest point of the edge moves with the body; the sample stays.
      out.linear -= 1.0 / f.value * slope;
      out.angular -= 1.0 / f.value * (glm::cross(f.nearest - centre, slope) + (1.0 - f.shape) * e.strength_turn);
    }
    return out;
  }

  /// The edges that prepare() collected.
  [[nodiscard]] std::span<const taper_edge> edges() const noexcept { return edges_; }

  /// d facing_weight / d rotation of the body, window axes.
  [[nodiscard]] vec3 facing_turn(const projected_triangle& t, const surface_index& index, const window_map& map,
                                 layer which) const noexcept {
    const double slope = facing_.slope(t.facing);
    if (slope == 0.0) return vec3(0.0);
    const vec3 normal = map.direction(index.normal[t.triangle]);
    return slope * sign(which) * glm::cross(normal, vec3(0.0, 0.0, 1.0));  // d(N . n) = (phi x N) . n = phi . (N x n)
  }

 private:
  struct fade {
    double value = 1.0;         ///< 1 - strength (1 - shape)
    double shape = 1.0;         ///< smoothstep of the distance
    double per_distance = 0.0;  ///< d value / d distance, 1/m
    vec2 away{0.0};             ///< unit, from the edge to the sample
    vec3 nearest{0.0};          ///< nearest point of the edge, window coordinates
  };

  [[nodiscard]] fade at(const taper_edge& e, const vec2& uv) const noexcept {
    const vec3 along = e.to - e.from;
    const vec2 to_sample = uv - vec2(e.from);
    const double length2 = along.x * along.x + along.y * along.y;
    const double t =
        length2 > 0.0 ? std::clamp((to_sample.x * along.x + to_sample.y * along.y) / length2, 0.0, 1.0) : 0.0;
    fade f;
    f.nearest = e.from + t * along;
    const vec2 d = uv - vec2(f.nearest);
    const double distance2 = d.x * d.x + d.y * d.y;
    if (distance2 >= width_m_ * width_m_) return f;
    const double distance = std::sqrt(distance2);
    f.shape = smoothstep(distance / width_m_);
    f.value = 1.0 - e.strength * (1.0 - f.shape);
    f.per_distance = e.strength * smoothstep_slope(distance / width_m_) / width_m_;
    if (distance > 0.0) f.away = d / distance;
    return f;
  }

  std::vector<taper_edge> edges_;
  double width_m_ = 0.0;
  facing_weight facing_{0.1};
};

}  // namespace asperity::detail
