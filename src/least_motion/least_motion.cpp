#include "asperity/least_motion/least_motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "asperity/core/memory.hpp"
#include "least_motion/exit_solver.hpp"
#include "least_motion/mix.hpp"
#include "least_motion/stiffness.hpp"

namespace asperity::exits {

void exit_solver::solve(const scene_pose& at, std::span<wrench> by_body) noexcept {
  energy_j_ = 0.0;
  wrench_ = {};
  stiffness_ = {};
  const bool any = finder_.find(at);
  hit_ = finder_.hit();
  if (!any) return;
  posed().count.most += rule_.most_readings / 4;
  add_up(by_body);
  hit_.readings |= posed().count.cut;
}

void exit_solver::add_up(std::span<wrench> by_body) noexcept {
  energy_j_ = mixed_energy_j(finder_.ways(), springs_);
  unsettled_stiffness_ = {};
  mixed_stiffness stiffness(springs_);
  const std::uint32_t of_deepest = posed().meeting_of(finder_.deepest()).body;
  for (way_out& w : finder_.ways()) {
    w.on_probe_w = {};
    if (!(w.weight > 0.0)) continue;
    bed_patch& patch = finder_.gathered_at(w.moved());
    const double share = w.weight;
    if (!w.settled) {
      pull_out(w, by_body);
      continue;
    }
    way_out_stiffness own;
    const pivot& about = posed().about();
    vec3 pushed_n(0.0);
    patch.for_each_inside(w.moved(), posed(), [&](const mark& m, const coarse_reading& d) noexcept {
      const bool of_probe = posed().meeting_of(m).of_probe;
      const vec3 rest = posed().lever_w(m), arm = rest - about.centre, relief = posed().relief_slope(m);
      const vec3 turned_slope = glm::cross(d.slope, w.turn_w);
      // Where the sample meets the field, as seen from the probe as given; a fixed one comes nearer by the motion.
      const vec3 lever = of_probe ? rest : rest - w.z_w - glm::cross(w.turn_w, arm);
      vec6 by_pose{d.slope + relief, glm::cross(lever, d.slope) + glm::cross(rest, relief)};
      if (of_probe) {
        by_pose.angular += glm::cross(rest, turned_slope);
      } else {
        by_pose.linear -= turned_slope;
      }
      for (int i = 0; i < 3; ++i) by_pose += (-turned_slope[i]) * about.centre_by_pose[i];
      const double push_n = bed_.push_n(d.value_m);
      pushed_n += push_n * d.slope;
      push(to_wrench((-share * push_n) * by_pose), w, posed().meeting_of(m).body, by_body);
      own.add(bed_.rise_n_per_m(d.value_m), push_n, {by_pose, d.slope, d.hessian_per_m, arm, rest, lever, of_probe});
    });
    const double turned = -0.5 * share * rule_.stiffness_n_per_m * glm::dot(w.turn_w, w.turn_w);
    push(to_wrench(turned * about.arm_squared_by_pose), w, of_deepest, by_body);
    own.add_pivot(about, rule_.stiffness_n_per_m, w.turn_w, pushed_n);
    stiffness.add(share, own);
  }
  stiffness_ = stiffness.sum() + unsettled_stiffness_;
}

void exit_solver::pull_out(way_out& w, std::span<wrench> by_body) noexcept {
  const vec3 pull_n = (w.weight * springs_.one) * w.z_w, lever = posed().lever_w(finder_.deepest());
  push({pull_n, glm::cross(lever, pull_n)}, w, posed().meeting_of(finder_.deepest()).body, by_body);
  const double length = glm::length(w.z_w);
  if (!(length > 0.0)) return;
  const vec3 along = w.z_w / length;
  add_outer(unsettled_stiffness_, -w.weight * rule_.stiffness_n_per_m, {along, glm::cross(lever, along)});
}

}  // namespace asperity::exits

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
  solver_->solve(at, out.by_body);
  const std::size_t parts = report_ways(out.by_contact);
  out = {{solver_->on_probe_w(), solver_->stiffness()},
         reported_.contacts(),
         reported_.depths(),
         out.by_body,
         out.by_contact.first(parts)};
  return solver_->hit().any() ? status::capacity_reached : status::ok;
}

double least_motion::energy_j() const noexcept { return solver_->energy_j(); }
const exits::exit_limits_hit& least_motion::hit() const noexcept { return solver_->hit(); }
std::size_t least_motion::readings() const noexcept { return solver_->readings(); }
std::size_t least_motion::heap_bytes() const noexcept {
  return sizeof(exits::exit_solver) + solver_->heap_bytes() + asperity::heap_bytes(reported_);
}

std::size_t least_motion::report_ways(std::span<wrench> by_contact) noexcept {
  reported_.clear();
  bool all = true;
  for (const exits::way_out& w : solver_->ways()) {
    const double pushed_n = glm::length(w.bed.gradient.linear);
    if (!(w.weight > 0.0 && pushed_n > 0.0) || w.touching.empty()) {
      all = all && is_zero(w.on_probe_w);
      continue;
    }
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
    if (!reported_.add(c, d)) return 0;
    if (c.id < by_contact.size()) by_contact[c.id] = w.on_probe_w;
  }
  return all ? std::min(by_contact.size(), reported_.size()) : 0;
}

}  // namespace asperity
