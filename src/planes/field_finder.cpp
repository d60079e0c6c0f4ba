#include "asperity/planes/field_finder.hpp"

#include <cstdint>
#include <span>

#include "asperity/core/pose.hpp"
#include "asperity/field/field_body.hpp"

namespace asperity {
namespace {

// Samples of X in the field of Y; T_yx takes X's frame to Y's.
void list(const sample_tree& of_x, const body_field& in_y, const pose& T_yx, const near_leaf& whose, double reach_m,
          near_samples& out) noexcept {
  of_x.query([&](const vec3& centre_x,
                 double radius_m) noexcept { return in_y.most_near(T_yx * centre_x, radius_m) > -reach_m; },
             [&](const vec3& centre_x, double radius_m, std::span<const field_sample> samples) noexcept {
               near_leaf leaf = whose;
               leaf.first = samples.data();
               leaf.count = static_cast<std::uint32_t>(samples.size());
               leaf.centre_b = centre_x;
               leaf.radius_m = radius_m;
               static_cast<void>(out.add(leaf));
             });
}

}  // namespace

status field_finder::find(const scene_pose& at, near_samples& out) noexcept {
  out.clear();
  for (std::uint32_t b = 0; b < bodies_->fixed.size(); ++b) {
    const field_body &A = *bodies_->probe, &B = *bodies_->fixed[b];
    const pose T_ba = inverse(at.T_wb[b]) * at.T_wa;
    list(A.samples, B.field, T_ba, {.body = b, .of_probe = true}, reach_m_, out);
    list(B.samples, A.field, inverse(T_ba), {.body = b, .of_probe = false}, reach_m_, out);
  }
  return out.dropped() > 0 ? status::capacity_reached : status::ok;
}

}  // namespace asperity
