// From the image of a haptic texture to the coarse surface, triangle by triangle.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "asperity/core/math.hpp"
#include "bake/image_triangle.hpp"

namespace asperity::bake {

/// The affine map that takes a triangle of the image to its place on the surface, beyond its edges too.
class texel_map {
 public:
  /// @pre the image triangle has area
  texel_map(const std::array<vec3, 3>& c, const image_triangle& image) noexcept : corner_(c[0]), texel_(image.c[0]) {
    const vec2 a = image.c[1] - image.c[0];
    const vec2 b = image.c[2] - image.c[0];
    per_x_ = (b.y * (c[1] - c[0]) - a.y * (c[2] - c[0])) / image.twice_area;
    per_y_ = (a.x * (c[2] - c[0]) - b.x * (c[1] - c[0])) / image.twice_area;
  }

  [[nodiscard]] vec3 point(const vec2& texel) const noexcept {
    const vec2 d = texel - texel_;
    return corner_ + d.x * per_x_ + d.y * per_y_;
  }

  /// Length on the surface of a texel's way in the direction in which it is longest, m.
  [[nodiscard]] double wide_m() const noexcept { return std::sqrt(mean2() + spread2()); }
  /// And where it is shortest, m.
  [[nodiscard]] double narrow_m() const noexcept { return std::sqrt(std::max(0.0, mean2() - spread2())); }

 private:
  [[nodiscard]] double mean2() const noexcept { return 0.5 * (glm::dot(per_x_, per_x_) + glm::dot(per_y_, per_y_)); }
  [[nodiscard]] double spread2() const noexcept {
    return std::hypot(0.5 * (glm::dot(per_x_, per_x_) - glm::dot(per_y_, per_y_)), glm::dot(per_x_, per_y_));
  }

  vec3 corner_;
  vec2 texel_;
  vec3 per_x_;  // m per texel
  vec3 per_y_;
};

}  // namespace asperity::bake
