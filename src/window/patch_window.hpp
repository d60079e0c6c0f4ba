// The window of a contact and the coarse triangles that can hold a point of the contact inside it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "asperity/core/fixed_vector.hpp"
#include "asperity/core/math.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/model/coarse_mesh.hpp"
#include "asperity/model/textured_model.hpp"
#include "asperity/render/contact.hpp"

namespace asperity {

/// Rectangle in the contact plane, coordinates along u and v, metres. Empty until something is added.
struct plane_box {
  vec2 low{std::numeric_limits<double>::infinity()};
  vec2 high{-std::numeric_limits<double>::infinity()};

  [[nodiscard]] bool empty() const noexcept { return !(low.x <= high.x && low.y <= high.y); }
  [[nodiscard]] vec2 centre() const noexcept { return 0.5 * (low + high); }
  /// Half the longer side. @pre !empty()
  [[nodiscard]] double half_side() const noexcept { return 0.5 * std::max(high.x - low.x, high.y - low.y); }
  void add(const vec3& uvh) noexcept {
    low = glm::min(low, vec2(uvh));
    high = glm::max(high, vec2(uvh));
  }
  /// Adds the shadow of a box of the frame that `to` projects, drawn together towards the origin by `scale`.
  template <class Projection>
  void add(const Projection& to, const bounds& box, double scale) noexcept {
    const vec3 centre = to(0.5 * (box.low + box.high));
    const vec3 half = 0.5 * (box.high - box.low);
    const vec3 extent =
        glm::abs(to.to_uvh[0]) * half.x + glm::abs(to.to_uvh[1]) * half.y + glm::abs(to.to_uvh[2]) * half.z;
    add(scale * (centre - extent));
    add(scale * (centre + extent));
  }
  [[nodiscard]] static plane_box square(const vec2& centre, double half) noexcept {
    return {centre - vec2(half), centre + vec2(half)};
  }
};

/// The common part; empty where there is none.
/// @rt safe
[[nodiscard]] inline plane_box intersection(const plane_box& a, const plane_box& b) noexcept {
  return {glm::max(a.low, b.low), glm::min(a.high, b.high)};
}

/// Maps points of a body frame to (u, v, h): coordinates along a window's axes from its centre, metres.
struct window_projection {
  mat3 to_uvh{1.0};
  vec3 offset{0.0};

  window_projection(const contact_window& w, const pose& T_w_body) noexcept {
    const mat3 axes(w.u_w, w.v_w, w.n_ab_w);
    to_uvh = glm::transpose(axes) * glm::mat3_cast(T_w_body.rotation);
    offset = (T_w_body.position - w.centre_w) * axes;
  }
  [[nodiscard]] vec3 operator()(const vec3& p) const noexcept { return to_uvh * p + offset; }
  /// Component along n of a direction of the body frame.
  [[nodiscard]] double along_n(const vec3& d) const noexcept {
    return to_uvh[0].z * d.x + to_uvh[1].z * d.y + to_uvh[2].z * d.z;
  }
  [[nodiscard]] std::array<vec3, 3> operator()(const std::array<vec3, 3>& c) const noexcept {
    return {(*this)(c[0]), (*this)(c[1]), (*this)(c[2])};
  }
};

/// Range of heights along n, metres.
struct height_slab {
  double low = 0.0;
  double high = 0.0;
};

/// Corners of a triangle after up to six cuts.
using clipped_polygon = fixed_vector<vec3, 9>;

/// Keeps the part of a convex polygon where coordinate `axis` times `sign` is at least `limit`.
/// @rt safe
inline void cut(clipped_polygon& polygon, int axis, double sign, double limit) noexcept {
  clipped_polygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const vec3& p = polygon[i];
    const vec3& q = polygon[(i + 1) % polygon.size()];
    const double dp = sign * p[axis] - limit;
    const double dq = sign * q[axis] - limit;
    if (dp >= 0.0) (void)kept.push_back(p);  // six cuts of a triangle have at most nine corners
    if ((dp >= 0.0) != (dq >= 0.0)) (void)kept.push_back(p + dp / (dp - dq) * (q - p));
  }
  polygon = kept;
}

/// The part of a triangle (u, v, h) inside a slab and a rectangle.
/// @rt safe
[[nodiscard]] inline clipped_polygon clip(const std::array<vec3, 3>& uvh, const height_slab& slab,
                                          const plane_box& box) noexcept {
  clipped_polygon p;
  for (const vec3& c : uvh) (void)p.push_back(c);
  cut(p, 2, 1.0, slab.low);
  cut(p, 2, -1.0, -slab.high);
  cut(p, 0, 1.0, box.low.x);
  cut(p, 0, -1.0, -box.high.x);
  cut(p, 1, 1.0, box.low.y);
  cut(p, 1, -1.0, -box.high.y);
  return p;
}

/// True where a triangle (u, v, h) may reach into the slab above the rectangle: by its bounding box, a superset.
/// @rt safe
[[nodiscard]] inline bool may_reach(const std::array<vec3, 3>& t, const height_slab& slab,
                                    const plane_box& box) noexcept {
  const vec3 low = glm::min(t[0], glm::min(t[1], t[2]));
  const vec3 high = glm::max(t[0], glm::max(t[1], t[2]));
  return low.x <= box.high.x && high.x >= box.low.x && low.y <= box.high.y && high.y >= box.low.y &&
         low.z <= slab.high && high.z >= slab.low;
}

/// Height of the triangle (u, v, h) over a point of the plane; false where the triangle is not over it.
/// @rt safe
[[nodiscard]] inline bool height_over(const std::array<vec3, 3>& t, const vec2& at, double& height) noexcept {
  constexpr double border = 1e-9;  // a point on a shared edge belongs to both triangles
  const vec2 a(t[0]), b(t[1]), c(t[2]);
  const auto area = [](const vec2& p, const vec2& q, const vec2& r) {
    return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
  };
  const double whole = area(a, b, c);
  if (whole == 0.0) return false;
  const double wa = area(at, b, c) / whole;
  const double wb = area(a, at, c) / whole;
  const double wc = 1.0 - wa - wb;
  if (wa < -border || wb < -border || wc < -border) return false;
  height = wa * t[0].z + wb * t[1].z + wc * t[2].z;
  return true;
}

}  // namespace asperity
