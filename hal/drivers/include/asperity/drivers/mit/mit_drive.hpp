// A joint drive that speaks the MIT mini-cheetah protocol (CubeMars AK actuators in MIT mode, motorcontrol).
#pragma once

#include <cstdint>

#include "asperity/core/export.hpp"
#include "asperity/drivers/joint/can_joint_drive.hpp"
#include "asperity/drivers/mit/mit_codec.hpp"

namespace asperity {

struct mit_settings {
  joint_drive_settings joint{};
  std::uint32_t motor_id = 1;            ///< id of the frames it takes, 11 bits; its low byte begins every answer
  std::uint32_t master_id = 0;           ///< id of the frames that it answers with
  mit::ranges ranges = mit::ak80_9;      ///< as set in the drive; check them, because they cannot be read
  bool watchdog_set = false;             ///< the drive has a time-out of its own, and you have tried it
  std::int64_t follow_ns = 100'000'000;  ///< torque that is commanded and not measured for that long is a fault; 0: off
};

/// The protocol has no state in its answers: whether a drive is enabled cannot be read, only whether it answers.
/// Therefore frames of bring-up are repeated, a torque that does not appear is a fault, and every frame outside
/// `enabled` orders the drive again to leave motor mode. These frames also get the readings of an idle drive.
/// @rt safe
class ASPERITY_API mit_drive final : public can_joint_drive {
 public:
  explicit mit_drive(const mit_settings& settings) noexcept;
  bool take(std::int64_t now_ns, const can_frame& frame) noexcept override;

 private:
  // Answers do not say to which frame: a step counts as heard when as many answers came as frames went out.
  static constexpr int repeats = 3;
  static constexpr std::int64_t old_error_ns = 100'000'000;

  [[nodiscard]] static mit_settings defaults(mit_settings o) noexcept;
  void begin_lead(bool clearing) noexcept override;

  enum class stage : std::uint8_t { zero, enter, confirm, exit };

  void begin(stage s) noexcept;
  void take_position(std::int64_t now_ns, const can_frame& frame, const mit::reply& r) noexcept;
  void advance(std::int64_t now_ns, const mit::reply& r) noexcept;

  // A drive that was reset goes on answering and puts out nothing: its current tells.
  void follow(std::int64_t now_ns, const mit::reply& r) noexcept;

  void send_due(std::int64_t now_ns, can_bus& bus) noexcept override;
  bool send_torque(std::int64_t now_ns, can_bus& bus, double joint_n_m) noexcept;
  bool send(std::int64_t now_ns, can_bus& bus, const mit::command_bytes& bytes) noexcept;

  mit_settings mit_;
  mit::symmetric_field position_;
  mit::symmetric_field torque_;
  stage stage_ = stage::zero;
  int sent_ = 0;     // frames of this stage that the bus took, up to `repeats`
  int answers_ = 0;  // answers in this stage
  std::int64_t counts_ = 0;
  std::int64_t follow_ns_ = 0;
  double commanded_n_m_ = 0.0;  // of the shaft
  std::uint8_t reply_size_ = 0;
  bool clearing_ = false;
  bool fresh_lead_ = true;
  bool owes_start_ = true;
};

}  // namespace asperity
