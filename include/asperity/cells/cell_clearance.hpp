// How far a point of a relief map is from where the cell ends.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "asperity/cells/cell_grid.hpp"
#include "asperity/cells/cell_outline.hpp"

namespace asperity::detail {

/// Fills the clearance of every node.
///
/// A cell ends at its sharp convex edges, and there the clearance is a line integral that keeps the edges straight. It
/// also ends where its aprons do; nothing happens there that could be felt, so a distance on the grid, smoothed, will
/// do. Both are made one by adding their inverse fourth powers. No step is steeper than `slope`: whatever a strange
/// coarse mesh does to the labels below, what a sample feels is a fade and not a jump.
class clearance_field {
 public:
  clearance_field(const cell_grid& grid, const cell_outline& outline, const cell_settings& settings)
      : grid_(grid),
        outline_(outline),
        settings_(settings),
        label_(grid.size(), label::apron_end),
        to_convex_(grid.size()) {
    for (const outline_segment& e : outline.rim) {
      if (e.kind == edge_kind::convex) convex_.push_back({e, glm::length(e.b - e.a)});
    }
  }

  /// @param own     nodes under the region's own triangles
  /// @param shown   nodes under any triangle of the outline
  [[nodiscard]] std::vector<float> make(const std::vector<char>& own, const std::vector<char>& shown) {
    label_nodes(own, shown);
    std::vector<char> beyond(grid_.size());
    for (std::size_t i = 0; i < beyond.size(); ++i) beyond[i] = label_[i] == label::apron_end ? 1 : 0;
    const double cap = 2.0 * settings_.depth_limit_m;
    std::vector<float> out = grid_.distance_to(beyond, cap);
    grid_.blur(out, 2);
    for (std::size_t i = 0; i < out.size(); ++i) {
      // The blur gives nodes beyond the end a little more than nothing: two nodes' width takes it back.
      const double to_apron_end = out[i] - 2.0 * grid_.cell->pitch_m;
      out[i] = static_cast<float>(clearance(i, to_apron_end, cap));
    }
    grid_.limit_slope(out, 1.2, +1.0F);
    return out;
  }

 private:
  enum class label : char {
    inside,
    beyond_edge,  ///< over a sharp convex edge: air
    apron_end,    ///< where the surface goes on but another cell has it
  };

  struct convex_segment {
    outline_segment segment;
    double length;
  };
  struct nearest {
    double convex, concave, smooth;
  };
  [[nodiscard]] nearest nearest_rim(const vec2& p) const noexcept {
    nearest squared{1e18, 1e18, 1e18};
    for (const outline_segment& e : outline_.rim) {
      double& d = e.kind == edge_kind::convex    ? squared.convex
                  : e.kind == edge_kind::concave ? squared.concave
                                                 : squared.smooth;
      d = std::min(d, e.distance_squared(p));
    }
    return {std::sqrt(squared.convex), std::sqrt(squared.concave), std::sqrt(squared.smooth)};
  }

  void label_nodes(const std::vector<char>& own, const std::vector<char>& shown) {
    const std::vector<float> to_own = grid_.distance_to(own, 1e9);
    for (std::size_t i = 0; i < label_.size(); ++i) {
      const bool near = to_own[i] <= settings_.apron_m;
      if (shown[i] != 0) {
        if (near) label_[i] = label::inside;
      } else {
        const nearest d = nearest_rim(grid_.position(i));
        const double slack = 0.05 * grid_.cell->pitch_m;  // a tie at a vertex goes to the edge that can be felt
        if (d.convex <= std::min(d.concave, d.smooth) + slack) {
          label_[i] = label::beyond_edge;
          to_convex_[i] = d.convex;
        } else if (d.concave <= d.smooth + slack && near) {
          label_[i] = label::inside;  // inside the neighbouring wall, where the feet of deep samples lie
        }
      }
    }
  }

  [[nodiscard]] double clearance(std::size_t i, double to_apron_end, double cap) const noexcept {
    if (label_[i] == label::beyond_edge) return -std::min(cap, to_convex_[i]);
    if (label_[i] == label::apron_end || to_apron_end <= 0.0) return std::min(to_apron_end, 0.0);
    const vec2 p = grid_.position(i);
    double sum = 0.0;
    for (const convex_segment& e : convex_) sum += e.segment.inverse_distance_4(p, e.length);
    if (to_apron_end < cap) {
      const double a2 = to_apron_end * to_apron_end;
      sum += 1.0 / (a2 * a2);
    }
    return sum > 0.0 ? std::min(cap, 1.0 / std::sqrt(std::sqrt(sum))) : cap;
  }

  const cell_grid& grid_;
  const cell_outline& outline_;
  const cell_settings& settings_;
  std::vector<label> label_;
  std::vector<convex_segment> convex_;
  std::vector<double> to_convex_;  ///< of nodes beyond an edge: distance to the nearest convex one, m
};

}  // namespace asperity::detail
