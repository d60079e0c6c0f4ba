// All drives of an arm on their buses, which start, step and fall silent together.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

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
[[nodiscard]] inline std::string to_words(const arm_fault& fault) {
  std::string out;
  if (fault.joint >= 0)
    out = "joint " + std::to_string(fault.joint + 1) + ": ";
  else if (fault.bus >= 0)
    out = "bus " + std::to_string(fault.bus + 1) + ": ";
  out += fault.what;
  if (fault.code != 0) {
    constexpr const char* digits = "0123456789abcdef";
    std::string hex = "00000000";
    for (std::size_t i = 0; i < 8; ++i) hex[7 - i] = digits[(fault.code >> (4 * i)) & 0xf];
    out += " (code 0x" + hex + ")";
  }
  return out;
}

/// The drives of an arm, joint by joint from the base outwards, and the buses they are on. It decides nothing: what
/// goes wrong is returned, once per call, and the caller stops the arm.
/// @rt safe, as far as buses and drives are
class drive_group {
 public:
  /// @param joints @param buses keep their places in memory as long as this is used
  /// @pre check(articulated_settings) of the arm they are from
  drive_group(std::span<const arm_joint> joints, std::span<const arm_bus> buses) noexcept
      : joints_(joints), buses_(buses) {}

  [[nodiscard]] std::size_t size() const noexcept { return joints_.size(); }
  [[nodiscard]] joint_drive& operator[](std::size_t joint) const noexcept { return *joints_[joint].drive; }

  void start(std::int64_t now_ns) noexcept {
    for (const arm_joint& j : joints_) j.drive->start(now_ns);
  }
  /// @pre all_idle(). Zero torque first. @return the first drive that was not idle
  [[nodiscard]] std::optional<arm_fault> enable(std::int64_t now_ns) noexcept;
  void clear_faults(std::int64_t now_ns) noexcept {
    for (const arm_joint& j : joints_) {
      if (j.drive->state() == drive_state::fault) static_cast<void>(j.drive->clear_fault(now_ns));
    }
  }
  /// N m, on the wire with the next step().
  void set_torques(const joint_vector& torque_n_m) noexcept {
    for (std::size_t i = 0; i < size(); ++i) (*this)[i].set_torque(torque_n_m[i]);
  }

  /// Hands every drive the frames that came for it.
  [[nodiscard]] std::optional<arm_fault> drain(std::int64_t now_ns) noexcept;
  /// What is due in this period: of the drives first, then of the buses' services.
  [[nodiscard]] std::optional<arm_fault> step(std::int64_t now_ns) noexcept;
  /// Zero torque on every drive at once, whatever the buses answer.
  void silence(std::int64_t now_ns) noexcept;
  /// Leads the drives to idle, as far as the buses let us.
  void wind_down(std::int64_t now_ns) noexcept {
    for (std::size_t b = 0; b < buses_.size(); ++b) static_cast<void>(take_frames(b, now_ns));
    silence(now_ns);
  }
  /// The session is over. @pre none_on()
  void finish(std::int64_t now_ns) noexcept {
    for (const arm_bus& b : buses_) {
      if (b.service != nullptr) b.service->finish(now_ns, *b.bus);
    }
  }

  /// What a drive says that is in fault.
  [[nodiscard]] arm_fault fault_of_drive(std::size_t joint) const noexcept {
    const drive_fault f = (*this)[joint].fault();
    return {f.what, static_cast<int>(joint), static_cast<int>(joints_[joint].bus), f.code};
  }
  /// Idle, and each has told its angle.
  [[nodiscard]] bool all_idle() const noexcept {
    return std::ranges::all_of(joints_, [](const arm_joint& j) {
      return j.drive->state() == drive_state::idle && j.drive->reading().sequence != 0;
    });
  }
  [[nodiscard]] bool all_enabled() const noexcept {
    return std::ranges::all_of(joints_, [](const arm_joint& j) { return j.drive->state() == drive_state::enabled; });
  }
  /// None is enabled or on the way there or back.
  [[nodiscard]] bool none_on() const noexcept {
    return std::ranges::none_of(joints_, [](const arm_joint& j) {
      return j.drive->state() == drive_state::enabled || j.drive->state() == drive_state::starting;
    });
  }

  /// Whether every joint has been read since this was last true.
  [[nodiscard]] bool measured_anew() noexcept;
  /// Time of the joint's reading that is oldest; now_ns where none is older.
  [[nodiscard]] std::int64_t oldest_reading_ns(std::int64_t now_ns) const noexcept {
    for (const arm_joint& j : joints_) now_ns = std::min(now_ns, j.drive->reading().host_time_ns);
    return now_ns;
  }
  /// Frames that the buses lost so far.
  [[nodiscard]] std::uint64_t lost() const noexcept {
    std::uint64_t sum = 0;
    for (const arm_bus& b : buses_) sum += b.bus->health().lost;
    return sum;
  }

 private:
  static constexpr int most_frames_per_call = 512;  // a babbling node must not hold the tick

  [[nodiscard]] static arm_fault fault_of_bus(std::size_t bus, io_status s) noexcept {
    const bool gone = s == io_status::gone;
    return {
        .what = gone ? "the bus was unplugged (answer of the transport)" : "the bus failed (answer of the transport)",
        .bus = static_cast<int>(bus),
        .code = static_cast<std::uint32_t>(s),
        .departed = gone};
  }
  [[nodiscard]] io_status take_frames(std::size_t bus, std::int64_t now_ns) noexcept;

  std::span<const arm_joint> joints_;
  std::span<const arm_bus> buses_;
  std::array<std::uint64_t, most_joints> seen_{};
};

inline std::optional<arm_fault> drive_group::enable(std::int64_t now_ns) noexcept {
  for (std::size_t i = 0; i < size(); ++i) {
    (*this)[i].set_torque(0.0);
    if (!(*this)[i].enable(now_ns)) {
      return arm_fault{.what = "the drive was not idle when it was to be enabled", .joint = static_cast<int>(i)};
    }
  }
  return std::nullopt;
}

/// @return ok where the limit ended it, otherwise what the bus said after its last frame
inline io_status drive_group::take_frames(std::size_t bus, std::int64_t now_ns) noexcept {
  can_frame frame;
  for (int k = 0; k < most_frames_per_call; ++k) {
    const io_status s = buses_[bus].bus->receive(now_ns, frame);
    if (s != io_status::ok) return s;
    for (const arm_joint& j : joints_) {
      if (j.bus == bus && j.drive->take(now_ns, frame)) break;
    }
  }
  return io_status::ok;
}

inline std::optional<arm_fault> drive_group::drain(std::int64_t now_ns) noexcept {
  for (std::size_t b = 0; b < buses_.size(); ++b) {
    const io_status s = take_frames(b, now_ns);
    if (s != io_status::ok && s != io_status::nothing) return fault_of_bus(b, s);
    if (buses_[b].bus->health().bus_off) return fault_of_bus(b, io_status::down);
  }
  return std::nullopt;
}

inline std::optional<arm_fault> drive_group::step(std::int64_t now_ns) noexcept {
  for (std::size_t i = 0; i < size(); ++i) {
    const std::size_t b = joints_[i].bus;
    joint_drive& d = (*this)[i];
    const io_status s = d.step(now_ns, *buses_[b].bus);
    if (s != io_status::ok && s != io_status::busy) return fault_of_bus(b, s);
    if (d.state() == drive_state::fault) return fault_of_drive(i);
  }
  for (std::size_t b = 0; b < buses_.size(); ++b) {
    if (buses_[b].service == nullptr) continue;
    const io_status s = buses_[b].service->step(now_ns, *buses_[b].bus);
    if (s != io_status::ok && s != io_status::busy) return fault_of_bus(b, s);
  }
  return std::nullopt;
}

inline void drive_group::silence(std::int64_t now_ns) noexcept {
  for (const arm_joint& j : joints_) {
    j.drive->set_torque(0.0);
    j.drive->disable(now_ns);
    static_cast<void>(j.drive->step(now_ns, *buses_[j.bus].bus));
  }
  for (const arm_bus& b : buses_) {
    if (b.service != nullptr) static_cast<void>(b.service->step(now_ns, *b.bus));
  }
}

inline bool drive_group::measured_anew() noexcept {
  for (std::size_t i = 0; i < size(); ++i) {
    if ((*this)[i].reading().sequence == seen_[i]) return false;
  }
  for (std::size_t i = 0; i < size(); ++i) seen_[i] = (*this)[i].reading().sequence;
  return true;
}

}  // namespace asperity
