// The loop behind the device panel: measures, and puts out a test force through the library's gate.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "asperity/control/rate_monitor.hpp"
#include "asperity/core/triple_buffer.hpp"
#include "asperity/device/device.hpp"
#include "asperity/device/output_gate.hpp"
#include "asperity/device/sample_check.hpp"
#include "dead_man.hpp"

namespace asperity::command {

inline constexpr double most_test_force_n = 1.0;

/// The largest test force of a device: 1 N, or what it can hold for ever, or what its slew rate takes to zero in 50 ms.
[[nodiscard]] inline double test_force_of(const device_capabilities& c) noexcept {
  constexpr double to_zero_s = 0.05;
  const double n =
      std::min({most_test_force_n, c.continuous_force_n, c.peak_force_n, to_zero_s * c.force_slew_n_per_s});
  return (c.actuated & translation_axes) != 0 && n > 0.0 ? n : 0.0;
}

/// Limits of the gate for the test: no torque, and no more force than may be tried.
[[nodiscard]] inline gate_limits test_limits_of(const device_capabilities& c, double most_n) noexcept {
  gate_limits out = limits_of(c);
  out.peak_force_n = out.continuous_force_n = most_n;
  out.peak_torque_n_m = out.continuous_torque_n_m = 0.0;
  return tighter(limits_of(c), out);
}

/// What became of one press, on the clock of the loop.
struct press_record {
  std::uint64_t press = 0;
  vec3 force_d{0.0};  ///< wanted, N
  press_end end = press_end::none;
  std::int64_t last_beat_ns = 0;  ///< arrival of its last beat
  std::int64_t began_ns = 0;      ///< tick of its first beat
  std::int64_t zero_ns = 0;       ///< first tick after its end in which nothing was put out; 0 before
  double largest_n = 0.0;         ///< put out
};

/// The loop as a page is told of it.
struct panel_snapshot {
  std::int64_t time_ns = 0;
  device_sample sample{};
  sample_verdict verdict = sample_verdict::no_answer;
  device_state device = device_state::absent;
  gate_fault fault = gate_fault::none;
  wrench put_out{};
  rate_report rates{};
  double rate_scale = 1.0;
  std::uint64_t rejected = 0;  ///< samples that could not be used
  std::uint64_t repeated = 0;  ///< reads that found no new measurement
  press_record last{};         ///< the newest press
};

/// Whatever a loop shares with the threads of a server. Each triple buffer has one writer and one reader at a time.
struct panel_exchange {
  static constexpr std::size_t periods = 16384;

  triple_buffer<force_wish> wish;
  triple_buffer<panel_snapshot> seen;
  std::atomic<std::uint64_t> over{0};         ///< the newest press that has ended
  std::atomic<std::uint64_t> application{0};  ///< beats of the program's main thread
  std::array<std::atomic<std::uint32_t>, periods> period_ns{};
  std::atomic<std::uint64_t> periods_written{0};
};

struct panel_settings {
  std::int64_t period_ns = 1'000'000;
  std::int64_t watchdog_ns = 1'000'000'000;  ///< of the program's main thread
  bool offers_force = false;                 ///< false: no force is ever wanted
  dead_man_settings button{};                ///< most_n is filled in from the device
};

/// One thread's loop. Order of a tick: read, judge the sample and the rate, ask the dead-man button, gate, write.
///
/// What a session's device_loop has for the output, this has too: sample check, rate monitor, watchdog of the
/// application, output gate with its latched faults, disarming once a shut gate is at rest. It has no probe, no coupling
/// and no passivity guard, which would hold a constant force back: that gives energy to a hand that goes along.
/// @rt tick() is as safe as the device
template <haptic_device Device>
class panel_loop {
 public:
  static constexpr std::int64_t command_valid_ns = 20'000'000;
  static constexpr std::size_t most_records = 256;

  /// @param shared outlives the loop
  panel_loop(Device& dev, panel_settings settings, panel_exchange& shared) noexcept
      : device_(&dev),
        settings_(settings),
        most_n_(settings.offers_force ? test_force_of(dev.capabilities()) : 0.0),
        shared_(&shared),
        rates_(rates_for(settings.period_ns)),
        button_(with_most(settings.button, most_n_)),
        gate_(test_limits_of(dev.capabilities(), most_n_), command_valid_ns) {}

  panel_loop(const panel_loop&) = delete;
  panel_loop& operator=(const panel_loop&) = delete;
  ~panel_loop() {
    if (may_put_out(device_->state())) static_cast<void>(device_->disarm());
  }

  void tick(std::int64_t clock_ns) noexcept {
    const std::int64_t gap_ns = clock_.advance(clock_ns);
    const std::int64_t now_ns = clock_.now_ns();
    device_sample seen = last_;
    const sample_verdict verdict = check_.judge(now_ns, device_->read(now_ns, seen), seen);
    const bool accepted = verdict == sample_verdict::accepted;
    if (accepted) {
      repeated_ += rates_.report().ticks > 0 && seen.sequence == last_.sequence ? 1U : 0U;
      last_ = seen;
    }
    const rate_verdict rates = rates_.judge(gap_ns, now_ns > valid_until_ns_, rate_monitor::no_contact, true);
    if (rates_.report().ticks > 1) note_period(gap_ns);
    if (rates.fault != gate_fault::none && may_put_out(device_->state())) gate_.trip(rates.fault, now_ns);
    const std::uint64_t beats = shared_->application.load(std::memory_order_relaxed);
    if (application_.is_silent(beats, now_ns, settings_.watchdog_ns)) gate_.trip(gate_fault::watchdog, now_ns);

    static_cast<void>(shared_->wish.refresh());
    const force_wish& wish = shared_->wish.front();
    const bool may = settings_.offers_force && may_put_out(device_->state()) && gate_.fault() == gate_fault::none;
    vec3 force_d = button_.wanted(now_ns, wish, may);
    if (!accepted || !may) force_d = vec3(0.0);
    if (!may_put_out(device_->state())) gate_.rest();
    const device_command sent =
        gate_.pass(now_ns, seen, {{rates.scale * force_d, vec3(0.0)}, wrench_frame::device_base, now_ns, ++sequence_});
    valid_until_ns_ = sent.valid_until_ns;
    judge_device(device_->write(now_ns, sent));
    if (check_.exhausted()) gate_.trip(gate_fault::bad_samples);
    if (gate_.fault() != gate_fault::none && gate_.at_rest() && may_put_out(device_->state())) {
      static_cast<void>(device_->disarm());
    }
    keep(now_ns, wish, sent.on_hand.force);
    report(now_ns, verdict, rates);
  }

  /// Shuts the gate: the force goes to zero at the slew rate and the device is disarmed.
  void stop(gate_fault cause = gate_fault::stopped) noexcept { gate_.trip(cause, clock_.now_ns()); }

  [[nodiscard]] const output_gate& gate() const noexcept { return gate_; }
  [[nodiscard]] const rate_monitor& rates() const noexcept { return rates_; }
  [[nodiscard]] const sample_check& samples() const noexcept { return check_; }
  [[nodiscard]] const dead_man& button() const noexcept { return button_; }
  /// Largest test force, N; 0 where none is offered.
  [[nodiscard]] double most_n() const noexcept { return most_n_; }
  /// Presses that had a beat, the first of them.
  [[nodiscard]] std::size_t records() const noexcept { return kept_; }
  [[nodiscard]] const press_record& record(std::size_t i) const noexcept { return records_[i]; }
  /// Presses that had a beat, all of them.
  [[nodiscard]] std::uint64_t presses() const noexcept { return presses_; }
  /// Longest time after the arrival of a beat in which anything was put out without another one.
  [[nodiscard]] std::int64_t longest_without_beat_ns() const noexcept { return longest_without_beat_ns_; }
  [[nodiscard]] double largest_n() const noexcept { return largest_n_; }

 private:
  [[nodiscard]] static rate_limits rates_for(std::int64_t period_ns) noexcept {
    rate_limits out;
    out.period_ns = period_ns;
    return out;
  }
  [[nodiscard]] static dead_man_settings with_most(dead_man_settings s, double most_n) noexcept {
    s.most_n = most_n;
    return s;
  }

  // As device_loop has it: a device that is not there answers not_ready, and so does a closed one.
  void judge_device(status written) noexcept {
    if (written == status::ok) return;
    const device_state s = device_->state();
    const bool gone = written == status::not_ready &&
                      (s == device_state::absent || s == device_state::present || s == device_state::fault);
    gate_.trip(gone ? gate_fault::device_departed : gate_fault::device_failed);
  }

  void note_period(std::int64_t gap_ns) noexcept {
    const std::uint64_t at = shared_->periods_written.load(std::memory_order_relaxed);
    const auto ns =
        static_cast<std::uint32_t>(std::min<std::int64_t>(gap_ns, std::numeric_limits<std::uint32_t>::max()));
    shared_->period_ns[at % panel_exchange::periods].store(ns, std::memory_order_relaxed);
    shared_->periods_written.store(at + 1, std::memory_order_release);
  }

  // The book of presses.
  void keep(std::int64_t now_ns, const force_wish& wish, const vec3& put_out_d) noexcept {
    if (button_.press() != now_.press) {
      now_ = {.press = button_.press(), .force_d = button_.force_d()};
      in_book_ = false;
    }
    if (now_.press == 0) return;
    if (button_.begun() && now_.began_ns == 0) now_.began_ns = now_ns;
    if (wish.press == now_.press && button_.holds()) now_.last_beat_ns = wish.beat_ns;
    now_.end = button_.end();
    const double n = glm::length(put_out_d);
    now_.largest_n = std::max(now_.largest_n, n);
    largest_n_ = std::max(largest_n_, n);
    if (n > 0.0) longest_without_beat_ns_ = std::max(longest_without_beat_ns_, now_ns - now_.last_beat_ns);
    if (now_.end == press_end::none) return;
    if (now_.zero_ns == 0 && n == 0.0) now_.zero_ns = now_ns;
    if (now_.zero_ns != 0 && !in_book_) {
      in_book_ = true;
      presses_ += button_.begun() ? 1U : 0U;
      if (button_.begun() && kept_ < most_records) records_[kept_++] = now_;
    }
    shared_->over.store(now_.press, std::memory_order_release);
  }

  void report(std::int64_t now_ns, sample_verdict verdict, const rate_verdict& rates) noexcept {
    panel_snapshot& to = shared_->seen.back();
    to.time_ns = now_ns;
    to.sample = last_;
    to.verdict = verdict;
    to.device = device_->state();
    to.fault = gate_.fault();
    to.put_out = gate_.last();
    to.rates = rates_.report();
    to.rate_scale = rates.scale;
    to.rejected = check_.rejected();
    to.repeated = repeated_;
    to.last = now_;
    shared_->seen.publish();
  }

  Device* device_;
  panel_settings settings_;
  double most_n_;
  panel_exchange* shared_;
  loop_clock clock_;
  sample_check check_;
  rate_monitor rates_;
  heartbeat_watch application_;
  dead_man button_;
  output_gate gate_;
  device_sample last_{};
  std::int64_t valid_until_ns_ = std::numeric_limits<std::int64_t>::max();
  std::uint64_t sequence_ = 0;
  std::uint64_t repeated_ = 0;
  press_record now_{};
  bool in_book_ = false;
  std::array<press_record, most_records> records_{};
  std::size_t kept_ = 0;
  std::uint64_t presses_ = 0;
  std::int64_t longest_without_beat_ns_ = 0;
  double largest_n_ = 0.0;
};

}  // namespace asperity::command
