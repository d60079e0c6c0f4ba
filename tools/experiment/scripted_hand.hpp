// A hand that does what an experiment says: a device under the contract of a real one, made for measuring.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>

#include "asperity/core/spatial.hpp"
#include "asperity/device/device.hpp"

namespace asperity::experiment {

/// What the hand wants at one time, in the device's base frame.
struct hand_wish {
  pose T_dh{};         ///< where it wants the handle
  twist velocity_d{};  ///< how fast it means to move there
  wrench push_d{};     ///< what it pushes with besides, about the handle's origin: a constant force, say
};

/// How the hand holds the handle: a spring and a damper for each axis of the base frame, and the handle's own mass.
struct hand_grip {
  bool rigid = true;  ///< the handle is where it is wanted, whatever the force; all else is then of no use
  vec3 stiffness_n_per_m{0.0};
  vec3 damping_n_s_per_m{0.0};
  vec3 stiffness_n_m_per_rad{0.0};
  vec3 damping_n_m_s_per_rad{0.0};
  double mass_kg = 0.1;
  double inertia_kg_m2 = 2e-4;
};

/// Driver of the scripted hand. Unlike simulated_device it has no limits, no encoder steps, no delay and no tremor:
/// what an experiment measures is the library's. read(now) moves the handle up to now in steps of 50 us with the last
/// command; the script is asked for times since the first read(). The same calls give the same bits.
class scripted_hand {
 public:
  using policy_tag = device_tag;

  scripted_hand(std::function<hand_wish(double t_s)> script, const hand_grip& grip);

  [[nodiscard]] const device_capabilities& capabilities() const noexcept { return capabilities_; }
  [[nodiscard]] device_state state() const noexcept { return machine_.state(); }
  [[nodiscard]] result<void> open();
  [[nodiscard]] result<void> arm();
  [[nodiscard]] result<void> clear_fault();
  status disarm() noexcept;
  void close() noexcept;
  /// @rt as safe as the script
  [[nodiscard]] status read(std::int64_t now_ns, device_sample& in) noexcept;
  [[nodiscard]] status write(std::int64_t now_ns, const device_command& out) noexcept;

 private:
  static constexpr std::int64_t step_ns = 50'000;

  [[nodiscard]] double seconds(std::int64_t ns) const noexcept { return 1e-9 * static_cast<double>(ns - origin_ns_); }
  void advance(std::int64_t now_ns) noexcept;
  void step(const hand_wish& wish) noexcept;

  std::function<hand_wish(double)> script_;
  hand_grip grip_;
  device_capabilities capabilities_;
  device_state_machine machine_;
  device_command command_{};
  pose T_dh_{};
  twist velocity_d_{};
  bool started_ = false;
  std::int64_t origin_ns_ = 0, at_ns_ = 0, sampled_ns_ = 0;
  std::uint64_t sequence_ = 0;
};

}  // namespace asperity::experiment
