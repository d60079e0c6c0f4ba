// A device made of numbers: a plant, a hand and a script of faults on a virtual clock.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string>

#include "asperity/core/export.hpp"
#include "asperity/device/device.hpp"
#include "asperity/device/simulated/actuator.hpp"
#include "asperity/device/simulated/motion_script.hpp"
#include "asperity/device/simulated/simulated_settings.hpp"

namespace asperity {

/// Where the energy of the plant went since the first read(), J. Works are of the wrench at the end of a plant step, as
/// the step uses it, so that by_device_j + by_hand_j + by_weight_j - damped_j - numerical_j is the kinetic energy
/// gained, to rounding.
struct plant_energy {
  double by_device_j = 0.0;  ///< work of the device's wrench
  double by_hand_j = 0.0;    ///< work of the hand's spring and damper
  double by_weight_j = 0.0;  ///< work of the plant's own weight
  double damped_j = 0.0;     ///< lost in the plant's own dampers
  double numerical_j = 0.0;  ///< taken out by the implicit step
};

/// Driver of a device that does not exist, under the contract of a real one.
///
/// read(now) integrates plant and hand up to now in steps of 50 us with the last command (zero after its
/// valid_until_ns, which is the device's own watchdog), so that the session's clock is the only clock. The motion
/// script begins with the first read(). The same configuration and the same calls give the same bits.
class ASPERITY_API simulated_device {
 public:
  using policy_tag = device_tag;

  explicit simulated_device(simulated_settings settings = {});
  [[nodiscard]] const device_capabilities& capabilities() const noexcept { return settings_.capabilities; }
  [[nodiscard]] device_state state() const noexcept { return machine_.state(); }

  [[nodiscard]] result<void> open();
  [[nodiscard]] result<void> arm();
  [[nodiscard]] result<void> clear_fault();
  status disarm() noexcept;
  void close() noexcept;

  /// @return ok | backend_failed (a scripted drop, or in a fault) | not_ready (not open, or departed)
  [[nodiscard]] status read(std::int64_t now_ns, device_sample& in) noexcept;

  /// @return ok | backend_failed (a scripted refusal, or in a fault) | not_ready (not open, or departed)
  [[nodiscard]] status write(std::int64_t now_ns, const device_command& out) noexcept;

  /// Wrench that is commanded to the motors at now_ns. @rt safe
  [[nodiscard]] status applied(std::int64_t now_ns, wrench& out) const noexcept;

  /// Takes the device off its bus, as device_fault::depart does.
  void unplug() noexcept { depart(); }

  /// Puts a departed device back on its bus: present, or still in its fault until clear_fault(). Every return is under
  /// another path.
  void plug_in() noexcept;
  /// Where the device is plugged in: "simulated:0", after its first return "simulated:1". Not in a tick.
  [[nodiscard]] std::string path() const { return "simulated:" + std::to_string(returns_); }
  /// What the motors put out in the last step of the plant.
  [[nodiscard]] const wrench& put_out() const noexcept { return put_out_; }
  /// The device's own motors, as hot and as limited as they are.
  [[nodiscard]] const simulated_actuator& actuator() const noexcept { return actuator_; }

  /// What the hand feels and does now, for tests and recordings: the truth behind the measurements.
  [[nodiscard]] const pose& true_T_dh() const noexcept { return plant_.T_dh; }
  [[nodiscard]] const twist& true_velocity_d() const noexcept { return plant_.velocity_d; }
  /// Work of the device's wrench on the hand's side of the port since the first read(), J.
  [[nodiscard]] double delivered_j() const noexcept { return energy_.by_device_j; }
  /// The whole book of the plant.
  [[nodiscard]] const plant_energy& energy() const noexcept { return energy_; }
  /// Kinetic energy of the plant, J.
  [[nodiscard]] double kinetic_j() const noexcept;
  [[nodiscard]] const simulated_settings& settings() const noexcept { return settings_; }

 private:
  static constexpr std::int64_t plant_step_ns = 50'000;
  static constexpr std::int64_t slow_reply_ns = 8'000'000;
  static constexpr std::size_t past_size = 512;  // 25.6 ms of plant states for the delay

  struct plant_state {
    pose T_dh{};
    twist velocity_d{};
  };
  struct past_state {
    plant_state plant{};
    std::int64_t time_ns = 0;
  };
  struct tremor_wave {
    double rate_rad_per_s = 0.0;
    double phase_rad = 0.0;
  };

  [[nodiscard]] double unit() noexcept { return static_cast<double>(bits_() >> 11) * 0x1.0p-53; }

  [[nodiscard]] bool measures() const noexcept { return asperity::measures(machine_.state()); }

  [[nodiscard]] bool fault_at(device_fault kind, std::int64_t now_ns) const noexcept;

  // A device that is there and in a fault says so; one that is not there says nothing.
  [[nodiscard]] status unanswered() const noexcept;

  void depart() noexcept;
  void overheat() noexcept;

  // Whether a measurement reaches the host now. The first one always does.
  [[nodiscard]] bool has_news(std::int64_t now_ns) noexcept;

  [[nodiscard]] error refused(const char* what) const;

  // What the output gate let through stays as it is, to the bit; its certificate leaves room for rounding.
  [[nodiscard]] static vec3 saturated(const vec3& v, double limit) noexcept;

  void advance(std::int64_t now_ns) noexcept;

  // Where a hand is that somebody leads.
  [[nodiscard]] const hand_target& led(double h_s) noexcept;

  // Semi-implicit Euler: the dampers are taken at the end of the step, so that a firm grip cannot blow up.
  void step() noexcept;

  // `pull` is the hand's wrench before its damper took part in the step.
  void book(double h, const twist& before, const wrench& put_out, const wrench& pull) noexcept;

  // The hand opens and shuts a gripper every two seconds, beginning shut.
  [[nodiscard]] double gripper_m(double t_s) const noexcept;
  [[nodiscard]] vec3 tremor(double t_s) const noexcept;
  void measure(std::int64_t now_ns) noexcept;
  [[nodiscard]] pose quantised(const pose& T) const noexcept;
  void spoil(std::int64_t now_ns, device_sample& s) noexcept;

  simulated_settings settings_;
  motion_script motion_;
  led_motion led_;
  std::mt19937_64 bits_;
  std::mt19937_64 luck_;  // of its own, so that a loss leaves delays and tremor as they are
  simulated_actuator actuator_;
  std::array<tremor_wave, 9> tremor_{};
  device_state_machine machine_{};
  bool departed_ = false;
  unsigned returns_ = 0;

  bool started_ = false;
  std::int64_t origin_ns_ = 0;
  std::int64_t plant_ns_ = 0;
  plant_state plant_{};
  std::array<past_state, past_size> past_{};
  std::size_t past_next_ = 0;
  device_command command_{};
  wrench put_out_{};
  device_sample newest_{};
  std::uint64_t sequence_ = 0;
  std::uint64_t lost_ = 0;
  double stuck_x_m_ = 0.0;
  plant_energy energy_{};
};

static_assert(haptic_device<simulated_device>);

}  // namespace asperity
