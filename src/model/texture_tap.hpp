// The textured surface between four texels: a bilinear patch, its point and its tangents.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "asperity/model/haptic_texture.hpp"

namespace asperity::detail {

/// Point of the surface with its derivatives by the texel position.
struct surface_tap {
  vec3 point;    ///< m
  vec3 along_x;  ///< per texel column, m
  vec3 along_y;  ///< per texel row, m
};

/// Bilinear patch between four texel centres; its value is that of haptic_texture::sample.
/// Made and read for every sample of every tick. Inlining is forced, because GCC 12 would make calls with the patch in
/// memory: a tick of `cpu_depth` is a sixth shorter so.
struct texture_cell {
  double column, row;                               ///< texel of the lower corner
  vec3 corner, along_x, along_y, twist;             ///< point = corner + along_x f + along_y g + twist f g
  bool open_left, open_right, open_low, open_high;  ///< the image goes on beyond that side

  /// The cell around texel position z (texel centres at integers), at the border of the image the outermost one.
  /// @pre z finite, width and height > 0; a NaN texel makes the corner or a derivative NaN   @rt safe
  [[gnu::always_inline]] texture_cell(const haptic_texture& texture, const vec2& z) noexcept {
    // Clamped before it is cut to an integer: floor() is a call on plain x86-64.
    const auto cut = [](double x, std::int64_t last) {
      const double upper = static_cast<double>(last);
      return static_cast<std::int64_t>(x < 0.0 ? 0.0 : (x > upper ? upper : x));
    };
    const std::int64_t last_column = texture.width > 1 ? std::int64_t{texture.width} - 2 : 0;
    const std::int64_t last_row = texture.height > 1 ? std::int64_t{texture.height} - 2 : 0;
    const std::int64_t i = cut(z.x, last_column);
    const std::int64_t j = cut(z.y, last_row);
    const std::size_t right = texture.width > 1 ? 1 : 0;
    const std::size_t up = texture.height > 1 ? texture.width : 0;
    const glm::vec3* texel =
        texture.texels.data() + static_cast<std::size_t>(j) * texture.width + static_cast<std::size_t>(i);
    column = static_cast<double>(i);
    row = static_cast<double>(j);
    corner = vec3(texel[0]);
    along_x = vec3(texel[right]) - corner;
    along_y = vec3(texel[up]) - corner;
    twist = vec3(texel[up + right]) - vec3(texel[up]) - along_x;
    open_left = i > 0;
    open_right = i < last_column;
    open_low = j > 0;
    open_high = j < last_row;
  }

  /// True where z is in this cell, or beyond the image's border next to it.
  [[nodiscard]] bool holds(const vec2& z) const noexcept {
    return (z.x >= column || !open_left) && (z.x <= column + 1.0 || !open_right) && (z.y >= row || !open_low) &&
           (z.y <= row + 1.0 || !open_high);
  }

  /// True where z lies between the four texels.
  [[nodiscard]] bool spans(const vec2& z) const noexcept {
    return z.x >= column && z.x <= column + 1.0 && z.y >= row && z.y <= row + 1.0;
  }

  /// Largest change of the tangents in a step of one texel, m.
  [[nodiscard]] double largest_twist() const noexcept {
    return std::max({std::fabs(twist.x), std::fabs(twist.y), std::fabs(twist.z)});
  }

  /// The same patch in other coordinates. @param map  has point() and direction()
  template <class Map>
  [[nodiscard]] texture_cell seen_by(const Map& map) const noexcept {
    texture_cell out = *this;
    out.corner = map.point(corner);
    out.along_x = map.direction(along_x);
    out.along_y = map.direction(along_y);
    out.twist = map.direction(twist);
    return out;
  }

  /// Surface at z; beyond the image's border its nearest point there.
  [[nodiscard, gnu::always_inline]] surface_tap at(const vec2& z) const noexcept {
    const double f = within(z.x - column);
    const double g = within(z.y - row);
    const vec3 per_x = along_x + g * twist;
    return {corner + f * per_x + g * along_y, per_x, along_y + f * twist};
  }

 private:
  [[nodiscard]] static double within(double x) noexcept { return x < 0.0 ? 0.0 : (x > 1.0 ? 1.0 : x); }
};

/// Reads the texture once. @pre as for texture_cell
[[nodiscard]] inline surface_tap read(const haptic_texture& texture, const vec2& z) noexcept {
  return texture_cell(texture, z).at(z);
}

}  // namespace asperity::detail
