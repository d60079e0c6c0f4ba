// Bilinear reading of a map whose pixels hold one or two numbers, under any texture coordinates.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/core/status.hpp"
#include "asperity/model/map_image.hpp"
#include "asperity/model/triangle_mesh.hpp"

namespace asperity::bake {

/// Pixel that stands at place i of an endless row.
[[nodiscard]] inline std::uint32_t wrapped(double i, std::uint32_t size, map_wrap wrap) noexcept {
  const double n = size;
  if (wrap == map_wrap::clamp) return static_cast<std::uint32_t>(std::clamp(i, 0.0, n - 1.0));
  const double period = wrap == map_wrap::mirrored ? 2.0 * n : n;
  const double k = std::clamp(i - period * std::floor(i / period), 0.0, period - 1.0);
  return static_cast<std::uint32_t>(k < n ? k : period - 1.0 - k);
}

/// A map of T (float, double or vec2) per pixel.
template <class T>
struct map_lookup {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  map_wrap wrap_u = map_wrap::repeat;
  map_wrap wrap_v = map_wrap::repeat;
  std::vector<T> pixels;

  [[nodiscard]] T operator()(const vec2& uv) const noexcept {
    return read(uv, [](const T& pixel) { return pixel; });
  }

  /// Bilinear between what value_of() makes of the pixels.
  template <class Value>
  [[nodiscard]] auto read(const vec2& uv, const Value& value_of) const noexcept {
    const double x = uv.x * width - 0.5;
    const double y = uv.y * height - 0.5;
    const double i = std::floor(x);
    const double j = std::floor(y);
    const std::uint32_t i0 = wrapped(i, width, wrap_u), i1 = wrapped(i + 1.0, width, wrap_u);
    const std::uint32_t j0 = wrapped(j, height, wrap_v), j1 = wrapped(j + 1.0, height, wrap_v);
    const auto at = [&](std::uint32_t a, std::uint32_t b) { return value_of(pixels[std::size_t{b} * width + a]); };
    const auto top = (1.0 - (x - i)) * at(i0, j0) + (x - i) * at(i1, j0);
    const auto bottom = (1.0 - (x - i)) * at(i0, j1) + (x - i) * at(i1, j1);
    return decltype(value_of(pixels[0]))((1.0 - (y - j)) * top + (y - j) * bottom);
  }
};

/// Texture coordinates inside a triangle.
[[nodiscard]] inline vec2 mixed(const std::array<vec2, 3>& uv, const std::array<double, 3>& b) noexcept {
  return b[0] * uv[0] + b[1] * uv[1] + b[2] * uv[2];
}

/// What is said where the caller has had enough while a map is read.
[[nodiscard]] inline error cancelled_map() { return {error_code::cancelled, "was not laid on the mesh: cancelled"}; }

/// Edge in metres of a map's texels on a mesh: the root of surface over image area, in pixels, in the mean. 0 where the
/// texture coordinates span no area.
[[nodiscard]] double mean_texel_m(const triangle_mesh& mesh, std::uint32_t width, std::uint32_t height);

}  // namespace asperity::bake
