// The collision finder of the shared formulation: lists near cells and nothing else.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>

#include "asperity/cells/cell_scene.hpp"
#include "asperity/collision/concept.hpp"
#include "asperity/collision/near_cells.hpp"
#include "asperity/core/status.hpp"

namespace asperity {

/// Which tiles may touch which cells, by boxes and balls. Keeps nothing between ticks.
///
/// No direction, window or patch comes from here, so nothing that it reports can make the force jump: a cell enters the
/// list long before it has weight.
/// @rt safe   @source the formulation is ours; the paper finds contacts by convex pieces, see convex_piece_finder
class cell_finder {
 public:
  using policy_tag = collision_tag;
  using found_type = near_cells;

  /// @param reach_m      samples farther outside than this are left out
  /// @param facing_none  and faces that meet a cell at a smaller cosine: the depth backend's setting of that name
  cell_finder(std::shared_ptr<const cell_scene> bodies, double reach_m, double facing_none) noexcept
      : bodies_(std::move(bodies)), reach_m_(reach_m), facing_none_(facing_none) {}

  /// @return ok | capacity_reached
  [[nodiscard]] status find(const scene_pose& at, near_cells& out) const noexcept {
    out.clear();
    for (std::size_t b = 0; b < bodies_->fixed.size(); ++b) {
      const auto body = static_cast<std::uint32_t>(b);
      const surface_cells &A = *bodies_->probe, &B = *bodies_->fixed[b];
      const pose T_ba = inverse(at.T_wb[b]) * at.T_wa;
      list_cells(body, false, B, A, inverse(T_ba), out);
      list_cells(body, true, A, B, T_ba, out);
      list_edges(body, A, B, T_ba, out);
    }
    return out.dropped() > 0 ? status::capacity_reached : status::ok;
  }

 private:
  // Cells of Y against tiles of X; T_xy takes Y's frame to X's.
  void list_cells(std::uint32_t body, bool on_probe, const surface_cells& Y, const surface_cells& X, const pose& T_xy,
                  near_cells& out) const noexcept {
    const mat3 R = glm::mat3_cast(T_xy.rotation);
    for (std::uint32_t c = 0; c < Y.cells.size(); ++c) {
      const surface_cell& cell = Y.cells[c];
      if (cell.highest_m < cell.lowest_m) continue;
      // The box over the cell in which a sample has weight.
      const vec3 low(cell.low, cell.lowest_m - cell.depth_limit_m);
      const vec3 high(cell.low + cell.pitch_m * vec2(cell.columns - 1.0, cell.rows - 1.0), cell.highest_m + reach_m_);
      const vec3 half = 0.5 * (high - low), middle = 0.5 * (low + high);
      const mat3 axes = R * mat3(cell.u_b, cell.v_b, cell.n_b);  // in X's frame
      const vec3 centre = T_xy * cell.origin_b + axes * middle;
      // In the cell's axes: a large face at a slant has a far larger box along the axes of X.
      const auto meets = [&](const bounds& box) noexcept {
        const vec3 d = 0.5 * (box.low + box.high) - centre, extent = 0.5 * (box.high - box.low);
        for (int k = 0; k < 3; ++k) {
          if (std::fabs(glm::dot(axes[k], d)) > half[k] + glm::dot(glm::abs(axes[k]), extent)) return false;
        }
        return true;
      };
      bool open = false, full = false;
      X.tile_tree.query_where(meets, [&](std::uint32_t t) noexcept {
        if (full) return;
        const sample_tile& tile = X.tiles[t];
        const vec3 d = tile.centre_b - centre;
        for (int k = 0; k < 3; ++k) {
          if (std::fabs(glm::dot(axes[k], d)) > half[k] + tile.radius_m) return;
        }
        // A face that does not look at the cell has no weight there either.
        const vec3& n = X.origins[tile.origin].normal_b;
        if (glm::dot(n, axes[2]) > -facing_none_ && glm::dot(n, n) > 0.0) return;
        if (!open) {
          open = out.add_cell(body, on_probe, c);
          full = !open;
          if (full) return;
        }
        out.add_tile(t);
      });
    }
    out.close();
  }

  void list_edges(std::uint32_t body, const surface_cells& A, const surface_cells& B, const pose& T_ba,
                  near_cells& out) const noexcept {
    // The fine edges may be nearer than the coarse ones.
    const double reach = std::max(reach_m_, std::min(A.settings.depth_limit_m, B.settings.depth_limit_m)) +
                         A.largest_edge_relief_m + B.largest_edge_relief_m;
    for (std::uint32_t a = 0; a < A.edges.size(); ++a) {
      const sharp_edge& e = A.edges[a];
      const vec3 along = T_ba.rotation * e.along_b, start = T_ba * e.from_b;
      const vec3 from = start - e.extension_m[0] * along, to = start + (e.length_m + e.extension_m[1]) * along;
      B.edge_tree.query({glm::min(from, to) - reach, glm::max(from, to) + reach}, [&](std::uint32_t b) noexcept {
        if (cross(e, along, start, B.edges[b], reach)) out.add_edges({body, a, b});
      });
    }
  }

  // Whether two edges pass each other within their lengths and within reach: no other pair has weight, and boxes alone
  // bring a thousand of them where two bodies of many short edges meet.
  [[nodiscard]] static bool cross(const sharp_edge& a, const vec3& along, const vec3& start, const sharp_edge& b,
                                  double reach) noexcept {
    const vec3 normal = glm::cross(along, b.along_b), offset = start - b.from_b;
    const double squared = glm::dot(normal, normal);
    if (!(squared > 1e-9)) return false;
    const double distance = glm::dot(normal, offset);
    if (distance * distance > reach * reach * squared) return false;
    const double cosine = glm::dot(along, b.along_b), on_a = glm::dot(offset, along),
                 on_b = glm::dot(offset, b.along_b);
    const double at_a = (cosine * on_b - on_a) / squared, at_b = (on_b - cosine * on_a) / squared;
    return at_a >= -a.extension_m[0] && at_a <= a.length_m + a.extension_m[1] && at_b >= -b.extension_m[0] &&
           at_b <= b.length_m + b.extension_m[1];
  }

  std::shared_ptr<const cell_scene> bodies_;
  double reach_m_, facing_none_;
};

static_assert(collision_finder<cell_finder>);

}  // namespace asperity
