// A sharp edge of the probe across a sharp edge of a fixed body.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "asperity/cells/sharp_edges.hpp"
#include "asperity/cells/surface_cells.hpp"
#include "asperity/collision/near_cells.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/depth/cell_reading.hpp"
#include "asperity/depth/dual6.hpp"
#include "asperity/depth/shared_settings.hpp"

namespace asperity::detail {

/// Relief of a sharp edge where it is crossed, world; it turns with the probe where it is the probe's.
[[nodiscard]] inline dual3 relief_at(const surface_cells& body, const sharp_edge& e, const dual6& at,
                                     const quat& rotation, bool of_probe) noexcept {
  vec3 slope_b;
  const vec3 value_w = rotation * read_edge_relief(body, e, at.value, slope_b);
  const vec3 slope_w = rotation * slope_b;
  dual3 out = of_probe ? turning(value_w) : dual3(value_w);
  out.x.slope += slope_w.x * at.slope;
  out.y.slope += slope_w.y * at.slope;
  out.z.slope += slope_w.z * at.slope;
  return out;
}

/// Reading of two edges that cross: direction m = e_A x e_B, depth m . (a - b) with a, b the points where they cross.
///
/// It counts where both edges are the outermost of their bodies along m (both faces of each lead back), where they
/// cross within both edges, and where they are not parallel; towards each of these limits it fades, weight and depth,
/// as a cell's samples do. Only a few pairs are near in a tick, so the derivatives are carried along with the numbers.
/// @source ours. The coarse edges say where and along what; the fine surface at the crossing says how deep.
[[nodiscard]] inline cell_reading read_edges(const surface_cells& A, const pose& T_wa, const surface_cells& B,
                                             const pose& T_wb, const vec3& c_w, const near_edges& which,
                                             const shared_settings& s) noexcept {
  cell_reading out;
  out.body = which.body;
  const sharp_edge &a = A.edges[which.edge_a], &b = B.edges[which.edge_b];
  const vec3 e_a = T_wa.rotation * a.along_b, e_b = T_wb.rotation * b.along_b;
  vec3 m = glm::cross(e_a, e_b);
  const double sine = glm::length(m);
  if (!(sine > s.crossing_none)) return out;
  const vec3 faces[4] = {T_wa.rotation * a.face_b[0], T_wa.rotation * a.face_b[1], T_wb.rotation * b.face_b[0],
                         T_wb.rotation * b.face_b[1]};
  const double sign = glm::dot(faces[0] + faces[1], m) < 0.0 ? 1.0 : -1.0;
  m *= sign / sine;
  for (std::size_t f = 0; f < 4; ++f) {
    if (glm::dot(faces[f], f < 2 ? m : -m) >= s.leaving_full) return out;
  }

  // From here on with derivatives. A's edge turns with the probe; the fixed edge does not.
  const dual3 da = turning(e_a), db(e_b);
  const dual3 cross = cross_product(da, db);
  const dual6 sine_d = square_root(dot(cross, cross));
  const dual3 m_d = (dual6(sign) / sine_d) * cross;
  const dual3 from_a = moving(T_wa * a.from_b, c_w);
  const dual3 offset = from_a - dual3(T_wb * b.from_b);
  const dual6 cosine = dot(da, db), along_a = dot(offset, da), along_b = dot(offset, db);
  const dual6 scale = dual6(1.0) / (sine_d * sine_d);
  const dual6 at_a = (cosine * along_b - along_a) * scale;  // how far along each edge they cross
  const dual6 at_b = (along_b - cosine * along_a) * scale;
  const dual6 d = dot(m_d, offset) + dot(m_d, relief_at(A, a, at_a, T_wa.rotation, true)) -
                  dot(m_d, relief_at(B, b, at_b, T_wb.rotation, false));

  const double taper = std::max(A.settings.taper_m, B.settings.taper_m);
  const double limit = std::min(A.settings.depth_limit_m, B.settings.depth_limit_m);
  const dual6 ends[4] = {at_a + dual6(a.extension_m[0]), dual6(a.length_m + a.extension_m[1]) - at_a,
                         at_b + dual6(b.extension_m[0]), dual6(b.length_m + b.extension_m[1]) - at_b};
  dual6 sigma(1.0), nearness(0.0);
  for (const dual6& end : ends) {
    if (!(end.value > 0.0)) return out;
    sigma = sigma * smooth_step(dual6(2.0 / taper) * end);
    const dual6 squared = end * end;
    nearness = nearness + dual6(1.0) / (squared * squared);
  }
  if (d.value < -20.0 * s.tau_m) return out;
  if (d.value >= limit) {
    out.too_deep = true;
    return out;
  }
  dual6 fade = smooth_step((sine_d - dual6(s.crossing_none)) / dual6(s.crossing_full - s.crossing_none));
  fade = fade * smooth_step(dual6(2.0 / limit) * (dual6(limit) - d));
  for (std::size_t f = 0; f < 4; ++f) {
    const dual3 face = f < 2 ? turning(faces[f]) : dual3(-faces[f]);
    const dual6 leads_in = dot(face, m_d);
    if (leads_in.value > 0.0) fade = fade * smooth_step(dual6(1.0) - dual6(1.0 / s.leaving_full) * leads_in);
  }
  const double area = A.settings.feature_pitch_m * B.settings.feature_pitch_m;
  const dual6 weight = dual6(area) * fade * sigma;
  if (!(weight.value > 0.0)) return out;
  dual6 e = d;
  if (d.value > 0.0) {
    const dual6 squared = d * d;
    const dual6 q = fade / square_root(dual6(1.0) + squared * squared * nearness);
    e = d * (dual6(1.0) - (dual6(1.0) - q) * smooth_step(dual6(1.0 / (2.0 * s.tau_m)) * d));
  }

  out.samples = 1;
  out.n_ab_w = m;
  for (int j = 0; j < 3; ++j) {
    out.turn[j] = vec3(m_d.x.slope.angular[j], m_d.y.slope.angular[j], m_d.z.slope.angular[j]);
  }
  out.reference_m = e.value;
  out.mass = weight.value;
  out.moment = weight.value * e.value;
  out.mass_slope = weight.slope + (weight.value / s.tau_m) * e.slope;
  out.moment_slope = e.value * out.mass_slope + weight.value * e.slope;
  if (e.value > 0.0) {
    out.overlap = weight.value * e.value * e.value;
    out.overlap_slope = (e.value * e.value) * weight.slope + (2.0 * weight.value * e.value) * e.slope;
    out.area_m2 = area;
  }
  out.slope_sum = weight.value * e.slope;
  add_outer(out.slope_product, weight.value, e.slope);
  out.depth_m = e.value;
  out.witness_w = T_wa * a.from_b + at_a.value * e_a;
  out.centre_w = out.witness_w - 0.5 * d.value * m;
  return out;
}

}  // namespace asperity::detail
