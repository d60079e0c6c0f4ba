// One motor with its drive on a CAN bus: torque in, angle out.
#pragma once

#include <cstdint>
#include <string_view>

#include "asperity/core/status.hpp"
#include "asperity/transport/can_bus.hpp"

namespace asperity {

/// Where a drive is on its way to putting out torque.
enum class drive_state : std::uint8_t {
  silent,    ///< nothing heard of it yet, or not any more
  starting,  ///< its own state machine is being led through
  idle,      ///< measures, puts out no torque
  enabled,   ///< puts out the commanded torque
  fault,     ///< says so itself, or broke the protocol; latched until clear_fault()
};

[[nodiscard]] constexpr const char* to_string(drive_state s) noexcept {
  switch (s) {
    case drive_state::silent:
      return "silent";
    case drive_state::starting:
      return "starting";
    case drive_state::idle:
      return "idle";
    case drive_state::enabled:
      return "enabled";
    case drive_state::fault:
      return "fault";
  }
  return "unknown state";
}

/// What a drive can do, at the joint (behind the gear), SI.
struct drive_facts {
  std::string_view protocol;           ///< a literal
  double peak_torque_n_m = 0.0;        ///< no value over it is ever put on the wire
  double torque_resolution_n_m = 0.0;  ///< of the command on the wire
  double zero_torque_error_n_m = 0.0;  ///< torque that a command of zero decodes to; 0 where zero is exact
  double position_resolution_rad = 0.0;
  bool drive_side_watchdog = false;  ///< the drive itself goes to zero when the host falls silent
  bool needs_fd = false;
};

/// Newest reading of a joint.
struct joint_reading {
  std::int64_t host_time_ns = 0;  ///< of the frame that brought the position
  std::uint64_t sequence = 0;     ///< grows with every position
  double position_rad = 0.0;
  double velocity_rad_per_s = 0.0;
  double torque_n_m = 0.0;
  bool has_velocity = false;
  bool has_torque = false;
};

/// Why a drive is in fault: a sentence that is a literal, and the drive's own code.
struct drive_fault {
  const char* what = "none";
  std::uint32_t code = 0;  ///< the drive's own; 0 where it has none
};

/// A state machine that speaks one protocol. It owns no bus and no thread: the owner of the bus hands it every frame
/// that arrives and calls step() once in every period, and it answers at once.
/// - start() begins to lead the drive to idle; enable() from there to enabled; step() takes one step of the way when it
///   is due and repeats what stayed unanswered. What takes longer than its limit ends in fault.
/// - In every state but enabled the torque on the wire is zero, and a torque that is not finite is zero.
/// - disable() sends zero torque first and then leads back to idle. Faults do the same by themselves.
/// - Nothing but enable() enables: not a drive that comes back, not a cleared fault.
/// One thread at a time. Nothing here blocks, allocates, locks, throws or reads a clock.
class joint_drive {
 public:
  joint_drive() = default;
  joint_drive(const joint_drive&) = delete;
  joint_drive& operator=(const joint_drive&) = delete;
  virtual ~joint_drive() = default;
  [[nodiscard]] virtual const drive_facts& facts() const noexcept = 0;
  [[nodiscard]] virtual drive_state state() const noexcept = 0;
  [[nodiscard]] virtual drive_fault fault() const noexcept = 0;
  [[nodiscard]] virtual const joint_reading& reading() const noexcept = 0;
  virtual void start(std::int64_t now_ns) noexcept = 0;
  /// @return false where the state is not idle
  [[nodiscard]] virtual bool enable(std::int64_t now_ns) noexcept = 0;
  virtual void disable(std::int64_t now_ns) noexcept = 0;
  /// @return false where the state is not fault
  [[nodiscard]] virtual bool clear_fault(std::int64_t now_ns) noexcept = 0;

  /// Torque at the joint from the next step() on, N m; saturated to facts().peak_torque_n_m.
  virtual void set_torque(double torque_n_m) noexcept = 0;

  /// A frame that came in on the drive's bus; others' frames are ignored. @return whether it was this drive's
  virtual bool take(std::int64_t now_ns, const can_frame& frame) noexcept = 0;

  /// Sends what is due in this period. @return the worst answer of the bus
  [[nodiscard]] virtual io_status step(std::int64_t now_ns, can_bus& bus) noexcept = 0;
};

}  // namespace asperity
