// A joint drive that speaks the moteus register protocol on CAN FD.
#pragma once

#include <cstdint>
#include <limits>
#include <numbers>

#include "asperity/core/export.hpp"
#include "asperity/drivers/joint/can_joint_drive.hpp"
#include "asperity/drivers/moteus/moteus_codec.hpp"

namespace asperity {

struct moteus_settings {
  joint_drive_settings joint{};   ///< the gear is what lies behind the output that moteus itself counts
  std::uint32_t id = 1;           ///< 1-127
  std::uint32_t host_id = 0;      ///< 0-127
  std::int32_t register_map = 5;  ///< version of the registers that the firmware has to have
  std::int32_t watchdog_ms = 20;  ///< the drive's own, sent with every command; 1-32767
  bool bit_rate_switch = true;
};

/// Torque is position mode with no position, no gains, a feedforward torque and a bound on it. Every command carries
/// its watchdog and enables by itself, which is a danger: a drive that was reset would be enabled by the next one. So a
/// command is only sent to a drive that was heard in that mode within quiet_ns, which is shorter than a reset takes;
/// until then it is only asked.
/// @rt safe
class ASPERITY_API moteus_drive final : public can_joint_drive {
 public:
  explicit moteus_drive(const moteus_settings& settings) noexcept;
  bool take(std::int64_t now_ns, const can_frame& frame) noexcept override;

 private:
  static constexpr double turn = 2.0 * std::numbers::pi;
  static constexpr std::int32_t position_mode = static_cast<std::int32_t>(moteus::mode::position);
  static constexpr std::int32_t stopped = static_cast<std::int32_t>(moteus::mode::stopped);
  static constexpr std::int32_t faulted = static_cast<std::int32_t>(moteus::mode::fault);
  static constexpr std::int32_t timed_out = static_cast<std::int32_t>(moteus::mode::timeout);

  struct answer {
    bool has_state = false;  // mode, position and fault
    bool has_version = false;
    bool refused = false;
    std::uint32_t refused_register = 0;
    std::int32_t mode = 0;
    std::uint32_t fault = 0;
    std::int32_t firmware = 0;
    std::int32_t register_map = 0;
    double position_rev = 0.0;
    double velocity_rev_per_s = std::numeric_limits<double>::quiet_NaN();
    double torque_n_m = std::numeric_limits<double>::quiet_NaN();
  };

  // False where the frame is none of a drive. A value that came as a float where a whole number belongs is none either.
  [[nodiscard]] static bool parse(const can_frame& frame, answer& a) noexcept;

  void begin_lead(bool clearing) noexcept override;
  void take_version(std::int64_t now_ns, const answer& a) noexcept;
  void advance(std::int64_t now_ns, const answer& a) noexcept;
  void send_due(std::int64_t now_ns, can_bus& bus) noexcept override;
  void ask_version(std::int64_t now_ns, can_bus& bus) noexcept;
  void ask(std::int64_t now_ns, can_bus& bus) noexcept;
  bool stop(std::int64_t now_ns, can_bus& bus) noexcept;
  bool command(std::int64_t now_ns, can_bus& bus, double joint_n_m) noexcept;
  static void add_query(moteus::frame_writer& w) noexcept;
  bool send(std::int64_t now_ns, can_bus& bus, moteus::frame_writer& w) noexcept;

  static constexpr std::int32_t unknown = -1;
  static constexpr int repeats = 3;

  moteus_settings moteus_;
  float limit_;
  std::int32_t mode_ = unknown;  // as last heard
  int stops_ = 0;                // sent on this way to idle, up to `repeats`
  int stopped_answers_ = 0;      // in a row
  bool known_ = false;           // its version was read, and is the right one
  bool clearing_ = false;
};

}  // namespace asperity
