// A pad held still on another one, in a notch of its ridges: what the hand gets from a contact that is late, held or
// linearised.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "asperity/control/passivity_guard.hpp"
#include "experiment.hpp"
#include "trial.hpp"

namespace asperity::experiment {

/// What the contact thread hands over of a contact.
enum class contact_line : std::uint8_t {
  held,        ///< the wrench alone
  linearised,  ///< and the stiffness of the depth's slope: J = -k g g^T
  curved,      ///< and that of its curvature: J = -k (g g^T + d C), what the library does
};

/// One renderer for many sessions, so that its preparation is paid for once.
class notch {
 public:
  /// Two pads whose ridges fit into each other, or two flat ones, felt with a variant.
  /// @return what a model or the renderer's maker says
  [[nodiscard]] static result<notch> make(workbench& bench, const variant& kind, bool flat);

  /// A renderer with this contact stiffness, which hands over that much of each contact. Wrench and stiffness matrix
  /// are proportional to the contact stiffness, so scaling both is the same as setting it.
  [[nodiscard]] any_renderer with(double stiffness_n_per_m, contact_line line) const;
  /// Whether every tick so far that was linearised without curvature had one contact only, as that needs.
  [[nodiscard]] bool was_one_contact() const noexcept { return *one_contact_; }

  [[nodiscard]] bool is_flat() const noexcept { return flat_; }

 private:
  bool flat_ = false;
  std::shared_ptr<any_renderer> inner_;
  std::shared_ptr<bool> one_contact_;
};

/// How the block is held.
struct holding {
  double stiffness_n_per_m = 2000.0;
  contact_line line = contact_line::curved;
  std::int64_t contact_period_ns = 1'000'000;
  bool late = true;  ///< one period late
  bool guard = false;
  double press_n = 1.0;
  double beside_m = 0.1e-3;  ///< where the hand brings the pad down and holds it: so far beside the notch
  double drop_m = 20e-6;     ///< from how far above the first touch the hand lets the pad down
  double settle_s = 1.0;     ///< the hand brings the block down and comes to rest
  double hold_s = 2.5;       ///< what is judged
};

/// A hand rests that gets less energy than that, and whose handle moves less than that above 20 Hz: spec, A9.
inline constexpr double quiet_j = 1e-4, trembling_m_per_s = 1e-4;

/// What the hand had of it, from the end of settling on.
struct held_still {
  double given_j = 0.0;            ///< net energy that reached the hand while it held still
  double vibration_m_per_s = 0.0;  ///< root mean square of the handle's velocity above 20 Hz
  double surplus_j = 0.0;          ///< largest, from the beginning on: see passivity_guard
  double bound_j = 0.0;            ///< what passivity_guard promises of it at the hand's largest speeds
  double guard_share = 0.0;        ///< of the ticks in which the guard acted
  bool touches = false;            ///< at the end; a tool that was thrown off or through does not
  bool shut = false;               ///< the output gate shut: energy past the cut-off
  std::vector<double> time_s, sideways_m, energy_j;  ///< of the whole session, tick by tick
};

/// A hand of 100 N/m sideways holds the upper pad a little beside the notch and presses. No limit but the
/// simulated device's peak and slew rate.
/// @return the trial's error
[[nodiscard]] result<held_still> hold_still(const notch& where, const holding& how);

/// The largest energy that the guard promises to let through: see passivity_guard.
[[nodiscard]] double guard_bound_j(double speed_m_per_s, double speed_rad_per_s) noexcept;

}  // namespace asperity::experiment
