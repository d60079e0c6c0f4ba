// The virtual tool in a loop of the application's own.
#include "asperity/c/tool.h"

#include <cmath>
#include <memory>
#include <span>

#include "asperity/control/virtual_tool.hpp"
#include "asperity/device/gate_function.hpp"
#include "asperity/planes/plane_renderer.hpp"
#include "c/handles.hpp"
#include "plane_reach.hpp"

namespace {

using namespace asperity;
using namespace asperity::c;

/// 0: none.
struct effort_limits {
  double force_n = 0.0, torque_n_m = 0.0;
};

}  // namespace

// NOLINTBEGIN(readability-identifier-naming): names of the C header
struct asperity_tool : asperity::c::handle_mark<0x54617370U> {
  asperity_tool(asperity::plane_renderer made, const asperity::virtual_tool_settings& settings, effort_limits most,
                std::size_t bodies)
      : feel(std::move(made)), tool(settings), limits(most), longest_s(settings.longest_step_s), T_wb(bodies) {}

  asperity::plane_renderer feel;
  asperity::virtual_tool tool;
  effort_limits limits;
  double longest_s;
  bool placed = false;
  std::vector<asperity::pose> T_wb;
  asperity::fixed_vector<asperity::body_motion, asperity::most_moving_bodies> moving;
};
// NOLINTEND(readability-identifier-naming)

namespace {

vec3 shortened(const vec3& v, double most) noexcept {
  if (!(most > 0.0)) return v;
  return bound_vector(v, vec3(0.0), {.limit = most, .saturation = most, .max_change = 1e6}, true).value;
}

result<void> check(const asperity_tool_settings& s) {
  if (const result<void> ok =
          c::check({s.stiffness_n_per_m, s.dissipation_s_per_m, s.static_friction, s.dynamic_friction});
      !ok) {
    return ok;
  }
  return range_check()
      .within("substeps", s.substeps, 0.0, 1000.0)
      .within("period_s", or_usual(s.period_s, 1e-3), 1e-4, 0.1)
      .within("mass_kg", or_usual(s.mass_kg, 0.01), 1e-6, 1e3)
      .within("coupling_n_per_m", or_usual(s.coupling_n_per_m, 500.0), 1e-3, 1e6)
      .within("coupling_n_m_per_rad", or_usual(s.coupling_n_m_per_rad, 3.0), 1e-6, 1e6)
      .within("most_force_n", s.most_force_n, 0.0, 1e6)
      .within("most_torque_n_m", s.most_torque_n_m, 0.0, 1e6)
      .holds(is_valid(pose_or(s.probe_on_hand, {})),
             "probe_on_hand is no pose x y z qx qy qz qw with a quaternion of unit length: give one, or all zeros")
      .done();
}

virtual_tool_settings settings_from(const asperity_tool_settings& s, const scene& bodies) {
  const touch_wish wish{s.stiffness_n_per_m, s.dissipation_s_per_m, s.static_friction, s.dynamic_friction};
  virtual_tool_settings out;
  const mass_properties& shape = bodies.probe->mass;
  out.probe = solid_probe(shape, or_usual(s.mass_kg, 0.01));
  out.coupling.stiffness_n_per_m = or_usual(s.coupling_n_per_m, out.coupling.stiffness_n_per_m);
  out.coupling.stiffness_n_m_per_rad = or_usual(s.coupling_n_m_per_rad, out.coupling.stiffness_n_m_per_rad);
  out.contact.stiffness_n_per_m = or_usual(wish.stiffness_n_per_m, out.contact.stiffness_n_per_m);
  out.contact.dissipation_s_per_m = or_usual(wish.dissipation_s_per_m, out.contact.dissipation_s_per_m);
  out.friction.static_coefficient = wish.static_friction;
  out.friction.dynamic_coefficient = wish.dynamic_friction;
  out.surfaces = surfaces_of(bodies);
  apply(wish, out.surfaces);
  out.selection = selection_for(std::llround(1e9 * or_usual(s.period_s, 1e-3)));
  out.T_ha = pose_or(s.probe_on_hand, {});
  out.centre_of_mass_a = shape.centre_of_mass;
  if (s.substeps != 0) out.substeps = static_cast<int>(s.substeps);
  return out;
}

// One that stands still again leaves the list.
status tell_motion(asperity_tool& self, const body_motion& told) noexcept {
  const bool moves = glm::dot(told.velocity_w.linear, told.velocity_w.linear) > 0.0 ||
                     glm::dot(told.velocity_w.angular, told.velocity_w.angular) > 0.0;
  const auto before = self.moving;
  self.moving.clear();
  for (const body_motion& m : before) {
    if (m.body != told.body) static_cast<void>(self.moving.push_back(m));
  }
  return !moves || self.moving.push_back(told) ? status::ok : status::capacity_reached;
}

void carry_bodies(asperity_tool& self, double dt_s) noexcept {
  for (body_motion& m : self.moving) {
    m.T_wb = way_of(m, std::min(dt_s, self.longest_s)).after(1.0);
    self.T_wb[m.body] = m.T_wb;
  }
}

}  // namespace

std::int32_t asperity_tool_make(const asperity_model* probe, const asperity_model* const* fixed,
                                std::uint32_t fixed_count, const asperity_tool_settings* settings, asperity_tool** out,
                                asperity_error* why) {
  return guarded(why, [&] {
    if (out == nullptr) return refuse_argument(why, "out is NULL: give a place for the handle");
    *out = nullptr;
    asperity_tool_settings s{};
    if (const std::int32_t taken = take(settings, s); taken != ASPERITY_STATUS_OK) return refuse_struct(why, taken);
    if (const result<void> ok = check(s); !ok) return refuse(why, ok.error());
    result<scene> bodies = scene_of(probe, fixed, fixed_count);
    if (!bodies) return refuse(why, bodies.error());
    const virtual_tool_settings inside = settings_from(s, *bodies);
    for (const result<void>& ok : {check(inside.contact), check(inside.friction), check(inside.selection)}) {
      if (!ok) return refuse(why, ok.error());
    }
    plane_renderer_settings planes;
    planes.reach_m = command::plane_reach_m(*bodies, reach_for(or_usual(s.period_s, 1e-3)));
    if (s.threads != 0) planes.threads = s.threads;
    result<plane_renderer> made = make_plane_renderer(std::move(*bodies), planes);
    if (!made) return refuse(why, made.error());
    *out = std::make_unique<asperity_tool>(std::move(*made), inside, effort_limits{s.most_force_n, s.most_torque_n_m},
                                           fixed_count)
               .release();
    return ASPERITY_STATUS_OK;
  });
}

std::int32_t asperity_tool_free(asperity_tool* tool) {
  if (tool == nullptr) return ASPERITY_STATUS_OK;
  if (checked(tool) == nullptr) return ASPERITY_ERROR_INVALID_ARGUMENT;
  delete tool;
  return ASPERITY_STATUS_OK;
}

std::int32_t asperity_tool_place(asperity_tool* tool, const double* T_wh) {
  if (checked(tool) == nullptr || T_wh == nullptr) return ASPERITY_ERROR_INVALID_ARGUMENT;
  const pose there = pose_of(T_wh);
  if (!is_valid(there)) return ASPERITY_STATUS_INVALID_POSE;
  tool->tool.place(there);
  tool->placed = true;
  return ASPERITY_STATUS_OK;
}

std::int32_t asperity_tool_move_body(asperity_tool* tool, std::uint32_t body, const double* T_wb,
                                     const double* velocity) {
  if (checked(tool) == nullptr || T_wb == nullptr || body >= tool->T_wb.size()) return ASPERITY_ERROR_INVALID_ARGUMENT;
  body_motion told{.body = body, .T_wb = pose_of(T_wb)};
  if (velocity != nullptr) told.velocity_w = {vec3_of(velocity), vec3_of(velocity + 3)};
  if (!is_valid(told.T_wb) || !is_finite(to_vec6(told.velocity_w))) return ASPERITY_STATUS_INVALID_POSE;
  const status s = tell_motion(*tool, told);
  if (s == status::ok) tool->T_wb[body] = told.T_wb;
  return answer(s);
}

std::int32_t asperity_tool_follow(asperity_tool* tool, const double* T_wh, double dt_s, asperity_felt* out) {
  if (checked(tool) == nullptr || T_wh == nullptr || !has_size(out)) return ASPERITY_ERROR_INVALID_ARGUMENT;
  asperity_felt full{};
  const auto ended = [&](std::int32_t code) {
    give(out, full);
    return code;
  };
  if (!(dt_s > 0.0) || !std::isfinite(dt_s)) return ended(ASPERITY_ERROR_INVALID_ARGUMENT);
  if (!tool->placed) return ended(ASPERITY_STATUS_NOT_READY);
  tick found;
  const status contact = tool->feel.step({tool->tool.T_wa(), tool->T_wb}, found);
  const wrench felt = tool->tool.follow(pose_of(T_wh), dt_s, found, contact, std::span(tool->moving));
  const status s = tool->tool.last();
  const touch_depth depth = depth_of(found);
  full.flags = static_cast<std::uint32_t>(found.flags);
  full.contact_answer = answer(contact);
  full.contacts = depth.overlapping;
  full.deepest_m = depth.deepest_m;
  put(wrench{shortened(felt.force, tool->limits.force_n), shortened(felt.torque, tool->limits.torque_n_m)},
      full.on_hand);
  if (s == status::ok) {
    put(tool->tool.motion().touched().on_probe_w, full.on_probe);
    carry_bodies(*tool, dt_s);
  }
  put(tool->tool.T_wa(), full.probe_pose);
  return ended(answer(s));
}
