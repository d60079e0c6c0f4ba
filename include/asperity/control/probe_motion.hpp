// The probe's way through one device period: its target moves evenly, the probe follows in substeps.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "asperity/control/contact_solver.hpp"
#include "asperity/control/friction.hpp"
#include "asperity/control/linear_contact.hpp"
#include "asperity/control/probe.hpp"
#include "asperity/control/virtual_coupling.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/core/status.hpp"

namespace asperity {

/// Probe and virtual coupling behind one handle.
///
/// A contact with support planes is solved for in every substep; one without is the linear wrench, evaluated at the
/// probe's pose in every substep. A step of the target at the beginning of the period would be felt as a jerk by a
/// probe that runs at several times the device's rate, so the target goes evenly from its last pose to the newest one.
/// The probe goes no further than the contact knows (linear_contact::known), planes or not: there it waits for the next
/// contact, and the coupling pulls at the hand by what it lags behind.
/// @rt safe: no allocation, lock, throw, print or clock
class probe_motion {
 public:
  /// @param substeps of the probe in one period; at least one is made
  /// @param rubbing on support planes; a contact without planes has no friction
  /// @pre check(laws.usual), check(rubbing)
  probe_motion(const probe_settings& body, const coupling_settings& coupling, contact_laws laws, int substeps,
               const friction_settings& rubbing = {}) noexcept
      : laws_(std::move(laws)),
        substeps_(std::max(1, substeps)),
        coupling_(coupling, body.mass_kg, mean_inertia(body)),
        probe_(body),
        friction_(rubbing) {}

  /// Puts probe and target there, at rest.
  void place(const pose& target_T_wc) noexcept {
    target_T_wc_ = target_T_wc;
    target_velocity_w_ = {};
    recent_.fill({});
    probe_.reset(target_T_wc);
    friction_.reset();
    caught_up_ = true;
  }

  /// What the last contact did to the probe is forgotten; where the probe is, is not.
  void forget_contact() noexcept {
    touched_ = {};
    pressed_ = {};
    friction_.forget();
  }

  /// From the present target to another pose: translation (m) and rotation vector (rad), world axes.
  [[nodiscard]] vec6 way_to(const pose& T_wc) const noexcept { return pose_difference(T_wc, target_T_wc_); }

  /// One period of dt_s seconds, at whose end the target has gone `part` of its way to wanted_T_wc.
  /// @param part 1: all of it, to the bit
  /// @return ok | not_finite (the probe is left at rest where it was)
  [[nodiscard]] status move(double dt_s, const pose& wanted_T_wc, double part, const linear_contact& contact) noexcept {
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
    for (int i = 1; i <= substeps_; ++i) {
      const double passed = static_cast<double>(i) / substeps_;
      const pose target{exp_rotation(passed * way.angular) * from.rotation, from.position + passed * way.linear};
      if (const status s = substep(dt_s / substeps_, target, contact); s != status::ok) return s;
    }
    return status::ok;
  }

  /// What a contact pushes with at the probe's pose, as far as the coupling will come to feel it: the linear wrench, or
  /// the wrench with which the coupling holds a resting probe that the planes have pushed out.
  [[nodiscard]] wrench push_of(const linear_contact& contact) const noexcept {
    if (contact.planes.empty()) return evaluate(contact, probe_.state().T_wc).on_probe_w;
    mat6 springs;
    for (std::size_t i = 0; i < 6; ++i) {
      springs(i, i) = i < 3 ? coupling_.stiffness_n_per_m() : coupling_.stiffness_n_m_per_rad();
    }
    const vec6 moved = pose_difference(probe_.state().T_wc, contact.T_wc);
    return balance_of(springs, {}, contact.planes, moved, laws_).on_probe_w;
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

  [[nodiscard]] status substep(double h_s, const pose& target, const linear_contact& contact) noexcept {
    if (contact.planes.empty()) {
      friction_.forget();
      const status s =
          probe_.step(h_s, coupling_, target, target_velocity_w_, touched_, {}, {contact.T_wc, contact.known});
      touched_ = evaluate(contact, probe_.state().T_wc);
      return s;
    }
    const status s = probe_.step_on_planes(h_s, coupling_, target, target_velocity_w_, contact.planes,
                                           {contact.T_wc, contact.known}, laws_, friction_, pressed_);
    touched_ = {pressed_.on_probe_w + friction_.on_probe_w(), {}, false};
    return s;
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
  pose target_T_wc_{};
  twist target_velocity_w_{};
  std::array<stretch, most_recent> recent_{};  // the newest first
  bool caught_up_ = true;
  contact_evaluation touched_{};
  contact_solution pressed_{};
};

}  // namespace asperity
