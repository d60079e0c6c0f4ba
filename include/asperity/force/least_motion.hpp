// The force model for poses alone: a spring on the least motion of the probe that clears the bodies.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "asperity/collision/contact.hpp"
#include "asperity/collision/near_samples.hpp"
#include "asperity/core/status.hpp"
#include "asperity/depth/near_plane.hpp"
#include "asperity/depth/penetration.hpp"
#include "asperity/exits/exit_solver.hpp"
#include "asperity/field/field_scene.hpp"
#include "asperity/force/concept.hpp"

namespace asperity {

/// Settings of least_motion.
struct least_motion_settings {
  double stiffness_n_per_m = 2000.0;  ///< k: of a contact, however many samples touch
  /// Over about this depth a contact's stiffness comes up to k, m. 0: softness_for() the period and the bodies' texels.
  double softness_m = 0.0;
  /// Where ways out compete, as on a ridge, the force turns from one to the other by at most this many times k per
  /// metre. At least 2. 0: softness_for() the period.
  double sharpness = 0.0;
  /// Ways out turn as well, on a spring of k times the square of this, m: what is wedged, or rocks on a face, is let
  /// out by a turn about where the bodies are close. The shorter, the softer a contact beside that place. 0: four times
  /// the way from the probe's centre of mass to its furthest point.
  double turn_arm_m = 0.0;
  double period_s = 1e-3;  ///< of the loop that asks, for what is automatic
  /// Readings of fields, or of their bounds, that a tick may spend; a reading takes 50 to 100 ns. Where they do not do,
  /// ways out may be missing: the tick answers capacity_reached. Nearly all contacts take less than 100,000;
  /// interlocked relief of whole faces takes a million.
  std::size_t most_readings = 2'000'000;
  std::size_t most_samples = 32'768;  ///< that may touch at one way out
};

/// How soft contacts are: see least_motion_settings.
struct contact_softness {
  double softness_m = 0.0;
  double sharpness = 0.0;
};

/// What a loop of this period can follow: a hand of 50 mm/s covers a softness in three ticks, and a quarter of a texel
/// at most, so that the texture stays. 15 um and 4 k at 1 kHz, 1.5 um and 12 k at 10 kHz.
[[nodiscard]] inline contact_softness softness_for(double period_s, double texel_m) noexcept {
  constexpr double speed_m_per_s = 0.05;
  const double travel_m = speed_m_per_s * period_s;
  contact_softness out;
  out.softness_m = std::max(1e-6, std::min(0.3 * travel_m, 0.25 * texel_m));
  out.sharpness = std::clamp(4.0 * std::sqrt(50e-6 / travel_m), 3.0, 12.0);
  return out;
}

/// Says which setting is out of range and what would do.
[[nodiscard]] inline result<void> check(const least_motion_settings& s) {
  const auto bad = [](std::string what) { return error{error_code::invalid_argument, "least motion: " + what}; };
  if (!(std::isfinite(s.stiffness_n_per_m) && s.stiffness_n_per_m > 0.0)) {
    return bad("stiffness_n_per_m must be a finite number above 0");
  }
  if (!(std::isfinite(s.softness_m) && s.softness_m >= 0.0)) {
    return bad("softness_m must be a finite length, or 0 for automatic");
  }
  if (!(s.sharpness == 0.0 || (std::isfinite(s.sharpness) && s.sharpness >= 2.0))) {
    return bad("sharpness must be a finite number of at least 2, or 0 for automatic");
  }
  if (!(std::isfinite(s.turn_arm_m) && s.turn_arm_m >= 0.0)) {
    return bad("turn_arm_m must be a finite length, or 0 for automatic");
  }
  if (!(std::isfinite(s.period_s) && s.period_s > 0.0)) return bad("period_s must be a finite time above 0");
  if (s.most_readings < 1000) return bad("most_readings must be 1000 or more");
  if (s.most_samples < 64) return bad("most_samples must be 64 or more");
  return {};
}

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

  /// @param bodies of the scene, in its order   @param centre_of_mass_a of the probe, its frame   @pre check(settings)
  least_motion(const field_scene& bodies, const vec3& centre_of_mass_a, const least_motion_settings& settings)
      : settings_(filled_in(settings, bodies, centre_of_mass_a)),
        solver_(std::make_shared<const exits::exit_scene>(bodies), centre_of_mass_a,
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
