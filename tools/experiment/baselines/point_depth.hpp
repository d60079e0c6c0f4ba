// The depth backend of the models of one point: one texture, read at one place.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "asperity/render/depth_backend.hpp"
#include "asperity/window/window_depth_settings.hpp"
#include "baselines/point_reading.hpp"
#include "model/texture_tap.hpp"
#include "window/patch_projection.hpp"

namespace asperity::baselines {

/// Reads the fixed body's texture under one point of the probe. The probe's own texture is not read at all: that is
/// what models of one point have in common, and what they cannot mend.
/// @source paper section 2.2, of Minsky 1995, Ho et al. 1999 and Siira and Pai 1996
class point_depth {
 public:
  using policy_tag = depth_tag;
  using found_type = point_contacts;
  using reading_type = point_reading;

  /// Takes all memory that a tick needs.
  /// @param point_a  the probe's point, in its body frame: the tip of a stylus. Nothing: each contact's witness point,
  ///                 the middle of where the coarse surfaces are near.
  /// @pre the scene's models are valid
  explicit point_depth(asperity::scene scene, std::optional<vec3> point_a = std::nullopt)
      : scene_(std::move(scene)), point_a_(point_a), patch_(most_triangles(scene_)) {
    for (const model_ptr& m : scene_.fixed) bodies_.emplace_back(*m);
  }

  /// @pre contacts are of this scene at these poses
  /// @return ok | not_ready (sizes or indices do not fit); a point over no surface is told in its reading
  /// @rt safe
  [[nodiscard]] status measure(const scene_pose& at, const point_contacts& contacts,
                               std::span<point_reading> out) noexcept {
    if (out.size() < contacts.size() || at.T_wb.size() != scene_.fixed.size()) return status::not_ready;
    const vec3 centre_w = centre_of_mass_w(scene_, at.T_wa);
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const contact& c = contacts.contacts()[i];
      if (c.body >= scene_.fixed.size()) return status::not_ready;
      const vec3 point_w = point_a_ ? at.T_wa * *point_a_ : c.p_a_w;
      out[i] = read_under(point_w, at.T_wb[c.body], contacts.patch_b(c), c);
      out[i].arm_w = point_w - centre_w;
    }
    return status::ok;
  }

  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(scene_.fixed, patch_, bodies_); }

 private:
  [[nodiscard]] static std::size_t most_triangles(const asperity::scene& s) noexcept {
    std::size_t most = 0;
    for (const model_ptr& m : s.fixed) most = std::max(most, m->mesh.triangles.size());
    return most;
  }

  [[nodiscard]] point_reading read_under(const vec3& point_w, const pose& T_wb, std::span<const std::uint32_t> patch,
                                         const contact& c) noexcept {
    using namespace detail;
    const textured_model& model = *scene_.fixed[c.body];
    const surface_index& index = bodies_[c.body];
    const contact_window& window = c.window;
    const window_map map(window, T_wb);
    const vec3 from_centre = point_w - window.centre_w;
    const vec3 uvh(glm::dot(window.u_w, from_centre), glm::dot(window.v_w, from_centre),
                   glm::dot(window.n_ab_w, from_centre));
    point_reading out{.point_w = point_w, .outward_w = -window.n_ab_w};
    patch_.project(model.mesh, index, patch, map, layer::lowest, window_depth_settings{}.facing_cosine);
    for (const projected_triangle& t : patch_.triangles()) {
      if (!holds(t, uvh)) continue;
      const double coarse = t.height(uvh.x, uvh.y);
      if (out.read && uvh.z - coarse <= out.coarse_depth_m) continue;  // another sheet is met first
      const vec2 z(t.texel_x(uvh.x, uvh.y), t.texel_y(uvh.x, uvh.y));
      const surface_tap tap = read(model.texture, z);
      const vec3 normal = glm::cross(map.direction(tap.along_x), map.direction(tap.along_y));
      if (!is_finite(tap.point) || !(std::abs(normal.z) > 1e-3 * glm::length(normal))) continue;
      out.read = true;
      out.coarse_depth_m = uvh.z - coarse;
      out.relief_m = coarse - map.point(tap.point).z;
      out.relief_slope_w = direction_to_world(window, {normal.x / normal.z, normal.y / normal.z, 0.0});
    }
    return out;
  }

  // Whether a triangle lies over a point of the window.
  [[nodiscard]] static bool holds(const detail::projected_triangle& t, const vec3& at) noexcept {
    const auto side = [&](std::size_t k) {
      const vec3 &a = t.corner[k], &b = t.corner[(k + 1) % 3];
      return (b.x - a.x) * (at.y - a.y) - (b.y - a.y) * (at.x - a.x);
    };
    // A point on a shared edge belongs to both triangles, whatever rounding makes of it.
    const double s0 = side(0), s1 = side(1), s2 = side(2), border = 1e-9 * (s0 + s1 + s2);
    return border > 0.0 ? (s0 >= -border && s1 >= -border && s2 >= -border)
                        : (s0 <= -border && s1 <= -border && s2 <= -border);
  }

  asperity::scene scene_;
  std::optional<vec3> point_a_;
  detail::patch_projection patch_;
  std::vector<detail::surface_index> bodies_;
};

static_assert(depth_backend<point_depth>);

}  // namespace asperity::baselines
