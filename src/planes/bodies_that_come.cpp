// Bodies that come into a scene where the probe is: plane_depth::take(), and how they stand back.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "asperity/planes/plane_depth.hpp"
#include "asperity/planes/plane_scene.hpp"
#include "planes/facing.hpp"
#include "planes/known_branches.hpp"
#include "planes/known_depths.hpp"
#include "planes/plane_materials.hpp"
#include "planes/plane_watch.hpp"

namespace asperity {
namespace {

// Of a depth on one surface, the part that pushes as much or less on another one.
double share_of_push(const std::optional<surface_pair>& on, const std::optional<surface_pair>& now) noexcept {
  if (!on && !now) return 1.0;
  if (!on || !now) return 0.0;
  return std::min(1.0, on->stiffness_n_per_m / now->stiffness_n_per_m);
}

}  // namespace

void plane_depth::take(const plane_scene& next) noexcept {
  const std::uint64_t before = placed_ != nullptr ? placed_->version : 0;
  for (way& w : ways_) w.deepest_m = 0.0;
  for (const support_plane& p : reported_) {
    way& w = ways_[p.body];
    w.deepest_m = std::max(w.deepest_m, p.depth_m);
  }
  for (std::uint32_t b = 0; b < ways_.size(); ++b) {
    if (!(next.since[b] > before)) continue;
    way& w = ways_[b];
    const double share = placed_ != nullptr ? share_of_push(placed_->surfaces[b], next.surfaces[b]) : 0.0;
    w = {.shallow_m = facing::shallow_m(next.of[b].smallest_m),
         .comes = true,
         .was_m = share * w.deepest_m,
         .half_m = next.of[b].half_m};
    come_ = true;
    watch_->forget(b, next.of[b]);
    known_->forget(b);
    materials_->forget(b);
    if (branches_) branches_->forget(b);
  }
  bodies_ = next.fields;
  materials_->take(next);
  placed_ = &next;
}

vec6 plane_depth::way_ahead(const pose& T_wa) const noexcept {
  // Rendered where the probe is, in use a period later and for a period: so it is asked for the end of that.
  constexpr double periods = 2.0;
  if (!went_) return {};
  const vec3 slid_w = T_wa * centre_of_mass_a_ - before_wa_ * centre_of_mass_a_;
  return periods * vec6{slid_w, log_rotation(T_wa.rotation * glm::conjugate(before_wa_.rotation))};
}

void plane_depth::stand_back(const near_samples& found, const vec6& ahead, std::span<near_plane> out) noexcept {
  // Half way through there are several ways out, and the probe goes on until it is read again.
  constexpr double answered = 0.7;
  constexpr double none = -std::numeric_limits<double>::infinity();
  for (way& w : ways_) {
    w.deepest_m = w.bound_m = w.ahead_m = none;
    w.too_deep = false;
  }
  for (const near_patch& patch : found.patches()) {
    way& w = ways_[patch.body];
    // Where a probe has left it so fast that nothing of it was read, a bound will do.
    w.bound_m = std::max(w.bound_m, patch.in_other.most_m);
    // Not of planes: half way through, samples have none.
    w.too_deep = w.too_deep || patch.in_other.smooth_m > answered * (patch.of_probe ? w.half_m : probe_half_m_);
    for (const near_plane& p : out.subspan(patch.first_leaf, patch.leaf_count)) {
      if (!(p.plane.depth_m > none)) continue;
      const double grows_m = std::min(told_m_, dot(p.plane.gradient, ahead));
      w.deepest_m = std::max(w.deepest_m, p.plane.depth_m);
      w.ahead_m = std::max(w.ahead_m, p.plane.depth_m + std::max(0.0, grows_m));
    }
  }
  come_ = false;
  for (way& w : ways_) {
    if (const bool comes = std::exchange(w.comes, false); comes || w.away) {
      const double deeper_m = w.ahead_m - (comes ? w.was_m : 0.0);
      w.away = w.too_deep && (!comes || deeper_m > let_in_m);
      w.back_m = !w.away && deeper_m > let_in_m ? deeper_m : 0.0;
    } else if (w.back_m > 0.0) {
      const bool was_read = w.deepest_m > w.back_m - 1.25 * told_m_;
      w.back_m = std::max(0.0, std::min(w.back_m, (was_read ? w.deepest_m : w.bound_m) + told_m_));
    }
    come_ = come_ || w.away || w.back_m > 0.0;
  }
  if (!come_) return;
  for (const near_patch& patch : found.patches()) {
    const way& w = ways_[patch.body];
    for (near_plane& p : out.subspan(patch.first_leaf, patch.leaf_count)) {
      p.plane.depth_m = w.away ? none : p.plane.depth_m - w.back_m;
      p.plane.back_m += w.back_m;
    }
  }
}

}  // namespace asperity
