#include "asperity/drivers/joint/can_joint_drive.hpp"

#include <cmath>
#include <cstdint>

namespace asperity {

bool joint_drive_settings::usable() const noexcept {
  return scale.usable() && std::isfinite(peak_torque_n_m) && peak_torque_n_m > 0.0 && peak_torque_n_m <= 1e6 &&
         std::isfinite(fastest_rad_per_s) && fastest_rad_per_s > 0.0 && step_limit_ns > 0 && quiet_ns > 0 &&
         silence_ns >= quiet_ns && hold_ns > 0;
}

drive_state can_joint_drive::state() const noexcept {
  switch (phase_) {
    case phase::off:
    case phase::seeking:
      return drive_state::silent;
    case phase::idle:
      return drive_state::idle;
    case phase::enabled:
      return drive_state::enabled;
    case phase::faulted:
      return drive_state::fault;
    case phase::leading:
    case phase::arming:
    case phase::leaving:
      break;
  }
  return drive_state::starting;
}

void can_joint_drive::start(std::int64_t now_ns) noexcept {
  if (phase_ != phase::off) return;
  lead(now_ns, false);
}

bool can_joint_drive::enable(std::int64_t now_ns) noexcept {
  if (phase_ != phase::idle) return false;
  enter(phase::arming, now_ns);
  return true;
}

void can_joint_drive::disable(std::int64_t now_ns) noexcept {
  torque_n_m_ = 0.0;
  if (phase_ == phase::arming || phase_ == phase::enabled) enter(phase::leaving, now_ns);
}

bool can_joint_drive::clear_fault(std::int64_t now_ns) noexcept {
  if (phase_ != phase::faulted) return false;
  fault_ = {};
  lead(now_ns, true);
  return true;
}

void can_joint_drive::set_torque(double torque_n_m) noexcept {
  torque_n_m_ = saturated(torque_n_m, facts_.peak_torque_n_m);
  renewed_ = true;
}

io_status can_joint_drive::step(std::int64_t now_ns, can_bus& bus) noexcept {
  if (phase_ == phase::off || !usable_) return io_status::ok;
  watch(now_ns);
  worst_ = io_status::ok;
  if (facts_.needs_fd && !bus.takes_fd()) {
    fail("the bus carries no CAN FD, which this drive needs", 0);
    return io_status::refused;
  }
  send_due(now_ns, bus);
  judge();
  return worst_;
}

can_joint_drive::can_joint_drive(const joint_drive_settings& settings) noexcept
    : options_(settings), usable_(settings.usable()) {
  if (!usable_) options_ = joint_drive_settings{};
  facts_.peak_torque_n_m = options_.peak_torque_n_m;
}

double can_joint_drive::torque_due(std::int64_t now_ns) const noexcept {
  if (phase_ != phase::enabled || is_quiet(now_ns)) return 0.0;
  return torque_n_m_;
}

bool can_joint_drive::put(std::int64_t now_ns, can_bus& bus, const can_frame& frame) noexcept {
  const io_status s = bus.send(now_ns, frame);
  if (s == io_status::ok) return true;
  if (worst_ == io_status::ok || worst_ == io_status::busy) worst_ = s;
  return false;
}

void can_joint_drive::fail(const char* what, std::uint32_t code, std::int64_t now_ns) noexcept {
  if (phase_ == phase::off || phase_ == phase::faulted) return;
  fault_ = {what, code};
  enter(phase::faulted, now_ns);
}

void can_joint_drive::heard(std::int64_t now_ns) noexcept {
  heard_ns_ = now_ns;
  seen_ns_ = now_ns;
  if (phase_ == phase::seeking) lead(now_ns, false);
}

void can_joint_drive::heard_position(std::int64_t now_ns, const can_frame& frame, double position_rad) noexcept {
  if (!std::isfinite(position_rad) || std::fabs(position_rad) > 1e6) {
    fail("the drive reports a position that cannot be", 0, now_ns);
    return;
  }
  if (has_position_) {
    constexpr double jitter_s = 5e-3;
    const double reach = options_.fastest_rad_per_s * (static_cast<double>(now_ns - position_ns_) * 1e-9 + jitter_s);
    if (std::fabs(position_rad - reading_.position_rad) > reach) {
      fail("the position jumped: the drive was reset or lost its count", 0, now_ns);
    }
  }
  has_position_ = true;
  position_ns_ = now_ns;
  reading_.host_time_ns = frame.host_time_ns;
  reading_.position_rad = position_rad;
  ++reading_.sequence;
}

void can_joint_drive::heard_velocity(double velocity_rad_per_s) noexcept {
  reading_.has_velocity = std::isfinite(velocity_rad_per_s);
  reading_.velocity_rad_per_s = reading_.has_velocity ? velocity_rad_per_s : 0.0;
}

void can_joint_drive::heard_torque(double torque_n_m) noexcept {
  reading_.has_torque = std::isfinite(torque_n_m);
  reading_.torque_n_m = reading_.has_torque ? torque_n_m : 0.0;
}

void can_joint_drive::enter(phase next, std::int64_t now_ns) noexcept {
  phase_ = next;
  since_ns_ = now_ns;
  seen_ns_ = now_ns;
  owes_zero_ = next == phase::leaving || next == phase::faulted;
  torque_n_m_ = 0.0;
  ever_set_ = false;
  renewed_ = false;
  renewed_ns_ = now_ns;
}

void can_joint_drive::lead(std::int64_t now_ns, bool clearing) noexcept {
  has_position_ = false;
  busy_ = 0;
  heard_ns_ = now_ns;
  enter(phase::leading, now_ns);
  begin_lead(clearing);
  if (!usable_) fail("settings of this drive are outside their ranges: gear ratio, torque, id or times", 0, now_ns);
}

void can_joint_drive::watch(std::int64_t now_ns) noexcept {
  seen_ns_ = now_ns;
  const bool late = now_ns - since_ns_ > options_.step_limit_ns;
  const bool silent = now_ns - heard_ns_ > options_.silence_ns;
  fed_ = true;
  switch (phase_) {
    case phase::leading:
      if (late) fail(late_lead(), 0, now_ns);
      break;
    case phase::arming:
      if (late) fail("the drive did not enable in time", 0, now_ns);
      break;
    case phase::leaving:
      if (late) fail("the drive did not confirm in time that its torque is off", 0, now_ns);
      break;
    case phase::idle:
      if (silent) enter(phase::seeking, now_ns);
      break;
    case phase::enabled: {
      // Also where the application is back by now: what was held for too long does not go on by itself.
      const bool late_torque = ever_set_ && now_ns - renewed_ns_ > options_.hold_ns;
      ever_set_ = ever_set_ || renewed_;
      fed_ = renewed_ || !ever_set_;
      if (fed_) renewed_ns_ = now_ns;
      if (silent) {
        fail("the drive fell silent", 0, now_ns);
      } else if (late_torque) {
        fail("the application did not renew its torque in time", 0, now_ns);
      }
      break;
    }
    case phase::off:
    case phase::seeking:
    case phase::faulted:
      break;
  }
  renewed_ = false;
}

const char* can_joint_drive::late_lead() const noexcept {
  if (!has_position_ && malformed_ > 0) return "something answers with this drive's id, but not in its protocol";
  return has_position_ ? "the drive did not become idle in time" : "the drive does not answer";
}

void can_joint_drive::judge() noexcept {
  if (worst_ == io_status::ok || worst_ == io_status::nothing) {
    busy_ = 0;
    return;
  }
  if (worst_ == io_status::busy) {
    if (++busy_ > busy_limit) fail("the bus took no frame: its queue stays full", 0);
    return;
  }
  switch (worst_) {
    case io_status::down:
      fail("the bus took no frame: it is down or bus-off", 0);
      break;
    case io_status::gone:
      fail("the bus took no frame: its interface is gone", 0);
      break;
    case io_status::too_short:
      fail("the bus took a part of a frame only", 0);
      break;
    case io_status::refused:
      fail("the bus cannot carry this drive's frames", 0);
      break;
    default:
      fail("the bus took no frame: sending failed", 0);
      break;
  }
}

}  // namespace asperity
