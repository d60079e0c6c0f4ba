// The probe's way through one device period: its target moves evenly, the probe follows in substeps.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "asperity/control/carried_contact.hpp"
#include "asperity/control/contact_solver.hpp"
#include "asperity/control/friction.hpp"
#include "asperity/control/linear_contact.hpp"
#include "asperity/control/moving_bodies.hpp"
#include "asperity/control/probe.hpp"
#include "asperity/control/virtual_coupling.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/core/status.hpp"
#include "asperity/render/tick_flag.hpp"

namespace asperity {

/// Probe and virtual coupling behind one handle.
///
/// A contact with support planes is solved for in every substep; one without is the linear wrench, evaluated at the
/// probe's pose in every substep. A step of the target at the beginning of the period would be felt as a jerk by a
/// probe that runs at several times the device's rate, so the target goes evenly from its last pose to the newest one.
/// The probe goes no further than the contact knows (linear_contact::known), planes or not: there it waits for the next
/// contact, and the coupling pulls at the hand by what it lags behind.
/// Planes are read again where the probe is, as far as the contact's renderer can (local_model): all of them once in a
/// period, and those that may press in every substep. A probe that takes several substeps on one reading goes to where
/// the surface would be if it were flat, and the next reading throws it back: between the stripes of two blocks it
/// trembled so without end.
/// Planes of bodies that move go with them, evenly through the period. A linear wrench does not: it is the one of the
/// contact's time.
/// @rt safe: no allocation, lock, throw, print or clock
class probe_motion {
 public:
  /// @param substeps of the probe in one period, see substeps_in(); at least one is made
  /// @param rubbing on support planes; a contact without planes has no friction
  /// @param reads_again whether planes are read again where the probe is, see local_model
  /// @pre check(laws.usual), check(rubbing)
  probe_motion(const probe_settings& body, const coupling_settings& coupling, contact_laws laws, int substeps,
               const friction_settings& rubbing = {}, bool reads_again = true) noexcept
      : laws_(std::move(laws)),
        substeps_(std::max(1, substeps)),
        coupling_(coupling, body.mass_kg, mean_inertia(body)),
        probe_(body),
        friction_(rubbing),
        local_(reads_again) {}

  /// Puts probe and target there, at rest.
  void place(const pose& target_T_wc) noexcept {
    target_T_wc_ = target_T_wc;
    target_velocity_w_ = {};
    recent_.fill({});
    probe_.reset(target_T_wc);
    friction_.reset();
    caught_up_ = true;
  }

  /// Puts the target there, with no way that the probe would be drawn along: what the coupling had stored is lost.
  void put_target(const pose& target_T_wc) noexcept { target_T_wc_ = target_T_wc; }

  /// What the last contact did to the probe is forgotten; where the probe is, is not.
  void forget_contact() noexcept {
    touched_ = {};
    pressed_ = {};
    friction_.forget();
  }

  /// Another contact comes into use. To be told of each before it is felt.
  void take_contact() noexcept { local_.take_contact(); }

  /// A contact of another scene comes: the probe rubs anew on the bodies that were not where they are.
  /// @param before version of the contact that was in use   @param now comes into use
  void take_scene(std::uint64_t before, const linear_contact& now) noexcept {
    for (const contact_body& b : now.of) {
      if (b.since > before) friction_.forget(b.body);
    }
  }
  /// The laws of what a contact of a changing scene has planes of. To be told of each before it is felt.
  void take_laws(const linear_contact& now) noexcept { laws_.put({now.of.data(), now.of.size()}); }

  /// From the present target to another pose: translation (m) and rotation vector (rad), world axes.
  [[nodiscard]] vec6 way_to(const pose& T_wc) const noexcept { return pose_difference(T_wc, target_T_wc_); }

  /// One period of dt_s seconds, at whose end the target has gone `part` of its way to wanted_T_wc.
  /// @param part 1: all of it, to the bit
  /// @param ways of the moving bodies in this period
  /// @param velocity_w of the target at the period's end, where it is known otherwise than by its way; not used while
  ///                   the target is on its way to the handle (part < 1)
  /// @return ok | not_finite (the probe is left at rest where it was)
  [[nodiscard]] status move(double dt_s, const pose& wanted_T_wc, double part, const linear_contact& contact,
                            std::span<const body_way> ways = {},
                            const std::optional<twist>& velocity_w = std::nullopt) noexcept {
    const support_planes& planes = local_.planes_of(contact, ways, probe_.state().T_wc);
    const carried_contact carried(contact, planes, ways);
    felt_.list.clear();
    velocities_.clear();
    const pose from = target_T_wc_;
    vec6 way = way_to(wanted_T_wc);
    target_T_wc_ = wanted_T_wc;
    caught_up_ = !(part < 1.0);
    if (!caught_up_) {
      way = part * way;
      target_T_wc_ = {glm::normalize(exp_rotation(way.angular) * from.rotation), from.position + way.linear};
    }
    if (contact.planes.empty()) {
      touched_ = evaluate(contact, probe_.state().T_wc);
      pressed_ = {};
    }
    if (!(dt_s > 0.0)) return status::ok;

    target_velocity_w_ = velocity_over(way, dt_s);
    if (velocity_w && caught_up_) target_velocity_w_ = *velocity_w;
    const int substeps = substeps_in(dt_s);
    const double h_s = dt_s / substeps;
    for (int i = 1; i <= substeps; ++i) {
      const double passed = static_cast<double>(i) / substeps;
      const double begun = static_cast<double>(i - 1) / substeps;
      if (i > 1) local_.follow(contact, ways, probe_.state().T_wc, begun);
      const pose target{exp_rotation(passed * way.angular) * from.rotation, from.position + passed * way.linear};
      if (const status s = substep(h_s, dt_s, target, contact, planes, carried, begun); s != status::ok) return s;
    }
    local_.pass(dt_s);
    felt_.point_w = probe_.state().T_wc.position;
    body_share_ = carried.moves() ? carried.body_share(probe_.state().T_wc, 1.0) : 0.0;
    return status::ok;
  }

  /// What a contact pushes with at the probe's pose, as far as the coupling will come to feel it: the linear wrench, or
  /// the wrench with which the coupling holds a resting probe that the planes have pushed out.
  /// @param ways of the moving bodies in the next period: the planes are taken where it begins, and read again there
  [[nodiscard]] wrench push_of(const linear_contact& contact, std::span<const body_way> ways = {}) noexcept {
    if (contact.planes.empty()) return evaluate(contact, probe_.state().T_wc).on_probe_w;
    mat6 springs;
    for (std::size_t i = 0; i < 6; ++i) {
      springs(i, i) = i < 3 ? coupling_.stiffness_n_per_m() : coupling_.stiffness_n_m_per_rad();
    }
    const vec6 moved = pose_difference(probe_.state().T_wc, contact.T_wc);
    const support_planes& read = local_.planes_of(contact, ways, probe_.state().T_wc);
    const carried_contact carried(contact, read, ways);
    if (!carried.moves()) return balance_of(springs, {}, read, moved, laws_).on_probe_w;
    support_planes planes;
    body_velocities none;
    carried.at(probe_.state().T_wc, 0.0, 0.0, planes, none);
    return balance_of(springs, {}, planes, moved, laws_).on_probe_w;
  }

  /// What the hand feels of the coupling: minus its wrench on the probe, world axes, about target().position.
  [[nodiscard]] wrench on_hand_w() const noexcept {
    const probe_state& p = probe_.state();
    return -1.0 * coupling_.on_probe(target_T_wc_, target_velocity_w_, p.T_wc, p.velocity_w);
  }

  /// What the coupling's springs do to the probe where it is, less what friction holds.
  [[nodiscard]] coupling_pull pull() const noexcept {
    coupling_pull out = coupling_.pull(target_T_wc_, probe_.state().T_wc);
    out.on_probe_w += friction_.on_probe_w();
    return out;
  }

  /// Where the handle wants the probe's centre-of-mass frame, as far as the target has come.
  [[nodiscard]] const pose& target() const noexcept { return target_T_wc_; }
  /// Whether the target is where the handle is.
  [[nodiscard]] bool caught_up() const noexcept { return caught_up_; }
  /// Contact wrench on the probe at the end of the last period; against planes, that of its last substep.
  [[nodiscard]] const contact_evaluation& touched() const noexcept { return touched_; }
  /// The solution of the last substep; empty where the last contact had no planes.
  [[nodiscard]] const contact_solution& pressed() const noexcept { return pressed_; }
  /// What rubs, and its energy.
  [[nodiscard]] const friction& rubbing() const noexcept { return friction_; }
  /// What the planes did not answer in the last substep. @param failed it found no solution on planes
  [[nodiscard]] tick_flag flags(bool failed) const noexcept {
    tick_flag out = tick_flag::none;
    if (pressed_.deepest_m > deepest_held_m) out |= tick_flag::not_held;
    if (failed || pressed_.residual_n > most_unbalanced_n) out |= tick_flag::unbalanced;
    if (friction_.leaves_out()) out |= tick_flag::friction_left_out;
    return out;
  }
  /// What bodies felt in the last period, where the contact had planes; the time is the caller's.
  [[nodiscard]] const felt_bodies& felt() const noexcept { return felt_; }
  /// Of what the contact knows, the largest share that a body had used up by its own motion at the period's end.
  [[nodiscard]] double body_share() const noexcept { return body_share_; }
  [[nodiscard]] const asperity::probe& probe() const noexcept { return probe_; }
  [[nodiscard]] const virtual_coupling& coupling() const noexcept { return coupling_; }

 private:
  [[nodiscard]] static double mean_inertia(const probe_settings& p) noexcept {
    return (p.inertia_kg_m2[0][0] + p.inertia_kg_m2[1][1] + p.inertia_kg_m2[2][2]) / 3.0;
  }

  // The target's velocity, over this period and as many before it as make a millisecond: one, at 1 kHz. An encoder's
  // step of 1 um in a period of 0.25 ms would be a velocity of 4 mm/s, which is 18 mN through the coupling's damper.
  [[nodiscard]] twist velocity_over(const vec6& way, double dt_s) noexcept {
    constexpr double shortest_s = 1e-3 * (1.0 - 1e-9);
    std::rotate(recent_.begin(), recent_.end() - 1, recent_.end());
    recent_.front() = {way, dt_s};
    vec6 sum;
    double time_s = 0.0;
    for (const stretch& s : recent_) {
      if (time_s >= shortest_s || !(s.time_s > 0.0)) break;
      sum += s.way;
      time_s += s.time_s;
    }
    return to_twist((1.0 / time_s) * sum);
  }

  // As many substeps as were asked for in a period of a millisecond or longer, and none shorter than these in a shorter
  // period: they cost as much as a long one.
  [[nodiscard]] int substeps_in(double dt_s) const noexcept {
    constexpr double full_s = 1e-3;
    return dt_s < full_s ? std::max(1, static_cast<int>(std::lround(substeps_ * (dt_s / full_s)))) : substeps_;
  }

  // One of the substeps of h_s that a period of dt_s has.
  [[nodiscard]] status substep(double h_s, double dt_s, const pose& target, const linear_contact& contact,
                               const support_planes& read, const carried_contact& carried, double begun) noexcept {
    if (contact.planes.empty()) {
      friction_.forget();
      const status s =
          probe_.step(h_s, coupling_, target, target_velocity_w_, touched_, {}, {contact.T_wc, contact.known});
      touched_ = evaluate(contact, probe_.state().T_wc);
      return s;
    }
    const support_planes* planes = &read;
    known_region within{contact.T_wc, contact.known};
    if (carried.moves()) {
      carried.at(probe_.state().T_wc, begun, dt_s, carried_, velocities_);
      planes = &carried_;
      within.known = carried.known(probe_.state().T_wc, begun);
    }
    const status s = probe_.step_on_planes(h_s, coupling_, target, target_velocity_w_, *planes, within, laws_,
                                           friction_, pressed_, {}, velocities_);
    touched_ = {pressed_.on_probe_w + friction_.on_probe_w(), {}, false};
    feel(*planes, h_s / dt_s);
    return s;
  }

  // Adds what bodies feel in a substep. @param share of the period that it takes
  void feel(const support_planes& planes, double share) noexcept {
    for (std::size_t i = 0; i < planes.size(); ++i) {
      if (pressed_.lambda_n[i] > 0.0) {
        felt_.add(planes[i].body, to_wrench(share * pressed_.lambda_n[i] * planes[i].gradient));
      }
    }
    friction_.for_each_body(
        [&](std::uint32_t body, const wrench& on_probe_w) noexcept { felt_.add(body, -share * on_probe_w); });
  }

  /// What the target did in one period.
  struct stretch {
    vec6 way{};
    double time_s = 0.0;
  };
  static constexpr std::size_t most_recent = 10;  // of 10 kHz

  contact_laws laws_;
  int substeps_;
  virtual_coupling coupling_;
  asperity::probe probe_;
  friction friction_;
  local_model local_;
  pose target_T_wc_{};
  twist target_velocity_w_{};
  std::array<stretch, most_recent> recent_{};  // the newest first
  bool caught_up_ = true;
  contact_evaluation touched_{};
  contact_solution pressed_{};
  support_planes carried_{};      // of the substep, where bodies move
  body_velocities velocities_{};  // of the same
  felt_bodies felt_{};
  double body_share_ = 0.0;
};

}  // namespace asperity
