// Fixed bodies whose support planes are known in closed form, as a renderer: the probe is a set of points.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "asperity/control/contact_loop.hpp"

namespace asperity::test_support {

/// A face without end, solid behind it: outward_w . p = height_m + amplitude_m sin(2 pi along_w . p / wave_m).
struct wall {
  vec3 outward_w{0.0, 0.0, 1.0};
  double height_m = 0.0;
  double amplitude_m = 0.0;
  double wave_m = 1e-3;
  vec3 along_w{1.0, 0.0, 0.0};
  std::uint32_t body = 0;

  [[nodiscard]] double phase(const vec3& p_w) const noexcept {
    return 6.283185307179586 * glm::dot(along_w, p_w) / wave_m;
  }
  /// Depth of a point, m; negative outside.
  [[nodiscard]] double depth_m(const vec3& p_w) const noexcept {
    return height_m + amplitude_m * std::sin(phase(p_w)) - glm::dot(outward_w, p_w);
  }
  /// Derivative of the depth by the point.
  [[nodiscard]] vec3 slope(const vec3& p_w) const noexcept {
    return 6.283185307179586 * amplitude_m / wave_m * std::cos(phase(p_w)) * along_w - outward_w;
  }
};

/// Points of the probe, in its body frame about its centre of mass, against walls. Every point and every wall is a
/// support plane, gaps included. Two walls of a plate are one body: a point meets the side that it is nearer to.
/// W0 and J are springs of the same stiffness on every point that overlaps, for sessions without planes.
struct plane_body {
  std::vector<vec3> points_c{vec3(0.0)};
  double radius_m = 0.0;  ///< of a ball about each point
  std::vector<wall> walls{wall{}};
  bool plate = false;  ///< walls are the two sides of a plate

  bool reports_planes = true;
  std::size_t most_reported = 1000;                                 ///< the deepest so many
  double reported_gap_m = std::numeric_limits<double>::infinity();  ///< gaps beyond this are not told
  bool tells_known = true;                                          ///< how far the probe may go on the gaps told
  double linear_n_per_m = 5e4;                                      ///< of W0 and J
  bool linearised = true;                                           ///< false: J is dropped

  std::vector<support_plane> planes;

  [[nodiscard]] status step(const scene_pose& at, tick& out) noexcept {
    out = {};
    planes.clear();
    const vec3 c = at.T_wa.position;
    for (const vec3& point : points_c) {
      const vec3 centre = at.T_wa * point;
      const wall* met = nullptr;
      for (const wall& w : walls) {
        if (plate && met != nullptr && w.depth_m(centre) >= met->depth_m(centre)) continue;
        met = &w;
        if (!plate) report(w, centre, c);
      }
      if (plate) report(*met, centre, c);
    }
    for (const support_plane& p : planes) {
      if (p.depth_m <= 0.0) continue;
      out.force.on_probe_w += to_wrench(-linear_n_per_m * p.depth_m * p.gradient);
      if (linearised) add_outer(out.force.stiffness, -linear_n_per_m, p.gradient);
    }
    out.centre_of_mass_w = c;
    const double gaps_m = tells_known ? std::min(reported_gap_m, at.gaps_m) : reported_gap_m;
    if (reports_planes && tells_known) out.known = known(at.T_wa, gaps_m);
    if (reports_planes) out.planes = reported(gaps_m);
    return status::ok;
  }

  /// How deep the probe is in the body, m; negative: how far away.
  [[nodiscard]] double depth_m(const pose& T_wa) const {
    double deepest = -std::numeric_limits<double>::infinity();
    for (const vec3& point : points_c) {
      double here = plate ? std::numeric_limits<double>::infinity() : -std::numeric_limits<double>::infinity();
      for (const wall& w : walls) {
        const double d = w.depth_m(T_wa * point) + radius_m;
        here = plate ? std::min(here, d) : std::max(here, d);
      }
      deepest = std::max(deepest, here);
    }
    return deepest;
  }

 private:
  // As far as gaps are told, or as far as nothing is near.
  [[nodiscard]] known_motion known(const pose& T_wa, double gaps_m) const noexcept {
    double farthest_m = radius_m;
    for (const vec3& point : points_c) farthest_m = std::max(farthest_m, glm::length(point) + radius_m);
    const double way_m = std::max(gaps_m, -depth_m(T_wa));
    return {way_m, way_m / farthest_m};
  }

  void report(const wall& w, const vec3& centre, const vec3& c) noexcept {
    const double depth = w.depth_m(centre) + radius_m;
    const vec3 r = centre - radius_m * w.outward_w - c;
    const vec3 slope = w.slope(centre);
    planes.push_back({.depth_m = depth,
                      .gradient = {slope, glm::cross(r, slope)},
                      .n_ab_w = -w.outward_w,
                      .r_w = r,
                      .spread_m = 0.0,
                      .body = w.body});
  }

  [[nodiscard]] std::span<const support_plane> reported(double gaps_m) noexcept {
    std::erase_if(planes, [&](const support_plane& p) { return p.depth_m < -gaps_m; });
    if (most_reported < planes.size()) {
      std::stable_sort(planes.begin(), planes.end(),
                       [](const support_plane& a, const support_plane& b) { return a.depth_m > b.depth_m; });
      planes.resize(most_reported);
    }
    return planes;
  }
};

/// Points of the lower face of a box about its centre, n by n.
inline std::vector<vec3> lower_face(double half_x_m, double half_y_m, double half_z_m, int n) {
  std::vector<vec3> out;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      out.push_back({half_x_m * (2.0 * i / (n - 1) - 1.0), half_y_m * (2.0 * j / (n - 1) - 1.0), -half_z_m});
    }
  }
  return out;
}

/// A block of 20 mm whose lower face lies on z = 0 where its centre is at 10 mm.
inline plane_body block_on_plane() {
  plane_body b;
  b.points_c = lower_face(0.01, 0.01, 0.01, 5);
  return b;
}

/// A block over a plate from z = -thickness to 0, both sides told.
inline plane_body block_on_plate(double thickness_m) {
  plane_body b = block_on_plane();
  b.walls = {wall{}, wall{.outward_w = {0, 0, -1}, .height_m = thickness_m}};
  b.plate = true;
  return b;
}

/// Three walls that meet in the origin, solid where any coordinate is negative, and a ball.
inline plane_body ball_in_corner(double radius_m) {
  plane_body b;
  b.radius_m = radius_m;
  b.walls = {wall{.outward_w = {1, 0, 0}}, wall{.outward_w = {0, 1, 0}}, wall{.outward_w = {0, 0, 1}}};
  return b;
}

/// Two flanks that fall towards x = 0 at this slope, and a ball.
inline plane_body ball_in_groove(double radius_m, double slope) {
  plane_body b;
  b.radius_m = radius_m;
  const double g = std::sqrt(1.0 + slope * slope);
  b.walls = {wall{.outward_w = vec3(-slope, 0, 1) / g}, wall{.outward_w = vec3(slope, 0, 1) / g}};
  return b;
}

/// A peg of 6 mm by 6 mm by 10 mm in a slot along y that is `gap_m` wider on each side, with a floor at z = 0 where the
/// peg's centre is at 5 mm.
inline plane_body peg_in_slot(double gap_m) {
  constexpr double half = 0.003;
  plane_body b;
  b.points_c.clear();
  for (const double x : {-half, half}) {
    for (const double y : {-half, half}) {
      for (const double z : {-0.005, 0.005}) b.points_c.push_back({x, y, z});
    }
  }
  b.walls = {wall{.outward_w = {1, 0, 0}, .height_m = -half - gap_m},
             wall{.outward_w = {-1, 0, 0}, .height_m = -half - gap_m}, wall{}};
  return b;
}

}  // namespace asperity::test_support
