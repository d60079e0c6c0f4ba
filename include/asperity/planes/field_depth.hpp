// How deep samples lie in the other body's field: one support plane for a few neighbouring samples.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "asperity/core/export.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/field/field_scene.hpp"
#include "asperity/model/scene.hpp"
#include "asperity/planes/near_samples.hpp"
#include "asperity/render/depth_backend.hpp"
#include "asperity/render/plane_source.hpp"
#include "asperity/render/support_plane.hpp"
#include "asperity/render/tick_flag.hpp"

namespace asperity {

class field_watch;

/// Reads the field at every near sample and keeps the deepest of each leaf, with its slope, as a support plane. Edge
/// across edge needs nothing of its own: the samples along one edge lie in the field of the other's body.
///
/// The field's way out is the shortest one of the point, whatever body the point belongs to. Beside a sharp edge that
/// can be sideways, where the bodies would not slide apart. A sample therefore sinks, by up to 3 % of the smallest
/// body's diagonal, as the way turns from where its own surface looks: the plane leaves without a step.
/// A reading whose depth is -infinity stands for a leaf that has no plane.
class ASPERITY_API field_depth {
 public:
  using policy_tag = depth_tag;
  using found_type = near_samples;
  using reading_type = near_plane;

  /// @param bodies   the scene's, in its order
  /// @param reach_m  gaps up to this are told, m
  /// @param most     planes that a tick may tell: near_sample_limits::readings()
  field_depth(std::shared_ptr<const field_scene> bodies, const scene& of, double reach_m, std::size_t most);
  field_depth(field_depth&&) noexcept;
  field_depth& operator=(field_depth&&) noexcept;
  ~field_depth();

  /// @return ok
  /// @rt safe
  [[nodiscard]] status measure(const scene_pose& at, const near_samples& found, std::span<near_plane> out) noexcept;

  /// The planes of the samples that are deeper than above_m at a pose near that of the last measure(), of leaves that
  /// can have come so deep by this motion. Where there are more than `out` takes, the deepest.
  /// @param found, read of the last measure()   @param moved from its pose to this one, about c_A
  /// @return ok | capacity_reached
  /// @rt safe
  [[nodiscard]] status planes_at(const scene_pose& at, const near_samples& found, std::span<const near_plane> read,
                                 const vec6& moved, double above_m, plane_list& out) const noexcept;

  /// The planes of the last measure(), gaps included.
  [[nodiscard]] std::span<const support_plane> support_planes() const noexcept { return told_; }
  /// What these planes do not answer.
  [[nodiscard]] tick_flag flags() const noexcept { return flags_; }
  [[nodiscard]] const field_scene& bodies() const noexcept { return *bodies_; }
  [[nodiscard]] std::size_t heap_bytes() const noexcept;

 private:
  // The deepest sample of X in the field of Y where it is deeper than above_m. The depth grows where X's point moves
  // along the field's slope; where X is the fixed body, the probe's motion takes the field along, and the sign turns.
  [[nodiscard]] near_plane deepest(const near_leaf& leaf, const body_field& in_y, const pose& T_yx,
                                   const quat& rotation_wy, const pose& T_wx, double sign, const vec3& c_a_w,
                                   double above_m) const noexcept;

  std::shared_ptr<const field_scene> bodies_;
  vec3 centre_of_mass_a_;
  double reach_m_;
  double sinking_m_ = 0.0;  // of a sample that looks away
  std::vector<support_plane> told_;
  std::unique_ptr<field_watch> watch_;
  tick_flag flags_ = tick_flag::none;
};

static_assert(depth_backend<field_depth>);
static_assert(tells_planes_nearby<field_depth>);

}  // namespace asperity
