// Which samples may touch: balls of one body's samples against the other body's depth field.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "asperity/core/export.hpp"
#include "asperity/core/math.hpp"
#include "asperity/core/memory.hpp"
#include "asperity/field/field_scene.hpp"
#include "asperity/planes/near_samples.hpp"
#include "asperity/render/collision_finder.hpp"

namespace asperity {

class known_branches;
struct body_facts;
struct plane_scene;
class tick_team;

/// Lists the patches of samples whose depth may be more than -reach, with a bound of it: of the probe in each fixed
/// body's field, and of each fixed body in the probe's. Bodies that are too far away as a whole are known by a sphere
/// around each; of a scene that changes, where bodies stand still (scene_pose::version), a tree of these spheres knows
/// them without a look at each. What earlier ticks know spares it most looks. What it lists decides nothing, because a patch that is
/// listed and has no sample within reach gives no plane.
class ASPERITY_API plane_finder {
 public:
  using policy_tag = collision_tag;
  using found_type = near_samples;
  using placed_type = plane_scene;

  /// Threads that share a tick's work, and room for what one of them finds.
  struct shared_work {
    std::shared_ptr<tick_team> team;  ///< null: the calling thread alone
    std::shared_ptr<near_samples> beside;
  };

  /// @param reach_m gaps up to this are reported, m
  /// @param known   of the renderer's ticks, shared with its depth backend, which knows more; or nullptr
  plane_finder(std::shared_ptr<const field_scene> bodies, double reach_m,
               std::shared_ptr<known_branches> known = nullptr, shared_work with = {});

  /// Of a scene that changes. @param first its first version
  plane_finder(const plane_scene& first, double reach_m, std::shared_ptr<known_branches> known, shared_work with = {});

  /// Goes on with another version of the scene, which outlives its use here. @pre as many slots   @rt safe
  void take(const plane_scene& next) noexcept;

  /// @return ok | capacity_reached
  /// @rt safe
  [[nodiscard]] status find(const scene_pose& at, near_samples& out) noexcept;

  /// Fixed bodies that the last find() looked into.
  [[nodiscard]] std::size_t near_bodies() const noexcept { return near_bodies_; }
  /// Without the bodies, which others share.
  [[nodiscard]] std::size_t heap_bytes() const noexcept {
    const std::size_t beside = with_.beside ? sizeof(near_samples) + with_.beside->heap_bytes() : 0;
    return asperity::heap_bytes(fixed_, near_) + beside;
  }

 private:
  friend ASPERITY_API body_facts facts_of(const field_body&, double, double);
  // Nothing of two bodies whose spheres are further apart than the reach is listed.
  struct sphere {
    vec3 centre_b{0.0};
    double radius_m = 0.0;
  };
  [[nodiscard]] static sphere around(const field_body& body) noexcept;
  // The samples of the probe and one fixed body, where their spheres are near enough.
  void look_into(std::uint32_t body, const scene_pose& at, const vec3& probe_w, double reach_m,
                 near_samples& out) noexcept;

  std::shared_ptr<const field_scene> bodies_;
  std::shared_ptr<known_branches> known_;
  shared_work with_;
  sphere probe_;
  std::vector<sphere> fixed_;
  const plane_scene* placed_ = nullptr;
  std::vector<std::uint32_t> near_;  // of the tick, by the tree
  double reach_m_;
  std::size_t near_bodies_ = 0;
};

static_assert(collision_finder<plane_finder>);

}  // namespace asperity
