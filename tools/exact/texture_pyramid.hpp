// Where the textured surface can be between many texels at once: a pyramid of leaning boxes over the texture.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "asperity/model/haptic_texture.hpp"

namespace asperity::detail {

/// A square of the texture. At level L >= 0 it is 2^L cells wide, a cell being the square between four texel centres;
/// at level -L it is one of the 4^L parts of a cell. Cell (0, 0) ends at texel (0, 0): the first and the last row and
/// column of cells lie beyond the image, where its border is repeated.
struct texture_place {
  std::int8_t level = 0;
  std::int32_t x = 0, y = 0;

  [[nodiscard]] double half() const noexcept { return std::ldexp(0.5, level); }  ///< half its width, texels
  [[nodiscard]] vec2 middle() const noexcept {                                   ///< texels
    const double width = std::ldexp(1.0, level);
    return {(x + 0.5) * width - 1.0, (y + 0.5) * width - 1.0};
  }
  /// One of the four squares of the next finer level. @pre i < 4
  [[nodiscard]] texture_place child(std::uint32_t i) const noexcept {
    return {static_cast<std::int8_t>(level - 1), 2 * x + static_cast<std::int32_t>(i & 1U),
            2 * y + static_cast<std::int32_t>(i >> 1U)};
  }
};

/// The surface over a place: with w the way from the place's middle, in texels, each of its points is
/// centre + along_x w.x + along_y w.y + an error. Body frame, metres.
struct texture_block {
  vec3 centre{0.0};
  vec3 along_x{0.0}, along_y{0.0};  ///< per texel
  /// Down to a level of 1: component i of the error is at most spare[i]. Below: the error is spare times a number of at
  /// most 1.
  vec3 spare{0.0};
  bool empty = true;      ///< no surface: all texels are NaN, or one of a single cell's is
  bool one_cell = false;  ///< a cell, or a part of one
};

/// Box around what texels deviate from a block's lean.
struct rest_box {
  vec3 low{0.0}, high{0.0};
  bool empty = true;

  void add(const vec3& rest) noexcept {
    low = empty ? rest : glm::min(low, rest);
    high = empty ? rest : glm::max(high, rest);
    empty = false;
  }
  void close(texture_block& block) const noexcept {
    block.centre = 0.5 * (low + high);
    block.spare = 0.5 * (high - low);
    block.empty = empty;
  }
};

/// Smallest and largest texel positions over blocks of cells, measured from a plane patch that leans as the block does:
/// a box along the axes would be as thick as a slope makes it, and the bound of a tilted face useless.
/// Bilinear interpolation of what texels deviate from an affine function stays between their extremes, so a box that
/// holds all texels of a block holds all that lies between them. NaN texels are left out.
class texture_pyramid {
 public:
  /// Finer blocks are read from the texels themselves; this level and coarser ones are stored.
  static constexpr int first_stored = 2;

  /// Not for a tick. @pre texture.texels.size() == width * height > 0; it outlives this
  explicit texture_pyramid(const haptic_texture& texture) : texture_(&texture) {
    const std::uint32_t cells = std::max(texture.width, texture.height) + 1;
    for (int level = first_stored; level == first_stored || (cells - 1) >> (level - 1) > 0; ++level) {
      stored_level s;
      s.width = (texture.width >> level) + 1;
      s.height = (texture.height >> level) + 1;
      s.blocks.reserve(std::size_t{s.width} * s.height);
      for (std::uint32_t y = 0; y < s.height; ++y) {
        for (std::uint32_t x = 0; x < s.width; ++x) {
          s.blocks.push_back(
              fit({static_cast<std::int8_t>(level), static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)}));
        }
      }
      levels_.push_back(std::move(s));
    }
  }

  /// Coarsest level: one block holds the whole texture.
  [[nodiscard]] int top() const noexcept { return first_stored - 1 + static_cast<int>(levels_.size()); }

  /// @pre the place is at most at level top(). Beyond the texture: empty   @rt safe
  [[nodiscard]] texture_block block(const texture_place& at) const noexcept {
    if (at.level < first_stored) return at.level > 0 ? fit(at) : part_of_cell(at);
    const stored_level& s = levels_[static_cast<std::size_t>(at.level - first_stored)];
    if (at.x < 0 || at.y < 0 || at.x >= static_cast<std::int64_t>(s.width) ||
        at.y >= static_cast<std::int64_t>(s.height)) {
      return {};
    }
    return s.blocks[static_cast<std::size_t>(at.y) * s.width + static_cast<std::size_t>(at.x)];
  }

  [[nodiscard]] std::size_t heap_bytes() const noexcept {
    std::size_t bytes = asperity::heap_bytes(levels_);
    return bytes;
  }

 private:
  struct stored_level {
    std::uint32_t width = 0, height = 0;
    std::vector<texture_block> blocks;
    [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(blocks); }
  };

  /// Texel of a node: node (i, j) is the lower corner of cell (i, j).
  [[nodiscard]] vec3 node(std::int64_t i, std::int64_t j) const noexcept {
    const auto inside = [](std::int64_t k, std::uint32_t size) {
      return static_cast<std::size_t>(std::clamp<std::int64_t>(k - 1, 0, std::int64_t{size} - 1));
    };
    return texture_->at(inside(i, texture_->width), inside(j, texture_->height));
  }

  [[nodiscard]] bool beyond(std::int64_t cell_x, std::int64_t cell_y) const noexcept {
    return cell_x < 0 || cell_y < 0 || cell_x > texture_->width || cell_y > texture_->height;
  }

  [[nodiscard]] texture_block fit(const texture_place& at) const noexcept {
    texture_block out;
    const std::int64_t width = std::int64_t{1} << at.level;
    const std::int64_t i0 = at.x * width, j0 = at.y * width;
    if (beyond(i0, j0)) return out;
    const std::int64_t i1 = std::min<std::int64_t>(i0 + width, std::int64_t{texture_->width} + 1);
    const std::int64_t j1 = std::min<std::int64_t>(j0 + width, std::int64_t{texture_->height} + 1);
    const vec3 p00 = node(i0, j0), p10 = node(i1, j0), p01 = node(i0, j1), p11 = node(i1, j1);
    const vec3 along_x = 0.5 / static_cast<double>(i1 - i0) * ((p10 - p00) + (p11 - p01));
    const vec3 along_y = 0.5 / static_cast<double>(j1 - j0) * ((p01 - p00) + (p11 - p10));
    if (is_finite(along_x) && is_finite(along_y)) {
      out.along_x = along_x;
      out.along_y = along_y;
    }
    const vec2 middle = at.middle();
    rest_box box;
    for (std::int64_t j = j0; j <= j1; ++j) {
      for (std::int64_t i = i0; i <= i1; ++i) {
        const vec3 p = node(i, j);
        if (!is_finite(p)) continue;
        const vec3 rest = p - (static_cast<double>(i) - 1.0 - middle.x) * out.along_x -
                          (static_cast<double>(j) - 1.0 - middle.y) * out.along_y;
        box.add(rest);
      }
    }
    box.close(out);
    return out;
  }

  [[nodiscard]] texture_block part_of_cell(const texture_place& at) const noexcept {
    texture_block out;
    out.one_cell = true;
    const std::int64_t i = at.x >> -at.level, j = at.y >> -at.level;
    if (beyond(i, j)) return out;
    const vec3 corner = node(i, j), right = node(i + 1, j), up = node(i, j + 1);
    const vec3 along_x = right - corner, along_y = up - corner;
    const vec3 twist = node(i + 1, j + 1) - up - along_x;
    const vec3 sum = corner + along_x + along_y + twist;
    if (!is_finite(sum)) return out;
    const vec2 f = at.middle() - vec2(static_cast<double>(i) - 1.0, static_cast<double>(j) - 1.0);
    out.centre = corner + f.x * along_x + f.y * along_y + f.x * f.y * twist;
    out.along_x = along_x + f.y * twist;
    out.along_y = along_y + f.x * twist;
    out.spare = at.half() * at.half() * twist;
    out.empty = false;
    return out;
  }

  const haptic_texture* texture_;
  std::vector<stored_level> levels_;
};

}  // namespace asperity::detail
