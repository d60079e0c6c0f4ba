// The numbers of a device recording as bytes, and its limits; see docs/reference/device-recording.md.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "asperity/device/replay_device.hpp"

namespace asperity::recording_detail {

inline constexpr char magic[] = {'A', 'S', 'P', 'D', 'E', 'V', 'R', '2'};
inline constexpr char magic_with_gripper[] = {'A', 'S', 'P', 'D', 'E', 'V', 'R', '3'};  // of devices that have one
inline constexpr char magic_without_blocks[] = {'A', 'S', 'P', 'D', 'E', 'V', 'R', '1'};
inline constexpr std::uint64_t block_calls = 256;  // a quarter of a second and less at 1 kHz
inline constexpr std::uint8_t block_mark = 0xfe;
inline constexpr std::size_t longest_name = 256;
inline constexpr std::uintmax_t largest_file = std::uintmax_t{1} << 30;
inline constexpr std::size_t most_calls = std::size_t{1} << 23;  // an hour and more at 1 kHz
inline constexpr std::size_t free_call_bytes = std::size_t{512} << 20;
inline constexpr std::uint8_t end_mark = 0xff;
inline constexpr std::uint8_t same_sample = 0x80;  // in the byte of the call: the sample is that of the read before

inline std::uint64_t add_to_sum(std::uint64_t sum, char byte) noexcept {
  return (sum ^ static_cast<unsigned char>(byte)) * 0x100000001b3ULL;  // FNV-1a: against accidents, not against malice
}
inline constexpr std::uint64_t first_sum = 0xcbf29ce484222325ULL;

/// Little endian, whatever the machine.
class byte_writer {
 public:
  template <class T>
  void number(T x) {
    auto bits = static_cast<std::uint64_t>(x);
    for (std::size_t i = 0; i < sizeof(T); ++i, bits >>= 8U) bytes_ += static_cast<char>(bits & 0xffU);
  }
  void real(double x) { number(std::bit_cast<std::uint64_t>(x)); }
  void vector(const vec3& v) {
    for (int i = 0; i < 3; ++i) real(v[i]);
  }
  void text(const char* first, std::size_t n) { bytes_.append(first, n); }
  [[nodiscard]] std::string take() { return std::exchange(bytes_, {}); }

 private:
  std::string bytes_;
};

/// Reads until the bytes end; afterwards everything is zero and ok() false.
class byte_reader {
 public:
  explicit byte_reader(const std::string& bytes) : bytes_(&bytes) {}

  template <class T>
  [[nodiscard]] T number() noexcept {
    if (bytes_->size() - at_ < sizeof(T)) {
      at_ = bytes_->size();
      ok_ = false;
      ended_ = true;
      return T{};
    }
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      bits |= std::uint64_t{static_cast<unsigned char>((*bytes_)[at_ + i])} << (8U * i);
    }
    at_ += sizeof(T);
    return static_cast<T>(bits);
  }
  [[nodiscard]] double real() noexcept { return std::bit_cast<double>(number<std::uint64_t>()); }
  [[nodiscard]] vec3 vector() noexcept {
    vec3 v{0.0};
    for (int i = 0; i < 3; ++i) v[i] = real();
    return v;
  }
  /// An enumerator below `count`; otherwise the reader is no longer ok.
  template <class Enum>
  [[nodiscard]] Enum choice(int count) noexcept {
    const auto value = number<std::uint8_t>();
    if (value >= count) ok_ = false;
    return static_cast<Enum>(value < count ? value : 0);
  }
  [[nodiscard]] std::string text(std::size_t n) {
    if (bytes_->size() - at_ < n) {
      ok_ = false;
      ended_ = true;
      return {};
    }
    at_ += n;
    return bytes_->substr(at_ - n, n);
  }
  [[nodiscard]] bool ok() const noexcept { return ok_; }
  /// Whether more was asked for than there is.
  [[nodiscard]] bool ended() const noexcept { return ended_; }
  [[nodiscard]] std::size_t at() const noexcept { return at_; }

 private:
  const std::string* bytes_;
  std::size_t at_ = 0;
  bool ok_ = true;
  bool ended_ = false;
};

/// The check sum of a recording's first bytes, as far as somebody asked.
class running_sum {
 public:
  explicit running_sum(const std::string& bytes) : bytes_(&bytes) {}
  /// @param at not before that of the last call
  [[nodiscard]] std::uint64_t up_to(std::size_t at) noexcept {
    for (; at_ < at; ++at_) sum_ = add_to_sum(sum_, (*bytes_)[at_]);
    return sum_;
  }

 private:
  const std::string* bytes_;
  std::size_t at_ = 0;
  std::uint64_t sum_ = first_sum;
};

inline constexpr std::array capability_numbers{
    &device_capabilities::continuous_force_n,      &device_capabilities::peak_force_n,
    &device_capabilities::continuous_torque_n_m,   &device_capabilities::peak_torque_n_m,
    &device_capabilities::force_slew_n_per_s,      &device_capabilities::torque_slew_n_m_per_s,
    &device_capabilities::max_stiffness_n_per_m,   &device_capabilities::max_stiffness_n_m_per_rad,
    &device_capabilities::max_stiffness_rate_hz,   &device_capabilities::position_resolution_m,
    &device_capabilities::rotation_resolution_rad, &device_capabilities::nominal_rate_hz,
    &device_capabilities::minimum_rate_hz,         &device_capabilities::moving_mass_kg,
    &device_capabilities::moving_inertia_kg_m2};

// A device with a gripper has two numbers more.
inline void write(byte_writer& w, const device_capabilities& c) {
  w.number(static_cast<std::uint8_t>(c.maturity));
  w.number(c.sensed);
  w.number(c.actuated);
  w.number(static_cast<std::uint8_t>((c.needs_homing ? 1 : 0) | (c.device_side_watchdog ? 2 : 0)));
  for (const auto member : capability_numbers) w.real(c.*member);
  w.vector(c.workspace_low_d);
  w.vector(c.workspace_high_d);
  w.number(c.worst_latency_ns);
  if (!c.has_gripper()) return;
  w.real(c.gripper_low_m);
  w.real(c.gripper_high_m);
}

inline device_capabilities read_capabilities(byte_reader& r, bool gripper) noexcept {
  device_capabilities c;
  c.maturity = r.choice<driver_maturity>(3);
  c.sensed = r.number<axis_mask>();
  c.actuated = r.number<axis_mask>();
  const auto flags = r.number<std::uint8_t>();
  c.needs_homing = (flags & 1U) != 0;
  c.device_side_watchdog = (flags & 2U) != 0;
  for (const auto member : capability_numbers) c.*member = r.real();
  c.workspace_low_d = r.vector();
  c.workspace_high_d = r.vector();
  c.worst_latency_ns = r.number<std::int64_t>();
  if (gripper) {
    c.gripper_low_m = r.real();
    c.gripper_high_m = r.real();
  }
  return c;
}

inline void write(byte_writer& w, const device_sample& s, bool gripper) {
  w.number(s.host_time_ns);
  w.number(s.device_time_ns);
  w.number(s.sequence);
  w.number(s.lost);
  for (const double q : {s.T_dh.rotation.w, s.T_dh.rotation.x, s.T_dh.rotation.y, s.T_dh.rotation.z}) w.real(q);
  w.vector(s.T_dh.position);
  w.vector(s.velocity_d.linear);
  w.vector(s.velocity_d.angular);
  w.number(s.buttons);
  w.number(static_cast<std::uint8_t>(s.valid));
  if (gripper) w.real(s.gripper_m);
}

inline device_sample read_sample(byte_reader& r, bool gripper) noexcept {
  device_sample s;
  s.host_time_ns = r.number<std::int64_t>();
  s.device_time_ns = r.number<std::int64_t>();
  s.sequence = r.number<std::uint64_t>();
  s.lost = r.number<std::uint64_t>();
  const double qw = r.real(), qx = r.real(), qy = r.real(), qz = r.real();
  s.T_dh.rotation = quat(qw, qx, qy, qz);
  s.T_dh.position = r.vector();
  s.velocity_d.linear = r.vector();
  s.velocity_d.angular = r.vector();
  s.buttons = r.number<std::uint32_t>();
  s.valid = static_cast<sample_field>(r.number<std::uint8_t>());
  if (gripper) s.gripper_m = r.real();
  return s;
}

inline void write(byte_writer& w, const device_command& c) {
  w.vector(c.on_hand.force);
  w.vector(c.on_hand.torque);
  w.number(static_cast<std::uint8_t>(c.frame));
  w.number(c.valid_until_ns);
  w.number(c.sequence);
}

inline device_command read_command(byte_reader& r) noexcept {
  device_command c;
  c.on_hand.force = r.vector();
  c.on_hand.torque = r.vector();
  c.frame = r.choice<wrench_frame>(4);
  c.valid_until_ns = r.number<std::int64_t>();
  c.sequence = r.number<std::uint64_t>();
  return c;
}

}  // namespace asperity::recording_detail
