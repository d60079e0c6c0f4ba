// The coarse triangles of a contact patch that face along n, projected into the window.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "asperity/core/memory.hpp"
#include "model/surface_index.hpp"
#include "window/window_map.hpp"

namespace asperity::detail {

/// Which way a body's surface must face to be seen along n, and which of several layers counts.
enum class layer : std::int8_t {
  highest = 1,  ///< the probe A: normal along +n, largest height
  lowest = -1,  ///< the fixed body B: normal along -n, smallest height
};

[[nodiscard]] constexpr double sign(layer l) noexcept { return static_cast<double>(l); }

/// f(u, v) = at_centre + u * per_u + v * per_v over a projected triangle.
struct affine {
  double at_centre = 0.0, per_u = 0.0, per_v = 0.0;
  [[nodiscard]] double operator()(double u, double v) const noexcept { return at_centre + u * per_u + v * per_v; }
};

/// A facing coarse triangle in window coordinates.
struct projected_triangle {
  std::uint32_t triangle = 0;             ///< index in the coarse mesh
  std::array<std::uint32_t, 3> vertex{};  ///< mesh vertices of the corners
  std::array<vec3, 3> corner{};           ///< (u, v, h), metres
  affine height;                          ///< h of the coarse surface, m
  affine texel_x, texel_y;                ///< texel position of the coarse surface
  double facing = 0.0;                    ///< |cosine| between normal and n
};

/// Projects patches; all memory is taken when it is made.
class patch_projection {
 public:
  /// @param max_triangles  largest number of coarse triangles of any body that will be projected
  explicit patch_projection(std::size_t max_triangles) : slot_(max_triangles, 0) {
    detail::reserve_resident(list_, max_triangles);
  }

  /// @pre every index in patch is below mesh.triangles.size(), each once   @rt safe
  void project(const coarse_mesh& mesh, const surface_index& index, std::span<const std::uint32_t> patch,
               const window_map& map, layer which, double facing_cosine) noexcept {
    list_.clear();
    for (const std::uint32_t t : patch) {
      const double facing = sign(which) * glm::dot(index.normal[t], map.n_b);
      if (!(facing > facing_cosine) || !index.texels[t].usable) continue;
      projected_triangle p;
      p.triangle = t;
      p.vertex = mesh.triangles[t].vertex;
      p.facing = facing;
      for (std::size_t k = 0; k < 3; ++k) p.corner[k] = map.point(mesh.positions[p.vertex[k]]);
      const std::array<vec2, 3>& z = index.texels[t].corner;
      const interpolation over(p.corner);
      p.height = over({p.corner[0].z, p.corner[1].z, p.corner[2].z});
      p.texel_x = over({z[0].x, z[1].x, z[2].x});
      p.texel_y = over({z[0].y, z[1].y, z[2].y});
      slot_[t] = static_cast<std::uint32_t>(list_.size());
      list_.push_back(p);
    }
  }

  [[nodiscard]] std::span<const projected_triangle> triangles() const noexcept { return list_; }

  /// The projection of a coarse triangle; null where it is not in the patch or does not face along n.
  /// @rt safe
  [[nodiscard]] const projected_triangle* find(std::uint32_t triangle) const noexcept {
    if (triangle == surface_index::none) return nullptr;
    // A stale slot names another triangle, so slot_ never needs clearing.
    const std::uint32_t slot = slot_[triangle];
    return slot < list_.size() && list_[slot].triangle == triangle ? &list_[slot] : nullptr;
  }

  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(list_, slot_); }

 private:
  /// Turns corner values into an affine function of (u, v). Facing triangles have area across n, so this is safe.
  struct interpolation {
    vec2 first, to_1, to_2;
    double twice_area;

    explicit interpolation(const std::array<vec3, 3>& c) noexcept
        : first(c[0]),
          to_1(vec2(c[1]) - first),
          to_2(vec2(c[2]) - first),
          twice_area(to_1.x * to_2.y - to_1.y * to_2.x) {}

    [[nodiscard]] affine operator()(const std::array<double, 3>& f) const noexcept {
      affine out;
      out.per_u = ((f[1] - f[0]) * to_2.y - (f[2] - f[0]) * to_1.y) / twice_area;
      out.per_v = ((f[2] - f[0]) * to_1.x - (f[1] - f[0]) * to_2.x) / twice_area;
      out.at_centre = f[0] - first.x * out.per_u - first.y * out.per_v;
      return out;
    }
  };

  std::vector<projected_triangle> list_;
  std::vector<std::uint32_t> slot_;
};

}  // namespace asperity::detail
