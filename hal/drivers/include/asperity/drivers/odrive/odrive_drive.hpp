// A joint drive that speaks ODrive's CANSimple, firmware 0.5 or 0.6.
#pragma once

#include <cstdint>
#include <numbers>

#include "asperity/core/export.hpp"
#include "asperity/drivers/joint/can_joint_drive.hpp"
#include "asperity/drivers/odrive/odrive_codec.hpp"

namespace asperity {

struct odrive_settings {
  /// Estimates of the encoder come every 10 ms unless you set the drive to less, so quiet is longer than elsewhere.
  joint_drive_settings joint{.quiet_ns = 30'000'000};
  std::uint32_t node = 0;  ///< 0-63
  enum class version : std::uint8_t { ask, v0_5, v0_6 } firmware = version::ask;
  bool ask_estimates = true;  ///< 0.5: ask for them in every period; false where the drive sends them often
  double torque_constant_n_m_per_a = 0.0;   ///< 0.5: of the motor, turns its current into a torque; 0: none is measured
  std::int64_t heartbeat_ns = 350'000'000;  ///< three heartbeats as they are set by default, and a half
  bool watchdog_set = false;                ///< enable_watchdog and watchdog_timeout are set in the drive
};

/// A drive of 0.5 does not know the request for its version, so one that sends heartbeats without answering it is 0.5.
/// Its watchdog is fed by every frame: enabled, nothing at all is sent in a period without a new torque.
/// @rt safe
class ASPERITY_API odrive_drive final : public can_joint_drive {
 public:
  explicit odrive_drive(const odrive_settings& settings) noexcept;

  /// Which table is spoken; what was asked for, once the drive leads to idle.
  [[nodiscard]] odrive::firmware firmware() const noexcept { return firmware_; }

  bool take(std::int64_t now_ns, const can_frame& frame) noexcept override;

 private:
  static constexpr double turn = 2.0 * std::numbers::pi;
  static constexpr std::int64_t pace_ns = 20'000'000;        // of frames that are repeated until they are answered
  static constexpr std::int64_t ask_ns = 150'000'000;        // for an answer to the question for the version
  static constexpr std::int64_t estop_ns = 400'000'000;      // a drive that is not idle after that is stopped harder
  static constexpr std::int64_t old_error_ns = 250'000'000;  // heartbeats from before the errors were cleared

  void begin_lead(bool clearing) noexcept override;
  void take_version(std::int64_t now_ns, const odrive::version& v) noexcept;
  void take_error(std::int64_t now_ns, std::uint32_t error) noexcept;
  void take_heartbeat(std::int64_t now_ns, const odrive::heartbeat& h) noexcept;
  void send_due(std::int64_t now_ns, can_bus& bus) noexcept override;
  void lead_on(std::int64_t now_ns, can_bus& bus) noexcept;
  void disarm(std::int64_t now_ns, can_bus& bus) noexcept;

  // A heartbeat of an idle axis, and not one from before it was asked to be idle.
  [[nodiscard]] bool is_off() const noexcept;

  // Once at the beginning of something, and then at a pace.
  [[nodiscard]] bool is_due(std::int64_t now_ns) noexcept;

  void ask_estimates(std::int64_t now_ns, can_bus& bus) noexcept;
  bool send_torque(std::int64_t now_ns, can_bus& bus, double joint_n_m) noexcept;
  bool send(std::int64_t now_ns, can_bus& bus, const can_frame& f) noexcept { return put(now_ns, bus, f); }

  odrive_settings odrive_;
  float limit_;
  odrive::firmware firmware_ = odrive::firmware::v0_5;
  std::int64_t paced_ns_ = 0;
  std::int64_t beat_ns_ = 0;
  std::int64_t asked_ns_ = 0;  // when it was first asked to be idle
  std::uint8_t axis_state_ = 0;
  int idle_requests_ = 0;  // in this phase, up to 2
  bool known_ = false;     // which table
  bool beat_ = false;      // a heartbeat was heard on this way to idle
  bool has_estimate_ = false;
  bool clearing_ = false;
  bool owes_clearing_ = false;
  bool first_ = true;
  bool remote_ = false;
};

}  // namespace asperity
