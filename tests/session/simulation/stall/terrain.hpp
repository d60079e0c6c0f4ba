// A surface of hills in closed form: what is linearised about one place is wrong a little way on.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "asperity/control/contact_loop.hpp"

namespace asperity::simulation {

/// Three points of the probe, in its body frame about the centre of mass, against z = height(x, y). Each is a spring
/// along the surface's gradient with a third of the stiffness.
struct terrain {
  double stiffness_n_per_m = 2000.0;
  double arm_m = 0.0;    ///< distance of the points from the centre of mass
  double hill_m = 0.0;   ///< amplitude; 0 is a plane
  double wave_m = 0.05;  ///< length of the hills

  std::array<contact, 3> contacts{};
  std::array<penetration, 3> depths{};

  [[nodiscard]] status step(const scene_pose& at, tick& out) noexcept {
    out = {};
    for (std::size_t i = 0; i < 3; ++i) {
      const double angle = 2.0943951023931953 * static_cast<double>(i);
      const vec3 r = at.T_wa.rotation * vec3(arm_m * std::cos(angle), arm_m * std::sin(angle), 0.0);
      feel(at.T_wa.position + r, r, out, i);
    }
    out.centre_of_mass_w = at.T_wa.position;
    out.contacts = contacts;
    out.depths = depths;
    return status::ok;
  }

 private:
  void feel(const vec3& p, const vec3& r, tick& out, std::size_t i) noexcept {
    const double w = 6.283185307179586 / wave_m;
    const double height = hill_m * std::sin(w * p.x) * std::cos(w * p.y);
    const vec3 up{-hill_m * w * std::cos(w * p.x) * std::cos(w * p.y),
                  hill_m * w * std::sin(w * p.x) * std::sin(w * p.y), 1.0};
    const double depth = height - p.z;
    contacts[i] = {};
    contacts[i].window.n_ab_w = -glm::normalize(up);
    depths[i] = {};
    if (depth <= 0.0) return;
    depths[i].depth_m = depth / glm::length(up);
    const double k = stiffness_n_per_m / 3.0 / glm::dot(up, up);
    const vec6 g{-up, glm::cross(r, -up)};
    out.force.on_probe_w += to_wrench(-k * depth * g);
    add_outer(out.force.stiffness, -k, g);
  }
};

}  // namespace asperity::simulation
