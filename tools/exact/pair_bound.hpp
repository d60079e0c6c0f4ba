// How deep two pieces of surface can be in each other at most.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include "exact/window_piece.hpp"

namespace asperity::detail {

/// A convex polygon across the window, cut smaller and smaller. Memory for what two pieces can ask of it.
class window_polygon {
 public:
  /// A rectangle. @pre low <= high
  window_polygon(const vec2& low, const vec2& high) noexcept
      : corner_{low, vec2(high.x, low.y), high, vec2(low.x, high.y)}, count_(4) {}

  /// Keeps what lies on the inner side. A convex polygon gains one corner at most.
  void cut(const half_plane& side) noexcept {
    std::array<vec2, capacity> kept{};
    std::size_t n = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const vec2 &p = corner_[i], &q = corner_[(i + 1) % count_];
      const double at_p = side.at(p), at_q = side.at(q);
      if (at_p >= 0.0 && n < capacity) kept[n++] = p;
      if ((at_p < 0.0) != (at_q < 0.0) && n < capacity) kept[n++] = p + at_p / (at_p - at_q) * (q - p);
    }
    corner_ = kept;
    count_ = n;
  }

  [[nodiscard]] std::span<const vec2> corners() const noexcept { return std::span(corner_).first(count_); }
  [[nodiscard]] vec2 middle() const noexcept {
    vec2 sum(0.0);
    for (const vec2& p : corners()) sum += p;
    return sum / static_cast<double>(count_);
  }

 private:
  static constexpr std::size_t capacity = 4 + 2 * window_piece::most_sides;
  std::array<vec2, capacity> corner_{};
  std::size_t count_ = 0;
};

/// Bound of h_A - h_B over the lines of the window that two pieces share.
struct pair_bound {
  bool shared = false;  ///< false: no line crosses both
  double upper_m = 0.0;
  vec2 best{0.0};    ///< where the bound is reached
  vec2 middle{0.0};  ///< of all that may be shared
};

/// @rt safe
[[nodiscard]] inline pair_bound bound_pair(const window_piece& a, const window_piece& b, double half_m) noexcept {
  const vec2 low = glm::max(glm::max(vec2(a.low), vec2(b.low)), vec2(-half_m));
  const vec2 high = glm::min(glm::min(vec2(a.high), vec2(b.high)), vec2(half_m));
  pair_bound out;
  if (!(low.x <= high.x && low.y <= high.y)) return out;
  window_polygon polygon(low, high);
  for (const window_piece* piece : {&a, &b}) {
    for (std::uint32_t i = 0; i < piece->sides; ++i) {
      polygon.cut(piece->side[i]);
      if (polygon.corners().empty()) return out;
    }
  }
  // The planes' difference is largest at a corner.
  double most = 0.0;
  for (const vec2& p : polygon.corners()) {
    const double above_a = a.is_graph ? a.plane(p) + a.above_plane : a.high.z;
    const double below_b = b.is_graph ? b.plane(p) - b.above_plane : b.low.z;
    if (out.shared && above_a - below_b <= most) continue;
    most = above_a - below_b;
    out.best = p;
    out.shared = true;
  }
  out.upper_m = std::min(most, a.high.z - b.low.z);
  out.middle = polygon.middle();
  return out;
}

}  // namespace asperity::detail
