// Points of the probe in the fixed body's distance grid: the family of Voxmap PointShell, in its quickest form.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <exception>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <memory>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "contender.hpp"
#include "distance_grid.hpp"

namespace asperity::rivals {
namespace {

using point = glm::vec3;  // single precision, like the grid

/// Distances at points in grid coordinates, voxels from node (0, 0, 0).
class reader {
 public:
  explicit reader(const distance_grid& grid)
      : values_(grid.values.data()),
        along_y_(static_cast<std::size_t>(grid.size[2])),
        along_x_(static_cast<std::size_t>(grid.size[1]) * along_y_),
        last_(static_cast<float>(grid.size[0] - 1), static_cast<float>(grid.size[1] - 1),
              static_cast<float>(grid.size[2] - 1)) {}

  /// Interpolated along the three axes; false beyond the grid, which ends outside of the body.
  bool value(const point& p, float& out) const noexcept {
    std::array<float, 8> c;
    point at;
    if (!corners(p, c, at)) return false;
    const point w = 1.0F - at;
    const float a = (c[0] * w.z + c[1] * at.z) * w.y + (c[2] * w.z + c[3] * at.z) * at.y;
    const float b = (c[4] * w.z + c[5] * at.z) * w.y + (c[6] * w.z + c[7] * at.z) * at.y;
    out = a * w.x + b * at.x;
    return true;
  }

  /// Of the interpolated distance, metres per voxel. @pre value(p) is true
  [[nodiscard]] point slope(const point& p) const noexcept {
    std::array<float, 8> c;
    point at;
    if (!corners(p, c, at)) return point(0.0F);
    const point w = 1.0F - at;
    const float x00 = c[4] - c[0], x01 = c[5] - c[1], x10 = c[6] - c[2], x11 = c[7] - c[3];
    const float y00 = c[2] - c[0], y01 = c[3] - c[1], y10 = c[6] - c[4], y11 = c[7] - c[5];
    const float z00 = c[1] - c[0], z01 = c[3] - c[2], z10 = c[5] - c[4], z11 = c[7] - c[6];
    return {(x00 * w.z + x01 * at.z) * w.y + (x10 * w.z + x11 * at.z) * at.y,
            (y00 * w.z + y01 * at.z) * w.x + (y10 * w.z + y11 * at.z) * at.x,
            (z00 * w.y + z01 * at.y) * w.x + (z10 * w.y + z11 * at.y) * at.x};
  }

  /// How far p lies beyond the grid, voxels.
  [[nodiscard]] float beyond(const point& p) const noexcept {
    return glm::length(p - glm::clamp(p, point(0.0F), last_));
  }

 private:
  bool corners(const point& p, std::array<float, 8>& c, point& at) const noexcept {
    if (!(p.x >= 0.0F && p.y >= 0.0F && p.z >= 0.0F && p.x < last_.x && p.y < last_.y && p.z < last_.z)) return false;
    const auto i = static_cast<std::size_t>(p.x), j = static_cast<std::size_t>(p.y), k = static_cast<std::size_t>(p.z);
    at = p - point(static_cast<float>(i), static_cast<float>(j), static_cast<float>(k));
    const float* const v = values_ + i * along_x_ + j * along_y_ + k;
    c = {v[0],
         v[1],
         v[along_y_],
         v[along_y_ + 1],
         v[along_x_],
         v[along_x_ + 1],
         v[along_x_ + along_y_],
         v[along_x_ + along_y_ + 1]};
    return true;
  }

  const float* values_;
  std::size_t along_y_, along_x_;
  point last_;
};

/// A sphere about points, or about two smaller spheres.
struct sphere {
  point centre{0.0F};  // probe frame, metres
  float radius_m = 0.0F;
  std::uint32_t first = 0, count = 0;  // points of a leaf; 0: an inner one
  std::uint32_t right = 0;             // its left one follows it
};

class shell {
 public:
  explicit shell(const triangle_mesh& mesh) {
    for (const vec3& p : mesh.positions) points_.emplace_back(p);
    cut(0, static_cast<std::uint32_t>(points_.size()));
  }
  [[nodiscard]] const std::vector<point>& points() const noexcept { return points_; }
  [[nodiscard]] const std::vector<sphere>& spheres() const noexcept { return spheres_; }

 private:
  static constexpr std::uint32_t leaf_size = 16;

  void cut(std::uint32_t first, std::uint32_t count) {
    const auto index = spheres_.size();
    const auto begin = points_.begin() + first, end = begin + count;
    point low = *begin, high = *begin;
    for (auto p = begin; p != end; ++p) {
      low = glm::min(low, *p);
      high = glm::max(high, *p);
    }
    sphere s;
    s.centre = 0.5F * (low + high);
    for (auto p = begin; p != end; ++p) s.radius_m = std::max(s.radius_m, glm::distance(*p, s.centre));
    s.radius_m *= 1.0F + 1e-6F;
    s.first = first;
    s.count = count <= leaf_size ? count : 0;
    spheres_.push_back(s);
    if (s.count > 0) return;
    const point size = high - low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    std::nth_element(begin, begin + count / 2, end,
                     [axis](const point& a, const point& b) { return a[axis] < b[axis]; });
    cut(first, count / 2);
    spheres_[index].right = static_cast<std::uint32_t>(spheres_.size());
    cut(first + count / 2, count - count / 2);
  }

  std::vector<point> points_;
  std::vector<sphere> spheres_;
};

class point_shell final : public contender {
 public:
  point_shell(const triangle_mesh& probe, distance_grid grid) : shell_(probe), grid_(std::move(grid)), read_(grid_) {}

  felt feel(const pose& T_wa) override {
    const double per_m = 1.0 / grid_.voxel_m;
    const glm::mat3 turn(per_m * glm::mat3_cast(T_wa.rotation));
    const point shift(per_m * (T_wa.position - grid_.origin));
    felt out;
    float deepest = 0.0F;
    point push(0.0F);
    std::array<std::uint32_t, 64> stack;  // the tree is halved at each step: its depth is the logarithm of its points
    std::size_t waiting = 0;
    stack[waiting++] = 0;
    while (waiting > 0) {
      const std::uint32_t index = stack[--waiting];
      const sphere& s = shell_.spheres()[index];
      if (is_outside(turn * s.centre + shift, s.radius_m)) continue;
      if (s.count == 0) {
        stack[waiting++] = s.right;
        stack[waiting++] = index + 1;
        continue;
      }
      for (std::uint32_t i = s.first; i < s.first + s.count; ++i) {
        const point p = turn * shell_.points()[i] + shift;
        float d = 0.0F;
        if (!read_.value(p, d) || d >= 0.0F) continue;
        ++out.contacts;
        deepest = std::max(deepest, -d);
        const point up = read_.slope(p);
        const float steep = glm::length(up);
        if (steep > 0.0F) push += -d / steep * up;
      }
    }
    out.touches = out.contacts > 0;
    out.depth_m = static_cast<double>(deepest);
    out.force_w = vec3(push);
    return out;
  }

 private:
  /// No point of the sphere is inside the body, surely.
  [[nodiscard]] bool is_outside(const point& centre, float radius_m) const noexcept {
    float d = 0.0F;
    if (read_.value(centre, d)) return d > radius_m;
    // Beyond the grid there is the way to it.
    return read_.beyond(centre) * static_cast<float>(grid_.voxel_m) > radius_m;
  }

  shell shell_;
  distance_grid grid_;
  reader read_;
};

}  // namespace

result<contender_ptr> make_point_shell(const body_pair& bodies, double voxel) {
  vec3 low(std::numeric_limits<double>::max()), high(-low);
  for (const vec3& p : bodies.fixed.positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  constexpr double band_m = 2e-3;  // twice as deep as the race presses
  try {
    return contender_ptr(std::make_unique<point_shell>(
        bodies.probe, make_distance_grid(bodies.fixed, voxel * glm::length(high - low), band_m)));
  } catch (const std::exception& fault) {
    return error{error_code::bad_mesh,
                 "OpenVDB could not make a distance grid of " + bodies.name + ": " + fault.what()};
  }
}

}  // namespace asperity::rivals
