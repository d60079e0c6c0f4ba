// The textured surface and its tangents at a texel position.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "asperity/model/haptic_texture.hpp"

namespace asperity::detail {

/// Bilinear patch at a texel position: the point that haptic_texture::sample returns, and its derivatives.
struct texture_tap {
  vec3 point;    ///< body frame, m
  vec3 along_x;  ///< d point / d texel column, m
  vec3 along_y;  ///< d point / d texel row, m
};

/// Reads the texture at texel position z (texel centres at integers), clamped to the image.
/// @pre z finite, width and height > 0; a NaN texel in the cell makes the point NaN   @rt safe
[[nodiscard]] inline texture_tap read(const haptic_texture& texture, const vec2& z) noexcept {
  const auto cell = [](double x, std::uint32_t size) {
    const double last = size > 1 ? size - 2.0 : 0.0;
    return static_cast<std::size_t>(std::clamp(std::floor(x), 0.0, last));
  };
  const std::size_t i = cell(z.x, texture.width);
  const std::size_t j = cell(z.y, texture.height);
  const std::size_t i1 = std::min<std::size_t>(i + 1, texture.width - 1);
  const std::size_t j1 = std::min<std::size_t>(j + 1, texture.height - 1);
  const double fx = std::clamp(z.x - static_cast<double>(i), 0.0, 1.0);
  const double fy = std::clamp(z.y - static_cast<double>(j), 0.0, 1.0);
  const vec3 p00 = texture.at(i, j), p10 = texture.at(i1, j), p01 = texture.at(i, j1), p11 = texture.at(i1, j1);
  const vec3 bottom = (1.0 - fx) * p00 + fx * p10;
  const vec3 top = (1.0 - fx) * p01 + fx * p11;
  return {(1.0 - fy) * bottom + fy * top, (1.0 - fy) * (p10 - p00) + fy * (p11 - p01), top - bottom};
}

}  // namespace asperity::detail
