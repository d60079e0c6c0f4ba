// Textured plates from height functions: a coarse slab whose top face carries any fine surface, with everything about
// its mesh and charts under the test's control.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "asperity/core/pose.hpp"
#include "asperity/model/scene.hpp"
#include "asperity/render/contact.hpp"
#include "asperity/render/penetration.hpp"

namespace asperity::test_support {

using height_function = std::function<double(double x, double y)>;

/// A slab with its top face along +z. Lengths in metres.
struct plate_spec {
  double half_x = 0.01, half_y = 0.01, thickness = 0.01;
  std::uint32_t cells_x = 1, cells_y = 1;  ///< quads of the top face, two triangles each
  bool disc = false;                       ///< instead of quads: a fan about the centre, half_x its radius
  std::uint32_t texels = 256;              ///< per side of the top face, all its charts together
  bool chart_per_cell = false;             ///< cut the top's chart at every quad, gutters between
  height_function height;                  ///< fine surface; empty: the plane z = 0
  height_function coarse_height;           ///< coarse vertices of the top; empty: z = 0
  pose T_body_plate;                       ///< where the slab is in the body frame
  vec3 centre_of_mass{0.0, 0.0, -0.005};   ///< plate frame
};

/// Texels around every chart of a plate.
inline constexpr std::uint32_t plate_gutter = 2;

[[nodiscard]] model_ptr make_plate(const plate_spec& spec);

/// Every triangle of a model: the largest patch there is.
[[nodiscard]] inline std::vector<std::uint32_t> all_triangles(const textured_model& m) {
  std::vector<std::uint32_t> out(m.mesh.triangles.size());
  for (std::uint32_t i = 0; i < out.size(); ++i) out[i] = i;
  return out;
}

/// Window with n straight down, for a probe that stands on something.
[[nodiscard]] inline contact_window window_downwards(double half_size_m, const vec3& centre_w = vec3(0.0)) {
  contact_window w;
  w.centre_w = centre_w;
  w.u_w = {1.0, 0.0, 0.0};
  w.v_w = {0.0, -1.0, 0.0};
  w.n_ab_w = {0.0, 0.0, -1.0};
  w.half_size_m = half_size_m;
  return w;
}

/// Half a turn about x: brings a plate's top face down, so that it can be the probe.
[[nodiscard]] inline quat face_down() { return {0.0, 1.0, 0.0, 0.0}; }

/// The one contact that covers both bodies whole.
[[nodiscard]] inline contact_set whole_contact(const scene& s, const contact_window& w) {
  const auto a = all_triangles(*s.probe), b = all_triangles(*s.fixed[0]);
  contact_set out({.contacts = 4, .triangles = a.size() + b.size()});
  contact c;
  c.window = w;
  static_cast<void>(out.add(c, a, b));
  return out;
}

/// Depth of the one contact that covers both bodies whole, fixed bodies at the origin.
template <class Backend>
[[nodiscard]] penetration measure_whole(Backend& backend, const scene& s, const contact_window& w, const pose& T_wa) {
  const contact_set contacts = whole_contact(s, w);
  const std::vector<pose> T_wb(s.fixed.size());
  penetration out;
  static_cast<void>(backend.measure({T_wa, T_wb}, contacts, std::span(&out, 1)));
  return out;
}

/// Largest entry of a penetration's gradient and curvature.
[[nodiscard]] inline double largest_entry(const penetration& p) {
  double worst = 0.0;
  for (std::size_t i = 0; i < 6; ++i) worst = std::max(worst, std::fabs(p.gradient[i]));
  for (const double x : p.curvature.m) worst = std::max(worst, std::fabs(x));
  return worst;
}

/// The probe moved by q = (translation of its centre of mass; rotation about it), world axes.
[[nodiscard]] inline pose moved(const pose& T_wa, const vec3& centre_w, const vec6& q) {
  const quat turn = exp_rotation(q.angular);
  return {glm::normalize(turn * T_wa.rotation), centre_w + q.linear + turn * (T_wa.position - centre_w)};
}

}  // namespace asperity::test_support
