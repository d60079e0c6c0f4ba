// What the library tells at a pose: the deepest support plane of the plane renderer, and the wrench of the renderer for
// poses alone. Compiled once, optimised.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "asperity/core/pose.hpp"
#include "asperity/core/spatial.hpp"
#include "asperity/field/field_body.hpp"
#include "asperity/field/field_scene.hpp"
#include "asperity/model/scene.hpp"

namespace asperity::truth {

/// The deepest support plane of a pose, as the renderer told it. World axes.
struct reported_plane {
  double depth_m = 0.0;  ///< negative: a gap
  vec3 n_ab_w{0.0};
  vec3 point_w{0.0};  ///< the sample
  vec6 gradient{};
};

/// Support planes of one probe and one fixed body, both with fields made before.
class plane_law {
 public:
  /// @param reach_m gaps that are told; 0: the renderer's own choice   @throws std::runtime_error where it is refused
  plane_law(const scene& bodies, std::shared_ptr<const field_scene> fields, double reach_m = 0.0);
  plane_law(plane_law&&) noexcept;
  ~plane_law();

  /// Nothing where no plane is within reach.
  [[nodiscard]] std::optional<reported_plane> deepest(const pose& T_wa, const pose& T_wb = {});
  /// Whether the last tick had to leave planes out.
  [[nodiscard]] bool crowded() const noexcept;

 private:
  struct made;
  std::unique_ptr<made> made_;
};

/// What the renderer for poses alone is made with. 0: automatic.
struct pose_law_settings {
  double softness_m = 0.0;
  double period_s = 1e-3;
};

/// A wrench as it was told.
struct reported_force {
  wrench on_probe_w{};
  double energy_j = 0.0;
  std::size_t contacts = 0;
  vec3 n_ab_w{0.0};      ///< of the first contact
  bool complete = true;  ///< no limit was hit
};

/// The wrench of one probe and one fixed body, both with fields made before.
class pose_law {
 public:
  pose_law(const scene& bodies, std::shared_ptr<const field_scene> fields, const pose_law_settings& settings = {});
  pose_law(pose_law&&) noexcept;
  pose_law& operator=(pose_law&&) noexcept;
  ~pose_law();

  [[nodiscard]] reported_force at(const pose& T_wa, const pose& T_wb = {});
  [[nodiscard]] double stiffness_n_per_m() const noexcept;
  [[nodiscard]] double softness_m() const noexcept;

 private:
  struct made;
  std::unique_ptr<made> made_;
};

}  // namespace asperity::truth
