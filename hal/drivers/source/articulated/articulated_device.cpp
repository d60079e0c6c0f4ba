#include "asperity/drivers/articulated/articulated_device.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

namespace asperity {

result<articulated_device> articulated_device::make(articulated_settings settings) {
  if (result<void> good = check(settings); !good) return good.error();
  return articulated_device(std::move(settings));
}

articulated_device::~articulated_device() {
  if (!settings_.joints.empty()) close();  // not moved from
}

wrench_room articulated_device::room() const noexcept {
  const chain_pose at = forward(settings_.chain, angles_rad_);
  return room_for_wrench(settings_.chain, at, own_torques(at, 1.0), limits_n_m_);
}

articulated_device::articulated_device(articulated_settings settings)
    : settings_(std::move(settings)), drives_(settings_.joints, settings_.buses) {
  capabilities_ = capabilities_of(settings_);
  for (std::size_t i = 0; i < size(); ++i) {
    limits_n_m_[i] = torque_limit_n_m(settings_.joints[i], settings_.chain.joints[i]);
  }
}

bool articulated_device::well(const std::optional<arm_fault>& fault) noexcept {
  if (fault) fail(*fault);
  return !fault;
}

void articulated_device::fail(const arm_fault& fault) noexcept {
  if (!has_fault_) fault_ = fault;
  has_fault_ = true;
  machine_.apply(fault.departed ? device_event::departed : device_event::failed);
  silence();
}

void articulated_device::silence() noexcept {
  command_ = {};
  pushes_ = false;
  torques_ = {};
  drives_.silence(now_ns_);
}

// Judges what the drives say. In open() this begins when all of them are idle.
bool articulated_device::supervise() noexcept {
  const auto wrong = [this](const char* what, std::size_t joint) {
    fail(what, static_cast<int>(joint));
    return false;
  };
  for (std::size_t i = 0; i < size(); ++i) {
    const joint_drive& d = drives_[i];
    if (d.state() == drive_state::fault) return well(drives_.fault_of_drive(i));
    const joint_reading& r = d.reading();
    if (!std::isfinite(r.position_rad) || !std::isfinite(r.velocity_rad_per_s)) {
      return wrong("the joint's angle or speed is not finite", i);
    }
    if (r.sequence != 0) angles_rad_[i] = r.position_rad;
    rates_rad_per_s_[i] = r.has_velocity ? r.velocity_rad_per_s : 0.0;
    if (!measures()) continue;

    const chain_joint& j = settings_.chain.joints[i];
    if (now_ns_ - r.host_time_ns > settings_.reading_limit_ns) return wrong("the joint's reading is too old", i);
    if (angles_rad_[i] < j.lower_rad - settings_.stop.overrun_rad ||
        angles_rad_[i] > j.upper_rad + settings_.stop.overrun_rad) {
      return wrong("the joint is beyond its limits: its zero is wrong, or its stop is broken", i);
    }
    if (std::fabs(rates_rad_per_s_[i]) > settings_.joints[i].max_speed_rad_per_s) {
      return wrong("the joint is faster than its limit", i);
    }
    if (may_put_out(machine_.state()) && d.state() != drive_state::enabled) {
      return wrong("the drive is not enabled any more", i);
    }
  }
  return true;
}

joint_vector articulated_device::own_torques(const chain_pose& at, double gravity) const noexcept {
  joint_vector own{};
  if (settings_.gravity_compensation) own = torques_against_gravity(settings_.chain, at);
  for (std::size_t i = 0; i < size(); ++i) {
    own[i] =
        with_stop(gravity * own[i], settings_.stop, settings_.chain.joints[i], angles_rad_[i], rates_rad_per_s_[i]);
  }
  return own;
}

double articulated_device::gravity_share() const noexcept {
  if (settings_.gravity_ramp_ns <= 0) return 1.0;
  return std::clamp(static_cast<double>(now_ns_ - armed_ns_) / static_cast<double>(settings_.gravity_ramp_ns), 0.0,
                    1.0);
}

/// @pre may_put_out(state())
bool articulated_device::put_out(const wrench& on_hand) noexcept {
  const chain_pose at = forward(settings_.chain, angles_rad_);
  torques_ =
      share_torques(size(), own_torques(at, gravity_share()), torques_for(settings_.chain, at, on_hand), limits_n_m_);
  if (!torques_.finite) {
    fail("the joint torques of the wrench are not finite");
    return false;
  }
  drives_.set_torques(torques_.torque_n_m);
  pushes_ = on_hand.force != vec3(0.0) || on_hand.torque != vec3(0.0);
  return well(drives_.step(now_ns_));
}

status articulated_device::read(std::int64_t now_ns, device_sample& in) noexcept {
  advance(now_ns);
  if (!measures()) return status::not_ready;
  if (!well(drives_.drain(now_ns_)) || !supervise()) return status::backend_failed;
  // The application reads but does not write: its last wrench runs out here.
  if (pushes_ && now_ns_ > command_.valid_until_ns && !put_out({})) return status::backend_failed;

  // A measurement is complete when every joint has moved on.
  if (drives_.measured_anew()) {
    const chain_pose at = forward(settings_.chain, angles_rad_);
    const std::int64_t oldest_ns = drives_.oldest_reading_ns(now_ns_);
    newest_.host_time_ns = oldest_ns;
    newest_.device_time_ns = oldest_ns;
    ++newest_.sequence;
    newest_.lost = drives_.lost();
    newest_.T_dh = at.T_dh;
    newest_.velocity_d = handle_velocity(settings_.chain, at, rates_rad_per_s_);
    newest_.valid = sample_field::position | sample_field::rotation | sample_field::linear_velocity |
                    sample_field::angular_velocity;
  }
  in = newest_;
  return status::ok;
}

status articulated_device::write(std::int64_t now_ns, const device_command& out) noexcept {
  advance(now_ns);
  if (machine_.state() == device_state::fault) {
    drives_.wind_down(now_ns_);
    return status::not_ready;
  }
  if (!measures()) return status::not_ready;
  if (machine_.state() == device_state::ready) {
    drives_.set_torques({});
    torques_ = {};
    return well(drives_.step(now_ns_)) ? status::ok : status::backend_failed;
  }
  if (out.frame != wrench_frame::device_base || !is_finite(out.on_hand)) {
    fail("a command was not finite, or not written in the device's base frame");
    return status::not_finite;
  }
  const bool fresh = now_ns_ <= out.valid_until_ns;
  const wrench on_hand = fresh ? out.on_hand : wrench{};
  const bool zero = is_zero(on_hand);
  machine_.apply(zero ? device_event::released : device_event::engaged);
  command_ = out;
  return put_out(on_hand) ? status::ok : status::backend_failed;
}

// Ticks until done(); false where a fault came, of which one is that time ran out.
template <class Done>
bool articulated_device::tick_until(std::int64_t limit_ns, Done&& done, const char* late) noexcept {
  io_clock& clock = *settings_.clock;
  advance(clock.now_ns());
  const std::int64_t end_ns = now_ns_ + limit_ns;
  while (now_ns_ < end_ns) {
    if (!well(drives_.drain(now_ns_)) || !supervise()) return false;
    if (done()) return true;
    if (!well(drives_.step(now_ns_))) return false;
    clock.wait_until_ns(now_ns_ + settings_.period_ns);
    advance(clock.now_ns());
  }
  fail(late);
  return false;
}

result<void> articulated_device::refused(const char* what) const {
  return error{error_code::invalid_argument,
               std::string(what) + "() is not possible while the arm is " + to_string(machine_.state())};
}

error articulated_device::failed(const char* what) const {
  return {error_code::io_failed, std::string(what) + "() of the arm failed: " + fault_words()};
}

result<void> articulated_device::open() {
  if (machine_.state() == device_state::absent || machine_.state() == device_state::closed) {
    machine_.apply(device_event::arrived);
  }
  if (!machine_.apply(device_event::opened)) return refused("open");
  has_fault_ = false;
  fault_ = {};
  advance(settings_.clock->now_ns());
  drives_.start(now_ns_);
  const auto idle = [this] { return drives_.all_idle(); };
  if (!tick_until(settings_.open_limit_ns, idle, "the drives did not all become idle in time")) return failed("open");
  machine_.apply(device_event::prepared);
  if (!supervise()) return failed("open");
  newest_.valid = sample_field::none;
  return {};
}

result<void> articulated_device::arm() {
  if (machine_.state() != device_state::ready) return refused("arm");
  advance(settings_.clock->now_ns());
  // After a disarm() the drives are on their way to idle for some periods.
  const auto idle = [this] { return drives_.all_idle(); };
  const auto enabled = [this] { return drives_.all_enabled(); };
  if (!tick_until(settings_.arm_limit_ns, idle, "the drives did not all become idle in time")) return failed("arm");
  if (!well(drives_.enable(now_ns_))) return failed("arm");
  if (!tick_until(settings_.arm_limit_ns, enabled, "the drives were not all enabled in time")) return failed("arm");
  armed_ns_ = now_ns_;
  command_ = {};
  machine_.apply(device_event::armed);
  return {};
}

result<void> articulated_device::clear_fault() {
  if (!machine_.apply(device_event::cleared)) return refused("clear_fault");
  advance(settings_.clock->now_ns());
  drives_.clear_faults(now_ns_);
  return {};
}

status articulated_device::disarm() noexcept {
  const bool allowed = machine_.apply(device_event::disarmed);
  silence();
  return allowed ? status::ok : status::not_ready;
}

void articulated_device::close() noexcept {
  constexpr int most_ticks = 100;
  const bool was_open = machine_.state() != device_state::absent && machine_.state() != device_state::closed &&
                        machine_.state() != device_state::present;
  if (!was_open) return;
  machine_.apply(device_event::disarmed);
  silence();
  // The drives switch their power sections off before their supervision of us ends.
  io_clock& clock = *settings_.clock;
  for (int k = 0; k < most_ticks && !drives_.none_on(); ++k) {
    clock.wait_until_ns(clock.now_ns() + settings_.period_ns);
    advance(clock.now_ns());
    drives_.wind_down(now_ns_);
  }
  drives_.finish(now_ns_);
  machine_.apply(device_event::closed);
}

}  // namespace asperity
