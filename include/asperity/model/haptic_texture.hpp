// The fine surface: a texture whose texels are surface positions.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/core/memory.hpp"

namespace asperity {

/// Image of surface positions (paper, section 6.1): texel (i, j) holds the point of the full-resolution surface that
/// belongs to the coarse surface point with texture coordinates ((i + 1/2) / width, (j + 1/2) / height).
/// Body frame, metres, float32; rows from v = 0 upwards in memory; NaN where no surface maps to.
struct haptic_texture {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<glm::vec3> texels;  ///< width * height, row-major

  /// Surface point at texture coordinates uv, bilinear between texel centres, clamped at the image's border.
  /// Bilinear, because a nearest-texel lookup has a useless gradient below half a texel of motion.
  /// @pre width, height > 0; uv finite   @rt safe   @source paper Eq. 8 (the paper does not say how it filters)
  [[nodiscard]] vec3 sample(const vec2& uv) const noexcept {
    const double x = clamp_to(uv.x * width - 0.5, width - 1.0);
    const double y = clamp_to(uv.y * height - 0.5, height - 1.0);
    const auto i = static_cast<std::size_t>(x);
    const auto j = static_cast<std::size_t>(y);
    const std::size_t i1 = i + 1 < width ? i + 1 : i;
    const std::size_t j1 = j + 1 < height ? j + 1 : j;
    const double fx = x - static_cast<double>(i);
    const double fy = y - static_cast<double>(j);
    const vec3 bottom = (1.0 - fx) * at(i, j) + fx * at(i1, j);
    const vec3 top = (1.0 - fx) * at(i, j1) + fx * at(i1, j1);
    return (1.0 - fy) * bottom + fy * top;
  }

  /// Texel in column i and row j. @pre i < width, j < height
  [[nodiscard]] vec3 at(std::size_t i, std::size_t j) const noexcept { return {texels[j * width + i]}; }

  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(texels); }

 private:
  static double clamp_to(double x, double hi) noexcept { return x < 0.0 ? 0.0 : (x > hi ? hi : x); }
};

}  // namespace asperity
