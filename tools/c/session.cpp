// Sessions on the virtual clock.
#include "asperity/c/session.h"

#include <cmath>
#include <memory>

#include "asperity/control/virtual_session.hpp"
#include "asperity/planes/plane_renderer.hpp"
#include "c/held_device.hpp"
#include "c/made_renderer.hpp"
#include "plane_reach.hpp"

namespace {

using namespace asperity;
using namespace asperity::c;

struct keep_last {
  session_record* last;
  void operator()(const session_record& record) const noexcept { *last = record; }
};

/// All that a session is made of but its device.
struct session_parts {
  any_renderer feel;
  scene_placement placement;
  control_settings control;
  virtual_schedule schedule;
};

}  // namespace

// NOLINTBEGIN(readability-identifier-naming): names of the C header
struct asperity_session : asperity::c::handle_mark<0x53617370U> {
  asperity_session(std::shared_ptr<held_device> on, session_parts parts)
      : held(std::move(on)),
        start_ns(parts.schedule.start_ns),
        period_ns(parts.schedule.device_period_ns),
        session(std::move(parts.feel), std::move(parts.placement), held->device, parts.control, parts.schedule,
                keep_last{&last}) {}
  asperity_session(const asperity_session&) = delete;
  asperity_session& operator=(const asperity_session&) = delete;
  ~asperity_session() {
    static_cast<void>(held->device.disarm());
    held->used_until_ns = std::max(held->used_until_ns, session.now_ns());
    held->keep_state();
    held->in_session.store(false, std::memory_order_release);
  }

  std::shared_ptr<held_device> held;
  std::int64_t start_ns, period_ns;
  session_record last{};
  bool stopped = false;
  virtual_session<any_renderer, any_device, keep_last> session;
};
// NOLINTEND(readability-identifier-naming)

namespace {

constexpr double clearance_m = 0.003;  // the probe starts this far above the touch, as in the command's sessions

std::int64_t period_of(double rate_hz) noexcept { return std::llround(1e9 / rate_hz); }
double seconds(std::int64_t ns) noexcept { return 1e-9 * static_cast<double>(ns); }

asperity_session_settings with_usual(asperity_session_settings s) noexcept {
  if (s.formulation == ASPERITY_FORMULATION_USUAL) s.formulation = ASPERITY_FORMULATION_PLANES;
  s.device_rate_hz = or_usual(s.device_rate_hz, 1000.0);
  s.contact_rate_hz = or_usual(s.contact_rate_hz, 1000.0);
  s.scale = or_usual(s.scale, 1.0);
  s.mass_kg = or_usual(s.mass_kg, 0.01);
  return s;
}

touch_wish wish_of(const asperity_session_settings& s) noexcept {
  return {s.stiffness_n_per_m, s.dissipation_s_per_m, s.static_friction, s.dynamic_friction};
}

result<void> check(const asperity_session_settings& s) {
  if (const result<void> ok = c::check(wish_of(s)); !ok) return ok;
  const bool on_planes = s.formulation == ASPERITY_FORMULATION_PLANES;
  return range_check()
      .within("device_rate_hz", s.device_rate_hz, 100.0, 10'000.0)
      .within("contact_rate_hz", s.contact_rate_hz, 100.0, 10'000.0)
      .within("scale", s.scale, 1e-3, 1e3)
      .within("coupling_n_per_m", s.coupling_n_per_m, 0.0, 1e6)
      .within("coupling_n_m_per_rad", s.coupling_n_m_per_rad, 0.0, 1e6)
      .holds(on_planes || (s.static_friction == 0.0 && s.dissipation_s_per_m == 0.0),
             "friction and dissipation are of support planes: give formulation planes")
      .within("mass_kg", s.mass_kg, 1e-6, 1e3)
      .within("most_force_n", s.most_force_n, 0.0, 1e6)
      .within("most_torque_n_m", s.most_torque_n_m, 0.0, 1e6)
      .holds(is_valid(pose_or(s.start_pose, {})),
             "start_pose is no pose x y z qx qy qz qw with a quaternion of unit length: give one, or all zeros")
      .done();
}

result<std::vector<pose>> poses_of(const double* given, std::uint32_t count) {
  std::vector<pose> out(count);
  for (std::uint32_t i = 0; given != nullptr && i < count; ++i) {
    out[i] = pose_of(given + std::size_t{7} * i);
    if (is_valid(out[i])) continue;
    return error{error_code::invalid_argument, "pose " + std::to_string(i) +
                                                   " of fixed_poses is no pose x y z qx qy qz qw with a quaternion of "
                                                   "unit length"};
  }
  return out;
}

result<any_renderer> renderer_for(const scene& bodies, const asperity_session_settings& s, const loop_periods& p) {
  const bool on_planes = s.formulation == ASPERITY_FORMULATION_PLANES;
  renderer_wish wish{
      .formulation = s.formulation, .period_s = seconds(p.renewal_ns()), .threads = s.threads == 0 ? 1 : s.threads};
  if (on_planes) {
    const double hand_m = reach_for(seconds(p.contact_ns), seconds(p.device_ns));
    wish.reach_m = command::plane_reach_m(bodies, std::max(1.0, s.scale) * hand_m);
  } else {
    wish.stiffness_n_per_m = s.stiffness_n_per_m;
  }
  return make_any_renderer(bodies, wish);
}

control_settings control_for(const scene& bodies, const asperity_session_settings& s, const pose& T_wa,
                             const device_capabilities& can) {
  const mass_properties& shape = bodies.probe->mass;
  control_settings out;
  out.map = {.T_wd = {quat(1.0, 0.0, 0.0, 0.0), T_wa * shape.centre_of_mass},
             .scale = s.scale,
             .T_ha = {T_wa.rotation, -(T_wa.rotation * shape.centre_of_mass)}};
  out.probe = felt_alike(solid_probe(shape, s.mass_kg), s.scale);
  if (s.formulation == ASPERITY_FORMULATION_PLANES) {
    const touch_wish wish = wish_of(s);
    out.coupling = coupling_for(can, s.device_rate_hz, s.scale);
    out.contact.stiffness_n_per_m = or_usual(wish.stiffness_n_per_m, out.contact.stiffness_n_per_m);
    out.contact.dissipation_s_per_m = or_usual(wish.dissipation_s_per_m, out.contact.dissipation_s_per_m);
    out.friction.static_coefficient = wish.static_friction;
    out.friction.dynamic_coefficient = wish.dynamic_friction;
    out.surfaces = surfaces_of(bodies);
    apply(wish, out.surfaces);
  }
  out.coupling.stiffness_n_per_m = or_usual(s.coupling_n_per_m, out.coupling.stiffness_n_per_m);
  out.coupling.stiffness_n_m_per_rad = or_usual(s.coupling_n_m_per_rad, out.coupling.stiffness_n_m_per_rad);
  if (s.most_force_n != 0.0) out.limits.peak_force_n = out.limits.continuous_force_n = s.most_force_n;
  if (s.most_torque_n_m != 0.0) out.limits.peak_torque_n_m = out.limits.continuous_torque_n_m = s.most_torque_n_m;
  return out;
}

result<session_parts> parts_of(const scene& bodies, std::vector<pose> T_wb, const asperity_session_settings& s,
                               held_device& held) {
  const loop_periods periods{period_of(s.device_rate_hz), period_of(s.contact_rate_hz)};
  result<any_renderer> feel = renderer_for(bodies, s, periods);
  if (!feel) return feel.error();
  pose T_wa = pose_or(s.start_pose, {});
  if (std::all_of(s.start_pose, s.start_pose + 7, [](double x) { return x == 0.0; })) {
    const result<pose> touching = find_start(*feel, quat(1.0, 0.0, 0.0, 0.0), T_wb);
    if (!touching) return touching.error();
    T_wa = *touching;
    T_wa.position.z += clearance_m;
  }
  const control_settings control = control_for(bodies, s, T_wa, held.device.capabilities());
  for (const result<void>& ok : {asperity::check(control.contact), asperity::check(control.friction)}) {
    if (!ok) return ok.error();
  }
  // A device that was in use before goes on from its own time.
  const std::int64_t start_ns = held.used_until_ns < 0 ? 0 : held.used_until_ns + periods.device_ns;
  return session_parts{.feel = std::move(*feel),
                       .placement = {std::move(T_wb), bodies.probe->mass.centre_of_mass},
                       .control = control,
                       .schedule = {.start_ns = start_ns,
                                    .device_period_ns = periods.device_ns,
                                    .contact_period_ns = periods.contact_ns,
                                    .contact_one_period_late = true}};
}

result<void> open_and_arm(held_device& held) {
  const device_state now = held.device.state();
  if (now == device_state::absent || now == device_state::present || now == device_state::closed) {
    if (const result<void> opened = held.device.open(); !opened) return opened;
  }
  if (held.device.state() == device_state::armed || held.device.state() == device_state::active) return {};
  return held.device.arm();
}

/// Gives the device back where a session could not be made.
struct lease {
  explicit lease(held_device& of) noexcept : held(&of), taken(!of.in_session.exchange(true)) {}
  lease(const lease&) = delete;
  lease& operator=(const lease&) = delete;
  ~lease() {
    if (!taken) return;
    held->keep_state();
    held->in_session.store(false, std::memory_order_release);
  }
  held_device* held;
  bool taken;
};

asperity_session_tick tick_of(const asperity_session& self, std::uint32_t ticks) noexcept {
  const session_record& r = self.last;
  asperity_session_tick out{};
  out.flags = static_cast<std::uint32_t>(r.flags);
  out.time_ns = r.time_ns - self.start_ns;
  put(r.T_dh, out.device_pose);
  put(r.T_wa, out.probe_pose);
  put(r.on_hand_d, out.on_hand);
  put(r.on_probe_w, out.on_probe);
  out.deepest_m = r.max_depth_m;
  out.delivered_j = r.delivered_j;
  out.contacts = r.contacts;
  out.planes = r.planes;
  out.sample = static_cast<std::uint32_t>(r.sample);
  out.device = static_cast<std::uint32_t>(r.device);
  out.fault = static_cast<std::uint32_t>(r.fault);
  out.ticks = ticks;
  return out;
}

}  // namespace

std::int32_t asperity_session_make(const asperity_model* probe, const asperity_model* const* fixed,
                                   const double* fixed_poses, std::uint32_t fixed_count, asperity_haptic_device* device,
                                   const asperity_session_settings* settings, asperity_session** out,
                                   asperity_error* why) {
  return guarded(why, [&] {
    if (out == nullptr) return refuse_argument(why, "out is NULL: give a place for the handle");
    *out = nullptr;
    asperity_session_settings given{};
    if (const std::int32_t taken = take(settings, given); taken != ASPERITY_STATUS_OK) return refuse_struct(why, taken);
    const asperity_session_settings s = with_usual(given);
    if (const result<void> ok = check(s); !ok) return refuse(why, ok.error());
    const result<scene> bodies = scene_of(probe, fixed, fixed_count);
    if (!bodies) return refuse(why, bodies.error());
    result<std::vector<pose>> T_wb = poses_of(fixed_poses, fixed_count);
    if (!T_wb) return refuse(why, T_wb.error());
    if (checked(device) == nullptr) return refuse_argument(why, "device is no device");
    lease leased(*device->inside);
    if (!leased.taken)
      return refuse(why, ASPERITY_ERROR_BUSY, "another session has the device: free that session first");
    result<session_parts> parts = parts_of(*bodies, std::move(*T_wb), s, *device->inside);
    if (!parts) return refuse(why, parts.error());
    if (const result<void> ready = open_and_arm(*device->inside); !ready) return refuse(why, ready.error());
    auto made = std::make_unique<asperity_session>(device->inside, std::move(*parts));
    leased.taken = false;  // the session gives it back
    device->inside->keep_state();
    *out = made.release();
    return ASPERITY_STATUS_OK;
  });
}

std::int32_t asperity_session_free(asperity_session* session) {
  if (session == nullptr) return ASPERITY_STATUS_OK;
  if (checked(session) == nullptr) return ASPERITY_ERROR_INVALID_ARGUMENT;
  delete session;
  return ASPERITY_STATUS_OK;
}

std::int32_t asperity_session_step(asperity_session* session, std::uint32_t ticks, asperity_session_tick* out) {
  if (checked(session) == nullptr || (out != nullptr && !has_size(out))) return ASPERITY_ERROR_INVALID_ARGUMENT;
  const auto shut = [&] { return session->stopped || session->session.device().gate().fault() != gate_fault::none; };
  status s = status::ok;
  std::uint32_t ran = 0;
  while (ran < ticks && !shut()) {
    session->session.beat();
    s = session->session.step();
    ++ran;
  }
  session->held->keep_state();
  if (out != nullptr) give(out, tick_of(*session, ran));
  return shut() ? ASPERITY_STATUS_GATE_SHUT : answer(s);
}

std::int32_t asperity_session_stop(asperity_session* session) {
  if (checked(session) == nullptr) return ASPERITY_ERROR_INVALID_ARGUMENT;
  if (session->stopped) return ASPERITY_STATUS_OK;
  session->stopped = true;
  auto& loop = session->session.device();
  loop.stop(gate_fault::stopped);
  const std::int64_t longest = std::max<std::int64_t>(200, 200'000'000 / session->period_ns);
  for (std::int64_t i = 0; i < longest && !loop.gate().at_rest(); ++i) static_cast<void>(session->session.step());
  const status s = session->held->device.disarm();
  session->held->keep_state();
  return answer(s);
}
