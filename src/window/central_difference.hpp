// The paper's gradient: the depth at eleven poses of the probe.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/render/contact.hpp"

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

/// The paper's ten motions of the probe: +u, -u, +v, -v across the window, then turns about +u, -u, +v, -v, +n, -n.
inline constexpr std::size_t probe_motions = 10;

/// The probe after motion `i`; turns are about origin_w. @pre i < probe_motions
[[nodiscard]] inline pose moved_probe(std::size_t i, const contact_window& window, const pose& T_wa,
                                      const vec3& origin_w, double step_m, double step_rad) noexcept {
  const std::array axes{window.u_w, window.v_w, window.u_w, window.v_w, window.n_ab_w};
  const double sign = i % 2 == 0 ? 1.0 : -1.0;
  const vec3& axis = axes[i / 2];
  if (i < 4) return {T_wa.rotation, T_wa.position + sign * step_m * axis};
  return turned(T_wa, sign * step_rad * axis, origin_w);
}

/// Depth after each motion, nothing where the patches share no sample.
using moved_depths = std::array<std::optional<double>, probe_motions>;

/// Gradient of a depth by differences of signed depths, about c_A. The component along n is 1 and is not differenced.
/// Turns were about `origin_w` and are transported to c_A: T_c = T_o + (o - c) x F.
/// @rt safe   @source paper Eqs. 5 and 7; science, section 3.1 for the point of rotation
[[nodiscard]] inline vec6 gradient_of(const moved_depths& moved, const contact_window& window,
                                      const vec3& centre_of_mass_w, const vec3& origin_w, double here_m, double step_m,
                                      double step_rad) noexcept {
  const auto slope = [&](std::size_t axis, double step) {
    return quotient(moved[2 * axis], moved[2 * axis + 1], here_m, step);
  };
  vec6 g;
  g.linear = window.n_ab_w;
  g.linear += slope(0, step_m) * window.u_w;
  g.linear += slope(1, step_m) * window.v_w;
  g.angular += slope(2, step_rad) * window.u_w;
  g.angular += slope(3, step_rad) * window.v_w;
  g.angular += slope(4, step_rad) * window.n_ab_w;
  g.angular += glm::cross(origin_w - centre_of_mass_w, g.linear);
  return g;
}

/// Both of the above. @param depth_at  depth with the probe at a pose, nothing where the patches share no sample
/// @rt as safe as depth_at
template <class DepthAt>
[[nodiscard]] vec6 central_difference(const contact_window& window, const pose& T_wa, const vec3& centre_of_mass_w,
                                      const vec3& origin_w, double here_m, double step_m, double step_rad,
                                      DepthAt depth_at) noexcept {
  moved_depths moved;
  for (std::size_t i = 0; i < probe_motions; ++i) {
    moved[i] = depth_at(moved_probe(i, window, T_wa, origin_w, step_m, step_rad));
  }
  return gradient_of(moved, window, centre_of_mass_w, origin_w, here_m, step_m, step_rad);
}

}  // namespace asperity::detail
