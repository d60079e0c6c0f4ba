// Static tree of axis-aligned boxes, for pieces and triangles that never move in their body frame.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/core/memory.hpp"
#include "asperity/model/textured_model.hpp"

namespace asperity {

/// True where two boxes share a point, borders included.
/// @rt safe
[[nodiscard]] inline bool overlap(const bounds& a, const bounds& b) noexcept {
  return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y &&
         a.low.z <= b.high.z && b.low.z <= a.high.z;
}

/// The smallest box that holds both.
/// @rt safe
[[nodiscard]] inline bounds merged(const bounds& a, const bounds& b) noexcept {
  return {glm::min(a.low, b.low), glm::max(a.high, b.high)};
}

/// The smallest box around every triangle of a coarse mesh, in its order.
[[nodiscard]] inline std::vector<bounds> triangle_boxes(const coarse_mesh& mesh) {
  std::vector<bounds> boxes;
  boxes.reserve(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto c = corners(mesh, t);
    boxes.push_back({glm::min(c[0], glm::min(c[1], c[2])), glm::max(c[0], glm::max(c[1], c[2]))});
  }
  return boxes;
}

/// Binary tree over boxes, split at the median along the longest side. Built once, never changed.
class aabb_tree {
 public:
  aabb_tree() = default;

  /// @pre boxes.size() < 2^31
  explicit aabb_tree(std::span<const bounds> boxes) {
    if (boxes.empty()) return;
    std::vector<std::uint32_t> order(boxes.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::uint32_t>(i);
    nodes_.reserve(2 * boxes.size() - 1);
    build(boxes, order);
  }

  /// Calls visit(index) for every box that shares a point with `box`, each once, in an order that the tree fixes.
  /// @rt safe: no allocation; visit must not throw
  template <class Visit>
  void query(const bounds& box, Visit&& visit) const noexcept {
    query_where([&](const bounds& b) noexcept { return overlap(b, box); }, visit);
  }

  /// The same for every box that near(box) holds for. @pre what holds for a box holds for every box around it
  /// @rt safe: no allocation; near and visit must not throw
  template <class Near, class Visit>
  void query_where(Near&& near, Visit&& visit) const noexcept {
    if (nodes_.empty()) return;
    // Median splits halve the count, so 2^31 boxes need 32 levels and one waiting sibling at each.
    std::array<std::uint32_t, 64> waiting;
    std::size_t count = 0;
    waiting[count++] = 0;
    while (count > 0) {
      const node& n = nodes_[waiting[--count]];
      if (!near(n.box)) continue;
      if (n.right == 0) {
        visit(n.item);
      } else {
        waiting[count++] = n.right;
        waiting[count++] = static_cast<std::uint32_t>(&n - nodes_.data()) + 1;
      }
    }
  }

  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(nodes_); }

 private:
  // Depth-first layout: the left child follows its parent, `right` is 0 for a leaf.
  struct node {
    bounds box;
    std::uint32_t right = 0;
    std::uint32_t item = 0;
  };

  void build(std::span<const bounds> boxes, std::span<std::uint32_t> items) {
    const std::size_t self = nodes_.size();
    nodes_.push_back({boxes[items[0]], 0, items[0]});
    if (items.size() == 1) return;
    bounds all = boxes[items[0]];
    for (const std::uint32_t i : items) all = merged(all, boxes[i]);
    nodes_[self].box = all;
    const vec3 size = all.high - all.low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
    // Ties by index: the layout must not depend on the standard library's sort.
    std::sort(items.begin(), items.end(), [&](std::uint32_t a, std::uint32_t b) {
      const double ca = boxes[a].low[axis] + boxes[a].high[axis];
      const double cb = boxes[b].low[axis] + boxes[b].high[axis];
      return ca < cb || (ca == cb && a < b);
    });
    const std::size_t half = items.size() / 2;
    build(boxes, items.first(half));
    nodes_[self].right = static_cast<std::uint32_t>(nodes_.size());
    build(boxes, items.subspan(half));
  }

  std::vector<node> nodes_;
};

}  // namespace asperity
