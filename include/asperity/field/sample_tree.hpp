// Samples of a body in a tree of balls.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <utility>
#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/core/memory.hpp"

namespace asperity {

/// A point of a body's fine surface, and the directions that the coarse surface looks to there: one on a face, a fan on
/// an edge, a cone on a vertex. Body frame.
struct field_sample {
  glm::vec3 position_b{0.0F};
  glm::vec3 axis_b{0.0F, 0.0F, 1.0F};  ///< unit, outwards: the middle of the cone
  float cone_rad = 0.0F;               ///< half its opening: 0 on a face
};

/// Samples of one body in a binary tree of balls. A ball keeps its size however the body is turned, so a field of
/// another body can bound what a whole branch holds by one reading. Built once, never changed.
class sample_tree {
 public:
  /// Most samples of a leaf.
  static constexpr std::size_t leaf_samples = 8;

  sample_tree() = default;

  /// @param samples  positions finite   @pre fewer than 2^31
  explicit sample_tree(std::vector<field_sample> samples) : samples_(std::move(samples)) {
    if (samples_.empty()) return;
    balls_.reserve(2 * samples_.size() / (leaf_samples / 2) + 1);
    build(0, samples_.size());
    balls_.shrink_to_fit();
  }

  [[nodiscard]] std::span<const field_sample> samples() const noexcept { return samples_; }

  /// Calls visit(leaf) with the samples of every leaf whose ball, and all balls around it, may(centre_b, radius_m)
  /// holds for. The order is the tree's own.
  /// @rt safe: no allocation; may and visit must not throw
  template <class May, class Visit>
  void query(May&& may, Visit&& visit) const noexcept {
    if (balls_.empty()) return;
    // Median splits halve the count, so 2^31 points need 32 levels and one waiting sibling at each.
    std::array<std::uint32_t, 64> waiting;
    std::size_t count = 0;
    waiting[count++] = 0;
    while (count > 0) {
      const std::uint32_t i = waiting[--count];
      const ball& b = balls_[i];
      if (!may(vec3(b.centre_b), static_cast<double>(b.radius_m))) continue;
      if (b.right == 0) {
        visit(vec3(b.centre_b), static_cast<double>(b.radius_m),
              std::span<const field_sample>(samples_).subspan(b.first, b.count));
      } else {
        waiting[count++] = b.right;
        waiting[count++] = i + 1;
      }
    }
  }

  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(samples_, balls_); }

 private:
  // Depth-first layout: the left child follows its parent, `right` is 0 for a leaf.
  struct ball {
    glm::vec3 centre_b{0.0F};
    float radius_m = 0.0F;
    std::uint32_t right = 0, first = 0, count = 0;
  };

  void build(std::size_t first, std::size_t count) {
    const std::span<field_sample> part = std::span(samples_).subspan(first, count);
    glm::vec3 low = part[0].position_b, high = low;
    for (const field_sample& s : part) {
      low = glm::min(low, s.position_b);
      high = glm::max(high, s.position_b);
    }
    const std::size_t self = balls_.size();
    ball b{0.5F * (low + high), 0.0F, 0, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count)};
    double far = 0.0;
    for (const field_sample& s : part) far = std::max(far, glm::length(vec3(s.position_b) - vec3(b.centre_b)));
    b.radius_m = std::nextafter(static_cast<float>(far), 1e30F);  // rounding down would leave a sample outside
    balls_.push_back(b);
    if (count <= leaf_samples) return;
    const glm::vec3 size = high - low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
    // Ties by the other axes: the layout must not depend on the standard library's sort.
    std::sort(part.begin(), part.end(), [axis](const field_sample& a, const field_sample& c) {
      const glm::vec3 &p = a.position_b, &q = c.position_b;
      for (int i = 0; i < 3; ++i) {
        const int x = (axis + i) % 3;
        if (p[x] != q[x]) return p[x] < q[x];
      }
      return false;
    });
    const std::size_t half = count / 2;
    build(first, half);
    balls_[self].right = static_cast<std::uint32_t>(balls_.size());
    build(first + half, count - half);
  }

  std::vector<field_sample> samples_;
  std::vector<ball> balls_;
};

}  // namespace asperity
