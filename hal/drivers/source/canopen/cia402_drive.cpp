#include "asperity/drivers/canopen/cia402_drive.hpp"

#include <cmath>
#include <cstdint>

namespace asperity {

cia402_drive::cia402_drive(const cia402_settings& settings)
    : settings_(settings),
      setup_(settings),
      limit_permille_(canopen::torque_limit_permille(settings)),
      rad_per_count_((settings.reversed ? -1.0 : 1.0) * 6.283185307179586 /
                     (settings.counts_per_turn * settings.gear_ratio)) {
  const double per_permille_n_m = settings.rated_torque_n_m * settings.gear_ratio / 1000.0;
  facts_ = {.protocol = "CiA 402, cyclic synchronous torque",
            .peak_torque_n_m = limit_permille_ * per_permille_n_m,
            .torque_resolution_n_m = per_permille_n_m,
            .zero_torque_error_n_m = 0.0,
            .position_resolution_rad = std::fabs(rad_per_count_),
            .drive_side_watchdog = true,
            .needs_fd = false};
}

void cia402_drive::start(std::int64_t now_ns) noexcept {
  if (phase_ == phase::fault || phase_ == phase::switch_on || phase_ == phase::enabled) return;
  begin(now_ns);
}

bool cia402_drive::enable(std::int64_t now_ns) noexcept {
  if (phase_ != phase::idle) return false;
  torque_n_m_ = 0.0;
  enter(phase::switch_on, now_ns, settings_.state_limit_ns);
  return true;
}

void cia402_drive::disable(std::int64_t now_ns) noexcept {
  torque_n_m_ = 0.0;
  if (phase_ != phase::switch_on && phase_ != phase::enabled) return;
  zero_sent_ = false;
  enter(phase::wind_down, now_ns, settings_.state_limit_ns);
}

bool cia402_drive::clear_fault(std::int64_t now_ns) noexcept {
  if (phase_ != phase::fault) return false;
  begin(now_ns);
  return true;
}

bool cia402_drive::exchanges_data() const noexcept {
  return phase_ == phase::lead || phase_ == phase::idle || phase_ == phase::switch_on || phase_ == phase::enabled ||
         phase_ == phase::wind_down;
}

void cia402_drive::begin(std::int64_t now_ns) noexcept {
  fault_ = {};
  torque_n_m_ = 0.0;
  operational_ = has_status_ = has_motion_ = false;
  was_started_ = false;
  busy_in_a_row_ = resets_sent_ = 0;
  last_emergency_ = 0;
  reset_step_ = 0;
  setup_.restart();
  enter(phase::boot, now_ns, settings_.boot_limit_ns);
  repeat_ns_ = now_ns;
}

void cia402_drive::enter(phase p, std::int64_t now_ns, std::int64_t limit_ns) noexcept {
  phase_ = p;
  due_ns_ = now_ns + limit_ns;
}

void cia402_drive::fail(const char* what, std::uint32_t code) noexcept {
  if (phase_ == phase::fault) return;
  phase_ = phase::fault;
  torque_n_m_ = 0.0;
  fault_ = {what, code};
}

drive_state cia402_drive::state() const noexcept {
  switch (phase_) {
    case phase::off:
      return drive_state::silent;
    case phase::idle:
      return drive_state::idle;
    case phase::enabled:
      return drive_state::enabled;
    case phase::fault:
      return drive_state::fault;
    default:
      return drive_state::starting;
  }
}

bool cia402_drive::take(std::int64_t now_ns, const can_frame& frame) noexcept {
  const std::uint8_t node = settings_.node;
  if (!canopen::is_plain(frame)) return false;
  switch (frame.id - node) {
    case canopen::heartbeat_id:
      if (const auto state = canopen::decode_heartbeat(frame, node)) take_heartbeat(now_ns, *state);
      return true;
    case canopen::tpdo1_id:
      if (const auto status = canopen::decode_status_frame(frame, node)) take_status(now_ns, *status);
      return true;
    case canopen::tpdo2_id:
      if (const auto counts = canopen::decode_motion_frame(frame, node)) take_motion(frame, *counts);
      return true;
    case canopen::sdo_response_id:
      if (const auto answer = canopen::decode_response(frame, node)) take_answer(now_ns, *answer);
      return true;
    case canopen::emergency_id:
      if (const auto e = canopen::decode_emergency(frame, node); e && e->code != 0) {
        last_emergency_ = e->code;
        if (exchanges_data() && phase_ != phase::lead) fail("the drive sent an emergency message", e->code);
      }
      return true;
    default:
      return false;
  }
}

void cia402_drive::take_heartbeat(std::int64_t now_ns, canopen::nmt_state state) noexcept {
  heartbeat_ns_ = now_ns;
  if (state == canopen::nmt_state::boot_up) {
    if (phase_ == phase::boot || phase_ == phase::configure) {  // a repeated reset may be answered twice
      setup_.restart();
      phase_ = phase::configure;
      repeat_ns_ = now_ns;
    } else if (phase_ != phase::off) {
      fail("the drive started anew in the middle of a session", 0);
    }
    return;
  }
  operational_ = state == canopen::nmt_state::operational;
  if (exchanges_data() && !operational_) {
    fail("the drive left the NMT state operational", static_cast<std::uint32_t>(state));
  }
}

void cia402_drive::take_status(std::int64_t now_ns, const canopen::torque_status& status) noexcept {
  if (phase_ != phase::start_node && !exchanges_data()) return;
  status_ = status;
  has_status_ = true;
  data_ns_ = now_ns;
  reading_.torque_n_m = (settings_.reversed ? -1.0 : 1.0) * settings_.gear_ratio *
                        canopen::decode_torque(status.torque_permille, settings_.rated_torque_n_m);
  reading_.has_torque = true;
  judge_power();
}

void cia402_drive::take_motion(const can_frame& frame, const canopen::motion_counts& counts) noexcept {
  if (phase_ != phase::start_node && !exchanges_data()) return;
  has_motion_ = true;
  reading_.host_time_ns = frame.host_time_ns;
  ++reading_.sequence;
  reading_.position_rad = settings_.zero_offset_rad + rad_per_count_ * counts.position;
  reading_.velocity_rad_per_s = rad_per_count_ * counts.velocity_per_s;
  reading_.has_velocity = true;
}

void cia402_drive::take_answer(std::int64_t now_ns, const canopen::sdo_response& answer) noexcept {
  if (phase_ != phase::configure) return;
  if (const auto wrong = setup_.take(answer)) return fail(wrong->what, wrong->code);
  if (setup_.done()) {
    enter(phase::start_node, now_ns, settings_.state_limit_ns);
    repeat_ns_ = now_ns;
  }
}

// Power states that nobody asked for. On the way (lead, switch_on, wind_down) the limit in time is the judge.
void cia402_drive::judge_power() noexcept {
  using canopen::power_state;
  const power_state p = power();
  if (phase_ != phase::lead && exchanges_data() && (p == power_state::fault || p == power_state::fault_reaction)) {
    return fail("the drive reports a fault (its emergency code, or else its status word)",
                last_emergency_ != 0 ? last_emergency_ : status_.status_word);
  }
  if (phase_ == phase::idle && p != power_state::ready_to_switch_on) {
    fail("the drive left the state ready to switch on (status word)", status_.status_word);
  }
  if (phase_ == phase::enabled && p != power_state::operation_enabled) {
    fail("the drive left the state operation enabled (status word)", status_.status_word);
  }
  if (phase_ == phase::enabled && status_.mode != canopen::torque_mode) {
    fail("the drive left the torque mode (object 6061)", static_cast<std::uint8_t>(status_.mode));
  }
}

void cia402_drive::check_limits(std::int64_t now_ns) noexcept {
  if (phase_ == phase::off || phase_ == phase::fault) return;
  if (exchanges_data() && now_ns - heartbeat_ns_ > settings_.drive_silence_ns) {
    return fail("the drive's heartbeat stopped", 0);
  }
  if (exchanges_data() && now_ns - data_ns_ > settings_.drive_silence_ns) {
    return fail("the drive's process data stopped", 0);
  }
  if (phase_ == phase::idle || phase_ == phase::enabled || now_ns <= due_ns_) return;
  switch (phase_) {
    case phase::boot:
      return fail("no boot-up message came from the drive: check its power, its node number and the bit rate", 0);
    case phase::configure:
      return fail("the drive's configuration took too long (index of the object)", object().index);
    case phase::start_node:
      return fail("the drive did not start: no heartbeat in operational, or no process data", status_.status_word);
    case phase::lead:
      return fail(reset_step_ == 2 ? "the drive holds a fault that cannot be reset (its emergency code, or status word)"
                                   : "the drive did not become ready to switch on (status word)",
                  last_emergency_ != 0 ? last_emergency_ : status_.status_word);
    case phase::switch_on:
      return fail("the drive did not enable its operation in torque mode (status word)", status_.status_word);
    default:
      return fail("the drive did not switch off (status word)", status_.status_word);
  }
}

// Phases that end by what the drive said.
void cia402_drive::move_on(std::int64_t now_ns) noexcept {
  using canopen::power_state;
  if (phase_ == phase::start_node && operational_ && has_status_ && has_motion_) {
    enter(phase::lead, now_ns, settings_.state_limit_ns);
  }
  if ((phase_ == phase::lead || (phase_ == phase::wind_down && zero_sent_)) &&
      power() == power_state::ready_to_switch_on) {
    phase_ = phase::idle;
  }
  if (phase_ == phase::switch_on && power() == power_state::operation_enabled && status_.mode == canopen::torque_mode) {
    phase_ = phase::enabled;
  }
}

std::uint16_t cia402_drive::lead_word() noexcept {
  using canopen::power_state;
  namespace control = canopen::control;
  switch (power()) {
    case power_state::fault:
      // Bit 7 has to be low once before it rises.
      reset_step_ = reset_step_ == 0 ? 1 : 2;
      return reset_step_ == 1 ? control::disable_voltage : control::fault_reset;
    case power_state::switch_on_disabled:
    case power_state::ready_to_switch_on:
      return control::shutdown;
    default:
      return control::disable_voltage;
  }
}

canopen::torque_command cia402_drive::command() noexcept {
  using canopen::power_state;
  namespace control = canopen::control;
  canopen::torque_command c;
  switch (phase_) {
    case phase::lead:
      c.control_word = lead_word();
      break;
    case phase::idle:
      c.control_word = control::shutdown;
      break;
    case phase::switch_on:
      switch (power()) {
        case power_state::switched_on:
        case power_state::operation_enabled:
          c.control_word = control::enable_operation;
          break;
        case power_state::ready_to_switch_on:
          c.control_word = control::switch_on;
          break;
        default:
          c.control_word = control::shutdown;
      }
      break;
    case phase::enabled: {
      c.control_word = control::enable_operation;
      const double at_motor_n_m = (settings_.reversed ? -1.0 : 1.0) * torque_n_m_ / settings_.gear_ratio;
      c.torque_permille = canopen::encode_torque(at_motor_n_m, settings_.rated_torque_n_m, limit_permille_);
      break;
    }
    case phase::wind_down:
      // Zero torque is there one period before the power section is switched off.
      c.control_word =
          zero_sent_ || power() != power_state::operation_enabled ? control::shutdown : control::enable_operation;
      zero_sent_ = true;
      break;
    default:
      c.control_word = settings_.quick_stop_on_fault ? control::quick_stop : control::disable_voltage;
  }
  return c;
}

// @return whether the frame went out; `answer` becomes the worse of itself and the bus's
bool cia402_drive::send(std::int64_t now_ns, can_bus& bus, const can_frame& frame, io_status& answer) noexcept {
  const io_status s = bus.send(now_ns, frame);
  if (s == io_status::ok) {
    busy_in_a_row_ = 0;
    return true;
  }
  answer = s;
  if (s != io_status::busy) {
    fail("the bus did not take a frame (answer of the transport)", static_cast<std::uint32_t>(s));
  } else if (++busy_in_a_row_ > most_busy_in_a_row) {
    fail("the queue to the bus stays full", 0);
  }
  return false;
}

io_status cia402_drive::send_configuration(std::int64_t now_ns, can_bus& bus) noexcept {
  io_status answer = io_status::ok;
  if (!setup_.is_due(now_ns)) return answer;
  if (const auto wrong = setup_.unanswered()) {
    fail(wrong->what, wrong->code);
  } else if (send(now_ns, bus, setup_.frame(), answer)) {
    setup_.was_sent(now_ns);
  }
  return answer;
}

io_status cia402_drive::step(std::int64_t now_ns, can_bus& bus) noexcept {
  check_limits(now_ns);
  move_on(now_ns);
  io_status answer = io_status::ok;
  switch (phase_) {
    case phase::off:
      return answer;
    case phase::boot:
      if (now_ns >= repeat_ns_ &&
          send(now_ns, bus, canopen::encode_nmt(canopen::nmt_command::reset_communication, settings_.node), answer)) {
        repeat_ns_ = now_ns + repeat_reset_ns;
      }
      return answer;
    case phase::configure:
      return send_configuration(now_ns, bus);
    case phase::start_node:
      if (now_ns >= repeat_ns_ &&
          send(now_ns, bus, canopen::encode_nmt(canopen::nmt_command::start, settings_.node), answer)) {
        repeat_ns_ = now_ns + repeat_start_ns;
        was_started_ = true;
        heartbeat_ns_ = data_ns_ = now_ns;
      }
      return answer;
    case phase::fault:
      if (!was_started_) return answer;
      if (!operational_ && resets_sent_ < most_resets) {
        // It hears no process data, and may still hold a torque: only NMT reaches it.
        if (send(now_ns, bus, canopen::encode_nmt(canopen::nmt_command::reset_node, settings_.node), answer)) {
          ++resets_sent_;
        }
        return answer;
      }
      break;
    default:
      break;
  }
  static_cast<void>(send(now_ns, bus, canopen::encode(settings_.node, command()), answer));
  return answer;
}

}  // namespace asperity
