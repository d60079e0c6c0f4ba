#include "asperity/drivers/moteus/moteus_drive.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>

namespace asperity {

moteus_drive::moteus_drive(const moteus_settings& settings) noexcept
    : can_joint_drive(settings.joint),
      moteus_(settings),
      limit_(scale().shaft_limit(this->settings().peak_torque_n_m)) {
  drive_facts& f = facts_to_fill();
  constexpr double float_step = 1.0 / 8388608.0;
  f.protocol = "moteus";
  f.torque_resolution_n_m = f.peak_torque_n_m * float_step;
  f.position_resolution_rad = 2.0 * std::numbers::pi * float_step / scale().gear_ratio;
  f.drive_side_watchdog = true;
  f.needs_fd = true;
  const bool ids = settings.id >= 1 && settings.id <= 127 && settings.host_id <= 127;
  if (!ids || settings.watchdog_ms < 1 || settings.watchdog_ms > 32767) refuse_settings();
}

bool moteus_drive::take(std::int64_t now_ns, const can_frame& frame) noexcept {
  if (frame.remote || frame.id != moteus::frame_id(moteus_.id, moteus_.host_id, false)) return false;
  if (at() == phase::off) return true;
  answer a;
  if (!parse(frame, a)) {
    count_malformed();
    return true;
  }
  if (a.refused) {
    heard(now_ns);
    fail("the drive refused a register", a.refused_register, now_ns);
    return true;
  }
  if (a.has_version) take_version(now_ns, a);
  if (!a.has_state) return true;
  heard(now_ns);
  mode_ = a.mode;
  heard_position(now_ns, frame, scale().angle(a.position_rev * turn));
  heard_velocity(scale().velocity(a.velocity_rev_per_s * turn));
  heard_torque(scale().torque(a.torque_n_m));
  advance(now_ns, a);
  return true;
}

bool moteus_drive::parse(const can_frame& frame, answer& a) noexcept {
  using moteus::quantity;
  using moteus::reg;
  const auto size = std::min<std::size_t>(frame.size, frame.data.size());
  moteus::frame_reader reader(std::span(frame.data).first(size));
  moteus::item i;
  bool mode = false, position = false, fault = false, map = false;
  while (reader.next(i)) {
    if (i.what == moteus::action::write_error || i.what == moteus::action::read_error) {
      a.refused = true;
      a.refused_register = i.first;
      continue;
    }
    if (i.what != moteus::action::reply) return false;
    const bool whole = i.how != moteus::resolution::real;
    if (i.is(reg::mode) && whole) {
      a.mode = i.whole;
      mode = true;
    } else if (i.is(reg::fault) && whole) {
      a.fault = static_cast<std::uint32_t>(i.whole) & 0xffU;
      fault = true;
    } else if (i.is(reg::position)) {
      a.position_rev = i.value(quantity::position_rev);
      position = true;
    } else if (i.is(reg::velocity)) {
      a.velocity_rev_per_s = i.value(quantity::velocity_rev_per_s);
    } else if (i.is(reg::torque)) {
      a.torque_n_m = i.value(quantity::torque_n_m);
    } else if (i.is(reg::firmware_version) && whole) {
      a.firmware = i.whole;
    } else if (i.is(reg::register_map_version) && whole) {
      a.register_map = i.whole;
      map = true;
    }
  }
  a.has_state = mode && position && fault;
  a.has_version = map;
  return !reader.malformed() && (a.has_state || a.has_version || a.refused);
}

void moteus_drive::begin_lead(bool clearing) noexcept {
  known_ = false;
  clearing_ = clearing;
  mode_ = unknown;
  stops_ = 0;
  stopped_answers_ = 0;
}

void moteus_drive::take_version(std::int64_t now_ns, const answer& a) noexcept {
  if (at() != phase::leading) return;
  heard(now_ns);
  if (a.register_map != moteus_.register_map) {
    fail("the firmware has another version of the registers", static_cast<std::uint32_t>(a.register_map), now_ns);
    return;
  }
  known_ = true;
}

void moteus_drive::advance(std::int64_t now_ns, const answer& a) noexcept {
  const bool may_have_fault = at() == phase::leading && clearing_;
  if (a.mode == faulted && !may_have_fault) {
    fail(moteus::to_string_fault(a.fault), a.fault, now_ns);
    return;
  }
  switch (at()) {
    case phase::leading:
    case phase::leaving:
      // Answers do not say to which frame: several in a row, so that none is from before the stop.
      stopped_answers_ = a.mode == stopped && stops_ > 0 ? stopped_answers_ + 1 : 0;
      if (stopped_answers_ >= repeats && stops_ >= repeats) reached(phase::idle, now_ns);
      break;
    case phase::idle:
      if (a.mode != stopped) fail("the drive left its stop by itself", static_cast<std::uint32_t>(a.mode), now_ns);
      break;
    case phase::arming:
      if (a.mode == timed_out) fail("the drive's watchdog expired", timed_out, now_ns);
      if (a.mode == position_mode) reached(phase::enabled, now_ns);
      break;
    case phase::enabled:
      if (a.mode == timed_out) {
        fail("the drive's watchdog expired", timed_out, now_ns);
      } else if (a.mode != position_mode) {
        fail("the drive left torque control by itself: it was reset, or stopped by another", 0, now_ns);
      }
      break;
    default:
      break;
  }
}

void moteus_drive::send_due(std::int64_t now_ns, can_bus& bus) noexcept {
  switch (at()) {
    case phase::leading:
      if (!known_) {
        ask_version(now_ns, bus);
      } else if (mode_ == unknown) {
        ask(now_ns, bus);
      } else {
        stop(now_ns, bus);
      }
      break;
    case phase::idle:
    case phase::seeking:
      ask(now_ns, bus);
      break;
    case phase::arming:
      stops_ = 0;
      stopped_answers_ = 0;
      command(now_ns, bus, 0.0);
      break;
    case phase::enabled:
      if (is_quiet(now_ns) || !is_fed()) {
        ask(now_ns, bus);
      } else {
        command(now_ns, bus, torque_due(now_ns));
      }
      break;
    case phase::leaving:
      // Zero torque as a command enables, so only a drive that is known to be enabled gets it, and none after a stop:
      // an answer from before the stop must not bring it back.
      if (owes_zero() && mode_ == position_mode && !is_quiet(now_ns)) {
        if (command(now_ns, bus, 0.0)) zero_was_sent();
      } else {
        zero_was_sent();
        stop(now_ns, bus);
      }
      break;
    case phase::faulted:
      // A stop takes the torque away at once. It also wipes out the drive's own fault, which is for clear_fault().
      if (mode_ == faulted || mode_ == stopped) {
        ask(now_ns, bus);
      } else {
        stop(now_ns, bus);
      }
      break;
    case phase::off:
      break;
  }
}

void moteus_drive::ask_version(std::int64_t now_ns, can_bus& bus) noexcept {
  moteus::frame_writer w;
  w.begin(moteus::action::read, moteus::resolution::int32, 2, moteus::reg::firmware_version);
  send(now_ns, bus, w);
}

void moteus_drive::ask(std::int64_t now_ns, can_bus& bus) noexcept {
  moteus::frame_writer w;
  add_query(w);
  send(now_ns, bus, w);
}

bool moteus_drive::stop(std::int64_t now_ns, can_bus& bus) noexcept {
  moteus::frame_writer w;
  w.begin(moteus::action::write, moteus::resolution::int8, 1, moteus::reg::mode);
  w.value(stopped, moteus::quantity::plain);
  add_query(w);
  const bool taken = send(now_ns, bus, w);
  stops_ += taken && stops_ < repeats ? 1 : 0;
  return taken;
}

bool moteus_drive::command(std::int64_t now_ns, can_bus& bus, double joint_n_m) noexcept {
  using moteus::action;
  using moteus::quantity;
  using moteus::reg;
  using moteus::resolution;
  const auto limit = static_cast<double>(limit_);
  moteus::frame_writer w;
  w.begin(action::write, resolution::int8, 1, reg::mode);
  w.value(position_mode, quantity::plain);
  w.begin(action::write, resolution::int8, 1, reg::command_position);
  w.none();
  w.begin(action::write, resolution::real, 1, reg::feedforward_torque);
  w.value(scale().shaft_torque(joint_n_m), quantity::torque_n_m, limit);
  w.begin(action::write, resolution::int8, 2, reg::kp_scale);
  w.value(0.0, quantity::scale);
  w.value(0.0, quantity::scale);
  w.begin(action::write, resolution::real, 1, reg::maximum_torque);
  w.value(limit, quantity::torque_n_m);
  w.begin(action::write, resolution::int16, 1, reg::watchdog_timeout);
  w.value(moteus_.watchdog_ms * moteus::unit_of(quantity::time_s, resolution::int16), quantity::time_s);
  w.begin(action::write, resolution::int8, 1, reg::integral_scale);
  w.value(0.0, quantity::scale);
  add_query(w);
  return send(now_ns, bus, w);
}

void moteus_drive::add_query(moteus::frame_writer& w) noexcept {
  w.begin(moteus::action::read, moteus::resolution::int8, 1, moteus::reg::mode);
  w.begin(moteus::action::read, moteus::resolution::real, 3, moteus::reg::position);
  w.begin(moteus::action::read, moteus::resolution::int8, 1, moteus::reg::fault);
}

bool moteus_drive::send(std::int64_t now_ns, can_bus& bus, moteus::frame_writer& w) noexcept {
  can_frame f{.id = moteus::frame_id(moteus_.host_id, moteus_.id, true),
              .extended = true,
              .fd = true,
              .bit_rate_switch = moteus_.bit_rate_switch};
  f.size = static_cast<std::uint8_t>(w.finish(f.data));
  return f.size > 0 && put(now_ns, bus, f);
}

}  // namespace asperity
