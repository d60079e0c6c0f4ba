// Which slopes a depth field has near a point, as they were measured.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/core/memory.hpp"
#include "asperity/field/coarse_grid.hpp"

namespace asperity::detail {

class field_parts;

/// A box around the slopes at the points of each block of two cells a side of a grid. Measured, not proved: a slope that
/// no point had is not in it. Made once, beside the field; never changed.
class slope_boxes {
 public:
  /// Lowest and highest slopes by component.
  struct box {
    glm::vec3 low{std::numeric_limits<float>::infinity()}, high{-std::numeric_limits<float>::infinity()};

    /// Whether it holds any.
    [[nodiscard]] bool known() const noexcept { return low.x <= high.x; }
    friend bool operator==(const box&, const box&) = default;
  };

  slope_boxes() = default;

  /// Allocates six numbers per eight nodes.
  explicit slope_boxes(const coarse_grid& of)
      : low_(of.low),
        block_m_(2.0 * of.pitch_m),
        along_{of.nodes[0] / 2 + 1, of.nodes[1] / 2 + 1, of.nodes[2] / 2 + 1} {
    blocks_.resize(along_[0] * along_[1] * along_[2]);
  }

  /// Adds what was measured at a point; one outside the grid is left out.
  void add(const vec3& p_b, const vec3& slope) noexcept {
    std::array<std::size_t, 3> at{};
    for (std::size_t k = 0; k < 3; ++k) {
      const double g = (p_b[static_cast<int>(k)] - low_[static_cast<int>(k)]) / block_m_;
      if (!(g >= 0.0 && g < static_cast<double>(along_[k]))) return;
      at[k] = static_cast<std::size_t>(g);
    }
    box& in = blocks_[place(at[0], at[1], at[2])];
    in.low = glm::min(in.low, glm::vec3(slope));
    in.high = glm::max(in.high, glm::vec3(slope));
  }

  [[nodiscard]] std::size_t blocks() const noexcept { return blocks_.size(); }
  /// A place in a block.
  /// @param share 0 to 1 along each axis
  [[nodiscard]] vec3 place_in(std::size_t block, const vec3& share) const noexcept {
    const std::size_t row = block / along_[0];
    const std::size_t sheet = row / along_[1];
    const vec3 first(static_cast<double>(block % along_[0]), static_cast<double>(row % along_[1]),
                     static_cast<double>(sheet));
    return low_ + block_m_ * (first + share);
  }

  /// Adds what was measured at other points of the same grid.
  void add(const slope_boxes& others) noexcept {
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      blocks_[i].low = glm::min(blocks_[i].low, others.blocks_[i].low);
      blocks_[i].high = glm::max(blocks_[i].high, others.blocks_[i].high);
    }
  }

  /// Holds all slopes within radius_m of a point. Not known where a block has none, and for radii of more than two cells.
  /// @rt safe: 27 boxes at most
  [[nodiscard]] box around(const vec3& p_b, double radius_m) const noexcept {
    if (!(radius_m <= block_m_)) return {};
    std::array<std::size_t, 3> first{}, last{};
    for (std::size_t k = 0; k < 3; ++k) {
      const double g = (p_b[static_cast<int>(k)] - low_[static_cast<int>(k)]) / block_m_, r = radius_m / block_m_;
      const double end = static_cast<double>(along_[k]);
      if (!(g - r >= 0.0 && g + r < end)) return {};
      first[k] = static_cast<std::size_t>(g - r);
      last[k] = static_cast<std::size_t>(g + r);
    }
    box all;
    for (std::size_t z = first[2]; z <= last[2]; ++z) {
      for (std::size_t y = first[1]; y <= last[1]; ++y) {
        for (std::size_t x = first[0]; x <= last[0]; ++x) {
          const box& in = blocks_[place(x, y, z)];
          if (!in.known()) return {};
          all.low = glm::min(all.low, in.low);
          all.high = glm::max(all.high, in.high);
        }
      }
    }
    return all;
  }

  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(blocks_); }

  friend bool operator==(const slope_boxes&, const slope_boxes&) = default;

 private:
  friend class field_parts;  // reads and writes boxes

  [[nodiscard]] std::size_t place(std::size_t x, std::size_t y, std::size_t z) const noexcept {
    return (z * along_[1] + y) * along_[0] + x;
  }

  vec3 low_{0.0};
  double block_m_ = 1.0;
  std::array<std::size_t, 3> along_{};
  std::vector<box> blocks_;
};

}  // namespace asperity::detail
