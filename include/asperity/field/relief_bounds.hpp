// Upper bounds of the relief of a depth field in a ball.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/core/memory.hpp"
#include "asperity/field/relief_bricks.hpp"

namespace asperity::detail {

/// The largest coefficients of a body's relief, by brick and by blocks of 2, 4, 8, ... bricks a side. A spline lies
/// below the largest of its coefficients. Made once, beside the field; never changed.
class relief_bounds {
 public:
  relief_bounds() = default;

  /// Allocates a number per place of a brick, and a seventh more.
  explicit relief_bounds(const relief_bricks& of) : low_(of.low), pitch_m_(of.pitch_m) {
    if (of.index.empty()) return;
    level first{of.bricks_along, std::vector<float>(of.index.size(), 0.0F)};
    for (std::size_t i = 0; i < of.index.size(); ++i) {
      if (of.index[i] == 0) continue;  // zeros, at nearly all places
      for (const float c : of.bricks[of.index[i]]) first.most[i] = std::max(first.most[i], c);
    }
    levels_.push_back(std::move(first));
    while (levels_.back().most.size() > 1) levels_.push_back(halved(levels_.back()));
  }

  /// Upper bound of the relief at feet within radius_m of a place, at least 0, m. @rt safe: at most 27 numbers
  [[nodiscard]] double most_m(const vec3& foot_b, double radius_m) const noexcept {
    if (levels_.empty()) return 0.0;
    // The spline reads three nodes along each axis, up to a node and a half from its place.
    const double reach = radius_m / pitch_m_ + 1.5;
    double size = relief_bricks::side;  // of a block of the level, in nodes
    std::size_t l = 0;
    for (; l + 1 < levels_.size() && size < reach; ++l) size *= 2.0;
    const level& at = levels_[l];
    std::array<std::size_t, 3> first{}, last{};
    for (std::size_t k = 0; k < 3; ++k) {
      const double g = (foot_b[static_cast<int>(k)] - low_[static_cast<int>(k)]) / pitch_m_;
      const double end = static_cast<double>(at.along[k]);
      const double from = (g - reach) / size, to = (g + reach) / size;
      if (!(to >= 0.0 && from < end)) return 0.0;
      first[k] = static_cast<std::size_t>(std::max(0.0, from));
      last[k] = static_cast<std::size_t>(std::min(to, end - 1.0));
    }
    float most = 0.0F;
    for (std::size_t z = first[2]; z <= last[2]; ++z) {
      for (std::size_t y = first[1]; y <= last[1]; ++y) {
        for (std::size_t x = first[0]; x <= last[0]; ++x) most = std::max(most, at.most[at.place(x, y, z)]);
      }
    }
    return static_cast<double>(most);
  }

  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(levels_); }

  friend bool operator==(const relief_bounds&, const relief_bounds&) = default;

 private:
  struct level {
    std::array<std::size_t, 3> along{};
    std::vector<float> most;

    [[nodiscard]] std::size_t place(std::size_t x, std::size_t y, std::size_t z) const noexcept {
      return (z * along[1] + y) * along[0] + x;
    }
    [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(most); }
    friend bool operator==(const level&, const level&) = default;
  };

  [[nodiscard]] static level halved(const level& of) {
    level to;
    for (std::size_t k = 0; k < 3; ++k) to.along[k] = (of.along[k] + 1) / 2;
    to.most.assign(to.along[0] * to.along[1] * to.along[2], 0.0F);
    for (std::size_t z = 0; z < of.along[2]; ++z) {
      for (std::size_t y = 0; y < of.along[1]; ++y) {
        for (std::size_t x = 0; x < of.along[0]; ++x) {
          float& block = to.most[to.place(x / 2, y / 2, z / 2)];
          block = std::max(block, of.most[of.place(x, y, z)]);
        }
      }
    }
    return to;
  }

  vec3 low_{0.0};
  double pitch_m_ = 1.0;
  std::vector<level> levels_;
};

}  // namespace asperity::detail
