// The force model for poses alone: a spring on the least motion of the probe that clears the bodies.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>

#include "asperity/core/status.hpp"
#include "asperity/field/field_scene.hpp"
#include "asperity/least_motion/exit_solver.hpp"
#include "asperity/least_motion/least_motion_settings.hpp"
#include "asperity/planes/near_plane.hpp"
#include "asperity/planes/near_samples.hpp"
#include "asperity/render/contact.hpp"
#include "asperity/render/force_model.hpp"
#include "asperity/render/penetration.hpp"

namespace asperity {

/// W = -dU/dq with U the energy of the least motion that clears, see exits::exit_solver: a function of the pose alone
/// that has a potential, held at any depth up to the middle of a body.
///
/// It needs the bodies and their poses, and no contacts: what finder and depth backend hand on is left as it is.
/// @rt safe; the cost grows with the depth and is bounded by least_motion_settings::most_readings
class least_motion {
 public:
  using policy_tag = force_tag;
  using found_type = near_samples;
  using reading_type = near_plane;

  /// @param bodies of the scene, in its order   @param ways_of what the search needs of them: force models of the same
  /// bodies can share it   @param centre_of_mass_a of the probe, its frame   @pre check(settings),
  /// ways_of->is_of(bodies)
  least_motion(const field_scene& bodies, std::shared_ptr<const exits::exit_scene> ways_of,
               const vec3& centre_of_mass_a, const least_motion_settings& settings)
      : settings_(filled_in(settings, bodies, centre_of_mass_a)),
        solver_(std::move(ways_of), centre_of_mass_a,
                {.stiffness_n_per_m = settings_.stiffness_n_per_m,
                 .onset_m = settings_.softness_m,
                 .mixed = settings_.sharpness,
                 .turn_arm_m = settings_.turn_arm_m,
                 .most_readings = settings_.most_readings,
                 .most_marks = settings_.most_samples}) {}

  /// @return ok | capacity_reached (a limit of the settings was hit; hit() says which)
  /// @rt safe
  [[nodiscard]] status accumulate(const scene_pose& at, const near_samples&, std::span<const near_plane>,
                                  contact_force& out) const noexcept {
    solver_.solve(at);
    out.on_probe_w = solver_.on_probe_w();
    out.stiffness = solver_.stiffness();
    return solver_.hit().any() ? status::capacity_reached : status::ok;
  }

  /// Of the last call, J.
  [[nodiscard]] double energy_j() const noexcept { return solver_.energy_j(); }
  /// Limits that the last call ran into.
  [[nodiscard]] const exits::exit_limits_hit& hit() const noexcept { return solver_.hit(); }
  /// Readings that the last call spent.
  [[nodiscard]] std::size_t readings() const noexcept { return solver_.readings(); }

  /// The ways out of the last call that have weight, as contacts: depth_m is how far the motion takes the
  /// deepest sample, times the weight; n_ab points against the push. A way out past several walls is one contact.
  /// @rt safe
  void describe(contact_set& contacts, std::span<penetration> depths) const noexcept {
    contacts.clear();
    for (const exits::way_out& w : solver_.ways()) {
      const double pushed_n = glm::length(w.bed.gradient.linear);
      if (!(w.weight > 0.0 && pushed_n > 0.0) || w.touching.empty()) continue;
      if (contacts.size() == depths.size()) return;
      const exits::mark* deepest = w.touching.begin();
      for (const exits::mark& m : w.touching) {
        if (m.depth_m > deepest->depth_m) deepest = &m;
      }
      const exits::posed_samples& samples = solver_.samples();
      const vec3 n_ab_w = w.bed.gradient.linear / pushed_n, point_w = samples.centre_w() + samples.lever_w(*deepest);
      penetration& d = depths[contacts.size()];
      d = {};
      d.depth_m = d.soft_depth_m = w.weight * glm::length(w.z_w + glm::cross(w.turn_w, samples.arm_w(*deepest)));
      d.gradient = {n_ab_w, glm::cross(samples.lever_w(*deepest), n_ab_w)};
      d.samples = static_cast<std::uint32_t>(w.touching.size());
      d.witness_w = point_w;
      if (solver_.hit().any()) d.flags |= depth_flag::unresolved;
      contact c;
      c.id = static_cast<std::uint32_t>(contacts.size());
      c.body = samples.meeting_of(*deepest).body;
      c.separation_m = -d.depth_m;
      c.p_a_w = c.p_b_w = c.window.centre_w = point_w;
      c.window.n_ab_w = n_ab_w;
      c.window.u_w = any_orthogonal(n_ab_w);
      c.window.v_w = glm::cross(n_ab_w, c.window.u_w);
      if (!contacts.add(c, {}, {})) return;
    }
  }

  /// With what was automatic filled in.
  [[nodiscard]] const least_motion_settings& settings() const noexcept { return settings_; }
  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(solver_); }

 private:
  // How far the body's furthest sample is from a point of it, m.
  [[nodiscard]] static double reach_from(const vec3& point_b, const field_body& body) noexcept {
    double square = 0.0;
    for (const field_sample& s : body.samples.samples()) {
      const vec3 off = vec3(s.position_b) - point_b;
      square = std::max(square, glm::dot(off, off));
    }
    return std::sqrt(square);
  }
  [[nodiscard]] static least_motion_settings filled_in(least_motion_settings s, const field_scene& bodies,
                                                       const vec3& centre_of_mass_a) noexcept {
    double texel_m = bodies.probe->field.fine.pitch_m;
    for (const field_body_ptr& b : bodies.fixed) texel_m = std::min(texel_m, b->field.fine.pitch_m);
    const contact_softness usual = softness_for(s.period_s, texel_m);
    if (!(s.softness_m > 0.0)) s.softness_m = usual.softness_m;
    if (!(s.sharpness > 0.0)) s.sharpness = usual.sharpness;
    if (!(s.turn_arm_m > 0.0)) s.turn_arm_m = 4.0 * reach_from(centre_of_mass_a, *bodies.probe);
    return s;
  }

  least_motion_settings settings_;
  mutable exits::exit_solver solver_;  // its memory; nothing of a call outlives it but for describe()
};

static_assert(force_model<least_motion>);
static_assert(describes_contacts<least_motion>);

}  // namespace asperity
