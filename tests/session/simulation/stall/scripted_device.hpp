// A device whose handle is moved by a script, whatever it puts out, with an account of what its motors did.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "asperity/device/device.hpp"

namespace asperity::simulation {

/// Where the handle is, as a function of time: a press in cycles, a scrub across, a turn about one axis that stays.
/// With one axis, torque times angle is the work of a constant torque exactly.
struct hand_script {
  double above_m = 0.002;  ///< height over the surface at the beginning
  double depth_m = 0.01;   ///< of the deepest point under the surface
  double press_hz = 1.0;
  double scrub_m = 0.01;
  double scrub_hz = 1.0;
  vec3 axis{1.0, 0.0, 0.0};
  double turn_rad = 0.1;
  double turn_hz = 1.0;

  [[nodiscard]] double angle_rad(std::int64_t t_ns) const noexcept { return turn_rad * std::sin(turn(turn_hz, t_ns)); }
  [[nodiscard]] pose at(std::int64_t t_ns) const noexcept {
    const double pressed = 0.5 - 0.5 * std::cos(turn(press_hz, t_ns));
    return {exp_rotation(angle_rad(t_ns) * axis),
            {scrub_m * std::sin(turn(scrub_hz, t_ns)), 0.3 * scrub_m * std::sin(turn(0.7 * scrub_hz, t_ns)),
             above_m - (above_m + depth_m) * pressed}};
  }

 private:
  [[nodiscard]] static double turn(double hz, std::int64_t t_ns) noexcept {
    return 6.283185307179586 * hz * 1e-9 * static_cast<double>(t_ns);
  }
};

/// What the motors did from one moment on, until the next entry.
struct motor_entry {
  std::int64_t from_ns = 0;
  wrench out{};
  bool commanded = false;  ///< a command began it; otherwise the last command expired
};

/// Energy that the motors gave to the hand, J, by the script's own poses.
struct motor_work {
  double renewed_j = 0.0;    ///< under commands that were renewed in time
  double expired_j = 0.0;    ///< under commands that expired: while they were valid
  double expired_way = 0.0;  ///< most that such a command can have given, from the way of the handle, J
};

/// Keeps the device's contract: a command is put out while it is valid, and nothing after.
class scripted_device {
 public:
  using policy_tag = device_tag;

  scripted_device(const hand_script& hand, const device_capabilities& c) : hand_(hand), capabilities_(c) {
    motors_.reserve(16384);
  }

  [[nodiscard]] const device_capabilities& capabilities() const noexcept { return capabilities_; }
  [[nodiscard]] device_state state() const noexcept { return machine_.state(); }
  [[nodiscard]] result<void> open() {
    for (const device_event e : {device_event::arrived, device_event::opened, device_event::prepared})
      machine_.apply(e);
    return {};
  }
  [[nodiscard]] result<void> arm() {
    machine_.apply(device_event::armed);
    return {};
  }
  [[nodiscard]] result<void> clear_fault() { return {}; }
  status disarm() noexcept {
    command_.on_hand = {};
    machine_.apply(device_event::disarmed);
    return status::ok;
  }
  void close() noexcept { machine_.apply(device_event::closed); }

  [[nodiscard]] status read(std::int64_t now_ns, device_sample& in) noexcept {
    in.host_time_ns = in.device_time_ns = now_ns;
    in.sequence = ++sequence_;
    in.T_dh = hand_.at(now_ns);
    in.valid = sample_field::position | sample_field::rotation;
    return status::ok;
  }

  [[nodiscard]] status write(std::int64_t now_ns, const device_command& out) noexcept {
    settle(now_ns);
    command_ = out;
    if (!may_put_out(machine_.state())) command_.on_hand = {};
    commanded_at_ns_ = now_ns;
    push({now_ns, command_.on_hand, true});
    return status::ok;
  }

  /// Everything that the motors did, in order. May miss what came after `full()` turned true.
  [[nodiscard]] const std::vector<motor_entry>& motors() const noexcept { return motors_; }
  [[nodiscard]] bool full() const noexcept { return full_; }
  [[nodiscard]] const motor_work& work() const noexcept { return work_; }

 private:
  // The last command from when it was told to now, or to its end.
  void settle(std::int64_t now_ns) noexcept {
    if (commanded_at_ns_ < 0) return;
    const bool expired = now_ns > command_.valid_until_ns;
    const std::int64_t end_ns = std::min(now_ns, command_.valid_until_ns);
    const vec3 way = hand_.at(end_ns).position - hand_.at(commanded_at_ns_).position;
    const double turned = hand_.angle_rad(end_ns) - hand_.angle_rad(commanded_at_ns_);
    const wrench& w = command_.on_hand;
    const double given_j = glm::dot(w.force, way) + glm::dot(w.torque, hand_.axis) * turned;
    if (!expired) {
      work_.renewed_j += given_j;
      return;
    }
    work_.expired_j += given_j;
    work_.expired_way += glm::length(w.force) * glm::length(way) + glm::length(w.torque) * std::fabs(turned);
    push({command_.valid_until_ns, {}, false});
  }

  void push(const motor_entry& e) noexcept {
    full_ = full_ || motors_.size() == motors_.capacity();
    if (!full_) motors_.push_back(e);
  }

  hand_script hand_;
  device_capabilities capabilities_;
  device_state_machine machine_{};
  device_command command_{};
  std::int64_t commanded_at_ns_ = -1;
  std::uint64_t sequence_ = 0;
  std::vector<motor_entry> motors_;
  bool full_ = false;
  motor_work work_{};
};

static_assert(haptic_device<scripted_device>);

}  // namespace asperity::simulation
