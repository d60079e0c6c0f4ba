// What the models of one point are told: where the probe's point is, and the other body's texture under it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <utility>

#include "asperity/render/collision_finder.hpp"
#include "asperity/render/force_model.hpp"
#include "asperity/window/convex_piece_finder.hpp"

namespace asperity::baselines {

/// One contact as a model of one point knows it. World axes.
struct point_reading {
  vec3 point_w{0.0};            ///< the probe's point, on its coarse surface
  vec3 arm_w{0.0};              ///< from the probe's centre of mass to that point, m
  vec3 outward_w{0.0};          ///< unit normal of the fixed body's coarse contact: away from it
  double coarse_depth_m = 0.0;  ///< how far the point is inside the fixed body's coarse surface; negative outside
  double relief_m = 0.0;        ///< height of the fixed body's texture over its coarse surface there
  vec3 relief_slope_w{0.0};     ///< gradient of that height by the point's place in the tangent plane, m/m
  bool read = false;            ///< false: there is no surface under the point, and all else means nothing
};

/// Contacts of a finder for models of one point. The same as a contact_set; a type of its own, because what is read of
/// it is not a penetration.
struct point_contacts : contact_set {
  using contact_set::contact_set;
};

/// convex_piece_finder for models of one point.
class point_finder {
 public:
  using policy_tag = collision_tag;
  using found_type = point_contacts;

  explicit point_finder(const scene& s, const window_finder_settings& settings = {}) : finder_(s, settings) {}
  /// @rt safe
  [[nodiscard]] status find(const scene_pose& at, point_contacts& out) noexcept { return finder_.find(at, out); }
  [[nodiscard]] std::size_t heap_bytes() const noexcept { return finder_.heap_bytes(); }

 private:
  convex_piece_finder finder_;
};

/// What is common to force models of one point: a force at each contact's point, and what a report is told of it.
/// A Model has `force_at(const point_reading&)`, the force on the probe in newtons for a point that is read, and
/// `stiffness_n_per_m()`.
template <class Model>
class point_model {
 public:
  using policy_tag = force_tag;
  using found_type = point_contacts;
  using reading_type = point_reading;

  /// Adds the forces up. J is the spring's along the coarse normal alone, for all three models: how their texture
  /// forces change with the pose is no derivative of anything.
  /// @return ok | not_ready (too few readings) | not_finite; the last two leave zeros   @rt safe
  [[nodiscard]] status accumulate(const scene_pose&, const point_contacts& contacts,
                                  std::span<const point_reading> readings, force_report& out) noexcept {
    out = {};
    reported_.clear();
    if (readings.size() < contacts.size()) return status::not_ready;
    contact_force sum;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const point_reading& r = readings[i];
      if (!r.read) continue;
      const vec3 force = static_cast<const Model&>(*this).force_at(r);
      if (force == vec3(0.0)) continue;
      sum.on_probe_w += wrench{force, glm::cross(r.arm_w, force)};
      const vec3 n = -r.outward_w;
      const vec6 normal{n, glm::cross(r.arm_w, n)};
      add_outer(sum.stiffness, -static_cast<const Model&>(*this).stiffness_n_per_m(), normal);
      reported_.add(contacts.contacts()[i],
                    {.depth_m = glm::dot(force, r.outward_w) / static_cast<const Model&>(*this).stiffness_n_per_m(),
                     .gradient = normal,
                     .witness_w = r.point_w});
    }
    if (!is_finite(sum.on_probe_w)) return status::not_finite;
    out = {sum, reported_.contacts(), reported_.depths()};
    return status::ok;
  }
  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(reported_); }

 private:
  reported_contacts reported_;  // those that push
};

static_assert(collision_finder<point_finder>);

}  // namespace asperity::baselines
