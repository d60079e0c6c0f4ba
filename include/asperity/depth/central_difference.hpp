// The paper's gradient: the depth at eleven poses of the probe.
#pragma once

#include <array>
#include <optional>

#include "asperity/collision/contact.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"

namespace asperity::detail {

/// A body at T_wa after a turn by the rotation vector phi_w about the world point `about_w`.
[[nodiscard]] inline pose turned(const pose& T_wa, const vec3& phi_w, const vec3& about_w) noexcept {
  const quat turn = exp_rotation(phi_w);
  return {glm::normalize(turn * T_wa.rotation), about_w + turn * (T_wa.position - about_w)};
}

/// Difference quotient from what is known: two-sided, one-sided where one side does not overlap, 0 where neither does.
[[nodiscard]] inline double quotient(const std::optional<double>& plus, const std::optional<double>& minus, double here,
                                     double step) noexcept {
  if (plus && minus) return (*plus - *minus) / (2.0 * step);
  if (plus) return (*plus - here) / step;
  if (minus) return (here - *minus) / step;
  return 0.0;
}

/// Gradient of a depth by differences of signed depths, about c_A. The component along n is 1 and is not differenced.
/// Rotations are taken about `origin_w` and transported to c_A: T_c = T_o + (o - c) x F.
/// @param depth_at  depth with the probe at a pose, nothing where the patches share no sample
/// @rt as safe as depth_at   @source paper Eqs. 5 and 7; spec section 3.1 for the point of rotation
template <class DepthAt>
[[nodiscard]] vec6 central_difference(const contact_window& window, const pose& T_wa, const vec3& centre_of_mass_w,
                                      const vec3& origin_w, double here_m, double step_m, double step_rad,
                                      DepthAt depth_at) noexcept {
  const auto shifted = [&](const vec3& d) { return depth_at(pose{T_wa.rotation, T_wa.position + d}); };
  const auto rotated = [&](const vec3& phi) { return depth_at(turned(T_wa, phi, origin_w)); };
  vec6 g;
  g.linear = window.n_ab_w;
  for (const vec3& axis : {window.u_w, window.v_w}) {
    g.linear += quotient(shifted(step_m * axis), shifted(-step_m * axis), here_m, step_m) * axis;
  }
  for (const vec3& axis : {window.u_w, window.v_w, window.n_ab_w}) {
    g.angular += quotient(rotated(step_rad * axis), rotated(-step_rad * axis), here_m, step_rad) * axis;
  }
  g.angular += glm::cross(origin_w - centre_of_mass_w, g.linear);
  return g;
}

}  // namespace asperity::detail
