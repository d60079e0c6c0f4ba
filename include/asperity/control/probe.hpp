// The virtual tool: a small rigid body between the virtual coupling and the contact, stepped implicitly.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "asperity/control/carried_contact.hpp"
#include "asperity/control/contact_solver.hpp"
#include "asperity/control/friction.hpp"
#include "asperity/control/linear_contact.hpp"
#include "asperity/control/virtual_coupling.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/core/status.hpp"
#include "asperity/model/mass_properties.hpp"
#include "asperity/render/support_plane.hpp"

namespace asperity {

/// Mass properties of the virtual tool. A light tool transmits texture: at 100 Hz and 2 N/mm, 5 g pass 97 %, 50 g 11 %.
struct probe_settings {
  double mass_kg = 0.01;
  mat3 inertia_kg_m2{1e-5};  ///< about the centre of mass, body axes; symmetric positive definite
};

/// A virtual tool of this mass with the shape of a model: the inertia of a body of uniform density.
[[nodiscard]] inline probe_settings solid_probe(const mass_properties& shape, double mass_kg = 0.01) noexcept {
  return {mass_kg, mass_kg * shape.inertia_per_mass};
}

/// The virtual tool that a hand feels as it would feel this one without a scale: what it moves m by counts scale^2 m on
/// the device. Rotations are not scaled, so the inertia stays.
/// @param scale workspace_map::scale, > 0
[[nodiscard]] inline probe_settings felt_alike(probe_settings p, double scale) noexcept {
  p.mass_kg /= scale * scale;
  return p;
}

/// Motion of the probe's centre-of-mass frame c (origin c_A, body axes).
struct probe_state {
  pose T_wc{};
  twist velocity_w{};  ///< of c_A, world axes
};

/// Where the probe may go: as far as `known` from T_wc. Unlimited by default.
struct known_region {
  pose T_wc{};
  known_motion known{};
};

/// Where the energy of the probe went since reset(), J. Work is of the wrench at the end of a step, as the step uses
/// it. The five works minus numerical_j are the kinetic energy gained: to rounding where the inertia is a ball's,
/// otherwise up to the gyroscopic torque that the step leaves out. Bodies at rest give nothing: then contact and
/// friction only take, but for what their springs give back.
struct probe_energy {
  double by_coupling_j = 0.0;  ///< work that the coupling did on the probe
  double by_contact_j = 0.0;   ///< work that the contact did on the probe
  double by_friction_j = 0.0;  ///< work that friction did on the probe; minus what friction_energy stores and lost
  double by_external_j = 0.0;  ///< work that the external wrench did on the probe
  double from_bodies_j = 0.0;  ///< of by_contact_j and by_friction_j, what moving bodies gave
  double by_border_j = 0.0;    ///< work that the border of the known region did on the probe: 0 or less
  double numerical_j = 0.0;  ///< energy that the implicit step took out: the work done minus the kinetic energy gained
};

/// Rigid body under coupling, contact and an external wrench.
///
/// One implicit Euler step of length h against a linear contact solves
///   (M/h + B + h (K - J)) dv = f_coupling + W_contact + f_ext + h (J - K) v
/// with K, B of the coupling and J of the contact. M, K, B are positive and J is negative semidefinite, so the matrix
/// is positive definite and the step is stable for any stiffness. Against support planes J is zero and W_contact is
/// the push of the planes at the end of the step (solve_contact), which is stable for any stiffness as well.
///
/// A step that leaves the known region ends at its border: on the way from where the probe is to that point of the
/// border which lies between the step's end and the region's centre. Planes that hold at all three hold there. It goes
/// that way as far as the border, which stands still, need not push the probe on; so the border takes energy and gives
/// none. A probe that is outside, because a newer contact knows less of where it went, is not pulled back.
/// The gyroscopic torque, which would break the symmetry, is left out: for a 10 g tool at a hand's 10 rad/s it is about
/// 1 mN m.
/// @source science, section 4
class probe {
 public:
  explicit probe(const probe_settings& settings = {}) noexcept : settings_(settings) {}

  /// Puts the probe there, at rest.
  void reset(const pose& T_wc) noexcept {
    state_ = {T_wc, {}};
    energy_ = {};
  }

  /// Advances by h_s seconds towards the target. The contact is evaluated at the pose before the step.
  /// @return ok | not_finite (also a speed that no tool has; the probe is left at rest where it was)
  /// @rt safe: fixed cost
  [[nodiscard]] status step(double h_s, const virtual_coupling& coupling, const pose& target_T_wc,
                            const twist& target_velocity_w, const contact_evaluation& contact,
                            const wrench& external_w = {}, const known_region& within = {}) noexcept {
    const vec6 v = to_vec6(state_.velocity_w);
    const vec6 coupled = to_vec6(coupling.on_probe(target_T_wc, target_velocity_w, state_.T_wc, state_.velocity_w));
    const vec6 touched = to_vec6(contact.on_probe_w);
    const mat6 inertia = inertia_w();

    mat6 a = (1.0 / h_s) * inertia - h_s * contact.stiffness;
    const vec6 stretch_rate = add_coupling(h_s, coupling, v, a);
    const vec6 load = coupled + touched + to_vec6(external_w) + h_s * (contact.stiffness * v) - stretch_rate;

    vec6 dv;
    if (!solve(a, load, dv) || !plausible(v + dv)) return stop();
    const vec6 now = keep_within(within, h_s, a, v + dv);
    book(h_s, coupling, inertia, v, now, coupled, touched + h_s * (contact.stiffness * now));
    energy_.by_external_j += h_s * dot(to_vec6(external_w), now);
    move(h_s, now);
    return status::ok;
  }

  /// The same against support planes, as they were reported at within.T_wc.
  /// @param rubbing of the probe on what the planes stand for, from step to step
  /// @param carried velocities of the moving bodies, whose planes know how fast they close
  /// @param out which planes pushed, and how hard
  /// @return ok | not_finite (as above). A solver that ran out of passes is ok and tells its residual.
  /// @pre check(laws.usual)   @rt safe: at most laws.usual.most_passes passes of each solution that friction takes
  [[nodiscard]] status step_on_planes(double h_s, const virtual_coupling& coupling, const pose& target_T_wc,
                                      const twist& target_velocity_w, const support_planes& planes,
                                      const known_region& within, const contact_laws& laws, friction& rubbing,
                                      contact_solution& out, const wrench& external_w = {},
                                      std::span<const body_velocity> carried = {}) noexcept {
    const vec6 v = to_vec6(state_.velocity_w);
    const vec6 coupled = to_vec6(coupling.on_probe(target_T_wc, target_velocity_w, state_.T_wc, state_.velocity_w));
    const mat6 inertia = inertia_w();

    mat6 a = (1.0 / h_s) * inertia;
    const vec6 stretch_rate = add_coupling(h_s, coupling, v, a);
    const vec6 load = coupled + to_vec6(external_w) - stretch_rate;
    out = rubbing.solve(a, load, v, h_s, planes, pose_difference(state_.T_wc, within.T_wc), laws, carried);
    if (!out.solved || !is_finite(out.on_probe_w) || !plausible(out.velocity)) {
      out = {};
      rubbing.forget();
      return stop();
    }
    out.velocity = keep_within(within, h_s, a, out.velocity);
    const double given_before_j = rubbing.energy().from_bodies_j;
    rubbing.settle(h_s, out.velocity);
    energy_.from_bodies_j += h_s * out.from_bodies_w + rubbing.energy().from_bodies_j - given_before_j;
    book(h_s, coupling, inertia, v, out.velocity, coupled, to_vec6(out.on_probe_w));
    energy_.by_friction_j += h_s * dot(to_vec6(rubbing.on_probe_w()), out.velocity);
    energy_.by_external_j += h_s * dot(to_vec6(external_w), out.velocity);
    move(h_s, out.velocity);
    return status::ok;
  }

  [[nodiscard]] const probe_state& state() const noexcept { return state_; }
  [[nodiscard]] const probe_energy& energy() const noexcept { return energy_; }
  [[nodiscard]] const probe_settings& settings() const noexcept { return settings_; }
  /// Kinetic energy, J.
  [[nodiscard]] double kinetic_j() const noexcept {
    const vec6 v = to_vec6(state_.velocity_w);
    return 0.5 * dot(v, inertia_w() * v);
  }

 private:
  // Finite is not enough: a load of 1e300 N gives a finite velocity and a position that means nothing. NaN fails too.
  [[nodiscard]] static bool plausible(const vec6& v) noexcept {
    constexpr double fastest_m_per_s = 1e3;
    constexpr double fastest_rad_per_s = 1e5;
    return glm::dot(v.linear, v.linear) <= fastest_m_per_s * fastest_m_per_s &&
           glm::dot(v.angular, v.angular) <= fastest_rad_per_s * fastest_rad_per_s;
  }

  [[nodiscard]] mat6 inertia_w() const noexcept {
    const mat3 r = glm::mat3_cast(state_.T_wc.rotation);
    mat6 out;
    set_block(out, 0, 0, mat3(settings_.mass_kg));
    set_block(out, 3, 3, r * settings_.inertia_kg_m2 * glm::transpose(r));
    return out;
  }

  // The coupling's part of the step's matrix. @return h K v, what the springs lose while the probe moves at its old
  // speed
  [[nodiscard]] static vec6 add_coupling(double h_s, const virtual_coupling& coupling, const vec6& v,
                                         mat6& a) noexcept {
    vec6 stretch_rate;
    for (std::size_t i = 0; i < 6; ++i) {
      const double k = i < 3 ? coupling.stiffness_n_per_m() : coupling.stiffness_n_m_per_rad();
      const double b = i < 3 ? coupling.damping_n_s_per_m() : coupling.damping_n_m_s_per_rad();
      a(i, i) += b + h_s * k;
      stretch_rate[i] = h_s * k * v[i];
    }
    return stretch_rate;
  }

  [[nodiscard]] status stop() noexcept {
    state_.velocity_w = {};
    return status::not_finite;
  }

  [[nodiscard]] static pose moved(const pose& T_wc, const vec6& by) noexcept {
    return {glm::normalize(exp_rotation(by.angular) * T_wc.rotation), T_wc.position + by.linear};
  }

  void move(double h_s, const vec6& now) noexcept {
    state_.velocity_w = to_twist(now);
    state_.T_wc = moved(state_.T_wc, h_s * now);
  }

  // The velocity that does not leave what is known; the step's own, to the bit, where that does not.
  // The border's wrench is a (out - now). Its power is 0 or less as long as out is no further along the way to the
  // border than the point that is nearest to the step's end in the metric of the step's matrix a.
  [[nodiscard]] vec6 keep_within(const known_region& within, double h_s, const mat6& a, const vec6& now) noexcept {
    if (!within.known.is_limited()) return now;
    const vec6 far = pose_difference(moved(state_.T_wc, h_s * now), within.T_wc);
    const double share = within.known.share(far);
    if (!(share > 1.0)) return now;
    const vec6 way = pose_difference(moved(within.T_wc, (1.0 / share) * far), state_.T_wc);
    const double longest = dot(way, a * way);
    const double part = longest > 0.0 ? std::clamp(h_s * dot(way, a * now) / longest, 0.0, 1.0) : 0.0;
    const vec6 out = (part / h_s) * way;
    energy_.by_border_j += h_s * dot(out, a * (out - now));
    return out;
  }

  // The wrenches at the end of the step are the ones that the implicit equation balances: with them the book closes.
  void book(double h_s, const virtual_coupling& coupling, const mat6& inertia, const vec6& before, const vec6& after,
            const vec6& coupled, const vec6& touched_end) noexcept {
    vec6 coupled_end = coupled;
    for (std::size_t i = 0; i < 6; ++i) {
      const double k = i < 3 ? coupling.stiffness_n_per_m() : coupling.stiffness_n_m_per_rad();
      const double b = i < 3 ? coupling.damping_n_s_per_m() : coupling.damping_n_m_s_per_rad();
      coupled_end[i] -= b * (after[i] - before[i]) + h_s * k * after[i];
    }
    energy_.by_coupling_j += h_s * dot(coupled_end, after);
    energy_.by_contact_j += h_s * dot(touched_end, after);
    const vec6 dv = after - before;
    energy_.numerical_j += 0.5 * dot(dv, inertia * dv);
  }

  probe_settings settings_;
  probe_state state_{};
  probe_energy energy_{};
};

}  // namespace asperity
