// Whether a sample from a device can be believed.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "asperity/core/status.hpp"
#include "asperity/device/sample.hpp"

namespace asperity {

/// What was found wrong with a sample.
enum class sample_verdict : std::uint8_t {
  accepted,
  not_finite,    ///< NaN or infinity in the pose
  not_unit,      ///< the quaternion is not of unit length
  stale,         ///< older than its limit, or as far ahead of the clock
  jump,          ///< farther from the last good pose than any hand moves
  no_answer,     ///< the device could not answer
  not_measured,  ///< the device says that it measured no position
};

[[nodiscard]] constexpr const char* to_string(sample_verdict v) noexcept {
  switch (v) {
    case sample_verdict::accepted:
      return "accepted";
    case sample_verdict::not_finite:
      return "not finite";
    case sample_verdict::not_unit:
      return "quaternion not of unit length";
    case sample_verdict::stale:
      return "stale";
    case sample_verdict::jump:
      return "jump";
    case sample_verdict::no_answer:
      return "no answer";
    case sample_verdict::not_measured:
      return "not measured";
  }
  return "unknown verdict";
}

struct sample_check_settings {
  std::int64_t stale_after_ns = 20'000'000;  ///< age (now - host_time_ns, either sign) above which a sample is rejected
  double max_speed_m_per_s = 10.0;           ///< faster than a hand; a larger step between samples is an encoder fault
  double max_turn_rate_rad_per_s = 100.0;
  std::uint32_t reject_limit = 5;  ///< rejected samples in a row that make a fault
};

/// Judges every sample of one device and counts the bad ones.
/// @rt safe
class sample_check {
 public:
  explicit sample_check(const sample_check_settings& settings = {}) noexcept : settings_(settings) {}

  /// Verdict on what read() left behind. Only an accepted sample may be used.
  [[nodiscard]] sample_verdict judge(std::int64_t now_ns, status read, const device_sample& s) noexcept {
    const sample_verdict v = look(now_ns, read, s);
    if (v == sample_verdict::accepted) {
      rejected_in_a_row_ = 0;
      has_last_ = true;
      last_T_dh_ = s.T_dh;
      last_ns_ = s.host_time_ns;
    } else {
      ++rejected_in_a_row_;
      ++rejected_;
    }
    return v;
  }

  /// Whether so many samples in a row were rejected that the device must be given up.
  [[nodiscard]] bool exhausted() const noexcept { return rejected_in_a_row_ >= settings_.reject_limit; }
  [[nodiscard]] std::uint32_t rejected_in_a_row() const noexcept { return rejected_in_a_row_; }
  [[nodiscard]] std::uint64_t rejected() const noexcept { return rejected_; }
  /// Forgets the last pose, so that the next one may be anywhere.
  void restart() noexcept {
    has_last_ = false;
    rejected_in_a_row_ = 0;
  }

 private:
  [[nodiscard]] sample_verdict look(std::int64_t now_ns, status read, const device_sample& s) const noexcept {
    if (read != status::ok) return sample_verdict::no_answer;
    if (!has_all(s.valid, sample_field::position)) return sample_verdict::not_measured;
    const quat& q = s.T_dh.rotation;
    if (!is_finite(s.T_dh.position) || !is_finite(vec3(q.x, q.y, q.z)) || !std::isfinite(q.w)) {
      return sample_verdict::not_finite;
    }
    if (!is_valid(s.T_dh)) return sample_verdict::not_unit;
    if (!is_recent(now_ns, s.host_time_ns)) return sample_verdict::stale;
    if (has_last_) {
      // A burst of delayed samples arrives with times close together: a step is never judged over less than a
      // millisecond.
      const double dt = std::max(1e-3, static_cast<double>(s.host_time_ns - last_ns_) * 1e-9);
      const double step_m = glm::length(s.T_dh.position - last_T_dh_.position);
      const double turn_rad = glm::length(log_rotation(q * glm::conjugate(last_T_dh_.rotation)));
      if (!(step_m <= settings_.max_speed_m_per_s * dt)) return sample_verdict::jump;
      if (!(turn_rad <= settings_.max_turn_rate_rad_per_s * dt)) return sample_verdict::jump;
    }
    return sample_verdict::accepted;
  }

  // A stamp from far ahead is as wrong as an old one: it would never grow old, and excuse a jump of any length. The
  // difference is taken without sign, because that of two hostile numbers does not fit into 64 bits with one.
  [[nodiscard]] bool is_recent(std::int64_t now_ns, std::int64_t host_time_ns) const noexcept {
    const auto [earlier, later] = std::minmax(now_ns, host_time_ns);
    const std::uint64_t apart = static_cast<std::uint64_t>(later) - static_cast<std::uint64_t>(earlier);
    return apart <= static_cast<std::uint64_t>(std::max<std::int64_t>(0, settings_.stale_after_ns));
  }

  sample_check_settings settings_;
  bool has_last_ = false;
  pose last_T_dh_{};
  std::int64_t last_ns_ = 0;
  std::uint32_t rejected_in_a_row_ = 0;
  std::uint64_t rejected_ = 0;
};

}  // namespace asperity
