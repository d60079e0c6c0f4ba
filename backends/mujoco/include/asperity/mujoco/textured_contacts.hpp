// Textured contact inside a MuJoCo simulation: wrenches between bodies of its model, through xfrc_applied.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/core/status.hpp"
#include "asperity/model/scene.hpp"
#include "asperity/model/textured_model.hpp"
#include "asperity/render/any_renderer.hpp"

struct mjModel_;  // mjModel and mjData of <mujoco/mujoco.h>, which a program includes itself
struct mjData_;

namespace asperity::mujoco {

/// What a name is of.
enum class object_kind : std::uint8_t { body, geom };

/// A textured model on a body of the simulation.
struct textured_object {
  model_ptr model{};
  std::string name{};  ///< of the body, or of a geom of it
  object_kind kind = object_kind::body;
  /// Where the textured model's frame is in that of the body or geom. MuJoCo moves the frame of a mesh geom to the mesh's
  /// centre and turns it; T_om of such a geom is therefore in the frame of its body: what the geom has as pos and quat in
  /// the MJCF, which is nothing in most. It is checked against the mesh's extents.
  pose T_om{};
};

/// Two objects that feel each other. Both may move, and at least one does. Each pair has a renderer of its own.
struct textured_pair {
  textured_object probe{}, fixed{};
  double stiffness_n_per_m = 2000.0;  ///< of the default renderer's contacts
  /// What touches is damped by this times its stiffness, s: a mass m on a spring k has the damping ratio
  /// damping_s sqrt(k / m) / 2.
  double damping_s = 2e-3;
  /// Another renderer of the scene; its stiffness is its own. Empty: make_renderer(), for the simulation's time step.
  std::function<result<any_renderer>(scene bodies)> make_renderer{};
};

/// What an explicit step bears. A spring k on a mass m, stepped by MuJoCo's Euler, is stable up to h^2 k / m = 4, and with a
/// damper d as long as h^2 k / m + 2 h d / m < 4.
struct step_bound {
  double stiffness = 1.0;  ///< c in k_max = c m / h^2; more is scaled down
  double damping = 0.5;    ///< in d_max = c m / h
};

/// What a pair did in the last apply().
struct pair_report {
  status answer = status::not_ready;  ///< of the renderer; other than ok and capacity_reached: the pair adds nothing
  wrench on_probe_w{};                ///< added to the probe's body: about its centre of mass (xipos), world axes
  wrench on_fixed_w{};                ///< added to the other body, about its own centre of mass
  std::uint32_t contacts = 0;         ///< that overlap
  double deepest_m = 0.0;             ///< of these
  double stiffness_n_per_m = 0.0;     ///< of the contact along its force, as the renderer tells it
  double mass_kg = 0.0;               ///< that both bodies together have against the force, their joints included
  /// h^2 times the largest eigenvalue of stiffness over inertia, of all pairs that move the same bodies, as an upper bound.
  double step_load = 0.0;
  /// What the renderer's wrench was multiplied by. Below 1 the time step does not bear the stiffness, and the contact is
  /// felt softer: a body at rest lies deeper by 1 / force_share.
  double force_share = 1.0;
  double damping_share = 1.0;  ///< the same of the damping, by its own bound and because a contact never pulls
};

/// Adds textured contact to a simulation, between mj_step1() and mj_step2():
///
///     auto made = mujoco::textured_contacts::make(*m, {{{peg, "peg"}, {plate, "plate"}}});
///     for (;;) static_cast<void>(made->step(*m, *d));          // mj_step1, apply, mj_step2, take_back
///
/// or, in a loop that has its own mj_step1() and mj_step2(), with apply() between and take_back() after them.
/// - Wrenches act at the centres of mass of both bodies. No callback of MuJoCo's is taken, as there is one per process.
/// - What others keep in xfrc_applied is not disturbed. take_back() leaves the array with the bits that it had. Where it was not
///   called, the next apply() takes back what nobody has written since; a number that somebody has written is theirs as
///   it is. So who assigns need not care; who adds to the array calls take_back() first.
/// - The force is the renderer's, which is a function of the poses; with damping, which takes energy only. There is no friction:
///   asperity's bristles belong to the implicit step of a control loop, and MuJoCo's step is explicit here.
/// - What the time step does not bear is scaled down and told; see pair_report.
/// - A mocap body counts as standing still for the damping.
/// One object serves one mjData.
/// @rt apply() and take_back(): no allocation, lock, throw, print or clock. make() builds the renderers and takes all
/// memory.
class textured_contacts {
 public:
  /// @return invalid_argument (a name unknown or of another kind, a model missing or without volume, a mesh geom that
  ///         the model does not fit, bodies that cannot move against each other or have no mass, geoms that MuJoCo would
  ///         make contacts of as well: switch_off_own_contacts(), a number out of range) | unsupported (a libmujoco
  ///         of another version than the headers) | what the renderer answers
  [[nodiscard]] static result<textured_contacts> make(const mjModel_& m, std::vector<textured_pair> pairs,
                                                      const step_bound& bound = {1.0, 0.5});
  textured_contacts(textured_contacts&&) noexcept;
  textured_contacts& operator=(textured_contacts&&) noexcept;
  ~textured_contacts();

  /// mj_step1(), apply(), mj_step2() and take_back().
  [[nodiscard]] status step(const mjModel_& m, mjData_& d) noexcept;
  /// Takes back what the last one added, and adds the wrenches of the poses that d has.
  /// @pre mj_step1() or mj_forward() made d's poses, velocities and inertias
  /// @return ok | capacity_reached (something is missing in a wrench) | invalid_pose | not_finite | backend_failed of
  ///         the first pair that answered so and added nothing | not_ready: m is not what it was made for
  [[nodiscard]] status apply(const mjModel_& m, mjData_& d) noexcept;
  /// Takes back what apply() added; xfrc_applied is as it was, where nobody wrote meanwhile.
  void take_back(mjData_& d) noexcept;

  [[nodiscard]] std::size_t size() const noexcept;
  /// @pre pair < size()
  [[nodiscard]] const pair_report& report(std::size_t pair) const noexcept;
  /// Where a pair's textured models were in the last apply(). @pre pair < size()
  [[nodiscard]] pose T_w_probe(std::size_t pair) const noexcept;
  [[nodiscard]] pose T_w_fixed(std::size_t pair) const noexcept;
  /// Wrenches so far that were scaled because of the time step.
  [[nodiscard]] std::uint64_t scaled() const noexcept;

 private:
  struct parts;
  explicit textured_contacts(std::unique_ptr<parts> made) noexcept;
  std::unique_ptr<parts> parts_;
};

/// Changes contype and conaffinity so that MuJoCo makes no contacts between the geoms of each pair: of the named geoms, or of
/// all geoms of a named body. Every other two geoms collide or do not as before. Each geom of a probe that would collide takes
/// one of the 31 bits that the model does not use.
/// @return invalid_argument (as make()) | unsupported (the two are in a <pair> element, which masks do not rule) |
///         limit_exceeded (no bit is free); m is not changed then
[[nodiscard]] result<void> switch_off_own_contacts(mjModel_& m, std::span<const textured_pair> pairs);

}  // namespace asperity::mujoco
