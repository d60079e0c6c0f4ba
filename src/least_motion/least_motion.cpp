#include "asperity/least_motion/least_motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "asperity/core/memory.hpp"
#include "least_motion/exit_solver.hpp"

namespace asperity {
namespace {

// How far the body's furthest sample is from a point of it, m.
double reach_from(const vec3& point_b, const field_body& body) noexcept {
  double square = 0.0;
  for (const field_sample& s : body.samples.samples()) {
    const vec3 off = vec3(s.position_b) - point_b;
    square = std::max(square, glm::dot(off, off));
  }
  return std::sqrt(square);
}
least_motion_settings filled_in(least_motion_settings s, const field_scene& bodies,
                                const vec3& centre_of_mass_a) noexcept {
  double texel_m = bodies.probe->field.fine.pitch_m;
  for (const field_body_ptr& b : bodies.fixed) texel_m = std::min(texel_m, b->field.fine.pitch_m);
  const contact_softness usual = softness_for(s.period_s, texel_m);
  if (!(s.softness_m > 0.0)) s.softness_m = usual.softness_m;
  if (!(s.sharpness > 0.0)) s.sharpness = usual.sharpness;
  if (!(s.turn_arm_m > 0.0)) s.turn_arm_m = 4.0 * reach_from(centre_of_mass_a, *bodies.probe);
  return s;
}

exits::exit_rule rule_of(const least_motion_settings& s) noexcept {
  return {.stiffness_n_per_m = s.stiffness_n_per_m,
          .onset_m = s.softness_m,
          .mixed = s.sharpness,
          .turn_arm_m = s.turn_arm_m,
          .most_readings = s.most_readings,
          .most_marks = s.most_samples};
}

}  // namespace

least_motion::least_motion(const field_scene& bodies, std::shared_ptr<const exits::exit_scene> ways_of,
                           const vec3& centre_of_mass_a, const least_motion_settings& settings)
    : settings_(filled_in(settings, bodies, centre_of_mass_a)),
      solver_(std::make_unique<exits::exit_solver>(std::move(ways_of), centre_of_mass_a, rule_of(settings_))) {}
least_motion::least_motion(least_motion&&) noexcept = default;
least_motion& least_motion::operator=(least_motion&&) noexcept = default;
least_motion::~least_motion() = default;

status least_motion::accumulate(const scene_pose& at, const near_samples&, std::span<const near_plane>,
                                force_report& out) noexcept {
  solver_->solve(at);
  report_ways();
  out = {{solver_->on_probe_w(), solver_->stiffness()}, reported_.contacts(), reported_.depths()};
  return solver_->hit().any() ? status::capacity_reached : status::ok;
}

double least_motion::energy_j() const noexcept { return solver_->energy_j(); }
const exits::exit_limits_hit& least_motion::hit() const noexcept { return solver_->hit(); }
std::size_t least_motion::readings() const noexcept { return solver_->readings(); }
std::size_t least_motion::heap_bytes() const noexcept {
  return sizeof(exits::exit_solver) + solver_->heap_bytes() + asperity::heap_bytes(reported_);
}

void least_motion::report_ways() noexcept {
  reported_.clear();
  for (const exits::way_out& w : solver_->ways()) {
    const double pushed_n = glm::length(w.bed.gradient.linear);
    if (!(w.weight > 0.0 && pushed_n > 0.0) || w.touching.empty()) continue;
    const exits::mark* deepest = w.touching.begin();
    for (const exits::mark& m : w.touching) {
      if (m.depth_m > deepest->depth_m) deepest = &m;
    }
    const exits::posed_samples& samples = solver_->samples();
    const vec3 n_ab_w = w.bed.gradient.linear / pushed_n, point_w = samples.centre_w() + samples.lever_w(*deepest);
    penetration d;
    d.depth_m = d.soft_depth_m = w.weight * glm::length(w.z_w + glm::cross(w.turn_w, samples.arm_w(*deepest)));
    d.gradient = {n_ab_w, glm::cross(samples.lever_w(*deepest), n_ab_w)};
    d.samples = static_cast<std::uint32_t>(w.touching.size());
    d.witness_w = point_w;
    if (solver_->hit().any()) d.flags |= depth_flag::unresolved;
    contact c;
    c.id = static_cast<std::uint32_t>(reported_.size());
    c.body = samples.meeting_of(*deepest).body;
    c.separation_m = -d.depth_m;
    c.p_a_w = c.p_b_w = c.window.centre_w = point_w;
    c.window.n_ab_w = n_ab_w;
    c.window.u_w = any_orthogonal(n_ab_w);
    c.window.v_w = glm::cross(n_ab_w, c.window.u_w);
    if (!reported_.add(c, d)) return;
  }
}

}  // namespace asperity
