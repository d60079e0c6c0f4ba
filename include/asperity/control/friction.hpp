// Dry friction between the probe and what it presses on: one bristle for each body.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "asperity/control/carried_contact.hpp"
#include "asperity/control/contact_solver.hpp"
#include "asperity/control/linear_contact.hpp"
#include "asperity/core/export.hpp"
#include "asperity/core/fixed_vector.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/core/status.hpp"

namespace asperity {

/// How the probe rubs on a body. The coefficients are of bodies whose surface_pair is not known; the rest of all.
struct friction_settings {
  double static_coefficient = 0.0;   ///< of a contact that does not slip: largest tangential per normal force
  double dynamic_coefficient = 0.0;  ///< of one that slips fast; at most the static one. Both 0: no friction
  /// A slip of this speed has lost 63 % of the difference between the two (Stribeck), m/s.
  double stribeck_m_per_s = 0.01;
  /// Of a contact that sticks, along the surface, N/m: a force of 1 N moves it by 20 um.
  double stiffness_n_per_m = 5e4;
  /// Of the same: what sticks is damped by this times its stiffness, s. Without it the probe shook on its feet, because
  /// a bristle follows the forces of its points, and they the tilt that it causes.
  double damping_s = 1e-3;

  [[nodiscard]] bool any() const noexcept { return static_coefficient > 0.0; }
};

/// Says which setting is out of range and what would do.
[[nodiscard]] ASPERITY_API result<void> check(const friction_settings& s);

/// Where the energy of friction went since reset(), J.
struct friction_energy {
  double stored_j = 0.0;       ///< in the bristles now
  double lost_j = 0.0;         ///< to heat; never less than a step before
  double from_bodies_j = 0.0;  ///< that moving bodies gave
};

/// Contact with friction, step by step. The renderer's planes say which samples press and how hard; what has slipped is
/// known here and nowhere else.
///
/// Each body has one bristle: a rigid displacement z (6 numbers) of the probe against the body, which a spring of
/// stiffness k resists. The stretch is measured in the metric
///   D = sum (lambda_i / N) T_i^T T_i,   T_i = [P_i, -P_i [r_i]x],   P_i = 1 - n_i n_i^T,
/// so z^T D z is the mean square stretch along the surface of the points that press, weighted by their forces lambda_i,
/// N being their sum. Several points resist a turn about their normal by how far apart they are; one alone does not.
/// A step of length h with the velocity v at its end makes of it
///   y = z + h v,   f = -k theta D (y + t v),   z' = theta y,   theta = min(1, mu N / (k |y + t v|)),
/// t being the damping and |x|^2 = x^T D x. It loses
///   k (|z - theta y|^2 / 2 + theta (1 - theta) |y|^2 + theta t h |v|^2),
/// which is not negative for any theta from 0 to 1: friction makes no energy, however well the passes that find theta
/// and D have converged. On a body with a map of materials mu is the mean of what the pressed points have, weighted by
/// their forces; it may change from step to step, because no theta makes energy. Where other points press than before and the new metric would raise what is stored, z is made
/// shorter. On a moving body v is the probe's velocity less that of the body: the loss is the same, and f does work on the
/// body, which it gives.
/// @source bristles: Canudas de Wit et al., A new model for control of systems with friction, 1995; one cone for all
/// points of a body by the root of a mean square is ours
class ASPERITY_API friction {
 public:
  /// Bodies that can be rubbed on at the same time; further ones are pressed without friction, and leaves_out() tells.
  static constexpr std::size_t most_bodies = 8;

  /// @pre check(settings)
  explicit friction(const friction_settings& settings = {}) noexcept : settings_(settings) {}

  /// Lets go of all bodies; what the bristles hold is lost.
  void forget() noexcept;
  /// Lets go of one body: it has been taken away, or another one is in its place. @rt safe
  void forget(std::uint32_t body) noexcept;
  /// The same of all, and the energy book begins anew.
  void reset() noexcept {
    forget();
    energy_ = {};
  }

  /// solve_contact() with friction: velocity and forces at the end of a step of length h_s. Its on_probe_w is of the
  /// planes alone. The step is not over before settle().
  /// @param a friction's part is added to it, so that A (v - v0) goes on being what acts
  /// @pre as solve_contact   @rt safe: at most five solutions
  /// @param carried velocities of the moving bodies about c_A
  [[nodiscard]] contact_solution solve(mat6& a, const vec6& load, const vec6& v0, double h_s,
                                       const support_planes& planes, const vec6& moved, const contact_laws& laws,
                                       std::span<const body_velocity> carried = {}) noexcept;

  /// Ends the step that was solved, with the velocity that it really had: what else stops a probe may have made it
  /// another one than the solution's. Friction makes no energy with any. @rt safe
  void settle(double h_s, const vec6& v) noexcept;

  /// Of the last step, about c_A, world axes.
  [[nodiscard]] const wrench& on_probe_w() const noexcept { return on_probe_w_; }
  /// Calls visit(body, wrench on the probe) for the bodies that were rubbed on in the last step. @rt safe
  template <class Visit>
  void for_each_body(Visit&& visit) const noexcept {
    for (const bristle& b : bristles_) visit(b.body, b.on_probe_w);
  }
  /// Whether a body was slipped on in the last step.
  [[nodiscard]] bool slips() const noexcept { return slips_; }
  /// Whether a body was pressed without friction in the last step, because most_bodies others were rubbed on.
  [[nodiscard]] bool leaves_out() const noexcept { return leaves_out_; }
  [[nodiscard]] const friction_energy& energy() const noexcept { return energy_; }
  [[nodiscard]] const friction_settings& settings() const noexcept { return settings_; }

 private:
  struct bristle {
    std::uint32_t body = 0;
    double static_coefficient = 0.0, dynamic_coefficient = 0.0;
    vec6 stretch{};  // z
    double stored_j = 0.0;
    wrench on_probe_w{};
    bool on_map = false;  // pressed where a map says another material than the first: the coefficients are means
    // Of the step that is being solved.
    mat6 metric{};          // D
    vec6 held{};            // z in this metric
    double normal_n = 0.0;  // N
    double theta = 1.0;
    vec6 carried{};  // velocity of the body about c_A
  };

  // The bristles of the bodies that are pressed and have friction; new ones are at rest.
  void find_bodies(const support_planes& planes, const contact_solution& by, const contact_laws& laws,
                   std::span<const body_velocity> carried) noexcept;
  struct coefficients_of_plane {
    double at_rest, slipping;
  };
  [[nodiscard]] coefficients_of_plane coefficients(const support_plane& p, const contact_laws& laws) const noexcept;
  // The coefficients of a bristle as the mean over what is pressed.
  void take_mean(bristle& b, const support_planes& planes, const std::array<double, most_support_planes>& force_n,
                 const contact_laws& laws) const noexcept;
  // Metric, force and share of a bristle for these forces and this velocity.
  void measure(const support_planes& planes, const contact_solution& by, const vec6& v, double h_s,
               const contact_laws& laws) noexcept;

  friction_settings settings_;
  fixed_vector<bristle, most_bodies> bristles_;
  wrench on_probe_w_{};
  friction_energy energy_{};
  bool slips_ = false, leaves_out_ = false;
};

}  // namespace asperity
