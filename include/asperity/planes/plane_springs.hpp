// A spring per direction, on its deepest support plane: what a tick of the field formulation tells of its force.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>

#include "asperity/core/fixed_vector.hpp"
#include "asperity/core/math.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/core/status.hpp"
#include "asperity/planes/near_plane.hpp"
#include "asperity/planes/near_samples.hpp"
#include "asperity/render/contact.hpp"
#include "asperity/render/force_model.hpp"
#include "asperity/render/penetration.hpp"

namespace asperity {

/// Settings of plane_springs.
struct plane_spring_settings {
  double stiffness_n_per_m = 50'000.0;  ///< of every direction
  double same_direction = 0.82;         ///< cosine between n_ab of two planes above which they share a spring
};

/// Says which setting is out of range and what would do.
[[nodiscard]] inline result<void> check(const plane_spring_settings& s) {
  const auto bad = [](std::string what) { return error{error_code::invalid_argument, "plane springs: " + what}; };
  if (!(std::isfinite(s.stiffness_n_per_m) && s.stiffness_n_per_m >= 0.0)) {
    return bad("stiffness_n_per_m must be a finite number, 0 or more");
  }
  if (!(s.same_direction > 0.0 && s.same_direction < 1.0)) {
    return bad("same_direction must be a cosine between 0 and 1");
  }
  return {};
}

/// Wrench of the deepest support plane of each direction, W = -sum of k depth gradient.
///
/// The probe of a control loop stays at the surface, and there this is the force to first order. It is no potential:
/// where the deepest plane changes the torque steps. What a hand feels comes from the planes themselves, which the
/// device thread holds the probe by; for a force as a function of the pose alone there is least_motion.
class plane_springs {
 public:
  using policy_tag = force_tag;
  using found_type = near_samples;
  using reading_type = near_plane;

  explicit plane_springs(const plane_spring_settings& settings = {}) noexcept : settings_(settings) {}

  /// @return ok
  /// @rt safe
  [[nodiscard]] status accumulate(const near_samples&, std::span<const near_plane> planes,
                                  contact_force& out) const noexcept {
    out = {};
    group(planes);
    for (const near_plane& deepest : deepest_) {
      const support_plane& p = deepest.plane;
      if (!(p.depth_m > 0.0)) continue;
      out.on_probe_w += to_wrench((-settings_.stiffness_n_per_m * p.depth_m) * p.gradient);
      add_outer(out.stiffness, -settings_.stiffness_n_per_m, p.gradient);
    }
    return status::ok;
  }

  /// The directions of the last accumulate() as contacts, the deepest first; gaps within reach are among them.
  /// @rt safe
  void describe(contact_set& contacts, std::span<penetration> depths) const noexcept {
    contacts.clear();
    for (const near_plane& deepest : deepest_) {
      const support_plane& p = deepest.plane;
      if (contacts.size() == depths.size()) return;
      penetration& d = depths[contacts.size()];
      d = {};
      d.depth_m = d.soft_depth_m = p.depth_m;
      d.gradient = p.gradient;
      d.samples = 1;
      d.witness_w = deepest.point_w;
      contact c;
      c.id = static_cast<std::uint32_t>(contacts.size());
      c.body = p.body;
      c.separation_m = -p.depth_m;
      c.p_a_w = c.p_b_w = c.window.centre_w = deepest.point_w;
      c.window.n_ab_w = p.n_ab_w;
      c.window.u_w = any_orthogonal(p.n_ab_w);
      c.window.v_w = glm::cross(p.n_ab_w, c.window.u_w);
      if (!contacts.add(c, {}, {})) return;
    }
  }

  [[nodiscard]] const plane_spring_settings& settings() const noexcept { return settings_; }

 private:
  static constexpr std::size_t most_directions = 16;

  void group(std::span<const near_plane> planes) const noexcept {
    deepest_.clear();
    for (;;) {
      const near_plane* best = nullptr;
      for (const near_plane& p : planes) {
        if (!std::isfinite(p.plane.depth_m) || (best != nullptr && !(p.plane.depth_m > best->plane.depth_m))) continue;
        const bool known = std::any_of(deepest_.begin(), deepest_.end(), [&](const near_plane& g) {
          return g.plane.body == p.plane.body && glm::dot(g.plane.n_ab_w, p.plane.n_ab_w) >= settings_.same_direction;
        });
        if (!known) best = &p;
      }
      if (best == nullptr || !deepest_.push_back(*best)) return;
    }
  }

  plane_spring_settings settings_;
  mutable fixed_vector<near_plane, most_directions> deepest_;  // of the last accumulate(), for describe()
};

static_assert(force_model<plane_springs>);
static_assert(describes_contacts<plane_springs>);

}  // namespace asperity
