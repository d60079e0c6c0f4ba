// What must hold in every tick of every session, whatever happened to it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "asperity/control/session_record.hpp"
#include "session/simulation/energy_book.hpp"
#include "session/simulation/scenario.hpp"
#include "session/simulation/watched_device.hpp"

namespace asperity::simulation {

/// What the session itself knows about a tick: the outside world's view.
struct tick_facts {
  std::int64_t clock_ns = 0;         ///< what the clock said
  bool contact_given = false;        ///< a contact has been handed over since the start
  std::int64_t contact_pose_ns = 0;  ///< loop time of the pose that the newest one belongs to
};

/// Checks a session from outside: from what the device was told and answered, from the clock, and from the tick's
/// record where the record is what is promised. Limits, ages, energy and causes are worked out anew.
class checker {
 public:
  checker(const scenario& s, const watched_device& dev) noexcept
      : scenario_(&s),
        device_(&dev),
        force_limit_n_(std::min(s.device.capabilities.peak_force_n, s.control.limits.peak_force_n)),
        torque_limit_n_m_(std::min(s.device.capabilities.peak_torque_n_m, s.control.limits.peak_torque_n_m)),
        force_slew_(std::min(s.device.capabilities.force_slew_n_per_s, s.control.limits.force_slew_n_per_s)),
        torque_slew_(std::min(s.device.capabilities.torque_slew_n_m_per_s, s.control.limits.torque_slew_n_m_per_s)),
        book_(s.control.guard, std::max(force_limit_n_ / force_slew_, torque_limit_n_m_ / torque_slew_)) {}

  /// A person has cleared the loop's fault: the session starts anew from the device's next pose.
  void on_cleared() noexcept {
    fault_ = gate_fault::none;
    stop_asked_ = false;
    has_pose_ = false;
    rejected_in_a_row_ = 0;
    lateness_ = {};
    quiet_until_ns_ = std::numeric_limits<std::int64_t>::min();
  }
  /// A person has told the loop to stop.
  void on_stopped() noexcept { stop_asked_ = fault_ == gate_fault::none; }

  /// @return what is broken, in words; nullptr where everything holds
  [[nodiscard]] const char* check(const session_record& r, const tick_facts& facts) noexcept {
    const char* broken = nullptr;
    const auto expect = [&broken](bool holds, const char* what) {
      if (!holds && broken == nullptr) broken = what;
    };
    const device_command& commanded = device_->command();
    const double passed_s = started_ ? 1e-9 * static_cast<double>(r.time_ns - last_time_ns_) : 0.0;
    const double slew_s = std::clamp(passed_s, 0.0, longest_slew_s);
    expired_ = started_ && r.time_ns > last_commanded_.valid_until_ns;

    numbers(r, commanded, expect);
    time(r, facts, commanded, expect);
    limits(commanded, slew_s, expect);
    samples(r, expect);
    energy(r, commanded, passed_s, slew_s, expect);
    lateness(r, facts, commanded, slew_s, expect);
    causes(r, slew_s, commanded, expect);
    life(r, commanded, expect);

    started_ = true;
    last_time_ns_ = r.time_ns;
    last_clock_ns_ = facts.clock_ns;
    last_commanded_ = commanded;
    last_state_ = device_->state();
    last_arms_ = device_->arms();
    return broken;
  }

  [[nodiscard]] const energy_book& book() const noexcept { return book_; }

 private:
  static constexpr double longest_slew_s = 0.004;  // a late tick earns no more change than this
  static constexpr double rounding = 1e-8;

  template <class Expect>
  void numbers(const session_record& r, const device_command& commanded, Expect expect) const noexcept {
    expect(is_finite(commanded.on_hand) && is_finite(r.on_hand_d), "finite: the command");
    expect(is_finite(r.on_probe_w) && std::isfinite(r.max_depth_m), "finite: the contact");
    expect(is_valid(r.T_dh) && is_valid(r.T_wa) && is_valid(r.T_wa_target), "finite: the poses, rotations of length 1");
    expect(std::isfinite(r.delivered_j) && std::isfinite(r.surplus_j) && std::isfinite(r.guard_alpha_per_s) &&
               std::isfinite(r.guard_scale),
           "finite: the guard");
  }

  template <class Expect>
  void time(const session_record& r, const tick_facts& facts, const device_command& commanded,
            Expect expect) const noexcept {
    if (started_) {
      expect(r.time_ns >= last_time_ns_, "time forward: the record went back");
      expect(r.time_ns - last_time_ns_ == std::max<std::int64_t>(0, facts.clock_ns - last_clock_ns_),
             "time forward: the record does not follow the clock");
      expect(commanded.sequence == last_commanded_.sequence + 1,
             "time forward: the command's number does not grow by one");
    }
    expect(device_->read_at_ns() == r.time_ns && device_->written_at_ns() == r.time_ns,
           "time forward: the device was given another time");
    expect(commanded.valid_until_ns > r.time_ns, "time forward: a command that was over before it was given");
    expect(r.contact_age_ns >= 0, "time forward: a contact from the future");
  }

  template <class Expect>
  void limits(const device_command& commanded, double slew_s, Expect expect) const noexcept {
    expect(commanded.frame == wrench_frame::device_base, "limits: the command's frame");
    expect(glm::length(commanded.on_hand.force) <= force_limit_n_ * (1.0 + rounding), "limits: force");
    expect(glm::length(commanded.on_hand.torque) <= torque_limit_n_m_ * (1.0 + rounding), "limits: torque");
    const wrench change = commanded.on_hand - before();
    const bool to_zero = is_zero(commanded.on_hand);
    if (!device_->output_allowed() && to_zero) return;  // a device that is not armed is silenced at once
    expect(glm::length(change.force) <= force_slew_ * slew_s * (1.0 + rounding) + 1e-12, "limits: slew of the force");
    expect(glm::length(change.torque) <= torque_slew_ * slew_s * (1.0 + rounding) + 1e-12,
           "limits: slew of the torque");
  }

  // A sample that was accepted is judged again here, with the limits as documented.
  template <class Expect>
  void samples(const session_record& r, Expect expect) noexcept {
    const bool accepted = r.sample == sample_verdict::accepted;
    const device_sample& s = device_->sample();
    if (!accepted) {
      ++rejected_in_a_row_;
      return;
    }
    rejected_in_a_row_ = 0;
    expect(device_->read_status() == status::ok, "samples: accepted without an answer");
    expect(is_valid(s.T_dh), "samples: an accepted pose is not a pose");
    const sample_check_settings& c = scenario_->control.samples;
    const double age_s = 1e-9 * (static_cast<double>(r.time_ns) - static_cast<double>(s.host_time_ns));
    expect(std::fabs(age_s) <= 1e-9 * static_cast<double>(c.stale_after_ns) + 1e-6,
           "samples: an accepted sample is old, or from the future");
    if (has_pose_) {
      // The longest way that a hand goes since the last accepted sample: both may be as old as a sample may be.
      const double most_s = 1e-3 + 1e-9 * static_cast<double>(r.time_ns - accepted_at_ns_ + 2 * c.stale_after_ns);
      expect(glm::length(s.T_dh.position - T_dh_.position) <= c.max_speed_m_per_s * most_s,
             "samples: an accepted pose leapt");
    }
    expect(s.T_dh.position == r.T_dh.position && s.T_dh.rotation == r.T_dh.rotation,
           "samples: the record shows another pose than was measured");
  }

  // A fault has a cause, the cause has its fault, and a fault is silent after peak / slew.
  template <class Expect>
  void causes(const session_record& r, double slew_s, const device_command& commanded, Expect expect) noexcept {
    const bool given_up = rejected_in_a_row_ >= scenario_->control.samples.reject_limit;
    const bool refused = device_->write_status() != status::ok;
    const guard_settings& g = scenario_->control.guard;
    const bool spent = book_.surplus_j() > g.cut_off_j - book_.unknown_j() - 1e-9;
    const bool overspent = book_.surplus_j() > g.cut_off_j + book_.unknown_j() + 1e-9;
    const rate_limits& rates = scenario_->control.rates;
    const double lapse_limit = rates.most_lapses - 1e-6;
    const bool stood_still = lateness_.gap_ns > rates.longest_gap_ns;
    const bool may_stall = stood_still || lateness_.gaps.level > lapse_limit;
    const bool may_contact_stall =
        lateness_.contact_age_ns > rates.longest_contact_age_ns || lateness_.contacts.level > lapse_limit;
    const bool may_overload = lateness_.silent_ns > rates.longest_silence_ns;
    const bool must_stall = stood_still && has_pose_ && device_->output_allowed();
    if (fault_ != gate_fault::none) {
      expect(r.fault == fault_, "fault: the first cause was not kept");
      force_left_n_ = std::max(0.0, force_left_n_ - force_slew_ * slew_s);
      torque_left_n_m_ = std::max(0.0, torque_left_n_m_ - torque_slew_ * slew_s);
      expect(glm::length(commanded.on_hand.force) <= force_left_n_ * (1.0 + rounding) + 1e-12,
             "fault: the force stays");
      expect(glm::length(commanded.on_hand.torque) <= torque_left_n_m_ * (1.0 + rounding) + 1e-12,
             "fault: the torque stays");
      return;
    }
    expect(!(given_up || refused || stop_asked_ || overspent || must_stall) || r.fault != gate_fault::none,
           "fault: none where there is a cause");
    if (r.fault == gate_fault::none) return;
    expect((r.fault == gate_fault::bad_samples && given_up) || (r.fault == gate_fault::device_failed && refused) ||
               (r.fault == gate_fault::device_departed && device_->write_status() == status::not_ready) ||
               (r.fault == gate_fault::energy && spent) || (r.fault == gate_fault::stopped && stop_asked_) ||
               (r.fault == gate_fault::stalled && may_stall) ||
               (r.fault == gate_fault::contact_stalled && may_contact_stall) ||
               (r.fault == gate_fault::overloaded && may_overload),
           "fault: without its cause");
    fault_ = r.fault;
    stop_asked_ = false;
    force_left_n_ = glm::length(commanded.on_hand.force);
    torque_left_n_m_ = glm::length(commanded.on_hand.torque);
  }

  template <class Expect>
  void life(const session_record& r, const device_command& commanded, Expect expect) const noexcept {
    const bool was_armed = may_put_out(last_state_);
    const bool is_armed = may_put_out(device_->state());
    expect(!is_armed || was_armed || device_->arms() > last_arms_, "life: the device was armed by nobody");
    expect(device_->output_allowed() || is_zero(commanded.on_hand), "life: a wrench for a device that is not armed");
    expect(r.fault == gate_fault::none || !is_armed || !is_zero(commanded.on_hand), "life: armed in a fault, at rest");
  }

  // A contact that is too old is not felt, nor is anything soon after a command expired. How often either happened, and
  // for how long nothing left, is counted here anew: it is what a fault of lateness has to rest on.
  template <class Expect>
  void lateness(const session_record& r, const tick_facts& facts, const device_command& commanded, double slew_s,
                Expect expect) noexcept {
    const contact_ageing& a = scenario_->control.ageing;
    const rate_limits& limits = scenario_->control.rates;
    const std::int64_t age_ns = facts.contact_given ? r.time_ns - facts.contact_pose_ns : 0;
    const bool in_use = r.probe_status != status::not_ready;
    expect(!in_use || r.contact_age_ns == age_ns, "stale contact: its age is told wrong");
    expect((in_use && facts.contact_given) || is_zero(r.on_probe_w), "stale contact: pushes before there is one");

    const bool too_old = in_use && facts.contact_given && age_ns >= a.hold_ns + a.fade_ns;
    aged_n_ = too_old ? std::max(0.0, aged_n_ - force_slew_ * slew_s) : glm::length(commanded.on_hand.force);
    aged_n_m_ = too_old ? std::max(0.0, aged_n_m_ - torque_slew_ * slew_s) : glm::length(commanded.on_hand.torque);
    expect(glm::length(commanded.on_hand.force) <= aged_n_ * (1.0 + rounding) + 1e-12, "stale contact: still pushes");
    expect(glm::length(commanded.on_hand.torque) <= aged_n_m_ * (1.0 + rounding) + 1e-12, "stale contact: still turns");

    lateness_.gap_ns = started_ ? r.time_ns - last_time_ns_ : 0;
    if (expired_ && in_use) quiet_until_ns_ = r.time_ns + limits.settle_ns;
    expect(r.time_ns >= quiet_until_ns_ || is_zero(commanded.on_hand), "gap: output too soon after a command expired");

    if (!in_use) return;
    const double passed = static_cast<double>(lateness_.gap_ns) / static_cast<double>(limits.lapse_memory_ns);
    lateness_.gaps.count(passed, expired_);
    lateness_.contacts.count(passed, too_old && !was_too_old_);
    was_too_old_ = too_old;
    lateness_.contact_age_ns = age_ns;
    lateness_.silent_ns = is_zero(commanded.on_hand) ? lateness_.silent_ns + lateness_.gap_ns : 0;
  }

  template <class Expect>
  void energy(const session_record& r, const device_command& commanded, double passed_s, double slew_s,
              Expect expect) noexcept {
    const bool accepted = r.sample == sample_verdict::accepted;
    booked_tick t;
    t.accepted = accepted;
    t.T_dh = device_->sample().T_dh;
    t.commanded = commanded.on_hand;
    t.expired = expired_;
    t.uncertain = device_->write_status() != status::ok || was_silenced();
    t.slew_s = slew_s;
    t.step_s = std::min(passed_s, 1e-9 * static_cast<double>(scenario_->control.longest_step_ns));
    if (accepted && !has_pose_) book_.reset();
    book_.book(t);
    if (accepted) {
      has_pose_ = true;
      T_dh_ = t.T_dh;
      accepted_at_ns_ = r.time_ns;
    }
    expect(book_.surplus_j() <= book_.cut_off_bound_j() + 1e-9, "energy: past the cut-off's bound");
    expect(book_.surplus_j() <= book_.hard_bound_j() + 1e-9, "energy: past the hard limit's bound");
    if (book_.only_damping_left()) {
      const device_capabilities& c = scenario_->device.capabilities;
      const double force_n = c.moving_mass_kg * book_.most_damping_per_kg();
      const double torque_n_m = c.moving_inertia_kg_m2 * book_.most_damping_per_kg_m2();
      expect(glm::length(commanded.on_hand.force) <= force_n * (1.0 + rounding) + 1e-9 &&
                 glm::length(commanded.on_hand.torque) <= torque_n_m * (1.0 + rounding) + 1e-9,
             "energy: more than damping past the hard limit");
    }
    expect(!has_pose_ || std::fabs(book_.delivered_j() - r.delivered_j) <= book_.unknown_j() + 1e-9,
           "energy: the guard's book differs");
  }

  // The device stopped by itself, or was disarmed by a person, somewhere between two ticks.
  [[nodiscard]] bool was_silenced() const noexcept { return may_put_out(last_state_) && !device_->output_allowed(); }

  [[nodiscard]] static bool is_zero(const wrench& w) noexcept { return w.force == vec3(0.0) && w.torque == vec3(0.0); }
  /// What the device was putting out when the command came.
  [[nodiscard]] wrench before() const noexcept {
    return may_put_out(last_state_) && device_->output_allowed() && !expired_ ? last_commanded_.on_hand : wrench{};
  }

  const scenario* scenario_;
  const watched_device* device_;
  double force_limit_n_;
  double torque_limit_n_m_;
  double force_slew_;
  double torque_slew_;
  energy_book book_;

  bool started_ = false;
  std::int64_t last_time_ns_ = 0;
  std::int64_t last_clock_ns_ = 0;
  device_command last_commanded_{};
  device_state last_state_ = device_state::absent;
  std::uint64_t last_arms_ = 0;

  bool has_pose_ = false;
  pose T_dh_{};
  std::int64_t accepted_at_ns_ = 0;
  std::uint32_t rejected_in_a_row_ = 0;

  // A count that forgets one in each lapse_memory_ns.
  struct leaky_count {
    double level = 0.0;
    void count(double forgotten, bool one_more) noexcept {
      level = std::max(0.0, level - forgotten) + (one_more ? 1.0 : 0.0);
    }
  };
  struct late_loops {
    std::int64_t gap_ns = 0;
    std::int64_t contact_age_ns = 0;
    std::int64_t silent_ns = 0;
    leaky_count gaps{};
    leaky_count contacts{};
  };
  late_loops lateness_{};
  bool expired_ = false;  // the last command was no longer valid when this tick came
  bool was_too_old_ = false;
  std::int64_t quiet_until_ns_ = std::numeric_limits<std::int64_t>::min();
  double aged_n_ = 0.0;  // what may be left of the force since the contact grew too old
  double aged_n_m_ = 0.0;

  bool stop_asked_ = false;
  gate_fault fault_ = gate_fault::none;
  double force_left_n_ = 0.0;
  double torque_left_n_m_ = 0.0;
};

}  // namespace asperity::simulation
