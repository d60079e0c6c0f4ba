// From which side a model is looked at, and where its light comes from.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "asperity/core/math.hpp"
#include "asperity/picture/model_picture.hpp"
#include "picture/canvas.hpp"
#include "picture/colour.hpp"

namespace asperity::picture {

/// Parallel projection, so that sizes can be compared all over the picture. Axes of the eye in the body frame, unit
/// vectors.
struct view {
  vec3 right{1.0, 0.0, 0.0};
  vec3 up{0.0, 0.0, 1.0};
  vec3 to_eye{0.0, -1.0, 0.0};
  vec3 centre{0.0};           ///< point in the middle of the picture
  double pixels_per_m = 1.0;  ///< scale
  double middle_x = 0.0;      ///< pixels
  double middle_y = 0.0;

  [[nodiscard]] screen_point project(const vec3& p) const noexcept {
    const vec3 d = p - centre;
    return {middle_x + pixels_per_m * glm::dot(d, right), middle_y - pixels_per_m * glm::dot(d, up),
            glm::dot(d, to_eye)};
  }
  /// Direction in the axes of the eye: x to the right, y up, z to the eye.
  [[nodiscard]] vec3 turn(const vec3& direction) const noexcept {
    return {glm::dot(direction, right), glm::dot(direction, up), glm::dot(direction, to_eye)};
  }
};

/// 0, 1 or 2 for x, y or z. Size: edges of the model's box.
[[nodiscard]] inline int number_of(up_axis up, const vec3& size) noexcept {
  if (up != up_axis::automatic) return up == up_axis::x ? 0 : up == up_axis::y ? 1 : 2;
  if (size.z < 1.6 * std::max(size.x, size.y)) return 2;
  return size.x < size.y ? 0 : 1;
}

/// From above and from the side, the longer of the two level axes of the model running more across than away; then the
/// model is turned about the upward axis, counter-clockwise from above.
[[nodiscard]] inline view look_from_above(const vec3& size, up_axis up, double turn_deg = 0.0) noexcept {
  constexpr double degree = 0.017453292519943295;
  const double azimuth = (34.0 - turn_deg) * degree;
  constexpr double elevation = 30.0 * degree;
  const int u = number_of(up, size);
  vec3 vertical(0.0);
  vec3 across(0.0);
  vertical[u] = 1.0;
  const int first = (u + 1) % 3;
  const int second = (u + 2) % 3;
  // A right-handed frame (across, away, vertical) whatever is chosen.
  across[size[second] > size[first] ? second : first] = size[second] > size[first] ? -1.0 : 1.0;
  const vec3 away = glm::cross(vertical, across);
  const vec3 level_to_eye = -std::cos(azimuth) * away + std::sin(azimuth) * across;
  view v;
  v.to_eye = std::cos(elevation) * level_to_eye + std::sin(elevation) * vertical;
  v.right = glm::normalize(glm::cross(vertical, v.to_eye));
  v.up = glm::cross(v.to_eye, v.right);
  return v;
}

/// What a set of points covers, seen from somewhere: the frame to fit into a picture.
class extent {
 public:
  explicit extent(const view& from) : from_(from) {}

  void add(const vec3& p) noexcept {
    const vec3 q = from_.turn(p);
    low_ = glm::min(low_, q);
    high_ = glm::max(high_, q);
  }

  /// The view that shows all points in a rectangle of these pixels, centred and as large as it goes.
  [[nodiscard]] view fit(double left, double top, double width, double height) const noexcept {
    view v = from_;
    const vec3 middle = 0.5 * (low_ + high_);
    v.centre = middle.x * v.right + middle.y * v.up + middle.z * v.to_eye;
    const double across = std::max(high_.x - low_.x, 1e-12);
    const double tall = std::max(high_.y - low_.y, 1e-12);
    v.pixels_per_m = std::min(width / across, height / tall);
    v.middle_x = left + 0.5 * width;
    v.middle_y = top + 0.5 * height;
    return v;
  }

 private:
  view from_;
  vec3 low_{std::numeric_limits<double>::infinity()};
  vec3 high_{-std::numeric_limits<double>::infinity()};
};

/// How bright a matt surface of this unit normal (axes of the eye) is: a soft light from the upper left, a weak one
/// from the right, a sky above a darker ground. About 1 where it faces the soft light.
[[nodiscard]] inline float brightness(vec3 normal) noexcept {
  if (normal.z < 0.0) normal = -normal;  // the inside of a crack
  // Low over a level surface, so that relief throws light and shade.
  const vec3 key = glm::normalize(vec3(-0.66, 0.52, 0.40));
  const vec3 fill = glm::normalize(vec3(0.80, 0.05, 0.60));
  const double direct = std::max(0.0, (glm::dot(normal, key) + 0.08) / 1.08);
  const double side = std::max(0.0, glm::dot(normal, fill));
  const double sky = 0.5 + 0.5 * normal.y;
  return static_cast<float>(0.07 + 0.92 * direct + 0.13 * side + 0.12 * sky);
}

}  // namespace asperity::picture
