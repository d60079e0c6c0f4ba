#include "asperity/mujoco/textured_contacts.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <mujoco/mujoco.h>
#include <optional>
#include <utility>

#include "asperity/least_motion/least_motion_renderer.hpp"
#include "asperity/mujoco/conversions.hpp"
#include "find_objects.hpp"
#include "step_load.hpp"

namespace asperity::mujoco {
namespace {

bool moves(const mjModel& m, int body) { return m.body_weldid[body] != 0; }

pose T_w_body(const mjData& d, int body) noexcept {
  return pose_from_mujoco(std::span<const double, 3>(d.xpos + std::ptrdiff_t{3} * body, 3),
                          std::span<const double, 4>(d.xquat + std::ptrdiff_t{4} * body, 4));
}
vec3 centre_of_mass_w(const mjData& d, int body) noexcept {
  return vector_from_mujoco(std::span<const double, 3>(d.xipos + std::ptrdiff_t{3} * body, 3));
}

bool same_bits(double a, double b) noexcept {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

result<any_renderer> default_renderer(scene bodies, double stiffness_n_per_m, double period_s) {
  least_motion_renderer_settings settings;
  settings.force.stiffness_n_per_m = stiffness_n_per_m;
  settings.force.period_s = period_s;
  result<least_motion_renderer> made = make_renderer(std::move(bodies), settings);
  if (!made) return made.error();
  return any_renderer(std::move(*made));
}

// The mass that both bodies have against a force in direction u, from the inverse inertia about one point.
double mass_along(const mat6& inverse_inertia, const vec6& u) noexcept {
  const double mobility = dot(u, inverse_inertia * u);
  return mobility > 0.0 ? 1.0 / mobility : std::numeric_limits<double>::infinity();
}

}  // namespace

struct textured_contacts::parts {
  // A pair of the simulation with what one step knows of it.
  struct placed_pair {
    found_object probe, fixed;
    double damping_s;
    any_renderer feel;
    std::array<int, 2> trees;  // roots of the kinematic trees that move; -1: does not
    pair_report report{};
    pose T_wa{}, T_wb{};
    // Of this step, about the probe model's centre of mass.
    bool touches = false;
    vec3 c_a_w{0.0};
    wrench on_probe_w{}, damping_w{};
    double own_load = 0.0;

    [[nodiscard]] bool shares_a_tree_with(const placed_pair& other) const noexcept {
      return std::any_of(trees.begin(), trees.end(), [&](int t) {
        return t >= 0 && std::find(other.trees.begin(), other.trees.end(), t) != other.trees.end();
      });
    }
  };

  // Six numbers of xfrc_applied: what was there, and what was left there.
  struct written_row {
    int body = 0;
    std::array<double, 6> before{}, after{};
  };

  std::vector<placed_pair> pairs;
  step_bound bound;
  int nbody = 0, nv = 0;
  std::vector<written_row> rows;                        // one for each body that pairs push
  std::vector<double> jacobian, other_jacobian, moved;  // 6 x nv
  std::uint64_t scaled = 0;

  void find_motion(const mjModel& m, mjData& d, const placed_pair& p, mat6& inverse_inertia, vec6& velocity) noexcept;
  void feel(const mjModel& m, mjData& d, placed_pair& p) noexcept;
  void bear(placed_pair& p) noexcept;
  [[nodiscard]] status apply(const mjModel& m, mjData& d) noexcept;
  void push(mjData& d, int body, const wrench& w) noexcept;
  void take_back(mjData& d) noexcept;
};

// Of the probe's motion against the fixed body, about c_A: the inverse of the inertia that both have, and the velocity.
void textured_contacts::parts::find_motion(const mjModel& m, mjData& d, const placed_pair& p, mat6& inverse_inertia,
                                           vec6& velocity) noexcept {
  const auto n = static_cast<std::size_t>(nv);
  const std::array<double, 3> point{p.c_a_w.x, p.c_a_w.y, p.c_a_w.z};
  mj_jac(&m, &d, jacobian.data(), jacobian.data() + 3 * n, point.data(), p.probe.body);
  mj_jac(&m, &d, other_jacobian.data(), other_jacobian.data() + 3 * n, point.data(), p.fixed.body);
  for (std::size_t i = 0; i < 6 * n; ++i) jacobian[i] -= other_jacobian[i];
  mj_solveM(&m, &d, moved.data(), jacobian.data(), 6);
  for (std::size_t i = 0; i < 6; ++i) {
    double v = 0.0;
    for (std::size_t k = 0; k < n; ++k) v += jacobian[i * n + k] * d.qvel[k];
    velocity[i] = v;
    for (std::size_t j = 0; j < 6; ++j) {
      double sum = 0.0;
      for (std::size_t k = 0; k < n; ++k) sum += jacobian[i * n + k] * moved[j * n + k];
      inverse_inertia(i, j) = sum;
    }
  }
}

// The renderer's wrench and the damping at d's poses, before the time step is asked.
void textured_contacts::parts::feel(const mjModel& m, mjData& d, placed_pair& p) noexcept {
  p.report = {};
  p.touches = false;
  p.T_wa = T_w_body(d, p.probe.body) * p.probe.T_bm;
  p.T_wb = T_w_body(d, p.fixed.body) * p.fixed.T_bm;
  tick found;
  p.report.answer = p.feel.step({p.T_wa, std::span(&p.T_wb, 1)}, found);
  if (p.report.answer != status::ok && p.report.answer != status::capacity_reached) return;
  for (const penetration& depth : found.depths) {
    if (!(depth.depth_m > 0.0)) continue;
    ++p.report.contacts;
    p.report.deepest_m = std::max(p.report.deepest_m, depth.depth_m);
  }
  if (is_zero(found.force.on_probe_w)) return;

  p.touches = true;
  p.c_a_w = found.centre_of_mass_w;
  p.on_probe_w = found.force.on_probe_w;
  const mat6 stiffness = -1.0 * found.force.stiffness;
  mat6 inverse_inertia;
  vec6 velocity;
  find_motion(m, d, p, inverse_inertia, velocity);
  p.damping_w = to_wrench(-p.damping_s * (stiffness * velocity));
  p.own_load = m.opt.timestep * m.opt.timestep * largest_eigenvalue_of(inverse_inertia, stiffness);
  if (!is_finite(p.damping_w) || !std::isfinite(p.own_load)) {
    p.report.answer = status::not_finite;
    p.touches = false;
    return;
  }
  const double force_n = glm::length(p.on_probe_w.force);
  if (force_n > 0.0) {
    const vec6 along{p.on_probe_w.force / force_n, vec3(0.0)};
    p.report.stiffness_n_per_m = dot(along, stiffness * along);
    p.report.mass_kg = mass_along(inverse_inertia, along);
  }
}

// Scales the wrench to what the time step bears, damping included.
void textured_contacts::parts::bear(placed_pair& p) noexcept {
  pair_report& r = p.report;
  for (const placed_pair& other : pairs) {
    if (other.touches && (&other == &p || p.shares_a_tree_with(other))) r.step_load += other.own_load;
  }
  if (r.step_load > bound.stiffness) r.force_share = bound.stiffness / r.step_load;
  if (r.force_share < 1.0) ++scaled;
}

// To a body that nothing moves nothing is added.
void textured_contacts::parts::push(mjData& d, int body, const wrench& w) noexcept {
  double* const row = d.xfrc_applied + std::ptrdiff_t{6} * body;
  for (written_row& r : rows) {
    if (r.body != body) continue;
    const vec6 added = to_vec6(w);
    for (std::size_t i = 0; i < 6; ++i) {
      row[i] += added[i];
      r.after[i] = row[i];
    }
  }
}

void textured_contacts::parts::take_back(mjData& d) noexcept {
  for (written_row& r : rows) {
    double* const row = d.xfrc_applied + std::ptrdiff_t{6} * r.body;
    for (std::size_t i = 0; i < 6; ++i) {
      if (same_bits(row[i], r.after[i])) row[i] = r.before[i];
      // From here on nothing of ours is in the array.
      r.before[i] = r.after[i] = row[i];
    }
  }
}

status textured_contacts::parts::apply(const mjModel& m, mjData& d) noexcept {
  if (m.nbody != nbody || m.nv != nv) return status::not_ready;
  take_back(d);
  for (written_row& r : rows) {
    std::copy_n(d.xfrc_applied + std::ptrdiff_t{6} * r.body, 6, r.before.begin());
    r.after = r.before;
  }
  status answer = status::ok;
  for (placed_pair& pair : pairs) feel(m, d, pair);
  for (placed_pair& pair : pairs) {
    pair_report& r = pair.report;
    const bool felt = r.answer == status::ok || r.answer == status::capacity_reached;
    if (r.answer != status::ok && (answer == status::ok || (!felt && answer == status::capacity_reached))) {
      answer = r.answer;
    }
    if (!pair.touches) continue;
    bear(pair);
    const wrench pressed = r.force_share * pair.on_probe_w;
    // Against a damper of damping_s times the stiffness that is left.
    const double damping_load = std::min(r.step_load, bound.stiffness) * pair.damping_s / m.opt.timestep;
    if (damping_load > bound.damping) r.damping_share = bound.damping / damping_load;
    const wrench damped = r.force_share * r.damping_share * pair.damping_w;
    const double outwards = glm::dot(pressed.force, pressed.force), back = -glm::dot(damped.force, pressed.force);
    const double kept = back > outwards ? outwards / back : 1.0;
    r.damping_share *= kept;
    const wrench felt_w = pressed + kept * damped;
    r.on_probe_w = transport(felt_w, pair.c_a_w, centre_of_mass_w(d, pair.probe.body));
    r.on_fixed_w = -1.0 * transport(felt_w, pair.c_a_w, centre_of_mass_w(d, pair.fixed.body));
    push(d, pair.probe.body, r.on_probe_w);
    push(d, pair.fixed.body, r.on_fixed_w);
  }
  return answer;
}

textured_contacts::textured_contacts(std::unique_ptr<parts> made) noexcept : parts_(std::move(made)) {}
textured_contacts::textured_contacts(textured_contacts&&) noexcept = default;
textured_contacts& textured_contacts::operator=(textured_contacts&&) noexcept = default;
textured_contacts::~textured_contacts() = default;

result<textured_contacts> textured_contacts::make(const mjModel_& m, std::vector<textured_pair> given,
                                                  const step_bound& bound) {
  const auto bad = [](std::string what) { return error{error_code::invalid_argument, std::move(what)}; };
  if (mj_version() != mjVERSION_HEADER) {
    return error{error_code::unsupported,
                 "libmujoco is of version " + std::to_string(mj_version()) + " and asperity was compiled for " +
                     std::to_string(mjVERSION_HEADER) +
                     ", whose structs are others: compile asperity with the headers of this library"};
  }
  if (given.empty()) return bad("there is no MuJoCo pair: name two objects that feel each other");
  if (!(bound.stiffness > 0.0 && bound.stiffness <= 1.0 && bound.damping > 0.0 && bound.damping <= 0.5)) {
    return bad("the step bound's stiffness has to be above 0 and at most 1, its damping above 0 and at most 0.5");
  }
  auto out = std::make_unique<parts>();
  out->bound = bound;
  out->nbody = m.nbody;
  out->nv = m.nv;
  for (std::vector<double>* const buffer : {&out->jacobian, &out->other_jacobian, &out->moved}) {
    buffer->resize(6 * static_cast<std::size_t>(m.nv));
  }
  for (std::size_t i = 0; i < given.size(); ++i) {
    textured_pair& pair = given[i];
    const std::string where = "MuJoCo pair " + std::to_string(i);
    const result<found_object> probe = find_object(m, pair.probe, where + ", probe");
    if (!probe) return probe.error();
    const result<found_object> fixed = find_object(m, pair.fixed, where + ", fixed");
    if (!fixed) return fixed.error();
    const std::string both = name_of(m, mjOBJ_BODY, probe->body) + " and " + name_of(m, mjOBJ_BODY, fixed->body);
    if (m.body_weldid[probe->body] == m.body_weldid[fixed->body]) {
      return bad(where + ": " + both + " cannot move against each other: one of them needs a joint");
    }
    for (const int body : {probe->body, fixed->body}) {
      if (moves(m, body) && !(m.body_subtreemass[m.body_weldid[body]] > 0.0)) {
        return bad(where + ": " + name_of(m, mjOBJ_BODY, body) +
                   " moves and has no mass: give it an <inertial> element or its geoms a density");
      }
    }
    if (!(std::isfinite(pair.damping_s) && pair.damping_s >= 0.0)) {
      return bad(where + ": damping_s has to be a finite time, 0 or more");
    }
    if (const colliding_geoms hit = find_own_contacts(m, *probe, *fixed); hit.of_probe >= 0) {
      return bad(where + ": MuJoCo makes contacts between " + name_of(m, mjOBJ_GEOM, hit.of_probe) + " and " +
                 name_of(m, mjOBJ_GEOM, hit.of_fixed) +
                 " itself, which would push besides: call switch_off_own_contacts(), " +
                 "or give the two bodies an <exclude> element in the MJCF");
    }
    scene bodies{pair.probe.model, {pair.fixed.model}};
    result<any_renderer> feel = pair.make_renderer
                                    ? pair.make_renderer(std::move(bodies))
                                    : default_renderer(std::move(bodies), pair.stiffness_n_per_m, m.opt.timestep);
    if (!feel) return error{feel.error().code, where + ": " + feel.error().message};
    const auto tree = [&m](int body) { return moves(m, body) ? m.body_rootid[body] : -1; };
    out->pairs.push_back({.probe = *probe,
                          .fixed = *fixed,
                          .damping_s = pair.damping_s,
                          .feel = std::move(*feel),
                          .trees = {tree(probe->body), tree(fixed->body)}});
    for (const int body : {probe->body, fixed->body}) {
      const bool there = std::any_of(out->rows.begin(), out->rows.end(),
                                     [body](const parts::written_row& r) { return r.body == body; });
      if (moves(m, body) && !there) out->rows.push_back({.body = body});
    }
  }
  return textured_contacts(std::move(out));
}

status textured_contacts::step(const mjModel_& m, mjData_& d) noexcept {
  mj_step1(&m, &d);
  const status answer = apply(m, d);
  mj_step2(&m, &d);
  take_back(d);
  return answer;
}

status textured_contacts::apply(const mjModel_& m, mjData_& d) noexcept { return parts_->apply(m, d); }
void textured_contacts::take_back(mjData_& d) noexcept { parts_->take_back(d); }

std::size_t textured_contacts::size() const noexcept { return parts_->pairs.size(); }
const pair_report& textured_contacts::report(std::size_t pair) const noexcept { return parts_->pairs[pair].report; }
pose textured_contacts::T_w_probe(std::size_t pair) const noexcept { return parts_->pairs[pair].T_wa; }
pose textured_contacts::T_w_fixed(std::size_t pair) const noexcept { return parts_->pairs[pair].T_wb; }
std::uint64_t textured_contacts::scaled() const noexcept { return parts_->scaled; }

}  // namespace asperity::mujoco
