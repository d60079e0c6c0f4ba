// Which samples may touch: balls of one body's samples against the other body's depth field.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>

#include "asperity/core/pose.hpp"
#include "asperity/field/field_scene.hpp"
#include "asperity/planes/near_samples.hpp"
#include "asperity/render/collision_finder.hpp"

namespace asperity {

/// Lists the leaves of samples whose depth may be more than -reach: of the probe in each fixed body's field, and of
/// each fixed body in the probe's. It keeps nothing between ticks, and what it lists decides nothing: a leaf too many
/// gives planes that are far from active.
class field_finder {
 public:
  using policy_tag = collision_tag;
  using found_type = near_samples;

  /// @param reach_m gaps up to this are told, m
  field_finder(std::shared_ptr<const field_scene> bodies, double reach_m) noexcept
      : bodies_(std::move(bodies)), reach_m_(reach_m) {}

  /// @return ok | capacity_reached
  /// @rt safe
  [[nodiscard]] status find(const scene_pose& at, near_samples& out) noexcept {
    out.clear();
    for (std::uint32_t b = 0; b < bodies_->fixed.size(); ++b) {
      const field_body &A = *bodies_->probe, &B = *bodies_->fixed[b];
      const pose T_ba = inverse(at.T_wb[b]) * at.T_wa;
      list(A.samples, B.field, T_ba, {.body = b, .of_probe = true}, out);
      list(B.samples, A.field, inverse(T_ba), {.body = b, .of_probe = false}, out);
    }
    return out.dropped() > 0 ? status::capacity_reached : status::ok;
  }

 private:
  // Samples of X in the field of Y; T_yx takes X's frame to Y's.
  void list(const sample_tree& of_x, const body_field& in_y, const pose& T_yx, const near_leaf& whose,
            near_samples& out) const noexcept {
    of_x.query([&](const vec3& centre_x,
                   double radius_m) noexcept { return in_y.most_near(T_yx * centre_x, radius_m) > -reach_m_; },
               [&](const vec3& centre_x, double radius_m, std::span<const field_sample> samples) noexcept {
                 near_leaf leaf = whose;
                 leaf.first = samples.data();
                 leaf.count = static_cast<std::uint32_t>(samples.size());
                 leaf.centre_b = centre_x;
                 leaf.radius_m = radius_m;
                 static_cast<void>(out.add(leaf));
               });
  }

  std::shared_ptr<const field_scene> bodies_;
  double reach_m_;
};

static_assert(collision_finder<field_finder>);

}  // namespace asperity
