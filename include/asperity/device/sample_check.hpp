// What of a sample from a device can be believed: where its handle is, and how fast it moves.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
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

/// Where the velocity of the handle comes from that the virtual coupling's damper is given.
enum class velocity_source : std::uint8_t {
  poses,   ///< the poses of the last millisecond: an encoder's step of 10 um in it is 10 mm/s
  window,  ///< as many of the last poses as lie on one line
  device,  ///< what the device tells; the window where it tells none that can be believed
};

[[nodiscard]] constexpr const char* to_string(velocity_source s) noexcept {
  switch (s) {
    case velocity_source::poses:
      return "poses";
    case velocity_source::window:
      return "window";
    case velocity_source::device:
      return "device";
  }
  return "unknown source";
}

/// Velocity of a handle by its last poses, or as the device tells it.
///
/// Window: of the last 20 ms the longest stretch whose poses lie within the encoder's steps of the straight line from
/// its first to its last one; the velocity is the slope of the line that fits them best. At rest that is the whole
/// window, in a quick change of speed two poses.
///
/// Device: its own velocity, each of translation and rotation where the sample's `valid` has it. It is compared with the
/// poses: its integral over the last tenth of a second may be off by 3 mm and 25 ms at the largest speed (0.03 rad).
/// One that is further off (another unit, another sign, zeros), is not finite or faster than any hand is not believed
/// any more, until restart(); the window takes its place.
/// @source window: Janabi-Sharifi, Hayward and Chen 2000, end-fit; the slope of the best fit and the comparison are ours
/// @rt safe: at most 41 poses are looked at, each at most 40 times
class velocity_estimator {
 public:
  static constexpr std::int64_t longest_ns = 20'000'000;
  static constexpr std::int64_t spacing_ns = 500'000;  ///< poses that come closer take the place of the last one
  static constexpr double fastest_m_per_s = 10.0;
  static constexpr double fastest_rad_per_s = 100.0;

  /// @param position_resolution_m, rotation_resolution_rad of the encoder; 0 for one that is not known
  explicit velocity_estimator(velocity_source wanted = velocity_source::poses, double position_resolution_m = 0.0,
                              double rotation_resolution_rad = 0.0) noexcept
      : wanted_(wanted),
        off_m_(steps * (position_resolution_m > 0.0 ? position_resolution_m : 1e-5)),
        off_rad_(steps * (rotation_resolution_rad > 0.0 ? rotation_resolution_rad : 1e-4)) {}

  /// Forgets all poses and what was not believed.
  void restart() noexcept {
    size_ = 0;
    velocity_d_ = {};
    told_linear_ = told_angular_ = {};
    used_ = velocity_source::window;
  }

  /// Takes a sample that was accepted. One that is not new changes nothing.
  void observe(const device_sample& s) noexcept {
    if (wanted_ == velocity_source::poses) return;
    const bool first = size_ == 0;
    if (!first && (s.sequence == sequence_ || s.host_time_ns <= points_[newest_].time_ns)) return;
    const point before = first ? point{} : points_[newest_];
    add({s.host_time_ns, s.T_dh});
    sequence_ = s.sequence;
    velocity_d_ = fitted();
    used_ = velocity_source::window;
    if (wanted_ != velocity_source::device) return;
    const double dt_s = first ? 0.0 : 1e-9 * static_cast<double>(s.host_time_ns - before.time_ns);
    const vec3 moved = first ? vec3(0.0) : s.T_dh.position - before.T.position;
    const vec3 turned = first ? vec3(0.0) : log_rotation(s.T_dh.rotation * glm::conjugate(before.T.rotation));
    if (has_all(s.valid, sample_field::linear_velocity)) {
      told_linear_.compare(s.velocity_d.linear, velocity_d_.linear, moved, dt_s, {fastest_m_per_s, 3e-3});
      if (!told_linear_.refused) velocity_d_.linear = s.velocity_d.linear, used_ = velocity_source::device;
    }
    if (has_all(s.valid, sample_field::angular_velocity)) {
      told_angular_.compare(s.velocity_d.angular, velocity_d_.angular, turned, dt_s, {fastest_rad_per_s, 0.03});
      if (!told_angular_.refused) velocity_d_.angular = s.velocity_d.angular;
    }
  }

  [[nodiscard]] velocity_source wanted() const noexcept { return wanted_; }
  /// Where the translation of velocity_d() is from: window or device; `poses` where nothing else is wanted.
  [[nodiscard]] velocity_source used() const noexcept {
    return wanted_ == velocity_source::poses ? velocity_source::poses : used_;
  }
  /// Of the handle's origin, base frame; zero before the second pose, and where only poses are wanted.
  [[nodiscard]] const twist& velocity_d() const noexcept { return velocity_d_; }
  /// Whether the device told a velocity that does not go with its poses.
  [[nodiscard]] bool refused() const noexcept { return told_linear_.refused || told_angular_.refused; }

 private:
  // Two ends and a point between are each half a step off in every axis.
  static constexpr double steps = 1.75;
  static constexpr std::size_t most = static_cast<std::size_t>(longest_ns / spacing_ns) + 1;

  struct point {
    std::int64_t time_ns = 0;
    pose T{};
  };
  struct allowance {
    double fastest = 0.0;  ///< m/s or rad/s
    double way = 0.0;      ///< m or rad
  };

  /// How well a velocity that is told goes with the poses.
  struct comparison {
    vec3 ahead{0.0};  ///< what it is ahead of the poses, forgotten over a tenth of a second
    double speed = 0.0;
    bool refused = false;

    void compare(const vec3& told, const vec3& fitted_velocity, const vec3& moved, double dt_s,
                 const allowance& most_off) noexcept {
      constexpr double memory_s = 0.1;
      constexpr double latest_s = 0.025;
      const double told_speed = glm::length(told);
      if (!(told_speed <= most_off.fastest)) refused = true;  // NaN too
      if (refused) return;
      const double keep = std::max(0.0, 1.0 - dt_s / memory_s);
      ahead = keep * ahead + dt_s * told - moved;
      speed = std::max({keep * speed, told_speed, glm::length(fitted_velocity)});
      refused = glm::length(ahead) > most_off.way + latest_s * speed;
    }
  };

  [[nodiscard]] const point& back(std::size_t i) const noexcept { return points_[(newest_ + most - i) % most]; }

  void add(const point& p) noexcept {
    const bool close = size_ > 1 && p.time_ns - back(1).time_ns < spacing_ns;
    if (!close) {
      newest_ = (newest_ + 1) % most;
      size_ = std::min(size_ + 1, most);
    }
    points_[newest_] = p;
  }

  [[nodiscard]] twist fitted() const noexcept {
    std::array<double, most> ago_s{};
    std::array<vec3, most> moved{}, turned{};  // from the newest pose back to each
    const point& now = back(0);
    std::size_t n = 1;
    for (; n < size_ && now.time_ns - back(n).time_ns <= longest_ns; ++n) {
      ago_s[n] = 1e-9 * static_cast<double>(now.time_ns - back(n).time_ns);
      moved[n] = back(n).T.position - now.T.position;
      turned[n] = log_rotation(back(n).T.rotation * glm::conjugate(now.T.rotation));
    }
    return {slope(ago_s, moved, n, off_m_), slope(ago_s, turned, n, off_rad_)};
  }

  [[nodiscard]] static vec3 slope(const std::array<double, most>& ago_s, const std::array<vec3, most>& back_by,
                                  std::size_t n, double off) noexcept {
    std::size_t last = n > 1 ? 1 : 0;
    while (last + 1 < n && is_straight(ago_s, back_by, last + 1, off)) ++last;
    if (last == 0) return vec3(0.0);
    double mean_s = 0.0;
    vec3 mean(0.0);
    for (std::size_t i = 1; i <= last; ++i) mean_s += ago_s[i], mean += back_by[i];
    mean_s /= static_cast<double>(last + 1);
    mean /= static_cast<double>(last + 1);
    double squares = 0.0;
    vec3 products(0.0);
    for (std::size_t i = 0; i <= last; ++i) {
      squares += (ago_s[i] - mean_s) * (ago_s[i] - mean_s);
      products += (ago_s[i] - mean_s) * (back_by[i] - mean);
    }
    return squares > 0.0 ? -1.0 / squares * products : vec3(0.0);
  }

  [[nodiscard]] static bool is_straight(const std::array<double, most>& ago_s, const std::array<vec3, most>& back_by,
                                        std::size_t last, double off) noexcept {
    const vec3 rate = back_by[last] / ago_s[last];
    for (std::size_t i = 1; i < last; ++i) {
      if (!(glm::length(ago_s[i] * rate - back_by[i]) <= off)) return false;
    }
    return true;
  }

  velocity_source wanted_;
  double off_m_;
  double off_rad_;
  std::array<point, most> points_{};
  std::size_t newest_ = 0;
  std::size_t size_ = 0;
  std::uint64_t sequence_ = 0;
  twist velocity_d_{};
  comparison told_linear_{};
  comparison told_angular_{};
  velocity_source used_ = velocity_source::window;
};

}  // namespace asperity
