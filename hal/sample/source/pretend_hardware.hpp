// Stands where your hardware is: a handle on springs, three motors, three encoders and a controller that talks in
// counts once per millisecond. Replace this file by your USB, CAN or serial code.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace sample {

/// What the controller sends.
struct encoder_frame {
  std::array<std::int32_t, 3> counts{};  ///< 0 in the middle of the workspace
  std::uint64_t number = 0;              ///< grows by one with every frame
  std::int64_t time_ns = 0;              ///< the controller's clock
};

class pretend_hardware {
 public:
  static constexpr double metres_per_count = 1e-6;
  static constexpr double newtons_per_count = 0.001;
  static constexpr std::int64_t frame_period_ns = 1'000'000;

  /// The cable. A handle without one does not answer, and its motors have no power.
  [[nodiscard]] bool plugged_in() const noexcept { return plugged_in_; }
  void plug(bool in) noexcept {
    plugged_in_ = in;
    motors_ = {};
  }
  /// The next transfer to the controller fails.
  bool next_transfer_fails = false;

  /// Sends motor counts, which the controller holds until its watchdog ends them. @return false where the link failed
  [[nodiscard]] bool send(std::array<std::int16_t, 3> counts, std::int64_t watchdog_ns) noexcept {
    if (!plugged_in_) return false;
    if (next_transfer_fails) {
      next_transfer_fails = false;
      return false;
    }
    motors_ = counts;
    watchdog_ns_ = watchdog_ns;
    return true;
  }

  /// The newest frame that the controller has sent by now_ns. @return false where the link failed
  [[nodiscard]] bool receive(std::int64_t now_ns, encoder_frame& out) noexcept {
    if (!plugged_in_) return false;
    run_until(now_ns);
    out = frame_;
    return true;
  }

  /// What is on the motors now.
  [[nodiscard]] std::array<std::int16_t, 3> motors(std::int64_t now_ns) const noexcept {
    return plugged_in_ && now_ns <= watchdog_ns_ ? motors_ : std::array<std::int16_t, 3>{};
  }

 private:
  static constexpr double mass_kg = 0.1;
  static constexpr double spring_n_per_m = 80.0;
  static constexpr double damper_n_s_per_m = 4.0;
  static constexpr std::int64_t step_ns = 100'000;

  void run_until(std::int64_t now_ns) noexcept {
    // A handle that nobody asked for a while has come to rest in the meantime.
    if (!started_ || now_ns - time_ns_ > 100'000'000) {
      started_ = true;
      time_ns_ = now_ns - frame_period_ns;
      next_frame_ns_ = now_ns;
      position_m_ = {};
      velocity_m_per_s_ = {};
    }
    while (time_ns_ + step_ns <= now_ns) {
      step();
      if (time_ns_ >= next_frame_ns_) send_frame();
    }
  }

  void step() noexcept {
    constexpr double h = 1e-9 * static_cast<double>(step_ns);
    const std::array<std::int16_t, 3> now = motors(time_ns_);
    for (std::size_t i = 0; i < 3; ++i) {
      const double force_n = newtons_per_count * now[i] - spring_n_per_m * position_m_[i];
      velocity_m_per_s_[i] = (mass_kg * velocity_m_per_s_[i] + h * force_n) / (mass_kg + h * damper_n_s_per_m);
      position_m_[i] = std::clamp(position_m_[i] + h * velocity_m_per_s_[i], -0.08, 0.08);
    }
    time_ns_ += step_ns;
  }

  void send_frame() noexcept {
    for (std::size_t i = 0; i < 3; ++i) frame_.counts[i] = static_cast<std::int32_t>(position_m_[i] / metres_per_count);
    ++frame_.number;
    frame_.time_ns = time_ns_;
    next_frame_ns_ += frame_period_ns;
  }

  bool plugged_in_ = true;
  std::array<std::int16_t, 3> motors_{};
  std::int64_t watchdog_ns_ = -1;
  bool started_ = false;
  std::int64_t time_ns_ = 0;
  std::int64_t next_frame_ns_ = 0;
  std::array<double, 3> position_m_{};
  std::array<double, 3> velocity_m_per_s_{};
  encoder_frame frame_{};
};

}  // namespace sample
