// The scenes on which contacts of many kinds come and go, and the path of the probe through each.
#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "asperity/core/pose.hpp"
#include "polyhedra.hpp"

namespace asperity::contacts_test {

inline constexpr double mm = 1e-3;

/// Two bodies and the pose of the probe over a path parameter from 0 to 1; the fixed body's frame is the world.
struct contact_scene {
  std::string name;
  polyhedron probe, fixed;
  std::function<pose(double)> path;
  double lever_m = 10.0 * mm;  ///< what a radian of the probe counts as motion
  bool probe_is_convex = true;
};

[[nodiscard]] inline pose pose_mm(const vec3& position_mm, const vec3& rotation = vec3(0.0)) {
  return {exp_rotation(rotation), mm * position_mm};
}

/// Scale a list of points given in millimetres.
[[nodiscard]] inline std::vector<vec2> outline_mm(std::vector<vec2> points) {
  for (vec2& p : points) p *= mm;
  return points;
}

/// Block about the origin with these half extents, mm.
[[nodiscard]] inline polyhedron block_mm(double x, double y, double z) {
  return box(-mm * vec3(x, y, z), mm * vec3(x, y, z));
}

[[nodiscard]] inline polyhedron slab() { return box(mm * vec3(-30, -30, -10), mm * vec3(30, 30, 0)); }

/// A face on a larger face, turning and tilting a little.
[[nodiscard]] inline contact_scene slide() {
  return {"slide", block_mm(10, 10, 5), slab(), [](double t) {
            return pose_mm({-6 + 12.5 * t, 1.3 + 3 * t, 4.7},
                           {0.001 * std::sin(9 * t), 0.0012 * std::cos(7 * t), 0.05 * t});
          }};
}

/// The same until the last edge has left the slab.
[[nodiscard]] inline contact_scene slide_off() {
  return {"slide-off", block_mm(10, 10, 5), slab(), [](double t) {
            return pose_mm({15 + 25 * t, 2, 4.6}, {0.004, 0.006, 0.1});
          }};
}

/// From one bottom edge over the face to the other: 0.4 mm deep on an edge, 0.3 mm on the face. The root makes the path
/// itself smooth where the edge changes.
[[nodiscard]] inline contact_scene rocking() {
  return {"rocking flat", block_mm(10, 10, 5), slab(), [](double t) {
            const double a = -0.2 + 0.4 * t, s = std::sin(a);
            return pose_mm({1.3, 0.7, 5 * std::cos(a) + 10 * std::sqrt(s * s + 1e-4) - 0.4}, {0, a, 0});
          }};
}

/// Tipped about a bottom edge, 0.4 mm deep, from where the bottom face nearly lies on the slab to where it no longer
/// faces it.
[[nodiscard]] inline contact_scene tipping() {
  return {"tipping", block_mm(10, 10, 5), slab(), [](double t) {
            const double a = 0.3 + 0.6 * t;
            return pose_mm({1.3, 0.7, 5 * std::cos(a) + 10 * std::sin(a) - 0.4}, {0, a, 0.1 * t});
          }};
}

/// Pressed on floor and two walls one after the other.
[[nodiscard]] inline contact_scene concave_corner() {
  return {"concave corner", block_mm(8, 8, 5), hollow_corner(20 * mm, 5 * mm), [](double t) {
            return pose_mm({8 - 0.3 * smoothstep(3 * t) + 0.05 * std::sin(20 * t),
                            8 - 0.3 * smoothstep(3 * t - 0.8) + 0.06 * std::sin(23 * t),
                            5 - 0.3 * smoothstep(3 * t - 1.6) + 0.05 * std::cos(17 * t)},
                           {0.01 * std::sin(11 * t), 0.012 * std::cos(13 * t), 0.015 * std::sin(7 * t)});
          }};
}

/// A right-angled edge rocking in a groove of 100 degrees, while sliding along it.
[[nodiscard]] inline contact_scene v_groove() {
  const double rise = 20.0 / std::tan(50.0 * std::numbers::pi / 180.0);
  return {"V groove", block_mm(8, 8, 5),
          prism(outline_mm({{-20, -5}, {20, -5}, {20, rise}, {0, 0}, {-20, rise}}), -30 * mm, 30 * mm), [](double t) {
            const double b = 0.25 * std::numbers::pi + 0.1 * std::sin(8 * t);
            return pose_mm({5 * std::sin(b) - 8 * std::cos(b) + 0.3 * std::sin(9 * t), -5 + 12.5 * t,
                            8 * std::sin(b) + 5 * std::cos(b) - 0.35},
                           {0.01 * std::sin(5 * t), b, 0});
          }};
}

/// A sixteen-sided peg wobbling in a sixteen-sided hole, a quarter of a millimetre wider.
[[nodiscard]] inline contact_scene peg_in_hole() {
  contact_scene s{"peg in hole", prism(regular_polygon(16, 6 * mm), -12 * mm, 12 * mm),
                  tube(regular_polygon(16, 6.25 * mm), regular_polygon(16, 12.5 * mm), -10 * mm, 0.0), [](double t) {
                    return pose_mm(
                        {0.35 * std::cos(6 * t) + 0.05 * std::sin(20 * t), 5 - 6 * t, 0.35 * std::sin(6 * t)},
                        {0.03 * std::sin(9 * t), 0.2 * t, 0.03 * std::cos(7 * t)});
                  }};
  s.lever_m = 6 * mm;
  return s;
}

/// Along a wall that is touched now and then.
[[nodiscard]] inline contact_scene graze() {
  return {"graze", block_mm(10, 10, 5),
          prism(outline_mm({{-30, -10}, {30, -10}, {30, 12}, {12, 12}, {12, 0}, {-30, 0}}), -30 * mm, 30 * mm),
          [](double t) {
            return pose_mm({1.95 + 0.12 * std::sin(5 * t), -6 + 12.5 * t, 4.75}, {0, 0, 0.01 * std::sin(7 * t)});
          }};
}

/// Two right-angled edges across each other; the probe's presses on the slab's and slides along it.
[[nodiscard]] inline contact_scene edge_on_edge() {
  return {"edge on edge", block_mm(8, 8, 5), box(mm * vec3(-10, -30, -10), mm * vec3(10, 30, 0)), [](double t) {
            const double quarter = 0.25 * std::numbers::pi;
            const double from_edge = (8 + 5) / std::numbers::sqrt2 - 0.2 - 0.6 * std::sin(std::numbers::pi * t);
            const vec3 n = glm::normalize(vec3(1, 0, 1));
            const vec3 p = vec3(10, -2 + 6 * t, 0) + from_edge * n;
            return pose{exp_rotation({0, quarter, 0}) * exp_rotation({quarter, 0, 0}), mm * p};
          }};
}

/// A block with a step over trapezoidal ridges: faces, edges and corners in all directions at once.
[[nodiscard]] inline contact_scene stepped_block() {
  std::vector<vec2> ridges{{-32, -5}, {32, -5}};
  for (int i = 3; i >= -4; --i) {
    ridges.insert(ridges.end(), {{8.0 * i + 8, 0}, {8.0 * i + 6, 2}, {8.0 * i + 2, 2}});
  }
  ridges.emplace_back(-32, 0);
  contact_scene s{"stepped block",
                  prism(outline_mm({{-10, -4}, {-4, -4}, {-4, -7}, {4, -7}, {4, -4}, {10, -4}, {10, 4}, {-10, 4}}),
                        -10 * mm, 10 * mm),
                  prism(outline_mm(ridges), -30 * mm, 30 * mm), [](double t) {
                    return pose_mm({-6 + 12.5 * t, 1 + 2 * t, 8.6 + 0.35 * std::sin(6 * t)},
                                   {0.02 * std::sin(7 * t), 0.05 * std::sin(5 * t), 0.1 + 0.1 * t});
                  }};
  s.probe_is_convex = false;
  return s;
}

[[nodiscard]] inline std::vector<contact_scene> all_scenes() {
  return {slide(),    slide_off(),   rocking(), tipping(),      concave_corner(),
          v_groove(), peg_in_hole(), graze(),   edge_on_edge(), stepped_block()};
}

}  // namespace asperity::contacts_test
