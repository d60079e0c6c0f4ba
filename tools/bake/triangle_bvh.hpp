// Closest points and line crossings on a triangle mesh.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include "asperity/core/math.hpp"
#include "bake/halfedges.hpp"
#include "bake/stage_monitor.hpp"

namespace asperity::bake {

/// Point of the triangle nearest to p.
[[nodiscard]] vec3 closest_on_triangle(const vec3& p, const std::array<vec3, 3>& c) noexcept;

/// Tree of boxes over the triangles of a mesh. Looks at the mesh's positions, not at its triangles: 32 to 48 bytes a
/// triangle of its own.
class triangle_bvh {
 public:
  /// Room that a walk through the tree needs: it is balanced, its depth is the logarithm of the triangle count.
  static constexpr std::size_t deepest = 64;

  struct nearest {
    vec3 point{0.0};
    double distance_m = std::numeric_limits<double>::infinity();
    std::uint32_t triangle = no_halfedge;  ///< no_halfedge where nothing is within reach
  };

  /// Children of an inner node (count 0): the next node in memory, and `right_or_first`. A leaf holds triangles
  /// [right_or_first, right_or_first + count) in leaf order. A child has a higher number than its parent.
  struct node {
    std::array<float, 3> low;
    std::array<float, 3> high;
    std::uint32_t right_or_first;
    std::uint32_t count;
  };

  struct crossing {
    vec3 point{0.0};
    double offset_m = 0.0;  ///< signed, along the direction
    std::uint32_t triangle = 0;
  };

  /// The same tree with any number of threads. Building takes 16 bytes a triangle more.
  /// @pre all indices in range, all coordinates finite, at least one triangle; the positions outlive the tree and stay
  /// @param monitor asked on the way; a tree whose making is cancelled must not be looked into
  triangle_bvh(std::span<const vec3> positions, std::span<const index_triangle> triangles, unsigned threads = 1,
               stage_monitor* monitor = nullptr);

  /// The point of the surface nearest to p, no farther than `within`.
  [[nodiscard]] nearest closest(const vec3& p, double within = std::numeric_limits<double>::infinity()) const noexcept;

  /// Is a point within `within` of p on a triangle whose outward side faces along n, by less than a right angle?
  [[nodiscard]] bool has_facing(const vec3& p, const vec3& n, double within) const noexcept;

  /// The crossing of the line p + s d, |s| <= range, that is nearest to p among the triangles whose outward side
  /// faces along d. Edges and corners count, so a line cannot slip through between two triangles. @pre |d| = 1
  [[nodiscard]] std::optional<crossing> nearest_front_crossing(const vec3& p, const vec3& d,
                                                               double range) const noexcept;

  /// Calls visit(triangle), or visit(triangle, corners), for the triangles that meet the box, and for some beside it.
  template <class Visit>
  void visit_box(const vec3& low, const vec3& high, const Visit& visit) const {
    std::array<std::uint32_t, deepest> stack;
    std::size_t depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
      const std::uint32_t at = stack[--depth];
      const node& n = nodes_[at];
      bool apart = false;
      for (int k = 0; k < 3; ++k) {
        const auto axis = static_cast<std::size_t>(k);
        apart = apart || static_cast<double>(n.low[axis]) > high[k] || static_cast<double>(n.high[axis]) < low[k];
      }
      if (apart) continue;
      if (n.count == 0) {
        stack[depth++] = n.right_or_first;
        stack[depth++] = at + 1;
        continue;
      }
      for (std::uint32_t i = n.right_or_first; i < n.right_or_first + n.count; ++i) {
        if constexpr (std::is_invocable_v<const Visit&, std::uint32_t, const std::array<vec3, 3>&>) {
          visit(triangle_[i], corners_at(i));
        } else {
          visit(triangle_[i]);
        }
      }
    }
  }

  /// The tree itself, for whoever keeps something of his own at its nodes.
  [[nodiscard]] std::span<const node> nodes() const noexcept { return nodes_; }
  [[nodiscard]] std::size_t size() const noexcept { return triangle_.size(); }
  /// Corners and number of the i-th triangle in leaf order.
  [[nodiscard]] std::array<vec3, 3> corners_at(std::size_t i) const noexcept {
    const index_triangle& v = corners_[i];
    return {positions_[v[0]], positions_[v[1]], positions_[v[2]]};
  }
  [[nodiscard]] std::uint32_t triangle_at(std::size_t i) const noexcept { return triangle_[i]; }

 private:
  struct item;
  struct making;

  void build(making& all, std::span<item> items, std::size_t first, std::size_t index, unsigned threads,
             bool on_calling_thread);
  void make_leaf(std::span<const index_triangle> triangles, std::span<const item> items, std::size_t first, node& out);
  std::span<const vec3> positions_;
  std::vector<node> nodes_;
  std::vector<index_triangle> corners_;  // in leaf order
  std::vector<std::uint32_t> triangle_;  // leaf order to the caller's order
};

}  // namespace asperity::bake
