// Which samples may touch: balls of one body's samples against the other body's depth field.
#pragma once

#include <memory>

#include "asperity/core/export.hpp"
#include "asperity/field/field_scene.hpp"
#include "asperity/planes/near_samples.hpp"
#include "asperity/render/collision_finder.hpp"

namespace asperity {

class known_branches;

/// Lists the patches of samples whose depth may be more than -reach, with a bound of it: of the probe in each fixed
/// body's field, and of each fixed body in the probe's. What earlier ticks know spares it most looks. What it
/// lists decides nothing, because a patch that is listed and has no sample within reach gives no plane.
class ASPERITY_API plane_finder {
 public:
  using policy_tag = collision_tag;
  using found_type = near_samples;

  /// @param reach_m gaps up to this are reported, m
  /// @param known   of the renderer's ticks, shared with its depth backend, which knows more; or nullptr
  plane_finder(std::shared_ptr<const field_scene> bodies, double reach_m,
               std::shared_ptr<known_branches> known = nullptr) noexcept;

  /// @return ok | capacity_reached
  /// @rt safe
  [[nodiscard]] status find(const scene_pose& at, near_samples& out) noexcept;

 private:
  std::shared_ptr<const field_scene> bodies_;
  std::shared_ptr<known_branches> known_;
  double reach_m_;
};

static_assert(collision_finder<plane_finder>);

}  // namespace asperity
