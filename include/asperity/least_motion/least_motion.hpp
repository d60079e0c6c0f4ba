// The force model for poses alone: a spring on the least motion of the probe that clears the bodies.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "asperity/core/export.hpp"
#include "asperity/core/status.hpp"
#include "asperity/field/field_scene.hpp"
#include "asperity/least_motion/least_motion_settings.hpp"
#include "asperity/planes/near_samples.hpp"
#include "asperity/render/force_model.hpp"

namespace asperity {

namespace exits {
struct exit_scene;
class exit_solver;
}  // namespace exits

/// W = -dU/dq with U the energy of the least motion that clears (src/least_motion/least_motion.cpp): a function of the
/// pose alone that has a potential, held at any depth up to the middle of a body.
///
/// It needs the bodies and their poses, and no contacts: what finder and depth backend hand on is left as it is.
/// @rt safe; the cost grows with the depth and is bounded by least_motion_settings::most_readings
class ASPERITY_API least_motion {
 public:
  using policy_tag = force_tag;
  using found_type = near_samples;
  using reading_type = near_plane;

  /// @param bodies of the scene, in its order   @param ways_of what the search needs of them: force models of the same
  /// bodies can share it   @param centre_of_mass_a of the probe, its frame   @pre check(settings),
  /// ways_of->is_of(bodies)
  least_motion(const field_scene& bodies, std::shared_ptr<const exits::exit_scene> ways_of,
               const vec3& centre_of_mass_a, const least_motion_settings& settings);
  least_motion(least_motion&&) noexcept;
  least_motion& operator=(least_motion&&) noexcept;
  ~least_motion();

  /// Reports the ways out that have weight as contacts: depth_m is how far the motion takes the deepest sample, times
  /// the weight; n_ab points against the push. A way out past several walls is one contact.
  /// @return ok | capacity_reached (a limit of the settings was hit; hit() says which)
  /// @rt safe
  [[nodiscard]] status accumulate(const scene_pose& at, const near_samples&, std::span<const near_plane>,
                                  force_report& out) noexcept;

  /// Energy of the last call, J.
  [[nodiscard]] double energy_j() const noexcept;
  /// Limits that the last call ran into.
  [[nodiscard]] const exits::exit_limits_hit& hit() const noexcept;
  /// Readings that the last call spent.
  [[nodiscard]] std::size_t readings() const noexcept;

  /// The settings, automatic ones filled in.
  [[nodiscard]] const least_motion_settings& settings() const noexcept { return settings_; }
  [[nodiscard]] std::size_t heap_bytes() const noexcept;

 private:
  // One contact for each way out. @return how many of by_contact are known: as many as contacts, or none
  std::size_t report_ways(std::span<wrench> by_contact) noexcept;

  least_motion_settings settings_;
  std::unique_ptr<exits::exit_solver> solver_;
  reported_contacts reported_;
};

static_assert(force_model<least_motion>);

}  // namespace asperity
