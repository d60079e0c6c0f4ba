// Which of many bodies that stand still may be near: a tree of spheres around them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/core/memory.hpp"
#include "model/body_sphere.hpp"

namespace asperity {

/// Spheres in the world, in a binary tree; every ball of it holds the spheres below it. Immutable once made.
class body_tree {
 public:
  struct sphere {
    std::uint32_t body = 0;
    vec3 centre_w{0.0};
    double radius_m = 0.0;
  };

  body_tree() = default;
  explicit body_tree(std::vector<sphere> spheres) : spheres_(std::move(spheres)) {
    if (spheres_.empty()) return;
    nodes_.reserve(2 * spheres_.size());
    nodes_.push_back({});
    build(0, 0, static_cast<std::uint32_t>(spheres_.size()));
  }

  /// Gives near(body) every sphere that may be within reach_m of a sphere, in no order, but for those of bodies that
  /// is_elsewhere(body): these are left out altogether.
  /// @return of the others, the most that one overlaps it by, m: minus the least gap; -infinity where there is none. The
  /// same to the bit as from a look at each
  /// @rt safe
  template <class Elsewhere, class Near>
  [[nodiscard]] double find(const vec3& centre_w, double radius_m, double reach_m, Elsewhere&& is_elsewhere,
                            Near&& near) const noexcept {
    double most_left_m = -std::numeric_limits<double>::infinity();
    if (nodes_.empty()) return most_left_m;
    std::array<std::uint32_t, most_deep> open;
    std::size_t count = 0;
    open[count++] = 0;
    while (count > 0) {
      const node& n = nodes_[open[--count]];
      // A ball that is out of reach is of interest only while it may hold the nearest of what is out of reach.
      if (!may_be_within(reach_m, centre_w, radius_m, n.centre_w, n.radius_m) &&
          !may_be_within(-most_left_m, centre_w, radius_m, n.centre_w, n.radius_m)) {
        continue;
      }
      if (n.left == 0) {
        for (std::uint32_t i = n.first; i < n.first + n.count; ++i) {
          const sphere& s = spheres_[i];
          if (is_elsewhere(s.body)) continue;
          if (may_be_within(reach_m, centre_w, radius_m, s.centre_w, s.radius_m)) {
            near(s.body);
          } else {
            most_left_m = std::max(most_left_m, radius_m + s.radius_m - glm::distance(centre_w, s.centre_w));
          }
        }
        continue;
      }
      // The nearer half is looked into first, so that what it leaves spares the look into the other.
      const node &l = nodes_[n.left], &r = nodes_[n.left + 1];
      const bool left_first =
          glm::distance(l.centre_w, centre_w) - l.radius_m < glm::distance(r.centre_w, centre_w) - r.radius_m;
      open[count++] = left_first ? n.left + 1 : n.left;
      open[count++] = left_first ? n.left : n.left + 1;
    }
    return most_left_m;
  }

  [[nodiscard]] std::size_t size() const noexcept { return spheres_.size(); }
  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(spheres_, nodes_); }

 private:
  static constexpr std::uint32_t leaf = 4;
  static constexpr std::size_t most_deep = 64;  // halves of 2^32 bodies, two open in each

  struct node {
    vec3 centre_w{0.0};
    double radius_m = 0.0;
    std::uint32_t left = 0;  // the right one follows it; 0: a leaf
    std::uint32_t first = 0, count = 0;
  };

  void build(std::uint32_t at, std::uint32_t first, std::uint32_t count) {
    vec3 low(std::numeric_limits<double>::infinity()), high = -low;
    for (std::uint32_t i = first; i < first + count; ++i) {
      low = glm::min(low, spheres_[i].centre_w - spheres_[i].radius_m);
      high = glm::max(high, spheres_[i].centre_w + spheres_[i].radius_m);
    }
    node n{.centre_w = 0.5 * (low + high), .first = first, .count = count};
    for (std::uint32_t i = first; i < first + count; ++i) {
      n.radius_m = std::max(n.radius_m, glm::distance(n.centre_w, spheres_[i].centre_w) + spheres_[i].radius_m);
    }
    constexpr double rounding = 1.0 + 1e-9;
    n.radius_m *= rounding;
    if (count > leaf) {
      const vec3 wide = high - low;
      const int axis = wide.x >= wide.y ? (wide.x >= wide.z ? 0 : 2) : (wide.y >= wide.z ? 1 : 2);
      const std::uint32_t half = count / 2;
      const auto begin = spheres_.begin() + first;
      std::nth_element(begin, begin + half, begin + count,
                       [&](const sphere& a, const sphere& b) { return a.centre_w[axis] < b.centre_w[axis]; });
      n.left = static_cast<std::uint32_t>(nodes_.size());
      nodes_.push_back({});
      nodes_.push_back({});
      build(n.left, first, half);
      build(n.left + 1, first + half, count - half);
    }
    nodes_[at] = n;
  }

  std::vector<sphere> spheres_;
  std::vector<node> nodes_;
};

}  // namespace asperity
