// The time of the loops: whether they keep it, what becomes of the output where not, and whether a program beats.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "asperity/control/linear_contact.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/device/output_gate.hpp"

namespace asperity {

/// How late the loops may be. Past each limit the output first scales down to nothing, then the gate shuts.
struct rate_limits {
  /// The device loop's nominal period, ns. 0: a session fills in its own, and a loop by itself does not judge periods
  /// that were left out.
  std::int64_t period_ns = 0;

  std::int64_t longest_gap_ns = 250'000'000;  ///< between two device ticks; a longer one shuts the gate: stalled
  std::int64_t longest_contact_age_ns = 1'000'000'000;  ///< of the contact in use; an older one: contact_stalled

  double fading_lost_share = 0.25;           ///< share of device periods left out from which the output fades ...
  double silent_lost_share = 0.45;           ///< ... to nothing here
  std::int64_t share_time_ns = 500'000'000;  ///< time constant over which the share is taken

  std::int64_t settle_ns = 50'000'000;  ///< punctual ticks after a lapse before anything is put out again
  std::int64_t rise_ns = 200'000'000;   ///< from nothing to the full wrench, after that
  std::int64_t longest_silence_ns =
      2'000'000'000;                             ///< lateness that kept the output at zero for so long shuts the gate
  double most_lapses = 5.0;                      ///< more lapses than this in a short time shut the gate ...
  std::int64_t lapse_memory_ns = 1'000'000'000;  ///< ... of which one is forgotten in each such time

  /// A contact that takes the place of one older than this, and pushes by so much otherwise at the probe's pose, finds
  /// the probe where no plane was known. It throws the probe out, which the hand must not feel.
  std::int64_t surprise_age_ns = 25'000'000;
  double surprise_n = 0.5;
  double surprise_n_m = 0.02;

  double catch_up_m_per_s =
      1.0;  ///< after a lapse the probe returns to the hand at this speed, so that contacts follow
  double catch_up_rad_per_s = 2.5;
};

/// How punctual a device loop was since it was made.
struct rate_report {
  std::uint64_t ticks = 0;
  std::uint64_t lost_periods = 0;      ///< nominal periods without a tick of their own; 0 where no period is known
  std::uint64_t lapses = 0;            ///< gaps after which the last command had expired
  std::uint64_t contact_lapses = 0;    ///< times that the contact in use grew too old to be felt
  std::uint64_t surprises = 0;         ///< contacts that found the probe where no plane was known
  std::int64_t longest_gap_ns = 0;     ///< between two ticks
  std::int64_t oldest_contact_ns = 0;  ///< age of the oldest contact that was in use
  double worst_lost_share = 0.0;       ///< of the device periods, over rate_limits::share_time_ns
  double lowest_scale = 1.0;           ///< smallest factor that lateness put on the output
  std::int64_t silent_ns = 0;          ///< time in which lateness kept the output at zero
};

/// What one tick may put out, as far as punctuality goes.
struct rate_verdict {
  double scale = 1.0;                   ///< factor on the wrench; exactly 1 where nothing was late
  bool settling = false;                ///< after a lapse: the probe returns to the hand slowly
  bool blind = false;                   ///< no contact tells what is on the way to the hand: the probe stays
  gate_fault fault = gate_fault::none;  ///< what the gate should be shut with
};

/// Turns the times of ticks into one factor on the output. The factor falls at once and rises slowly, so that a loop
/// that is late again and again fades and does not pulse.
///
/// A lapse is a gap after which the last command had expired, or a contact older than contact_ageing allows. Behind it
/// the probe is not where the hand is, and a spring as long as the hand's way in the gap would pull. So nothing is put
/// out until the probe has returned to the hand and ticks were punctual for settle_ns. A surprise is treated alike.
/// @rt safe: fixed cost
class rate_monitor {
 public:
  explicit rate_monitor(const rate_limits& limits = {}, const contact_ageing& ageing = {}) noexcept
      : limits_(limits), ageing_(ageing) {}

  /// No contact was handed over yet.
  static constexpr std::int64_t no_contact = -1;

  /// One tick.
  /// @param gap_ns since the tick before, 0 for the first
  /// @param expired the last command was no longer valid when this tick came
  /// @param contact_age_ns of the contact in use, or no_contact
  /// @param caught_up the probe's target was at the hand at the end of the tick before
  /// @param surprised the contact in use is new, and the probe will be thrown by it
  [[nodiscard]] rate_verdict judge(std::int64_t gap_ns, bool expired, std::int64_t contact_age_ns, bool caught_up,
                                   bool surprised = false) noexcept {
    rate_verdict out;
    const bool contact_lapsed = contact_age_ns >= ageing_.hold_ns + ageing_.fade_ns;
    ++report_.ticks;
    report_.longest_gap_ns = std::max(report_.longest_gap_ns, gap_ns);
    report_.oldest_contact_ns = std::max(report_.oldest_contact_ns, contact_age_ns);
    count_lapses(gap_ns, expired, contact_lapsed && !contact_lapsed_);
    contact_lapsed_ = contact_lapsed;
    take_share(gap_ns);

    report_.surprises += surprised ? 1U : 0U;
    if (expired || contact_lapsed || surprised) {
      settling_ = true;
      quiet_ns_ = 0;
    } else if (settling_ && caught_up) {
      quiet_ns_ += gap_ns;
      settling_ = quiet_ns_ < limits_.settle_ns;
    }
    const double punctual = share_scale() * (contact_age_ns < 0 ? 1.0 : strength_at(contact_age_ns, ageing_));
    const double target = settling_ ? 0.0 : punctual;
    const double rise = limits_.rise_ns > 0 ? static_cast<double>(gap_ns) / static_cast<double>(limits_.rise_ns) : 1.0;
    scale_ = target < scale_ ? target : std::min(target, scale_ + rise);
    silent_ns_ = scale_ > 0.0 ? 0 : silent_ns_ + gap_ns;
    report_.silent_ns += scale_ > 0.0 ? 0 : gap_ns;
    report_.lowest_scale = std::min(report_.lowest_scale, scale_);

    out.scale = scale_;
    out.settling = settling_;
    out.blind = expired || contact_lapsed;
    out.fault = fault(gap_ns, contact_age_ns);
    return out;
  }

  /// The part of its way to the hand that the probe's target may go in dt_s seconds: all of it, unless ticks were late.
  /// Then it stays while nothing is known of the hand or the contact, and returns no faster than contacts can follow.
  /// @param now the answer of judge()   @param way translation, m, and rotation vector, rad
  [[nodiscard]] double part_allowed(const rate_verdict& now, const vec6& way, double dt_s) const noexcept {
    if (!now.settling) return 1.0;
    if (now.blind) return 0.0;
    const double far_m = glm::length(way.linear);
    const double far_rad = glm::length(way.angular);
    const double most_m = limits_.catch_up_m_per_s * dt_s;
    const double most_rad = limits_.catch_up_rad_per_s * dt_s;
    return std::min(far_m > most_m ? most_m / far_m : 1.0, far_rad > most_rad ? most_rad / far_rad : 1.0);
  }

  /// Begins anew after a person has cleared a fault. The report goes on.
  void restart() noexcept {
    const rate_report kept = report_;
    *this = rate_monitor(limits_, ageing_);
    report_ = kept;
  }

  [[nodiscard]] const rate_report& report() const noexcept { return report_; }
  [[nodiscard]] const rate_limits& limits() const noexcept { return limits_; }
  /// Share of the device periods left out lately, 0 to 1.
  [[nodiscard]] double lost_share() const noexcept { return lost_share_; }

 private:
  void count_lapses(std::int64_t gap_ns, bool expired, bool contact_began) noexcept {
    const double forgotten = limits_.lapse_memory_ns > 0
                                 ? static_cast<double>(gap_ns) / static_cast<double>(limits_.lapse_memory_ns)
                                 : std::numeric_limits<double>::infinity();
    device_lapses_ = std::max(0.0, device_lapses_ - forgotten) + (expired ? 1.0 : 0.0);
    contact_lapses_ = std::max(0.0, contact_lapses_ - forgotten) + (contact_began ? 1.0 : 0.0);
    report_.lapses += expired ? 1U : 0U;
    report_.contact_lapses += contact_began ? 1U : 0U;
  }

  // A tick that is late and followed by one in time has left nothing out: only whole periods behind the grid count.
  void take_share(std::int64_t gap_ns) noexcept {
    if (limits_.period_ns <= 0 || gap_ns <= 0) return;
    behind_ns_ = std::max<std::int64_t>(0, behind_ns_ + gap_ns - limits_.period_ns);
    const std::int64_t lost = behind_ns_ / limits_.period_ns;
    behind_ns_ -= lost * limits_.period_ns;
    report_.lost_periods += static_cast<std::uint64_t>(lost);
    const auto gap = static_cast<double>(gap_ns);
    const double now = std::min(1.0, static_cast<double>(lost) * static_cast<double>(limits_.period_ns) / gap);
    lost_share_ +=
        gap / (gap + static_cast<double>(std::max<std::int64_t>(0, limits_.share_time_ns))) * (now - lost_share_);
    report_.worst_lost_share = std::max(report_.worst_lost_share, lost_share_);
  }

  [[nodiscard]] double share_scale() const noexcept {
    if (lost_share_ <= limits_.fading_lost_share) return 1.0;
    if (lost_share_ >= limits_.silent_lost_share) return 0.0;
    return (limits_.silent_lost_share - lost_share_) / (limits_.silent_lost_share - limits_.fading_lost_share);
  }

  // The longest delay comes first: it names the cause best.
  [[nodiscard]] gate_fault fault(std::int64_t gap_ns, std::int64_t contact_age_ns) const noexcept {
    if (gap_ns > limits_.longest_gap_ns) return gate_fault::stalled;
    if (contact_age_ns > limits_.longest_contact_age_ns) return gate_fault::contact_stalled;
    if (device_lapses_ > limits_.most_lapses) return gate_fault::stalled;
    if (contact_lapses_ > limits_.most_lapses) return gate_fault::contact_stalled;
    if (silent_ns_ > limits_.longest_silence_ns) return gate_fault::overloaded;
    return gate_fault::none;
  }

  rate_limits limits_;
  contact_ageing ageing_;
  rate_report report_{};
  double scale_ = 1.0;
  bool settling_ = false;
  bool contact_lapsed_ = false;
  std::int64_t quiet_ns_ = 0;   // punctual since the last lapse
  std::int64_t silent_ns_ = 0;  // without output, in a row
  std::int64_t behind_ns_ = 0;  // part of a period that ticks are behind their grid
  double lost_share_ = 0.0;
  double device_lapses_ = 0.0;
  double contact_lapses_ = 0.0;
};

/// A loop's own time: the steps forward of the session's clock, summed up. A clock that steps back stands still for one
/// tick, and the time goes on from there. @rt safe
class loop_clock {
 public:
  /// @param clock_ns the session's clock; the first one is where the time begins
  /// @return how far it went, ns; 0 in the first tick
  std::int64_t advance(std::int64_t clock_ns) noexcept {
    if (!started_) now_ns_ = last_clock_ns_ = clock_ns;
    const std::int64_t step_ns = std::max<std::int64_t>(0, clock_ns - last_clock_ns_);
    started_ = true;
    last_clock_ns_ = clock_ns;
    now_ns_ += step_ns;
    return step_ns;
  }
  [[nodiscard]] std::int64_t now_ns() const noexcept { return now_ns_; }

 private:
  bool started_ = false;
  std::int64_t last_clock_ns_ = 0;
  std::int64_t now_ns_ = 0;
};

/// Watches the beats of an application. The first look counts as a beat, because the application has just started the
/// session. A beat carries no time: one that is found after a long gap may have come at the end of it, so the whole gap
/// counts as silence. @rt safe
class heartbeat_watch {
 public:
  /// @param beats counted so far   @param limit_ns of silence; 0: any is allowed
  /// @return whether there was none for longer
  [[nodiscard]] bool is_silent(std::uint64_t beats, std::int64_t now_ns, std::int64_t limit_ns) noexcept {
    if (!heard_) beat_ns_ = now_ns;
    const bool silent = limit_ns > 0 && now_ns - beat_ns_ > limit_ns;
    if (beats != beats_) beat_ns_ = now_ns;
    beats_ = beats;
    heard_ = true;
    return silent;
  }
  /// Silence is counted from now on.
  void restart(std::int64_t now_ns) noexcept { beat_ns_ = now_ns; }

 private:
  std::uint64_t beats_ = 0;   // as last seen ...
  std::int64_t beat_ns_ = 0;  // ... to change at this time
  bool heard_ = false;
};

}  // namespace asperity
