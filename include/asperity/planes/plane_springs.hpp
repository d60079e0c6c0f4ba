// A spring per direction, on its deepest support plane: the force that a tick of planes reports.
#pragma once

#include <cstddef>
#include <span>

#include "asperity/core/export.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/core/status.hpp"
#include "asperity/planes/near_samples.hpp"
#include "asperity/render/force_model.hpp"

namespace asperity {

/// Settings of plane_springs.
struct plane_spring_settings {
  double stiffness_n_per_m = 50'000.0;  ///< of every direction
  double same_direction = 0.82;         ///< cosine between n_ab of two planes above which they share a spring
};

/// Says which setting is out of range and what would do.
[[nodiscard]] ASPERITY_API result<void> check(const plane_spring_settings& s);

/// Wrench of the deepest support plane of each direction, W = -sum of k depth gradient.
///
/// The probe of a control loop stays at the surface, and there this is the force to first order. It is no potential:
/// where the deepest plane changes the torque steps. What a hand feels comes from the planes themselves, which the
/// device thread holds the probe by; for a force as a function of the pose alone there is least_motion.
class ASPERITY_API plane_springs {
 public:
  using policy_tag = force_tag;
  using found_type = near_samples;
  using reading_type = near_plane;

  explicit plane_springs(const plane_spring_settings& settings = {}) : settings_(settings) {}

  /// Reports the directions as contacts, the deepest first; gaps within reach are among them.
  /// @return ok
  /// @rt safe
  [[nodiscard]] status accumulate(const scene_pose&, const near_samples&, std::span<const near_plane> planes,
                                  force_report& out) noexcept;

  [[nodiscard]] const plane_spring_settings& settings() const noexcept { return settings_; }
  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(reported_); }

 private:
  plane_spring_settings settings_;
  reported_contacts reported_;
};

static_assert(force_model<plane_springs>);

}  // namespace asperity
