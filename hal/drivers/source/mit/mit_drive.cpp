#include "asperity/drivers/mit/mit_drive.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

namespace asperity {

mit_drive::mit_drive(const mit_settings& settings) noexcept
    : can_joint_drive(settings.joint),
      mit_(settings.ranges.usable() ? settings : defaults(settings)),
      position_(mit_.ranges.position_rad, 16),
      torque_(mit_.ranges.torque_n_m, 12, static_cast<double>(scale().shaft_limit(this->settings().peak_torque_n_m))) {
  drive_facts& f = facts_to_fill();
  const double gear = scale().gear_ratio;
  f.protocol = "MIT";
  f.peak_torque_n_m = std::min(f.peak_torque_n_m, torque_.largest() * gear);
  f.torque_resolution_n_m = 2.0 * torque_.half_step() * gear;
  f.zero_torque_error_n_m = scale().torque(torque_.decode(torque_.encode(0.0)));
  f.position_resolution_rad = 2.0 * position_.half_step() / gear;
  f.drive_side_watchdog = mit_.watchdog_set;
  const bool ids = mit_.motor_id <= 0x7ff && mit_.master_id <= 0x7ff;
  if (!settings.ranges.usable() || !ids || torque_.largest() * gear > this->settings().peak_torque_n_m) {
    refuse_settings();
  }
}

bool mit_drive::take(std::int64_t now_ns, const can_frame& frame) noexcept {
  if (frame.extended || frame.remote || frame.id != mit_.master_id || frame.size == 0) return false;
  if (frame.data[0] != (mit_.motor_id & 0xffU)) return false;
  if (at() == phase::off) return true;
  mit::reply r{};
  const auto size = std::min<std::size_t>(frame.size, frame.data.size());
  if (!mit::decode_reply(std::span(frame.data).first(size), mit_.ranges, r) ||
      (reply_size_ != 0 && r.size != reply_size_)) {
    count_malformed();
    return true;
  }
  reply_size_ = r.size;
  heard(now_ns);
  take_position(now_ns, frame, r);
  heard_velocity(scale().velocity(r.velocity_rad_per_s));
  heard_torque(scale().torque(r.torque_n_m));
  advance(now_ns, r);
  return true;
}

mit_settings mit_drive::defaults(mit_settings o) noexcept {
  o.ranges = mit::ak80_9;
  return o;
}

void mit_drive::begin_lead(bool clearing) noexcept {
  reply_size_ = 0;
  fresh_lead_ = true;
  clearing_ = clearing;
  begin(stage::zero);
}

void mit_drive::begin(stage s) noexcept {
  stage_ = s;
  sent_ = 0;
  answers_ = 0;
}

void mit_drive::take_position(std::int64_t now_ns, const can_frame& frame, const mit::reply& r) noexcept {
  if (fresh_lead_) {
    counts_ = r.position_counts;
  } else {
    // The nearest way round: half a turn of the counter between two answers is over any speed that is allowed.
    const auto last = static_cast<std::uint16_t>(counts_ & 0xffff);
    counts_ += static_cast<std::int16_t>(static_cast<std::uint16_t>(r.position_counts - last));
  }
  fresh_lead_ = false;
  const double shaft = (2.0 * static_cast<double>(counts_) - 65535.0) * position_.half_step();
  heard_position(now_ns, frame, scale().angle(shaft));
}

void mit_drive::advance(std::int64_t now_ns, const mit::reply& r) noexcept {
  if (r.error != 0) {
    if (at() == phase::leading && clearing_ && now_ns - since_ns() < old_error_ns) return;
    fail(mit::to_string_error(r.error), r.error, now_ns);
    return;
  }
  ++answers_;
  const bool heard_all = sent_ >= repeats && answers_ >= repeats;
  switch (at()) {
    case phase::leading:
    case phase::leaving:
      if (stage_ == stage::exit && heard_all) reached(phase::idle, now_ns);
      break;
    case phase::arming:
      if (heard_all && stage_ == stage::confirm) {
        follow_ns_ = now_ns;
        reached(phase::enabled, now_ns);
      } else if (heard_all) {
        begin(stage_ == stage::zero ? stage::enter : stage::confirm);
      }
      break;
    case phase::enabled:
      follow(now_ns, r);
      break;
    default:
      break;
  }
}

void mit_drive::follow(std::int64_t now_ns, const mit::reply& r) noexcept {
  const double wanted = std::fabs(commanded_n_m_);
  const bool commanded = wanted > 16.0 * torque_.half_step();
  if (!commanded || std::fabs(r.torque_n_m) > 0.25 * wanted) follow_ns_ = now_ns;
  if (mit_.follow_ns > 0 && now_ns - follow_ns_ > mit_.follow_ns) {
    fail("the drive answers, but puts out no torque: it was reset or left motor mode", 0, now_ns);
  }
}

void mit_drive::send_due(std::int64_t now_ns, can_bus& bus) noexcept {
  switch (at()) {
    case phase::leading:
      if (stage_ == stage::zero) {
        if (send_torque(now_ns, bus, 0.0)) begin(stage::exit);
      } else {
        send(now_ns, bus, mit::exit_motor_mode);
      }
      break;
    case phase::arming:
      if (owes_start_) begin(stage::zero);
      owes_start_ = false;
      if (stage_ == stage::enter) {
        send(now_ns, bus, mit::enter_motor_mode);
      } else {
        send_torque(now_ns, bus, 0.0);
      }
      break;
    case phase::enabled:
      if (is_fed()) send_torque(now_ns, bus, torque_due(now_ns));
      break;
    case phase::leaving:
    case phase::faulted:
      owes_start_ = true;
      if (owes_zero()) {
        if (send_torque(now_ns, bus, 0.0)) {
          zero_was_sent();
          begin(stage::exit);
        }
      } else {
        send(now_ns, bus, mit::exit_motor_mode);
      }
      break;
    case phase::idle:
    case phase::seeking:
      owes_start_ = true;
      send(now_ns, bus, mit::exit_motor_mode);
      break;
    case phase::off:
      break;
  }
}

bool mit_drive::send_torque(std::int64_t now_ns, can_bus& bus, double joint_n_m) noexcept {
  const double shaft = scale().shaft_torque(joint_n_m);
  commanded_n_m_ = torque_.decode(torque_.encode(shaft));
  return send(now_ns, bus, mit::encode_torque(shaft, mit_.ranges, torque_));
}

bool mit_drive::send(std::int64_t now_ns, can_bus& bus, const mit::command_bytes& bytes) noexcept {
  can_frame f{.id = mit_.motor_id, .size = 8};
  std::copy(bytes.begin(), bytes.end(), f.data.begin());
  const bool taken = put(now_ns, bus, f);
  sent_ += taken && sent_ < repeats ? 1 : 0;
  return taken;
}

}  // namespace asperity
