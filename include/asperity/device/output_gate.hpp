// The last stage before the device, which nothing goes round.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "asperity/device/capabilities.hpp"
#include "asperity/device/flight_recorder.hpp"
#include "asperity/device/gate_function.hpp"
#include "asperity/device/sample.hpp"

namespace asperity {

/// Why the gate shut. Latched: the first cause is kept.
enum class gate_fault : std::uint8_t {
  none,
  not_finite,          ///< a wrench with NaN, infinity or more than 1e150 came in
  wrong_frame,         ///< a wrench that is not written in wrench_frame::device_base
  stale_command,       ///< a command older than its own valid_until_ns
  certificate_failed,  ///< the value about to leave was not within its limit
  bad_samples,         ///< too many samples in a row that could not be used
  device_failed,       ///< the device refused a command, was closed, or reported a fault
  energy,              ///< more energy reached the hand than the passivity guard could hold back
  stopped,             ///< somebody asked for a stop
  device_departed,     ///< the device is no longer there
  watchdog,            ///< the application gave no sign of life in time
  interrupted,         ///< a signal asked for a stop
  stalled,             ///< the device loop stood still for too long, or again and again
  contact_stalled,     ///< the contact loop did
  overloaded,          ///< the loops were late for so long that nothing could be put out
};
inline constexpr int gate_fault_count = 15;

[[nodiscard]] constexpr const char* to_string(gate_fault f) noexcept {
  switch (f) {
    case gate_fault::none:
      return "none";
    case gate_fault::not_finite:
      return "wrench not finite";
    case gate_fault::wrong_frame:
      return "wrench in a wrong frame";
    case gate_fault::stale_command:
      return "stale command";
    case gate_fault::certificate_failed:
      return "certificate failed";
    case gate_fault::bad_samples:
      return "too many bad samples";
    case gate_fault::device_failed:
      return "device failed";
    case gate_fault::energy:
      return "too much energy";
    case gate_fault::stopped:
      return "stopped";
    case gate_fault::device_departed:
      return "device departed";
    case gate_fault::watchdog:
      return "application watchdog";
    case gate_fault::interrupted:
      return "interrupted";
    case gate_fault::stalled:
      return "device loop stalled";
    case gate_fault::contact_stalled:
      return "contact loop stalled";
    case gate_fault::overloaded:
      return "overloaded";
  }
  return "unknown fault";
}

/// Limits of what may leave. A limit of zero lets nothing through.
struct gate_limits {
  double peak_force_n = 0.0;
  double continuous_force_n = 0.0;  ///< running root mean square that the force settles to
  double force_slew_n_per_s = 0.0;
  double peak_torque_n_m = 0.0;
  double continuous_torque_n_m = 0.0;
  double torque_slew_n_m_per_s = 0.0;
  double thermal_time_s = 10.0;  ///< time constant of the running mean square
};

/// The limits that a device states of itself.
[[nodiscard]] inline gate_limits limits_of(const device_capabilities& c) noexcept {
  return {.peak_force_n = c.peak_force_n,
          .continuous_force_n = c.continuous_force_n,
          .force_slew_n_per_s = c.force_slew_n_per_s,
          .peak_torque_n_m = c.peak_torque_n_m,
          .continuous_torque_n_m = c.continuous_torque_n_m,
          .torque_slew_n_m_per_s = c.torque_slew_n_m_per_s};
}

/// The smaller of every limit: an application can lower a device's limits and never raise them.
[[nodiscard]] inline gate_limits tighter(const gate_limits& a, const gate_limits& b) noexcept {
  return {.peak_force_n = std::min(a.peak_force_n, b.peak_force_n),
          .continuous_force_n = std::min(a.continuous_force_n, b.continuous_force_n),
          .force_slew_n_per_s = std::min(a.force_slew_n_per_s, b.force_slew_n_per_s),
          .peak_torque_n_m = std::min(a.peak_torque_n_m, b.peak_torque_n_m),
          .continuous_torque_n_m = std::min(a.continuous_torque_n_m, b.continuous_torque_n_m),
          .torque_slew_n_m_per_s = std::min(a.torque_slew_n_m_per_s, b.torque_slew_n_m_per_s),
          .thermal_time_s = std::min(a.thermal_time_s, b.thermal_time_s)};
}

/// From a fault to a wrench of zero at the latest, ns: whatever was put out, at the slew rate, in ticks of this period.
/// A tick that comes later than period_ns prolongs it by its delay. The largest number where a slew rate of zero lets
/// nothing change, nor rise either.
/// @pre period_ns > 0
/// @rt safe
[[nodiscard]] inline std::int64_t time_to_zero_ns(const gate_limits& l, std::int64_t period_ns) noexcept;

/// Finite, frame, low-pass, saturation that keeps direction (force and torque apart, thermally derated), slew,
/// staleness, certificate. Whatever comes in, what leaves is finite and within the peak limits.
///
/// The low-pass is of first order, on the wanted wrench, before the saturation; it never sees a wrench that is not
/// finite or not allowed, and then starts anew from what is put out. It delays what is wanted, not the way to zero.
///
/// A non-finite, stale or wrongly framed command latches a fault. From then on the output goes to zero at the slew
/// rate, that is within peak / slew seconds, and stays there until clear(). The thermal budget is one first-order mean
/// square per vector: the longer a demand above the continuous limit lasts, the lower the saturation, so that the
/// running root mean square never passes the continuous limit.
/// @rt safe after construction
class output_gate {
 public:
  static constexpr double no_low_pass = std::numeric_limits<double>::infinity();

  /// @param cut_off_hz of the low-pass; infinite for none. One that is not above zero lets nothing through
  explicit output_gate(const gate_limits& limits, std::int64_t hold_ns = 20'000'000,
                       double cut_off_hz = no_low_pass) noexcept
      : limits_(sane(limits)), hold_ns_(hold_ns), time_constant_s_(time_constant_s(cut_off_hz)) {}

  /// What may leave at now_ns of the wanted command. `seen` goes to the flight recorder only.
  /// The answer is valid for hold_ns: a device with a watchdog falls to zero that long after the last tick, and after
  /// such a gap the slew begins at zero.
  [[nodiscard]] device_command pass(std::int64_t now_ns, const device_sample& seen,
                                    const device_command& wanted) noexcept {
    const double dt = advance(now_ns);
    const bool frame_ok = wanted.frame == wrench_frame::device_base;
    const bool fresh = now_ns <= wanted.valid_until_ns;
    const bool allowed = frame_ok & fresh & (fault_ == gate_fault::none);

    const wrench smooth = smoothed(wanted.on_hand, allowed, dt);
    const bounded_vector force =
        bound_vector(smooth.force, last_.force,
                     {.limit = limits_.peak_force_n,
                      .saturation = derated(limits_.peak_force_n, limits_.continuous_force_n, force_mean_square_),
                      .max_change = limits_.force_slew_n_per_s * dt},
                     allowed);
    const bounded_vector torque = bound_vector(
        smooth.torque, last_.torque,
        {.limit = limits_.peak_torque_n_m,
         .saturation = derated(limits_.peak_torque_n_m, limits_.continuous_torque_n_m, torque_mean_square_),
         .max_change = limits_.torque_slew_n_m_per_s * dt},
        allowed);
    last_ = {force.value, torque.value};

    flight_.record({now_ns, seen, wanted.on_hand, last_});
    if (!force.finite || !torque.finite) {
      trip(gate_fault::not_finite);
    } else if (!frame_ok) {
      trip(gate_fault::wrong_frame);
    } else if (!fresh) {
      trip(gate_fault::stale_command);
    } else if (!force.certified || !torque.certified) {
      trip(gate_fault::certificate_failed);
    }
    return {last_, wrench_frame::device_base, now_ns + hold_ns_, ++sequence_};
  }

  /// Shuts the gate for a cause found elsewhere, in the tick of the last pass(). The first cause stays.
  void trip(gate_fault cause) noexcept { trip(cause, last_ns_); }
  /// The same for a cause found at another time.
  void trip(gate_fault cause, std::int64_t at_ns) noexcept {
    if (fault_ != gate_fault::none) return;
    fault_ = cause;
    fault_ns_ = at_ns;
    flight_.freeze();
  }

  /// The device puts out zero by itself, whatever is commanded: nothing is put out, and the slew starts from zero.
  void rest() noexcept { last_ = smooth_ = {}; }

  /// Opens the gate again after a person has seen the fault. @return false while the output is not zero yet
  [[nodiscard]] bool clear() noexcept {
    if (!at_rest()) return false;
    fault_ = gate_fault::none;
    flight_.clear();
    return true;
  }

  [[nodiscard]] gate_fault fault() const noexcept { return fault_; }
  /// When the first cause was found. @pre fault() is not none
  [[nodiscard]] std::int64_t fault_time_ns() const noexcept { return fault_ns_; }
  /// Whether nothing is put out.
  [[nodiscard]] bool at_rest() const noexcept { return is_zero(last_); }
  /// What left last.
  [[nodiscard]] const wrench& last() const noexcept { return last_; }
  /// The ticks up to and including the one that tripped the gate.
  [[nodiscard]] const flight_recorder& flight() const noexcept { return flight_; }
  [[nodiscard]] const gate_limits& limits() const noexcept { return limits_; }
  /// Running mean square of the force, N^2.
  [[nodiscard]] double force_mean_square() const noexcept { return force_mean_square_; }
  [[nodiscard]] double torque_mean_square() const noexcept { return torque_mean_square_; }

 private:
  friend std::int64_t time_to_zero_ns(const gate_limits& l, std::int64_t period_ns) noexcept;

  // A late tick may not save up slew: the device would see the jump that the limit is there to prevent.
  static constexpr double longest_step_s = 0.004;
  static constexpr double largest = 1e150;  // as in bound_vector

  // The certificate needs limits that are ordinary numbers; one that is not becomes zero and lets nothing through.
  [[nodiscard]] static gate_limits sane(gate_limits l) noexcept {
    for (double* x : {&l.peak_force_n, &l.continuous_force_n, &l.force_slew_n_per_s, &l.peak_torque_n_m,
                      &l.continuous_torque_n_m, &l.torque_slew_n_m_per_s}) {
      if (!(*x >= 0.0)) *x = 0.0;
      *x = std::min(*x, 1e6);
    }
    if (!(l.thermal_time_s > 0.0)) l.thermal_time_s = 1.0;
    l.continuous_force_n = std::min(l.continuous_force_n, l.peak_force_n);
    l.continuous_torque_n_m = std::min(l.continuous_torque_n_m, l.peak_torque_n_m);
    return l;
  }

  [[nodiscard]] static double derated(double peak, double continuous, double mean_square) noexcept {
    const double c2 = continuous * continuous;
    if (!(c2 > 0.0)) return 0.0;
    return std::sqrt(c2 + (peak * peak - c2) * std::max(0.0, 1.0 - mean_square / c2));
  }

  [[nodiscard]] static double time_constant_s(double cut_off_hz) noexcept {
    if (cut_off_hz == no_low_pass) return 0.0;
    return cut_off_hz > 0.0 ? 1.0 / (6.283185307179586 * cut_off_hz) : std::numeric_limits<double>::infinity();
  }

  [[nodiscard]] static bool is_ordinary(const vec3& v) noexcept {
    return std::fabs(v.x) <= largest && std::fabs(v.y) <= largest && std::fabs(v.z) <= largest;
  }

  // What is wanted, low-passed. A wrench that is not ordinary goes on as it is, for bound_vector to find.
  [[nodiscard]] wrench smoothed(const wrench& wanted, bool allowed, double dt) noexcept {
    if (time_constant_s_ == 0.0) return wanted;
    if (!allowed || !is_ordinary(wanted.force) || !is_ordinary(wanted.torque)) {
      smooth_ = last_;
      return wanted;
    }
    const double part = dt / (time_constant_s_ + dt);
    smooth_.force += part * (wanted.force - smooth_.force);
    smooth_.torque += part * (wanted.torque - smooth_.torque);
    return smooth_;
  }

  // The last wrench warmed the motors for as long as it was held; after that they cooled, and what comes begins at
  // zero. @return what the slew may use
  [[nodiscard]] double advance(std::int64_t now_ns) noexcept {
    const double passed_s = started_ ? std::max(0.0, static_cast<double>(now_ns - last_ns_) * 1e-9) : 0.0;
    const bool expired = started_ && now_ns > last_ns_ && now_ns - last_ns_ > hold_ns_;
    started_ = true;
    last_ns_ = now_ns;
    const double held_s = std::min(passed_s, static_cast<double>(std::max<std::int64_t>(0, hold_ns_)) * 1e-9);
    heat(last_, held_s);
    heat({}, passed_s - held_s);
    if (expired) last_ = smooth_ = {};
    return std::min(passed_s, longest_step_s);
  }

  void heat(const wrench& held, double dt) noexcept {
    const double a = dt / (limits_.thermal_time_s + dt);
    force_mean_square_ += a * (glm::dot(held.force, held.force) - force_mean_square_);
    torque_mean_square_ += a * (glm::dot(held.torque, held.torque) - torque_mean_square_);
  }

  gate_limits limits_;
  std::int64_t hold_ns_;
  double time_constant_s_;
  std::int64_t last_ns_ = 0;
  bool started_ = false;
  wrench last_{};
  wrench smooth_{};
  double force_mean_square_ = 0.0;
  double torque_mean_square_ = 0.0;
  std::uint64_t sequence_ = 0;
  gate_fault fault_ = gate_fault::none;
  std::int64_t fault_ns_ = 0;
  flight_recorder flight_{};
};

inline std::int64_t time_to_zero_ns(const gate_limits& l, std::int64_t period_ns) noexcept {
  constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max();
  const gate_limits sane = output_gate::sane(l);
  const double dt = std::min(1e-9 * static_cast<double>(period_ns), output_gate::longest_step_s);
  double ticks = 0.0;
  for (const auto& [peak, slew] : {std::pair{sane.peak_force_n, sane.force_slew_n_per_s},
                                   std::pair{sane.peak_torque_n_m, sane.torque_slew_n_m_per_s}}) {
    if (peak > 0.0) ticks = std::max(ticks, peak / (slew * dt));  // infinite where the slew is zero
  }
  // One tick more: the sum of many changes falls short of the peak by its rounding.
  const double ns = (std::ceil(ticks) + 1.0) * static_cast<double>(period_ns);
  return ns < 9e18 ? static_cast<std::int64_t>(ns) : never;
}

}  // namespace asperity
