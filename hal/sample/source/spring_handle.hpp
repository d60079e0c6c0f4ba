// The device: what asperity/device/device.hpp asks for, in terms of the hardware.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include <asperity/device/device.hpp>
#include <asperity/device/driver_export.hpp>

#include "pretend_hardware.hpp"

namespace sample {

/// What the handle can do. Every number is one that you measured or that your data sheet warrants; what you do not know
/// stays zero, and a limit of zero lets nothing out.
[[nodiscard]] inline asperity::device_capabilities spring_handle_capabilities() noexcept {
  return {.name = "spring handle",
          .maturity = asperity::driver_maturity::simulated,  // yours: protocol_tested, later hardware_verified
          .sensed = asperity::translation_axes,
          .actuated = asperity::translation_axes,
          .continuous_force_n = 2.0,
          .peak_force_n = 4.0,
          .force_slew_n_per_s = 2000.0,
          .max_stiffness_n_per_m = 1000.0,
          .max_stiffness_rate_hz = 1000.0,
          .workspace_low_d = {-0.08, -0.08, -0.08},
          .workspace_high_d = {0.08, 0.08, 0.08},
          .position_resolution_m = pretend_hardware::metres_per_count,
          .nominal_rate_hz = 1000.0,
          .minimum_rate_hz = 200.0,
          .worst_latency_ns = 2'000'000,
          .moving_mass_kg = 0.1,
          .device_side_watchdog = true};
}

/// Motor counts of a force that is at most `limit_n` long. It saturates by itself, whatever it is told: NaN is zero, a
/// longer force is shortened and keeps its direction, and no number changes its sign on the way into 16 bits.
[[nodiscard]] inline std::array<std::int16_t, 3> motor_counts(const asperity::vec3& force_n, double limit_n) noexcept {
  if (!asperity::is_finite(force_n)) return {};
  // Divided before it is squared, so that 1e300 does not become infinite.
  const double largest = std::fmax(std::fabs(force_n.x), std::fmax(std::fabs(force_n.y), std::fabs(force_n.z)));
  if (!(largest > 0.0)) return {};
  const asperity::vec3 direction = force_n / largest;
  const double length = largest * std::sqrt(glm::dot(direction, direction));
  const asperity::vec3 allowed =
      length > limit_n ? (limit_n / std::sqrt(glm::dot(direction, direction))) * direction : force_n;
  std::array<std::int16_t, 3> counts{};
  for (int i = 0; i < 3; ++i) {
    const double c =
        std::trunc(allowed[i] / pretend_hardware::newtons_per_count);  // towards zero: never above the limit
    counts[static_cast<std::size_t>(i)] = static_cast<std::int16_t>(std::fmin(std::fmax(c, -32767.0), 32767.0));
  }
  return counts;
}

class spring_handle {
 public:
  using policy_tag = asperity::device_tag;  // "I keep the contract in device.hpp"

  spring_handle() = default;
  spring_handle(const spring_handle&) = delete;
  spring_handle& operator=(const spring_handle&) = delete;
  ~spring_handle() { close(); }

  [[nodiscard]] const asperity::device_capabilities& capabilities() const noexcept { return capabilities_; }
  [[nodiscard]] asperity::device_state state() const noexcept { return machine_.state(); }

  [[nodiscard]] asperity::result<void> open() {
    if (!hardware_.plugged_in()) {
      machine_.apply(asperity::device_event::departed);
      return asperity::error{asperity::error_code::io_failed, "the spring handle is not plugged in; plug it in"};
    }
    if (machine_.state() == asperity::device_state::closed || machine_.state() == asperity::device_state::absent) {
      machine_.apply(asperity::device_event::arrived);
    }
    if (!machine_.apply(asperity::device_event::opened)) return refused("open");
    // Here: read the firmware's version and limits, home the axes, wait until measurements flow.
    if (!hardware_.send({}, no_output)) {
      machine_.apply(asperity::device_event::closed);
      return asperity::error{asperity::error_code::io_failed, "the spring handle does not answer; plug it in again"};
    }
    machine_.apply(asperity::device_event::prepared);
    return {};
  }

  [[nodiscard]] asperity::result<void> arm() {
    if (!machine_.apply(asperity::device_event::armed)) return refused("arm");
    return {};
  }

  [[nodiscard]] asperity::result<void> clear_fault() {
    if (!machine_.apply(asperity::device_event::cleared)) return refused("clear_fault");
    cause_ = "";
    return {};
  }

  asperity::status disarm() noexcept {
    const bool sent = hardware_.send({}, no_output);
    if (!machine_.apply(asperity::device_event::disarmed)) return asperity::status::not_ready;
    return sent ? asperity::status::ok : asperity::status::backend_failed;
  }

  void close() noexcept {
    static_cast<void>(hardware_.send({}, no_output));
    machine_.apply(asperity::device_event::closed);
  }

  [[nodiscard]] asperity::status read(std::int64_t now_ns, asperity::device_sample& in) noexcept {
    if (!measures()) return asperity::status::not_ready;
    encoder_frame frame;
    if (!hardware_.receive(now_ns, frame)) return lost("the handle does not answer: its cable is out");
    if (frame.number != newest_.sequence) {  // otherwise the last sample stays as it is
      newest_.host_time_ns = now_ns;
      newest_.device_time_ns = frame.time_ns;
      newest_.sequence = frame.number;
      for (int i = 0; i < 3; ++i) {
        newest_.T_dh.position[i] = pretend_hardware::metres_per_count * frame.counts[static_cast<std::size_t>(i)];
      }
      newest_.valid = asperity::sample_field::position;  // no rotation, no velocity: this device does not measure them
    }
    in = newest_;
    return asperity::status::ok;
  }

  [[nodiscard]] asperity::status write(std::int64_t now_ns, const asperity::device_command& out) noexcept {
    if (!measures()) return asperity::status::not_ready;
    const bool armed = asperity::may_put_out(machine_.state());
    const bool sound = out.frame == asperity::wrench_frame::device_base && asperity::is_finite(out.on_hand);
    const bool fresh = now_ns <= out.valid_until_ns;
    const asperity::vec3 force = armed && sound && fresh ? out.on_hand.force : asperity::vec3(0.0);

    const std::array<std::int16_t, 3> counts = motor_counts(force, capabilities_.peak_force_n);
    if (!hardware_.send(counts, out.valid_until_ns)) return lost("a command could not be sent");
    if (!armed) return asperity::status::ok;
    const bool zero = counts == std::array<std::int16_t, 3>{};
    machine_.apply(zero ? asperity::device_event::released : asperity::device_event::engaged);
    if (!sound) {
      cause_ = "a command was not a finite wrench in the device's base frame";
      machine_.apply(asperity::device_event::failed);
      return asperity::status::not_finite;
    }
    return asperity::status::ok;
  }

  // Optional, for the conformance kit and for people who look for a fault.

  [[nodiscard]] asperity::status applied(std::int64_t now_ns, asperity::wrench& out) const noexcept {
    const std::array<std::int16_t, 3> counts = hardware_.motors(now_ns);
    out = {};
    for (int i = 0; i < 3; ++i) {
      out.force[i] = pretend_hardware::newtons_per_count * counts[static_cast<std::size_t>(i)];
    }
    return asperity::status::ok;
  }

  [[nodiscard]] std::string fault_text() const { return cause_; }

  // Only because there is no hardware: a driver of real hardware leaves this out.
  [[nodiscard]] bool provoke(asperity::provocation what) {
    switch (what) {
      case asperity::provocation::departure:
        hardware_.plug(false);
        return true;
      case asperity::provocation::comeback:
        hardware_.plug(true);
        return true;
      case asperity::provocation::write_failure:
        hardware_.next_transfer_fails = true;
        return true;
    }
    return false;
  }

 private:
  static constexpr std::int64_t no_output = -1;  // a watchdog that has run out

  [[nodiscard]] bool measures() const noexcept { return asperity::measures(machine_.state()); }

  // The link failed: what may put out becomes a fault, and stays one.
  [[nodiscard]] asperity::status lost(const char* cause) noexcept {
    static_cast<void>(hardware_.send({}, no_output));
    cause_ = cause;
    machine_.apply(hardware_.plugged_in() ? asperity::device_event::failed : asperity::device_event::departed);
    return asperity::status::backend_failed;
  }

  [[nodiscard]] asperity::error refused(const char* what) const {
    return {asperity::error_code::invalid_argument,
            std::string(what) + "() is not possible while the spring handle is " + to_string(machine_.state())};
  }

  asperity::device_capabilities capabilities_ = spring_handle_capabilities();
  asperity::device_state_machine machine_{asperity::device_state::present};
  pretend_hardware hardware_{};
  asperity::device_sample newest_{};
  const char* cause_ = "";
};

}  // namespace sample
