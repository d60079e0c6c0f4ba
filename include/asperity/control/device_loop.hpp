// The faster of the two rates: device pose in, wrench out, every period.
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "asperity/control/control_settings.hpp"
#include "asperity/control/exchange.hpp"
#include "asperity/control/moving_bodies.hpp"
#include "asperity/control/passivity_guard.hpp"
#include "asperity/control/probe_motion.hpp"
#include "asperity/control/rate_monitor.hpp"
#include "asperity/control/session_record.hpp"
#include "asperity/control/workspace_map.hpp"
#include "asperity/device/device.hpp"
#include "asperity/device/output_gate.hpp"
#include "asperity/device/sample_check.hpp"

namespace asperity {

/// Owns the stages between one device and the exchange: sample check, probe and coupling, passivity guard, output gate.
///
/// Order of one tick: read, judge the sample, book the energy of the last command, judge the rates, step the probe in
/// substeps towards the device (which moves evenly from its last pose to this one), coupling wrench, guard, gate,
/// write, publish the probe's pose and what bodies felt, tell the observer.
///
/// - The probe starts at the device's first good pose, at rest: no jump.
/// - The coupling's damper is given the handle's velocity by its poses, by a window of them, or as the device tells it
///   (control_settings::velocity). What a device tells is compared with its poses and believed only where it fits.
/// - A clutch (control_settings::clutch) lets go of the probe while a button is held down. It goes over in a ramp, with
///   motion and wrench in the same proportion, so that no step is felt and no energy made. The probe stays where it is.
/// - The handle's weight (control_settings::weight) is held up beside the contact's wrench, through the same gate, and its
///   work is kept out of the guard's surplus (handle_weight).
/// - A first touch may ring (control_settings::transient). The guard and the gate see that as any other force.
/// - While the device is not armed the wrench is zero. Once it is armed, the wrench grows from zero at the slew rate.
/// - A clock that steps back stands still for one tick; the loop's time, which the device and the record are given,
///   goes on from there and never goes back.
/// - A tick that comes after the last command has expired (command_valid_ns) finds a device that puts out nothing: the
///   books hold no work for that gap, the slew starts from zero, and nothing is put out until the probe is back at the
///   hand (rate_monitor). A device without a watchdog of its own (device_capabilities::device_side_watchdog) held its
///   wrench all the time: then the work is booked.
/// - A contact older than contact_ageing allows goes on holding the probe, which then does not follow the hand, and is
///   not felt. Letting it go would bury the probe in the body, and the next contact would throw it out.
/// - Bodies that the application moves (exchange::bodies) are followed from tick to tick (body_follower), and planes go
///   with them. What they do to the probe is theirs in the guard's book.
/// - A contact of another version of a changing scene comes into use as a whole: planes, laws, and whom bristles hold on
///   to. So a body that was removed is not felt from the tick on that exchange::scene tells.
/// - Lateness past rate_limits shuts the gate (stalled, contact_stalled, overloaded) while the device may put out.
/// - A rejected sample: the wanted wrench is zero in this tick, and the probe goes on towards the last good pose. After
///   sample_check_settings::reject_limit rejections in a row the gate shuts (bad_samples).
/// - A probe step that fails (a contact that is not finite): the wanted wrench is zero in this tick.
/// - Energy past the guard's cut-off shuts the gate (energy).
/// - An application that has not beaten exchange::application for longer than watchdog_ns shuts the gate (watchdog).
///   The loop itself never beats.
/// - A device that is gone shuts the gate (device_departed), and so does one that refuses a command (device_failed).
///   A shut gate disarms the device once the wrench is zero. Nothing here ever arms.
/// @tparam Device see haptic_device; not owned, outlives the loop
template <haptic_device Device, session_observer Observer = no_observer>
class device_loop {
 public:
  /// @param shared outlives the loop
  device_loop(Device& dev, const control_settings& settings, const vec3& centre_of_mass_a, exchange& shared,
              Observer observer = {})
      : device_(&dev),
        settings_(settings),
        T_ca_(inverse(pose{quat(1.0, 0.0, 0.0, 0.0), centre_of_mass_a})),
        shared_(&shared),
        observer_(std::move(observer)),
        check_(settings.samples),
        handle_(settings.map, settings.clutch, settings.velocity, dev.capabilities(),
                settings.map.T_ha * pose{quat(1.0, 0.0, 0.0, 0.0), centre_of_mass_a}),
        motion_(settings.probe, settings.coupling, laws_of(settings), settings.substeps, settings.friction,
                settings.local_model),
        transient_(settings.transient, dev.capabilities().moving_mass_kg),
        guard_(guard_for(settings.guard, dev.capabilities())),
        weight_(settings.weight, dev.capabilities()),
        rates_(settings.rates, settings.ageing),
        gate_(tighter(limits_of(dev.capabilities()), settings.limits), command_valid_ns, settings.low_pass_hz),
        goes_silent_(dev.capabilities().device_side_watchdog) {}

  // The destructor disarms the device, so that its wrench goes to zero at once: no later tick could lower it slowly.
  device_loop(const device_loop&) = delete;
  device_loop& operator=(const device_loop&) = delete;
  ~device_loop() {
    if (may_put_out(device_->state())) static_cast<void>(device_->disarm());
  }

  /// How long a command is valid, ns: a device with a watchdog puts out zero so long after the last tick.
  static constexpr std::int64_t command_valid_ns = 20'000'000;

  /// One period.
  /// @param clock_ns the session's clock
  /// @return ok | stale_input (sample rejected) | not_finite (probe) | not_ready (no good sample yet) |
  ///         gate_shut (see gate().fault())
  /// @rt as safe as the device: no allocation, lock, throw, print or clock here
  [[nodiscard]] status tick(std::int64_t clock_ns) noexcept {
    const std::int64_t gap_ns = clock_.advance(clock_ns);
    const double dt_s = static_cast<double>(std::min(gap_ns, settings_.longest_step_ns)) * 1e-9;
    const std::int64_t now_ns = clock_.now_ns();
    const bool expired = now_ns > valid_until_ns_;
    const wrench held = expired && goes_silent_ ? wrench{} : gate_.last();
    device_sample seen = handle_.last();
    const sample_verdict verdict = check_.judge(now_ns, device_->read(now_ns, seen), seen);
    if (verdict == sample_verdict::accepted) handle_.take(seen);
    unobserved_s_ += static_cast<double>(gap_ns) * 1e-9;

    const bool accepted = verdict == sample_verdict::accepted;
    if (accepted) follow_handle(dt_s);
    if (accepted && !placed_) place();
    status probe_status = status::not_ready;
    guard_action guarded;
    rate_verdict rates;
    follow_bodies(now_ns);
    if (placed_) {
      if (accepted) {
        const double given_j = std::exchange(unobserved_bodies_j_, 0.0);
        const double raised_j = weight_.observe(handle_.last().T_dh, held, wanted_);
        guard_.observe(handle_.last().T_dh, held, std::exchange(unobserved_s_, 0.0), given_j, raised_j);
        raised_j_ += raised_j;
      }
      const std::uint64_t version = shared_->contacts.front().version;
      const bool surprised = take_contact(now_ns);
      take_scene(version, now_ns);
      rates = rates_.judge(gap_ns, expired, contact_age_ns(now_ns), motion_.caught_up(), surprised);
      probe_status = move_probe(dt_s, accepted, rates);
      if (accepted) transient_.observe(handle_.last().T_dh.position);
      ring(dt_s, probe_status == status::ok && accepted && may_put_out(device_->state()));
      // Without a measured pose, or with a probe that is lost, nothing is put out, the guard's damping included.
      if (accepted && probe_status == status::ok) {
        guarded = guard_.adjust(wrench_on_hand());
        if (weight_.held()) guarded.on_hand += hold_weight(dt_s, rates.scale);
        guarded.on_hand = rates.scale * guarded.on_hand;
      }
    }
    if (rates.fault != gate_fault::none && may_put_out(device_->state())) gate_.trip(rates.fault, now_ns);
    if (guard_.exhausted()) gate_.trip(gate_fault::energy, now_ns);
    const std::uint64_t beats = shared_->application.beats();
    if (application_.is_silent(beats, now_ns, settings_.watchdog_ns)) gate_.trip(gate_fault::watchdog, now_ns);
    if (!may_put_out(device_->state())) {
      gate_.rest();
      guarded.on_hand = {};
    }
    wanted_ = guarded.on_hand;
    const device_command sent =
        gate_.pass(now_ns, seen, {guarded.on_hand, wrench_frame::device_base, now_ns, ++sequence_});
    valid_until_ns_ = sent.valid_until_ns;
    judge_device(device_->write(now_ns, sent));
    if (check_.exhausted()) gate_.trip(gate_fault::bad_samples);
    if (gate_.fault() != gate_fault::none && gate_.at_rest() && may_put_out(device_->state())) {
      static_cast<void>(device_->disarm());
    }
    if (placed_) {
      const pose& T_wc = motion_.probe().state().T_wc;
      shared_->poses.back() = {T_wc,
                               now_ns,
                               motion_.pull(),
                               gaps_for(shared_->contacts.front(), T_wc, settings_.least_gaps_m, motion_.body_share()),
                               bodies_.places(),
                               shared_->contacts.front().version};
      shared_->poses.publish();
      felt_bodies& felt = shared_->felt.back();
      felt = motion_.felt();
      felt.time_ns = now_ns;
      felt.version = shared_->contacts.front().version;
      shared_->felt.publish();
    }
    report(now_ns, verdict, probe_status, guarded, rates, sent.on_hand);
    return answer(verdict, probe_status);
  }

  [[nodiscard]] const output_gate& gate() const noexcept { return gate_; }
  [[nodiscard]] const passivity_guard& guard() const noexcept { return guard_; }
  [[nodiscard]] const asperity::probe& probe() const noexcept { return motion_.probe(); }
  [[nodiscard]] const virtual_coupling& coupling() const noexcept { return motion_.coupling(); }
  /// What the contact did to the probe in the last tick, plane by plane.
  [[nodiscard]] const contact_solution& pressed() const noexcept { return motion_.pressed(); }
  /// What the bodies felt in the last tick.
  [[nodiscard]] const felt_bodies& felt() const noexcept { return motion_.felt(); }
  /// Where the moving bodies are.
  [[nodiscard]] const body_follower& bodies() const noexcept { return bodies_; }
  [[nodiscard]] const sample_check& samples() const noexcept { return check_; }
  /// Where the handle is in the world, and how much of it the probe has.
  [[nodiscard]] const clutched_map& clutch() const noexcept { return handle_.clutch(); }
  /// How fast the handle moves, and who says so.
  [[nodiscard]] const velocity_estimator& speed() const noexcept { return handle_.speed(); }
  [[nodiscard]] const rate_monitor& rates() const noexcept { return rates_; }
  [[nodiscard]] Observer& observer() noexcept { return observer_; }
  [[nodiscard]] Device& device() noexcept { return *device_; }

  /// Shuts the gate: the wrench goes to zero at the slew rate and the device is disarmed.
  void stop(gate_fault cause = gate_fault::stopped) noexcept { gate_.trip(cause, clock_.now_ns()); }

  /// After a person has seen the fault: opens the gate and starts anew from the device's next pose. Arms nothing.
  /// @return false while the wrench is not zero yet
  [[nodiscard]] bool clear_fault() noexcept {
    if (!gate_.clear()) return false;
    check_.restart();
    handle_.restart();
    guard_.reset();
    rates_.restart();
    placed_ = false;
    motion_.forget_contact();
    application_.restart(clock_.now_ns());
    return true;
  }

 private:
  [[nodiscard]] static guard_settings guard_for(guard_settings g, const device_capabilities& c) noexcept {
    if (!(g.mass_kg > 0.0) && !(g.inertia_kg_m2 > 0.0)) {
      g.mass_kg = c.moving_mass_kg;
      g.inertia_kg_m2 = c.moving_inertia_kg_m2;
    }
    return g;
  }

  // A device that is not there answers not_ready, and so does a closed one: its state tells them apart.
  void judge_device(status written) noexcept {
    if (written == status::ok) return;
    const device_state s = device_->state();
    const bool gone = written == status::not_ready &&
                      (s == device_state::absent || s == device_state::present || s == device_state::fault);
    gate_.trip(gone ? gate_fault::device_departed : gate_fault::device_failed);
  }

  [[nodiscard]] std::int64_t contact_age_ns(std::int64_t now_ns) const noexcept {
    const linear_contact& contact = shared_->contacts.front();
    return contact.answer == status::not_ready ? rate_monitor::no_contact : now_ns - contact.time_ns;
  }

  // Takes the newest contact. @return whether the contact before was old or missing, and the new one pushes the probe
  // much harder or otherwise at the place where it went meanwhile
  [[nodiscard]] bool take_contact(std::int64_t now_ns) noexcept {
    const linear_contact& contact = shared_->contacts.front();
    const std::int64_t age_ns = now_ns - (contact.answer == status::not_ready ? placed_ns_ : contact.time_ns);
    if (age_ns <= rates_.limits().surprise_age_ns) {
      if (shared_->contacts.refresh()) motion_.take_contact();
      return false;
    }
    const wrench before = motion_.push_of(contact, bodies_.ways());
    if (!shared_->contacts.refresh()) return false;
    motion_.take_contact();
    wrench change = motion_.push_of(shared_->contacts.front(), bodies_.ways()) - before;
    change.force *= settings_.map.scale;  // as the hand would come to feel it
    return glm::length(change.force) > rates_.limits().surprise_n ||
           glm::length(change.torque) > rates_.limits().surprise_n_m;
  }

  // A contact of another version of the scene: from this tick on nothing of a body that is gone is felt, and the editing
  // thread is told. @param before version of the contact that was in use
  void take_scene(std::uint64_t before, std::int64_t now_ns) noexcept {
    const linear_contact& contact = shared_->contacts.front();
    if (contact.version == 0) return;
    motion_.take_laws(contact);
    bodies_.keep_only(contact.bodies, contact.time_ns);
    if (contact.version == before) return;
    motion_.take_scene(before, contact);
    shared_->scene.back() = {contact.version, sequence_ + 1, now_ns};
    shared_->scene.publish();
  }

  // After the guard, which would take a weight from the motors and give it to the hand.
  [[nodiscard]] wrench hold_weight(double dt_s, double scale) noexcept {
    const bool may = may_put_out(device_->state()) && gate_.fault() == gate_fault::none;
    return weight_.hold(handle_.last().T_dh, may, dt_s, scale);
  }

  // A handle that has let go of the probe, or takes it up again, does so where the probe is and without a pull.
  void follow_handle(double dt_s) noexcept {
    if (handle_.follow(shared_->let_go.load(std::memory_order_relaxed), dt_s) && placed_) {
      handle_.put(motion_.probe().state().T_wc);
      motion_.put_target(handle_.T_wc());
    }
  }

  void place() noexcept {
    placed_ns_ = clock_.now_ns();
    handle_.take_up();
    motion_.place(handle_.T_wc());
    guard_.reset();
    weight_.reset();
    transient_.reset();
    raised_j_ = unobserved_bodies_j_ = 0.0;
    placed_ = true;
  }

  // Moves the probe towards the hand. After a lapse the target returns to the hand no faster than contacts can follow;
  // without contacts it stays.
  [[nodiscard]] status move_probe(double dt_s, bool accepted, const rate_verdict& rates) noexcept {
    const pose wanted_T_wc = accepted ? handle_.T_wc() : motion_.target();
    const double part = rates_.part_allowed(rates, motion_.way_to(wanted_T_wc), dt_s);
    const double before_j = motion_.probe().energy().from_bodies_j;
    const status s = motion_.move(dt_s, wanted_T_wc, part, shared_->contacts.front(), bodies_.ways(),
                                  accepted ? handle_.velocity_of(wanted_T_wc) : std::nullopt);
    unobserved_bodies_j_ += motion_.probe().energy().from_bodies_j - before_j;
    return s;
  }

  // What a first touch rings with, as much of it as the hand has of the probe.
  void ring(double dt_s, bool felt) noexcept {
    if (!transient_.used()) return;
    const quat r_dw = glm::conjugate(settings_.map.T_wd.rotation);
    const double scale = settings_.map.scale;
    const vec3 push_d = r_dw * (scale * motion_.touched().on_probe_w.force);
    const vec3 velocity_d = r_dw * ((1.0 / scale) * motion_.probe().state().velocity_w.linear);
    ringing_d_ = transient_.play(push_d, velocity_d, dt_s, felt ? handle_.clutch().ratio() : 0.0);
  }

  void follow_bodies(std::int64_t now_ns) noexcept {
    if (shared_->bodies.refresh()) bodies_.take(shared_->bodies.front(), now_ns);
    bodies_.advance(now_ns);
  }

  [[nodiscard]] wrench wrench_on_hand() const noexcept {
    wrench out = handle_.clutch().to_device(motion_.on_hand_w(), motion_.target().position);
    if (transient_.used()) out.force += ringing_d_;
    return out;
  }

  void report(std::int64_t now_ns, sample_verdict verdict, status probe_status, const guard_action& guarded,
              const rate_verdict& rates, const wrench& sent) noexcept {
    const linear_contact& contact = shared_->contacts.front();
    session_record r;
    r.time_ns = now_ns;
    handle_.tell(r);
    r.T_wa_target = motion_.target() * T_ca_;
    r.T_wa = motion_.probe().state().T_wc * T_ca_;
    r.on_hand_d = sent;
    r.on_probe_w = motion_.touched().on_probe_w;
    r.max_depth_m = contact.max_depth_m;
    r.contacts = contact.contacts;
    r.planes = static_cast<std::uint32_t>(contact.planes.size());
    r.unbalanced_n = motion_.pressed().residual_n;
    r.overlap_m = motion_.pressed().deepest_m;
    const bool failed = !contact.planes.empty() && probe_status == status::not_finite;
    r.flags = contact.flags | motion_.flags(failed);
    if (bodies_.is_lost() || bodies_.refused() || bodies_.gone()) r.flags |= tick_flag::body_lost;
    r.contact_age_ns = std::max<std::int64_t>(0, contact_age_ns(now_ns));
    r.delivered_j = guard_.delivered_j();
    r.surplus_j = guard_.surplus_j();
    r.raised_j = raised_j_;
    r.transient_j = transient_.given_j();
    r.first_touches = transient_.touches();
    r.weight_share = weight_.share();
    r.from_bodies_j = motion_.probe().energy().from_bodies_j;
    r.guard_alpha_per_s = guarded.alpha_per_s;
    r.guard_scale = guarded.scale;
    r.rate_scale = rates.scale;
    r.pulling = motion_.touched().pulling;
    r.sample = verdict;
    r.contact_status = contact.answer;
    r.probe_status = probe_status;
    r.device = device_->state();
    r.fault = gate_.fault();
    observer_(r);
  }

  [[nodiscard]] status answer(sample_verdict verdict, status probe_status) const noexcept {
    if (gate_.fault() != gate_fault::none) return status::gate_shut;
    if (verdict != sample_verdict::accepted) return status::stale_input;
    return probe_status;
  }

  Device* device_;
  control_settings settings_;
  pose T_ca_;
  exchange* shared_;
  Observer observer_;
  sample_check check_;
  loop_clock clock_;
  heartbeat_watch application_;
  followed_handle handle_;
  probe_motion motion_;
  body_follower bodies_;
  contact_transient transient_;
  vec3 ringing_d_{0.0};
  passivity_guard guard_;
  handle_weight weight_;
  rate_monitor rates_;
  output_gate gate_;
  bool goes_silent_;  // the device puts out nothing once a command has expired

  bool placed_ = false;
  std::int64_t placed_ns_ = 0;
  double unobserved_s_ = 0.0;                                               // time since the guard saw a pose ...
  wrench wanted_{};                                                         // what went into the gate last
  double raised_j_ = 0.0;                                                   // work of the handle's weight
  double unobserved_bodies_j_ = 0.0;                                        // ... and what bodies gave in it
  std::int64_t valid_until_ns_ = std::numeric_limits<std::int64_t>::max();  // of the last command
  std::uint64_t sequence_ = 0;
};

}  // namespace asperity
