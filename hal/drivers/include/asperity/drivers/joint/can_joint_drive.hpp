// The common part of joint drives that answer in every period: the way to torque and back, and its time limits.
#pragma once

#include <cstdint>

#include "asperity/core/export.hpp"
#include "asperity/drivers/joint/joint_drive.hpp"
#include "asperity/drivers/joint/joint_scale.hpp"

namespace asperity {

/// Options that do not depend on the protocol. All times are counted on the session's clock.
struct ASPERITY_API joint_drive_settings {
  joint_scale scale{};
  double peak_torque_n_m = 1.0;              ///< at the joint; what is over it never reaches the wire
  double fastest_rad_per_s = 100.0;          ///< of the joint: a position that jumps further than that is a fault
  std::int64_t step_limit_ns = 500'000'000;  ///< for each way: to idle, to enabled, back to idle
  std::int64_t quiet_ns = 10'000'000;        ///< nothing heard for that long: zero torque until it is heard again
  std::int64_t silence_ns = 50'000'000;      ///< nothing heard for that long: a fault where it was enabled
  std::int64_t hold_ns = 20'000'000;         ///< a torque that set_torque() does not renew for that long: a fault

  [[nodiscard]] bool usable() const noexcept;
};

/// The part of a joint_drive that is the same for every protocol. A protocol says which frames a phase needs, and
/// reports what it received.
///
///     off -> leading -> idle -> arming -> enabled -> leaving -> idle
///                        \-> seeking -> leading           (an idle drive that fell silent, and was heard again)
///     anything but off -> faulted -> leading              (clear_fault() only)
///
/// - leading, arming and leaving end within step_limit_ns, or in a fault.
/// - enabled ends in a fault when the drive is not heard, or when the application no longer renews its torque: the
///   drive's own watchdog is fed by the application's commands and by nothing else. A torque that was never set is zero
///   and needs no renewing.
/// - A bus that does not take a frame is a fault at once; one whose queue is full, after busy_limit steps.
/// @rt safe
class ASPERITY_API can_joint_drive : public joint_drive {
 public:
  static constexpr int busy_limit = 5;

  [[nodiscard]] const drive_facts& facts() const noexcept final { return facts_; }
  [[nodiscard]] drive_fault fault() const noexcept final { return fault_; }
  [[nodiscard]] const joint_reading& reading() const noexcept final { return reading_; }
  [[nodiscard]] drive_state state() const noexcept final;
  /// Frames with this drive's id so far that are not valid in its protocol.
  [[nodiscard]] std::uint64_t malformed() const noexcept { return malformed_; }

  void start(std::int64_t now_ns) noexcept final;
  [[nodiscard]] bool enable(std::int64_t now_ns) noexcept final;
  void disable(std::int64_t now_ns) noexcept final;
  [[nodiscard]] bool clear_fault(std::int64_t now_ns) noexcept final;
  void set_torque(double torque_n_m) noexcept final;
  [[nodiscard]] io_status step(std::int64_t now_ns, can_bus& bus) noexcept final;

 protected:
  enum class phase : std::uint8_t { off, seeking, leading, idle, arming, enabled, leaving, faulted };

  explicit can_joint_drive(const joint_drive_settings& settings) noexcept;
  void refuse_settings() noexcept { usable_ = false; }

  // The frames of this period, by phase. What is not `enabled` sends no torque but zero.
  virtual void send_due(std::int64_t now_ns, can_bus& bus) noexcept = 0;
  // A way to idle begins; `clearing`: the drive's own fault is to be cleared on it.
  virtual void begin_lead(bool clearing) noexcept = 0;

  [[nodiscard]] phase at() const noexcept { return phase_; }
  [[nodiscard]] std::int64_t since_ns() const noexcept { return since_ns_; }
  [[nodiscard]] const joint_drive_settings& settings() const noexcept { return options_; }
  [[nodiscard]] const joint_scale& scale() const noexcept { return options_.scale; }
  [[nodiscard]] drive_facts& facts_to_fill() noexcept { return facts_; }

  // Torque of the joint that may go out now, N m.
  [[nodiscard]] double torque_due(std::int64_t now_ns) const noexcept;
  [[nodiscard]] bool is_quiet(std::int64_t now_ns) const noexcept { return now_ns - heard_ns_ > options_.quiet_ns; }
  // Whether this step may feed the drive's watchdog: a torque was set since the last one, or none since enable().
  [[nodiscard]] bool is_fed() const noexcept { return fed_; }

  // True until the zero torque that ends a phase was taken by the bus.
  [[nodiscard]] bool owes_zero() const noexcept { return owes_zero_; }
  void zero_was_sent() noexcept { owes_zero_ = false; }

  // Sends one frame. @return whether the bus took it
  bool put(std::int64_t now_ns, can_bus& bus, const can_frame& frame) noexcept;

  void fail(const char* what, std::uint32_t code, std::int64_t now_ns) noexcept;
  void fail(const char* what, std::uint32_t code) noexcept { fail(what, code, seen_ns_); }

  void reached(phase next, std::int64_t now_ns) noexcept { enter(next, now_ns); }
  void heard(std::int64_t now_ns) noexcept;
  void count_malformed() noexcept { ++malformed_; }

  // A position of the joint. A jump says that the drive lost its count, as a reset does.
  void heard_position(std::int64_t now_ns, const can_frame& frame, double position_rad) noexcept;
  void heard_velocity(double velocity_rad_per_s) noexcept;
  void heard_torque(double torque_n_m) noexcept;

 private:
  void enter(phase next, std::int64_t now_ns) noexcept;
  void lead(std::int64_t now_ns, bool clearing) noexcept;
  void watch(std::int64_t now_ns) noexcept;
  [[nodiscard]] const char* late_lead() const noexcept;
  void judge() noexcept;

  joint_drive_settings options_;
  drive_facts facts_{};
  drive_fault fault_{};
  joint_reading reading_{};
  double torque_n_m_ = 0.0;  // of the joint, within the peak
  std::int64_t since_ns_ = 0;
  std::int64_t seen_ns_ = 0;
  std::int64_t heard_ns_ = 0;
  std::int64_t renewed_ns_ = 0;
  std::int64_t position_ns_ = 0;
  std::uint64_t malformed_ = 0;
  int busy_ = 0;
  io_status worst_ = io_status::ok;
  phase phase_ = phase::off;
  bool usable_;
  bool owes_zero_ = false;
  bool renewed_ = false;
  bool ever_set_ = false;
  bool fed_ = true;
  bool has_position_ = false;
};

}  // namespace asperity
