// Bodies that the probe pushes, stacks and drops, for one thread with a loop of its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "asperity/control/contact_solver.hpp"
#include "asperity/control/friction.hpp"
#include "asperity/control/probe.hpp"
#include "asperity/control/virtual_coupling.hpp"
#include "asperity/core/export.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/core/status.hpp"
#include "asperity/field/field_scene.hpp"
#include "asperity/model/textured_model.hpp"
#include "asperity/render/tick_flag.hpp"

namespace asperity {

/// Most free bodies of one scene.
inline constexpr std::size_t most_free_bodies = 32;

/// A body that forces move. Its inertia is that of a solid of uniform density.
struct free_body {
  model_ptr model{};
  pose T_wb{};
  double mass_kg = 0.0;               ///< 0: by the density
  double density_kg_per_m3 = 1000.0;  ///< not used where the mass is given
};

/// A body that nothing moves.
struct standing_body {
  model_ptr model{};
  pose T_wb{};
};

/// What a free_bodies is made of.
struct free_scene {
  model_ptr probe{};  ///< behind the handle; null: nobody touches the bodies
  std::vector<standing_body> standing{};
  std::vector<free_body> free{};  ///< 1 to most_free_bodies
};

struct free_bodies_settings {
  vec3 gravity_m_per_s2{0.0, 0.0, -9.81};  ///< world axes
  double period_s = 1e-3;                  ///< of follow(); planes and gaps are chosen for it
  int render_every = 1;                    ///< calls of follow(): the contacts of all bodies are told anew
  int substeps = 4;                        ///< in one call
  contact_law contact{};                   ///< of pairs whose materials are not known
  /// Coefficients of such pairs; the rest of all. Stiffer than a probe's: what presses on a heavy body varies as it slides
  /// from sample to sample, and a soft bristle takes up too slowly what it gave up. With 50 N/mm blocks of 4 to 10 kg were
  /// held back by up to a tenth too little.
  friction_settings friction{.stiffness_n_per_m = 1e6};
  double linear_damping_per_s = 0.1;  ///< a body alone loses this share of its speed
  double angular_damping_per_s = 0.1;
  /// Bodies that touch each other and are all slower than this for sleep_after_s stand still until something awake
  /// touches one of them. The turning counts by the body's radius.
  double sleep_below_m_per_s = 1e-3;
  double sleep_after_s = 0.5;    ///< 0: never
  double fastest_m_per_s = 3.0;  ///< of a body; what falls faster is braked, and has_braked() tells
  probe_settings probe{};
  coupling_settings coupling{};
  pose T_ha{};                      ///< the probe's body frame on the handle
  field_body_settings fields{};     ///< of models that keep no depth field
  std::size_t most_leaves = 4'096;  ///< as near_sample_limits::leaves, of each body
  std::size_t most_planes = 1'024;  ///< between all bodies, in one step
};

/// Says which setting is out of range and what would do.
/// @return invalid_argument
[[nodiscard]] ASPERITY_API result<void> check(const free_bodies_settings& s);

/// Where the energy went since the scene was made, J. In each step
///   work of gravity, hand and pushes = gain of kinetic energy, plane springs and bristles + what was lost.
struct bodies_energy {
  double kinetic_j = 0.0;       ///< now
  double springs_j = 0.0;       ///< in the planes' springs now
  double bristles_j = 0.0;      ///< in the bristles now
  double by_gravity_j = 0.0;    ///< work
  double by_hand_j = 0.0;       ///< work of the coupling on the probe
  double by_pushes_j = 0.0;     ///< work of push()
  double by_rendering_j = 0.0;  ///< what the planes' springs gained because planes were told anew, or have turned
  double lost_j = 0.0;          ///< by contact, friction, damping and implicit steps
  double most_made_j = 0.0;     ///< the most that a step made: rounding
};

/// Rigid bodies, a probe behind a virtual coupling and what stands still, in one implicit step:
///
///     auto bodies = free_bodies::make({.probe = tool, .standing = {{table}}, .free = {{block, T_wb}}}, settings).value();
///     bodies.place(T_wh);
///     for (;;) send(bodies.follow(read_handle(), period_s));     // one pass per device period
///     draw(bodies.T_wb(0));
///
/// In a call the contacts of all pairs are told by plane_renderer, as support planes with gaps; then all bodies that are
/// in touch are solved for together in every substep, as contact_solver.hpp does for the probe alone. Planes go with
/// both of their bodies, which is exact for planes. Each pair has one bristle of friction. A step makes no energy:
/// springs, bristles, damping and gyroscopic torque are taken at its end.
/// - A body may go as far as its planes know, half of the way for each of two that meet; then it is braked until the
///   next contacts. has_braked() tells.
/// - A body that sleeps costs nothing but the look of others at it.
/// - Bodies of one model share its depth field.
/// It limits no force and watches no clock: what leaves should pass an output_gate, as a device_loop's wrench does.
/// For tens of bodies on a table, not for a world of them: take an engine for that, and tell a session where its bodies
/// are (moving_bodies).
/// @rt follow() as safe as a renderer: no allocation, lock, throw, print or clock. make() makes fields and takes all
/// memory.
/// @source the problem: as contact_solver.hpp; gyroscopic step: E. Catto, Physics for game programmers: Numerical methods,
/// 2015
class ASPERITY_API free_bodies {
 public:
  /// @return invalid_argument (a model missing, no body, too many, a mass or pose out of range) | bad_mesh | bad_texture
  [[nodiscard]] static result<free_bodies> make(const free_scene& scene, const free_bodies_settings& settings = {});
  free_bodies(free_bodies&&) noexcept;
  free_bodies& operator=(free_bodies&&) noexcept;
  ~free_bodies();

  /// Puts the probe where the handle is, at rest. @pre is_valid(T_wh)
  void place(const pose& T_wh) noexcept;
  /// Puts a free body somewhere, with the velocity of its centre of mass; everything wakes.
  /// @return false: there is no such body, or a number is not finite
  bool put(std::size_t body, const pose& T_wb, const twist& velocity_w = {}) noexcept;
  /// A wrench on a free body about its centre of mass for the next call of follow(), world axes; the body wakes.
  bool push(std::size_t body, const wrench& on_body_w) noexcept;

  /// dt_s seconds with the handle going evenly to T_wh; of a longer pause, two periods.
  /// @return wrench for the hand at the handle's origin, world axes; zero where last() is not ok or capacity_reached
  [[nodiscard]] wrench follow(const pose& T_wh, double dt_s) noexcept;
  /// The same without a probe.
  void advance(double dt_s) noexcept;

  /// How the last call ended: ok | capacity_reached (planes or samples were left out) | invalid_pose | not_finite (all
  /// bodies stand still where they were).
  [[nodiscard]] status last() const noexcept;
  /// What the contacts of the last call do not answer.
  [[nodiscard]] tick_flag flags() const noexcept;
  [[nodiscard]] std::size_t size() const noexcept;
  [[nodiscard]] pose T_wb(std::size_t body) const noexcept;
  /// Of the body's centre of mass.
  [[nodiscard]] twist velocity_w(std::size_t body) const noexcept;
  [[nodiscard]] double mass_kg(std::size_t body) const noexcept;
  [[nodiscard]] bool sleeps(std::size_t body) const noexcept;
  /// What contacts did to a free body in the last call, about its centre of mass, world axes; mean over the call. Of one
  /// that sleeps, as it was.
  [[nodiscard]] wrench on_free(std::size_t body) const noexcept;
  /// The same to a standing body, about its centre of mass.
  [[nodiscard]] wrench on_standing(std::size_t body) const noexcept;
  /// Pose of the probe's body frame.
  [[nodiscard]] pose T_wa() const noexcept;
  /// Whether a body was braked in the last call, because it was faster than its contacts know or than fastest_m_per_s.
  [[nodiscard]] bool has_braked() const noexcept;
  [[nodiscard]] const bodies_energy& energy() const noexcept;
  [[nodiscard]] std::size_t memory_bytes() const noexcept;

 private:
  struct parts;
  explicit free_bodies(std::unique_ptr<parts> made) noexcept;
  std::unique_ptr<parts> parts_;
};

}  // namespace asperity
