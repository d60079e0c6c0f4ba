// From a cluster of close pairs to a contact: window, patches and witness points.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "asperity/core/memory.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/render/contact.hpp"
#include "asperity/window/convex_piece_finder.hpp"
#include "window/clustering.hpp"
#include "window/collision_body.hpp"
#include "window/held_contact.hpp"
#include "window/patch_window.hpp"

namespace asperity {

/// Builds one contact at a time and keeps its patches until the next.
///
/// Rules, with t the tolerance, s the cluster's separation along n and d = max(-s, 0):
/// - A triangle faces the contact where n . N_A > 0.1 or n . N_B < -0.1.
/// - Region: facing triangles over the places where the cluster's pairs are near each other, cut to heights no more
///   than t - s behind the witness height (the surfaces are closer than t only there) and 2 t + d beyond it. The boxes
///   of A's and B's part along u and v are intersected.
/// - Window: the square about the region's centre, 5 % larger than its longer side, within the size limits. It moves
///   continuously with the pose while the cluster keeps its pieces and even where the witness points jump.
/// - Patch: every facing triangle of the body, of any piece, that may reach into the window grown by a tenth
///   (gradients move A a little) and whose heights come within 2 t + 2 d of the window's centre. Sheets further off,
///   and the far side of a thin part, stay out.
/// - Witness points: over the middle of the place where both surfaces are within t / 20 of their extreme height in the
///   region; a tie between parallel faces gives the middle of their overlap, not one of its corners.
class contact_builder {
 public:
  contact_builder(std::size_t triangles_a, std::size_t triangles_b) {
    detail::reserve_resident(patch_a_, triangles_a);
    detail::reserve_resident(patch_b_, triangles_b);
  }

  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(patch_a_, patch_b_); }

  /// Fills window, witness points and separation; out.window.u_w must hold the wanted axis, orthogonal to n_w.
  /// @return false where a body has no facing triangle in the window: there is no contact
  /// @rt safe
  bool build(const collision_body& a, const collision_body& b, const pose& T_wa, const pose& T_wb,
             const window_finder_settings& limits, std::span<const close_pair> pairs,
             std::span<const std::uint32_t> members, const pair_cluster& cluster, contact& out) noexcept {
    place_window(T_wa, cluster, out.window);
    const window_projection onto_a(out.window, T_wa);
    plane_box near;
    // Presence is relative to the nearest pair's, so that a contact that is new as a whole counts in full at once.
    double presence = 0.0;
    for (const std::uint32_t m : members) presence = std::max(presence, pairs[m].presence);
    for (const std::uint32_t m : members) near.add(onto_a, pairs[m].region, pairs[m].presence / presence);
    return complete(a, b, T_wa, T_wb, limits, near, cluster, out);
  }

  /// The same for a contact whose direction is held; its extent takes the place of the pairs' regions.
  /// @rt safe
  bool build(const collision_body& a, const collision_body& b, const pose& T_wa, const pose& T_wb,
             const window_finder_settings& limits, const held_contact& held, contact& out) noexcept {
    const pair_cluster cluster = held.cluster(T_wa, T_wb);
    place_window(T_wa, cluster, out.window);
    return complete(a, b, T_wa, T_wb, limits, held.near(out.window, T_wa, T_wb), cluster, out);
  }

  /// Patches of the last contact that was built.
  [[nodiscard]] std::span<const std::uint32_t> patch_a() const noexcept { return patch_a_; }
  [[nodiscard]] std::span<const std::uint32_t> patch_b() const noexcept { return patch_b_; }
  /// Extent of the last contact that was built, in its window's plane.
  [[nodiscard]] const plane_box& near() const noexcept { return near_; }

 private:
  static constexpr double facing_limit = 0.1;  // science, section 2
  static constexpr double least_share = 0.05;  // of the tolerance: thinnest slab that still has an extent

  static void place_window(const pose& T_wa, const pair_cluster& cluster, contact_window& w) noexcept {
    w.n_ab_w = T_wa.rotation * cluster.n_ab;
    w.v_w = glm::cross(w.n_ab_w, w.u_w);
    w.centre_w = T_wa * cluster.place;
  }

  /// @param near  where the bodies are near each other, about out.window's centre so far
  bool complete(const collision_body& a, const collision_body& b, const pose& T_wa, const pose& T_wb,
                const window_finder_settings& limits, plane_box near, const pair_cluster& cluster,
                contact& out) noexcept {
    const double tolerance = limits.tolerance_m;
    contact_window& w = out.window;
    const double foot = glm::dot(cluster.n_ab, cluster.place);
    const double height_a = cluster.height_a_m - foot;
    const double height_b = cluster.height_b_m - foot;
    const double separation = height_b - height_a;
    const double depth = std::max(-separation, 0.0);
    const double behind = std::max(tolerance - separation, least_share * tolerance);
    const double beyond = 2.0 * tolerance + depth;

    const window_projection onto_a(w, T_wa);
    const window_projection onto_b(w, T_wb);
    near = intersection(near, plane_box::square(vec2(0.0), limits.max_half_size_m));
    const plane_box region_a = cut_region(a, onto_a, 1.0, {height_a - behind, height_a + beyond}, near, patch_a_);
    const plane_box region_b = cut_region(b, onto_b, -1.0, {height_b - beyond, height_b + behind}, near, patch_b_);
    plane_box region = intersection(region_a, region_b);
    vec2 centre = vec2(onto_a(0.5 * (cluster.p_a + cluster.p_b)));
    w.half_size_m = limits.min_half_size_m;
    if (!region.empty()) {
      centre = region.centre();
      w.half_size_m = std::clamp(1.05 * region.half_side(), limits.min_half_size_m, limits.max_half_size_m);
      region = {region.low - centre, region.high - centre};
    }
    near_ = {near.low - centre, near.high - centre};
    w.centre_w += centre.x * w.u_w + centre.y * w.v_w + 0.5 * (height_a + height_b) * w.n_ab_w;

    const window_projection to_a(w, T_wa);
    const window_projection to_b(w, T_wb);
    const height_slab slab{-2.0 * (tolerance + depth), 2.0 * (tolerance + depth)};
    const plane_box reach = plane_box::square(vec2(0.0), 1.1 * w.half_size_m);
    collect(a, to_a, 1.0, slab, reach, patch_a_);
    collect(b, to_b, -1.0, slab, reach, patch_b_);
    if (patch_a_.empty() || patch_b_.empty()) return false;

    if (region.empty() || !find_witness(a, b, to_a, to_b, slab, region, least_share * tolerance, out)) {
      out.p_a_w = T_wa * cluster.p_a;
      out.p_b_w = T_wa * cluster.p_b;
    }
    out.separation_m = glm::dot(out.p_b_w - out.p_a_w, w.n_ab_w);
    return true;
  }

  static std::array<vec3, 3> projected(const collision_body& body, std::size_t t,
                                       const window_projection& to) noexcept {
    return to(corners(body.model->mesh, t));
  }

  /// Box of a body's facing surface within a slab and a rectangle; `scratch` is overwritten.
  static plane_box cut_region(const collision_body& body, const window_projection& to, double side,
                              const height_slab& slab, const plane_box& near,
                              std::vector<std::uint32_t>& scratch) noexcept {
    plane_box region;
    collect(body, to, side, slab, near, scratch);
    for (const std::uint32_t t : scratch) {
      for (const vec3& p : clip(projected(body, t, to), slab, near)) region.add(p);
    }
    return region;
  }

  /// Facing triangles that may reach into a slab over a rectangle.
  static void collect(const collision_body& body, const window_projection& to, double side, const height_slab& slab,
                      const plane_box& reach, std::vector<std::uint32_t>& patch) noexcept {
    patch.clear();
    const mat3 back = glm::transpose(to.to_uvh);
    const vec3 low(reach.low, slab.low);
    const vec3 high(reach.high, slab.high);
    const vec3 centre = back * (0.5 * (low + high) - to.offset);
    const vec3 size = 0.5 * (high - low);
    const vec3 extent = glm::abs(back[0]) * size.x + glm::abs(back[1]) * size.y + glm::abs(back[2]) * size.z;
    body.triangle_tree.query({centre - extent, centre + extent}, [&](std::uint32_t t) {
      if (side * to.along_n(body.triangle_normals[t]) <= facing_limit) return;
      if (may_reach(projected(body, t, to), slab, reach)) patch.push_back(t);
    });
  }

  /// Extreme height of a patch over the region and the box of what lies within `thin` of it.
  static plane_box extreme_place(const collision_body& body, std::span<const std::uint32_t> patch,
                                 const window_projection& to, double side, const height_slab& slab,
                                 const plane_box& region, double thin) noexcept {
    double top = -std::numeric_limits<double>::infinity();
    for (const std::uint32_t t : patch) {
      for (const vec3& p : clip(projected(body, t, to), slab, region)) top = std::max(top, side * p.z);
    }
    plane_box place;
    if (!std::isfinite(top)) return place;
    const height_slab cap = side > 0.0 ? height_slab{top - thin, slab.high} : height_slab{slab.low, thin - top};
    for (const std::uint32_t t : patch) {
      const auto uvh = projected(body, t, to);
      if (std::max({side * uvh[0].z, side * uvh[1].z, side * uvh[2].z}) < top - thin) continue;
      for (const vec3& p : clip(uvh, cap, region)) place.add(p);
    }
    return place;
  }

  /// The outermost point of a patch over a point of the window plane.
  static bool surface_over(const collision_body& body, std::span<const std::uint32_t> patch,
                           const window_projection& to, double side, const vec2& at, double& height) noexcept {
    bool found = false;
    for (const std::uint32_t t : patch) {
      double h = 0.0;
      if (!height_over(projected(body, t, to), at, h)) continue;
      if (!found || side * h > side * height) height = h;
      found = true;
    }
    return found;
  }

  bool find_witness(const collision_body& a, const collision_body& b, const window_projection& to_a,
                    const window_projection& to_b, const height_slab& slab, const plane_box& region, double thin,
                    contact& out) const noexcept {
    const plane_box place = intersection(extreme_place(a, patch_a_, to_a, 1.0, slab, region, thin),
                                         extreme_place(b, patch_b_, to_b, -1.0, slab, region, thin));
    if (place.empty()) return false;
    const vec2 at = place.centre();
    double height_a = 0.0, height_b = 0.0;
    if (!surface_over(a, patch_a_, to_a, 1.0, at, height_a) || !surface_over(b, patch_b_, to_b, -1.0, at, height_b)) {
      return false;
    }
    const contact_window& w = out.window;
    const vec3 foot = w.centre_w + at.x * w.u_w + at.y * w.v_w;
    out.p_a_w = foot + height_a * w.n_ab_w;
    out.p_b_w = foot + height_b * w.n_ab_w;
    return true;
  }

  std::vector<std::uint32_t> patch_a_, patch_b_;
  plane_box near_;
};

}  // namespace asperity
