// A z-buffer: triangles go in, the nearest ones come out, without stairs at their edges.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "picture/colour.hpp"

namespace asperity::picture {

/// Finished pixels, sRGB, rows from the top, three bytes each.
struct pixmap {
  std::size_t width = 0;
  std::size_t height = 0;
  std::vector<std::uint8_t> rgb;

  [[nodiscard]] std::array<std::uint8_t, 3> at(std::size_t x, std::size_t y) const noexcept {
    const std::size_t i = 3 * (y * width + x);
    return {rgb[i], rgb[i + 1], rgb[i + 2]};
  }
};

/// Where a corner falls: pixels from the upper left corner of the canvas, and how near it is (larger is nearer).
struct screen_point {
  double x = 0.0;
  double y = 0.0;
  double near = 0.0;
};

/// Twice the area of a triangle on the screen, pixels^2; positive where it runs clockwise to the eye, since y grows
/// downwards.
[[nodiscard]] inline double twice_area(const std::array<screen_point, 3>& p) noexcept {
  return (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x);
}

/// Draws with 3 x 3 samples per pixel. What a triangle covers is decided in whole numbers, so two triangles with a
/// common edge leave no sample between them out, and the same triangles give the same pixels.
class canvas {
 public:
  /// Samples along each side of a pixel.
  static constexpr int fineness = 3;

  canvas(std::size_t width, std::size_t height)
      : width_(width * fineness),
        height_(height * fineness),
        near_(width_ * height_, -std::numeric_limits<float>::infinity()),
        colour_(width_ * height_) {}

  /// Fills a triangle, of either winding. `shade` gets the barycentric coordinates of a sample, a float each, and
  /// answers its colour; it is asked only where nothing nearer was drawn before.
  template <class Shade>
  void triangle(const std::array<screen_point, 3>& corners, const Shade& shade) {
    std::array<point, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = {snap(corners[k].x), snap(corners[k].y)};
    std::int64_t area = cross(p[0], p[1], p[2]);
    if (area == 0) return;
    const std::int64_t side = area > 0 ? 1 : -1;
    area *= side;
    const auto [left, right] = samples_between(p[0].x, p[1].x, p[2].x, width_);
    const auto [top, bottom] = samples_between(p[0].y, p[1].y, p[2].y, height_);
    for (std::int64_t y = top; y <= bottom; ++y) {
      for (std::int64_t x = left; x <= right; ++x) {
        const point at{x * grain + grain / 2, y * grain + grain / 2};
        const std::int64_t w0 = side * cross(p[1], p[2], at);
        const std::int64_t w1 = side * cross(p[2], p[0], at);
        const std::int64_t w2 = side * cross(p[0], p[1], at);
        if ((w0 | w1 | w2) < 0) continue;
        const auto whole = static_cast<double>(area);
        const std::array<double, 3> share{static_cast<double>(w0) / whole, static_cast<double>(w1) / whole,
                                          static_cast<double>(w2) / whole};
        const auto near =
            static_cast<float>(share[0] * corners[0].near + share[1] * corners[1].near + share[2] * corners[2].near);
        const std::size_t i = static_cast<std::size_t>(y) * width_ + static_cast<std::size_t>(x);
        if (near <= near_[i]) continue;
        near_[i] = near;
        colour_[i] = shade(std::array<float, 3>{static_cast<float>(share[0]), static_cast<float>(share[1]),
                                                static_cast<float>(share[2])});
      }
    }
  }

  /// Means over the samples of each pixel; the background shows where nothing was drawn.
  [[nodiscard]] pixmap finish(const colour& background) const;

 private:
  static constexpr std::int64_t grain = 256;  // positions per sample, along each axis

  struct point {
    std::int64_t x = 0;
    std::int64_t y = 0;
  };

  static std::int64_t snap(double pixels) noexcept {
    constexpr double farthest = 1e6;  // far outside of any canvas, and its products still fit
    return std::llround(std::clamp(pixels, -farthest, farthest) * static_cast<double>(fineness * grain));
  }
  static std::int64_t cross(const point& a, const point& b, const point& c) noexcept {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  }
  // Samples whose middle may lie within.
  static std::array<std::int64_t, 2> samples_between(std::int64_t a, std::int64_t b, std::int64_t c,
                                                     std::size_t size) noexcept {
    const auto [low, high] = std::minmax({a, b, c});
    return {std::clamp<std::int64_t>((low - grain / 2) / grain, 0, static_cast<std::int64_t>(size)),
            std::min<std::int64_t>(high / grain, static_cast<std::int64_t>(size) - 1)};
  }

  std::size_t width_;
  std::size_t height_;
  std::vector<float> near_;
  std::vector<colour> colour_;
};

}  // namespace asperity::picture
