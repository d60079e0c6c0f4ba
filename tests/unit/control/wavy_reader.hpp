// Points of a probe over a wavy wall that goes with its body, as a reader of planes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "asperity/control/linear_contact.hpp"
#include "asperity/render/plane_source.hpp"
#include "unit/control/plane_bodies.hpp"

namespace asperity::test_support {

/// The plane of point i has the sample i + 1.
struct wavy_reader final : plane_reader {
  wall of{};  // at its body's origin
  std::vector<vec3> points_c{vec3(0.0)};
  mutable int readings = 0;

  [[nodiscard]] support_plane plane(const pose& T_wc, const pose& T_wb, std::size_t i = 0) const noexcept {
    const vec3 p_b = inverse(T_wb) * (T_wc * points_c[i]), slope_w = T_wb.rotation * of.slope(p_b);
    const vec3 r_w = T_wc * points_c[i] - T_wc.position;
    return {.depth_m = of.depth_m(p_b),
            .gradient = {slope_w, glm::cross(r_w, slope_w)},
            .n_ab_w = slope_w / glm::length(slope_w),
            .r_w = r_w,
            .body = of.body,
            .sample = static_cast<std::uint32_t>(i + 1)};
  }
  void read(const pose& T_wc, const pose& T_wb, std::uint32_t body,
            std::span<support_plane> planes) const noexcept override {
    ++readings;
    for (support_plane& p : planes) {
      if (p.body == body && p.sample != 0) p = plane(T_wc, T_wb, p.sample - 1);
    }
  }
};

/// A contact of all points, of a body at the world's origin that can be read again.
/// @param reader outlives it
inline linear_contact contact_at(const wavy_reader& reader, const pose& T_wc) {
  linear_contact out;
  out.T_wc = T_wc;
  for (std::size_t i = 0; i < reader.points_c.size(); ++i) {
    static_cast<void>(out.planes.push_back(reader.plane(T_wc, {}, i)));
  }
  out.reader = &reader;
  static_cast<void>(out.places.push_back({0, {}, 0}));
  return out;
}

/// A renderer of the points over the wavy wall.
struct wavy_renderer {
  wavy_reader reader{};
  std::vector<support_plane> planes{};

  [[nodiscard]] status step(const scene_pose& at, tick& out) noexcept {
    out = {};
    out.centre_of_mass_w = at.T_wa.position;
    planes.clear();
    for (std::size_t i = 0; i < reader.points_c.size(); ++i) planes.push_back(reader.plane(at.T_wa, at.T_wb[0], i));
    out.planes = planes;
    out.reader = &reader;
    return status::ok;
  }
};

}  // namespace asperity::test_support
