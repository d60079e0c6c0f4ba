// Vibration that is put out while the hand rests: what the hand does not cause, the loop does.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"

namespace asperity {

namespace detail {

/// One second-order section of a filter, transposed direct form II.
struct biquad {
  double b0 = 1.0, b1 = 0.0, b2 = 0.0, a1 = 0.0, a2 = 0.0;

  /// High-pass with the pole angle's quality q: two of them with q = 1 / (2 cos(pi / 8)) and 1 / (2 cos(3 pi / 8)) are
  /// Butterworth's filter of order 4. @pre 0 < corner_hz < rate_hz / 2
  /// @source bilinear transform of s^2 / (s^2 + s / q + 1), its corner prewarped
  [[nodiscard]] static biquad high_pass(double corner_hz, double rate_hz, double q) noexcept {
    const double k = std::tan(std::numbers::pi * corner_hz / rate_hz);
    const double norm = 1.0 / (1.0 + k / q + k * k);
    return {norm, -2.0 * norm, norm, 2.0 * (k * k - 1.0) * norm, (1.0 - k / q + k * k) * norm};
  }
};

/// A high-pass of order 4 over `channels` values at once.
template <std::size_t channels>
class high_pass_4 {
 public:
  high_pass_4(double corner_hz, double rate_hz) noexcept
      : sections_{biquad::high_pass(corner_hz, rate_hz, 0.5 / std::cos(std::numbers::pi / 8.0)),
                  biquad::high_pass(corner_hz, rate_hz, 0.5 / std::cos(3.0 * std::numbers::pi / 8.0))} {}

  /// As if `x` had been there for ever: the next output of the same value is zero.
  void settle(const std::array<double, channels>& x) noexcept {
    for (std::size_t c = 0; c < channels; ++c) {
      state_[0][c] = {-sections_[0].b0 * x[c], sections_[0].b2 * x[c]};
      state_[1][c] = {0.0, 0.0};
    }
  }

  [[nodiscard]] std::array<double, channels> operator()(std::array<double, channels> x) noexcept {
    for (std::size_t s = 0; s < sections_.size(); ++s) {
      const biquad& f = sections_[s];
      for (std::size_t c = 0; c < channels; ++c) {
        auto& z = state_[s][c];
        const double y = f.b0 * x[c] + z[0];
        z[0] = f.b1 * x[c] - f.a1 * y + z[1];
        z[1] = f.b2 * x[c] - f.a2 * y;
        x[c] = y;
      }
    }
    return x;
  }

 private:
  std::array<biquad, 2> sections_;
  std::array<std::array<std::array<double, 2>, channels>, 2> state_{};
};

}  // namespace detail

/// Vibration of one vector, in its unit: N for a force, N m for a torque.
struct vibration_level {
  double rms = 0.0;   ///< above the corner, over the last stretch of rest
  double mean = 0.0;  ///< length of the mean vector over that stretch
  double worst_rms = 0.0;
  double worst_mean = 0.0;         ///< mean when rms was worst
  std::int64_t worst_time_ns = 0;  ///< end of that stretch
  bool excessive = false;          ///< some stretch had more than both a hundredth of its mean and the least level
};

/// What a vibration_monitor has seen.
struct vibration_report {
  vibration_level force, torque;
  std::int64_t rest_ns = 0;        ///< time at rest that was measured
  std::uint64_t measurements = 0;  ///< stretches that were measured; 0: the levels mean nothing
};

/// Observes the wrench that is put out, and tells how much of it is vibration while the hand rests.
///
/// - Vibration: what a Butterworth high-pass of order 4 at 60 Hz lets through, for a sine of frequency f at device rate
/// r
///   the share 1 / sqrt(1 + (tan(60 pi / r) / tan(f pi / r))^8). Its band ends at half the rate. rms is over the three
///   components together.
/// - Blocks of a tenth of a second. The hand rests over a block where the means of its pose over this block and over
/// the
///   one before differ by less than slow_m_per_s and slow_rad_per_s allow. Means, because a vibrating handle has a fast
///   pose and rests all the same.
/// - A measurement is over the last 6 to 10 blocks at rest in a row, without the two of the largest and the two of the
/// least level: a vibration
///   lasts, a step of the force is in one block or on the border of two.
/// - A gap of more than 2.5 periods, a clock that steps back, and anything that is not finite start anew.
/// It only looks: nothing that is sent depends on it.
class vibration_monitor {
 public:
  static constexpr double corner_hz = 60.0;
  static constexpr double slow_m_per_s = 3e-3;
  static constexpr double slow_rad_per_s = 0.05;
  static constexpr double excessive_share = 0.01;    ///< of the mean force or torque
  static constexpr double excessive_force_n = 5e-3;  ///< least level that is reported
  static constexpr double excessive_torque_n_m = 0.5e-3;
  static constexpr std::int64_t shortest_period_ns = 100'000;
  static constexpr std::int64_t longest_period_ns = 5'000'000;

  /// @param period_ns  of the device loop: 200 Hz to 10 kHz; with another one nothing is measured, see valid()
  explicit vibration_monitor(std::int64_t period_ns) noexcept
      : period_ns_(std::clamp(period_ns, shortest_period_ns, longest_period_ns)),
        valid_(period_ns == period_ns_),
        block_ticks_(static_cast<std::uint32_t>((block_ns + period_ns_ / 2) / period_ns_)),
        filter_(corner_hz, 1e9 / static_cast<double>(period_ns_)) {}

  [[nodiscard]] bool valid() const noexcept { return valid_; }

  /// One device tick.
  /// @param T_dh     handle in the device's base frame
  /// @param on_hand  what was sent
  /// @rt safe: no allocation, lock, throw, print or clock
  void observe(std::int64_t time_ns, const pose& T_dh, const wrench& on_hand) noexcept {
    if (!valid_) return;
    if (!is_valid(T_dh)) {
      started_ = false;
      return;
    }
    const vec3 &f = on_hand.force, &t = on_hand.torque;
    const std::array<double, 6> sent{f.x, f.y, f.z, t.x, t.y, t.z};
    const std::int64_t gap_ns = time_ns - last_ns_;
    if (!started_ || gap_ns < 0 || 2 * gap_ns > 5 * period_ns_) restart(sent, T_dh);
    last_ns_ = time_ns;
    const std::array<double, 6> high = filter_(sent);
    block& b = now_;
    b.force2 += high[0] * high[0] + high[1] * high[1] + high[2] * high[2];
    b.torque2 += high[3] * high[3] + high[4] * high[4] + high[5] * high[5];
    b.force += f;
    b.torque += t;
    b.position += T_dh.position;
    b.rotation += log_rotation(T_dh.rotation * glm::conjugate(about_));
    if (++b.ticks == block_ticks_) close_block(time_ns);
  }

  [[nodiscard]] const vibration_report& report() const noexcept { return report_; }

 private:
  static constexpr std::int64_t block_ns = 100'000'000;
  static constexpr std::size_t most_blocks = 10, least_blocks = 6, left_out = 2;

  /// Sums over the ticks of a block.
  struct block {
    double force2 = 0.0, torque2 = 0.0;  ///< of what the high-pass let through
    vec3 force{0.0}, torque{0.0};
    vec3 position{0.0}, rotation{0.0};  ///< rotation vector from about_
    std::uint32_t ticks = 0;
  };

  void restart(const std::array<double, 6>& sent, const pose& T_dh) noexcept {
    filter_.settle(sent);
    about_ = T_dh.rotation;
    now_ = {};
    resting_ = 0;
    has_before_ = false;
    started_ = true;
  }

  void close_block(std::int64_t time_ns) noexcept {
    if (!std::isfinite(now_.force2 + now_.torque2)) {  // a wrench that is not a number, or its square
      started_ = false;
      return;
    }
    const double n = block_ticks_, seconds = n * static_cast<double>(period_ns_) * 1e-9;
    const vec3 position = now_.position / n, rotation = now_.rotation / n;
    const bool rests = has_before_ && glm::distance(position, before_position_) < slow_m_per_s * seconds &&
                       glm::distance(rotation, before_rotation_) < slow_rad_per_s * seconds;
    if (rests) {
      blocks_[next_] = now_;
      next_ = (next_ + 1) % most_blocks;
      resting_ = std::min(resting_ + 1, most_blocks);
      if (resting_ >= least_blocks) measure(time_ns);
    } else {
      resting_ = 0;
    }
    before_position_ = position;
    before_rotation_ = rotation;
    has_before_ = true;
    now_ = {};
  }

  void measure(std::int64_t time_ns) noexcept {
    const std::int64_t new_blocks = resting_ == least_blocks ? least_blocks : 1;
    report_.rest_ns += new_blocks * block_ticks_ * period_ns_;
    ++report_.measurements;
    take(time_ns, &block::force2, &block::force, excessive_force_n, report_.force);
    take(time_ns, &block::torque2, &block::torque, excessive_torque_n_m, report_.torque);
  }

  void take(std::int64_t time_ns, double block::*square, vec3 block::*sum, double least,
            vibration_level& out) const noexcept {
    std::array<double, most_blocks> squares{};
    vec3 total(0.0);
    for (std::size_t i = 0; i < resting_; ++i) {
      const block& b = blocks_[(next_ + most_blocks - 1 - i) % most_blocks];
      squares[i] = b.*square;
      total += b.*sum;
    }
    std::sort(squares.begin(), squares.begin() + static_cast<std::ptrdiff_t>(resting_));
    double kept = 0.0;
    for (std::size_t i = left_out; i + left_out < resting_; ++i) kept += squares[i];
    const double ticks = static_cast<double>(block_ticks_);
    out.rms = std::sqrt(kept / (ticks * static_cast<double>(resting_ - 2 * left_out)));
    out.mean = glm::length(total) / (ticks * static_cast<double>(resting_));
    out.excessive = out.excessive || out.rms > std::max(excessive_share * out.mean, least);
    if (out.rms <= out.worst_rms) return;
    out.worst_rms = out.rms;
    out.worst_mean = out.mean;
    out.worst_time_ns = time_ns;
  }

  std::int64_t period_ns_;
  bool valid_;
  std::uint32_t block_ticks_;
  detail::high_pass_4<6> filter_;
  std::array<block, most_blocks> blocks_{};
  block now_{};
  std::size_t next_ = 0, resting_ = 0;
  vec3 before_position_{0.0}, before_rotation_{0.0};
  quat about_{1.0, 0.0, 0.0, 0.0};
  bool has_before_ = false, started_ = false;
  std::int64_t last_ns_ = 0;
  vibration_report report_;
};

}  // namespace asperity
