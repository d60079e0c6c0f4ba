#include "asperity/drivers/articulated/drive_group.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace asperity {

std::string to_words(const arm_fault& fault) {
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

drive_group::drive_group(std::span<const arm_joint> joints, std::span<const arm_bus> buses) noexcept
    : joints_(joints), buses_(buses) {}

void drive_group::start(std::int64_t now_ns) noexcept {
  for (const arm_joint& j : joints_) j.drive->start(now_ns);
}

void drive_group::clear_faults(std::int64_t now_ns) noexcept {
  for (const arm_joint& j : joints_) {
    if (j.drive->state() == drive_state::fault) static_cast<void>(j.drive->clear_fault(now_ns));
  }
}

void drive_group::set_torques(const joint_vector& torque_n_m) noexcept {
  for (std::size_t i = 0; i < size(); ++i) (*this)[i].set_torque(torque_n_m[i]);
}

void drive_group::wind_down(std::int64_t now_ns) noexcept {
  for (std::size_t b = 0; b < buses_.size(); ++b) static_cast<void>(take_frames(b, now_ns));
  silence(now_ns);
}

void drive_group::finish(std::int64_t now_ns) noexcept {
  for (const arm_bus& b : buses_) {
    if (b.service != nullptr) b.service->finish(now_ns, *b.bus);
  }
}

arm_fault drive_group::fault_of_drive(std::size_t joint) const noexcept {
  const drive_fault f = (*this)[joint].fault();
  return {f.what, static_cast<int>(joint), static_cast<int>(joints_[joint].bus), f.code};
}

bool drive_group::all_idle() const noexcept {
  return std::ranges::all_of(joints_, [](const arm_joint& j) {
    return j.drive->state() == drive_state::idle && j.drive->reading().sequence != 0;
  });
}

bool drive_group::all_enabled() const noexcept {
  return std::ranges::all_of(joints_, [](const arm_joint& j) { return j.drive->state() == drive_state::enabled; });
}

bool drive_group::none_on() const noexcept {
  return std::ranges::none_of(joints_, [](const arm_joint& j) {
    return j.drive->state() == drive_state::enabled || j.drive->state() == drive_state::starting;
  });
}

std::int64_t drive_group::oldest_reading_ns(std::int64_t now_ns) const noexcept {
  for (const arm_joint& j : joints_) now_ns = std::min(now_ns, j.drive->reading().host_time_ns);
  return now_ns;
}

std::uint64_t drive_group::lost() const noexcept {
  std::uint64_t sum = 0;
  for (const arm_bus& b : buses_) sum += b.bus->health().lost;
  return sum;
}

arm_fault drive_group::fault_of_bus(std::size_t bus, io_status s) noexcept {
  const bool gone = s == io_status::gone;
  return {.what = gone ? "the bus was unplugged (answer of the transport)" : "the bus failed (answer of the transport)",
          .bus = static_cast<int>(bus),
          .code = static_cast<std::uint32_t>(s),
          .departed = gone};
}

std::optional<arm_fault> drive_group::enable(std::int64_t now_ns) noexcept {
  for (std::size_t i = 0; i < size(); ++i) {
    (*this)[i].set_torque(0.0);
    if (!(*this)[i].enable(now_ns)) {
      return arm_fault{.what = "the drive was not idle when it was to be enabled", .joint = static_cast<int>(i)};
    }
  }
  return std::nullopt;
}

/// @return ok where the limit ended it, otherwise what the bus said after its last frame
io_status drive_group::take_frames(std::size_t bus, std::int64_t now_ns) noexcept {
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

std::optional<arm_fault> drive_group::drain(std::int64_t now_ns) noexcept {
  for (std::size_t b = 0; b < buses_.size(); ++b) {
    const io_status s = take_frames(b, now_ns);
    if (s != io_status::ok && s != io_status::nothing) return fault_of_bus(b, s);
    if (buses_[b].bus->health().bus_off) return fault_of_bus(b, io_status::down);
  }
  return std::nullopt;
}

std::optional<arm_fault> drive_group::step(std::int64_t now_ns) noexcept {
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

void drive_group::silence(std::int64_t now_ns) noexcept {
  for (const arm_joint& j : joints_) {
    j.drive->set_torque(0.0);
    j.drive->disable(now_ns);
    static_cast<void>(j.drive->step(now_ns, *buses_[j.bus].bus));
  }
  for (const arm_bus& b : buses_) {
    if (b.service != nullptr) static_cast<void>(b.service->step(now_ns, *b.bus));
  }
}

bool drive_group::measured_anew() noexcept {
  for (std::size_t i = 0; i < size(); ++i) {
    if ((*this)[i].reading().sequence == seen_[i]) return false;
  }
  for (std::size_t i = 0; i < size(); ++i) seen_[i] = (*this)[i].reading().sequence;
  return true;
}

}  // namespace asperity
