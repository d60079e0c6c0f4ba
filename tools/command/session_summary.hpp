// What a session amounts to: ranges, energy and a picture.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "asperity/control/session_record.hpp"
#include "asperity/control/vibration_monitor.hpp"
#include "cli.hpp"
#include "plot.hpp"
#include "session.hpp"
#include "wall_summary.hpp"

namespace asperity::command {

/// Smallest and largest value of each component of a vector, and its largest length.
class vector_range {
 public:
  void add(const vec3& v) noexcept;
  [[nodiscard]] const vec3& low() const noexcept { return low_; }
  [[nodiscard]] const vec3& high() const noexcept { return high_; }
  [[nodiscard]] double largest() const noexcept { return largest_; }

 private:
  bool empty_ = true;
  vec3 low_{0.0};
  vec3 high_{0.0};
  double largest_ = 0.0;
};

/// Accumulates device ticks. Constant size.
class session_summary {
 public:
  /// @param device_period_ns of the device loop
  explicit session_summary(std::int64_t device_period_ns)
      : device_period_ns_(device_period_ns), vibration_(device_period_ns) {}

  void add(const session_record& tick) noexcept;

  [[nodiscard]] json to_json() const;
  [[nodiscard]] std::string to_text() const;
  /// Empty, or a line that says how much the wrench vibrates while the hand rests, and what to change.
  [[nodiscard]] std::string vibration_warning() const;
  [[nodiscard]] const wall_summary& wall() const noexcept { return wall_; }
  [[nodiscard]] bool touched() const noexcept { return touching_ > 0; }
  [[nodiscard]] double mean_contacts() const noexcept;
  /// How often the coupling's damper was given the velocity of this source.
  [[nodiscard]] std::uint64_t ticks_with(velocity_source source) const noexcept {
    return velocity_ticks_[static_cast<std::size_t>(source)];
  }
  [[nodiscard]] std::uint64_t ticks_let_go() const noexcept { return let_go_ticks_; }    ///< in full, by the clutch
  [[nodiscard]] std::uint32_t first_touches() const noexcept { return first_touches_; }  ///< that rang
  [[nodiscard]] bool buttons_told() const noexcept { return buttons_told_; }
  [[nodiscard]] bool velocity_refused() const noexcept { return velocity_refused_; }
  [[nodiscard]] double largest_hand_force_n() const noexcept { return hand_force_.largest(); }
  [[nodiscard]] double largest_hand_torque_n_m() const noexcept { return hand_torque_.largest(); }

 private:
  std::int64_t device_period_ns_;
  std::uint64_t ticks_ = 0;
  std::uint64_t touching_ = 0;
  std::uint64_t contact_sum_ = 0;
  std::uint32_t contacts_max_ = 0;
  double depth_max_m_ = 0.0;
  vector_range probe_force_, probe_torque_, hand_force_, hand_torque_;
  double delivered_j_ = 0.0;
  double from_bodies_j_ = 0.0;
  double surplus_max_j_ = 0.0;
  std::uint64_t guarded_ = 0;
  std::array<std::uint64_t, 3> velocity_ticks_{};
  bool velocity_refused_ = false;
  std::uint64_t let_go_ticks_ = 0;
  bool buttons_told_ = false;
  double raised_j_ = 0.0;
  std::optional<std::pair<double, double>> gripper_m_;  // narrowest and widest
  double transient_j_ = 0.0;
  std::uint32_t first_touches_ = 0;
  vibration_monitor vibration_;
  wall_summary wall_;
};

/// The curves of a session, thinned so that a long one stays a small picture.
class session_curves {
 public:
  /// @param expected_ticks device ticks that will come
  explicit session_curves(std::size_t expected_ticks);

  void add(const session_record& tick);

  /// Position of the probe, force and torque on the hand over time.
  [[nodiscard]] plot_page page(std::string title, std::string caption) const;

 private:
  std::size_t stride_;
  std::size_t seen_ = 0;
  std::vector<double> time_s_;
  std::vector<vec3> position_mm_, force_n_, torque_mn_m_;
  vec3 start_w_{0.0};
};

}  // namespace asperity::command
