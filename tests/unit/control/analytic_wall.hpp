// A renderer whose answers are known in closed form: the probe is a set of points, the fixed body a half space z < 0.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "asperity/control/contact_loop.hpp"

namespace asperity::test_support {

/// Three points of the probe, in its body frame about the centre of mass, against the plane z = 0 (overlap where z <
/// 0). n_ab = (0, 0, -1). Each point is a linear spring along n with a third of the stiffness; slope_x tilts the force,
/// as one flank of a texture does.
struct analytic_wall {
  double stiffness_n_per_m = 2000.0;
  double arm_m = 0.0;      ///< distance of the points from the centre of mass
  bool linearised = true;  ///< false: only the wrench is reported, so that the device thread holds it
  vec3 centre_of_mass_a{0.0};
  status answer = status::ok;

  std::array<contact, 3> contacts{};
  std::array<penetration, 3> depths{};

  [[nodiscard]] status step(const scene_pose& at, tick& out) noexcept {
    out = {};
    if (answer != status::ok) return answer;
    const vec3 n{0.0, 0.0, -1.0};
    const vec3 c = at.T_wa * centre_of_mass_a;
    const double k = stiffness_n_per_m / 3.0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double angle = 2.0943951023931953 * static_cast<double>(i);
      const vec3 r = at.T_wa.rotation * vec3(arm_m * std::cos(angle), arm_m * std::sin(angle), 0.0);
      const double depth = -(c.z + r.z);
      contacts[i] = {};
      contacts[i].window.n_ab_w = n;
      depths[i] = {};
      depths[i].depth_m = depth;
      if (depth <= 0.0) continue;
      const vec6 g{n, glm::cross(r, n)};
      out.force.on_probe_w += to_wrench(-k * depth * g);
      if (linearised) add_outer(out.force.stiffness, -k, g);
    }
    out.centre_of_mass_w = c;
    out.contacts = contacts;
    out.depths = depths;
    return status::ok;
  }
};

}  // namespace asperity::test_support
