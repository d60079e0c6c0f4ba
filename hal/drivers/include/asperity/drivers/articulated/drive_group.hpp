// All drives of an arm on their buses, which start, step and fall silent together.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "asperity/core/export.hpp"
#include "asperity/drivers/articulated/articulated_settings.hpp"

namespace asperity {

/// Why an arm is in fault.
struct arm_fault {
  const char* what = "none";  ///< a literal
  int joint = -1;             ///< counted from 0; -1 where no one joint is the cause
  int bus = -1;
  std::uint32_t code = 0;  ///< of the drive or transport, 0 where there is none
  bool departed = false;   ///< the bus was unplugged
};

/// The fault in one sentence.
[[nodiscard]] ASPERITY_API std::string to_words(const arm_fault& fault);

/// The drives of an arm, joint by joint from the base outwards, and the buses they are on. It decides nothing: each
/// call returns the fault that it found, and the caller stops the arm.
/// @rt safe, as far as buses and drives are
class ASPERITY_API drive_group {
 public:
  /// @param joints @param buses keep their places in memory as long as this is used
  /// @pre check(articulated_settings) of the arm they are from
  drive_group(std::span<const arm_joint> joints, std::span<const arm_bus> buses) noexcept;

  [[nodiscard]] std::size_t size() const noexcept { return joints_.size(); }
  [[nodiscard]] joint_drive& operator[](std::size_t joint) const noexcept { return *joints_[joint].drive; }

  void start(std::int64_t now_ns) noexcept;
  /// @pre all_idle(). Zero torque first. @return the first drive that was not idle
  [[nodiscard]] std::optional<arm_fault> enable(std::int64_t now_ns) noexcept;
  void clear_faults(std::int64_t now_ns) noexcept;
  /// N m, on the wire with the next step().
  void set_torques(const joint_vector& torque_n_m) noexcept;

  /// Hands every drive the frames that came for it.
  [[nodiscard]] std::optional<arm_fault> drain(std::int64_t now_ns) noexcept;
  /// What is due in this period: of the drives first, then of the buses' services.
  [[nodiscard]] std::optional<arm_fault> step(std::int64_t now_ns) noexcept;
  /// Zero torque on every drive at once, whatever the buses answer.
  void silence(std::int64_t now_ns) noexcept;
  /// Leads the drives to idle, as far as the buses let us.
  void wind_down(std::int64_t now_ns) noexcept;
  /// The session is over. @pre none_on()
  void finish(std::int64_t now_ns) noexcept;

  /// The fault that a drive reports.
  [[nodiscard]] arm_fault fault_of_drive(std::size_t joint) const noexcept;
  /// Idle, and each has reported its angle.
  [[nodiscard]] bool all_idle() const noexcept;
  [[nodiscard]] bool all_enabled() const noexcept;
  /// None is enabled or on the way there or back.
  [[nodiscard]] bool none_on() const noexcept;

  /// Whether every joint has been read since this was last true.
  [[nodiscard]] bool measured_anew() noexcept;
  /// Time of the joint's reading that is oldest; now_ns where none is older.
  [[nodiscard]] std::int64_t oldest_reading_ns(std::int64_t now_ns) const noexcept;
  /// Frames that the buses lost so far.
  [[nodiscard]] std::uint64_t lost() const noexcept;

 private:
  static constexpr int most_frames_per_call = 512;  // a babbling node must not hold the tick

  [[nodiscard]] static arm_fault fault_of_bus(std::size_t bus, io_status s) noexcept;
  [[nodiscard]] io_status take_frames(std::size_t bus, std::int64_t now_ns) noexcept;

  std::span<const arm_joint> joints_;
  std::span<const arm_bus> buses_;
  std::array<std::uint64_t, most_joints> seen_{};
};

}  // namespace asperity
