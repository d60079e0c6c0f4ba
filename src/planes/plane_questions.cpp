// Questions for planes at poses near that of the last tick: plane_depth::planes_at().
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include "asperity/planes/plane_depth.hpp"
#include "field/threads.hpp"
#include "planes/known_depths.hpp"
#include "planes/patch_readers.hpp"
#include "planes/plane_materials.hpp"
#include "planes/tick_team.hpp"

namespace asperity {
namespace {

void keep_deepest(const support_plane& p, plane_list& in) noexcept {
  if (in.push_back(p)) return;
  support_plane* const least =
      std::min_element(in.begin(), in.end(), [](const auto& a, const auto& b) { return a.depth_m < b.depth_m; });
  if (least->depth_m < p.depth_m) *least = p;
}

// Brings what is known of a patch to the pose that is asked for, turned by so much from the tick's. Returns how much
// deeper its samples can be there than at the tick's pose.
double come_to(known_depths& known, std::size_t p, const near_patch& patch, const leaf_reader& there,
               const vec3& turned) noexcept {
  constexpr double asked_pitches = 0.4;  // of the smooth part: the poses that are asked for are mostly no further
  const double radius_m = patch.ball.radius_m;
  known_depths::asked_patch& asked = known.asked(p);
  if (!std::exchange(asked.has_slopes, true)) {
    asked.slopes = there.slopes_about(patch, asked.middle_y, radius_m + asked_pitches * there.pitch_m());
  }
  const vec3 now_y = there.in_field(patch.ball.centre_b), before_y = std::exchange(asked.asked_y, now_y);
  const vec3 turn = turned - std::exchange(asked.turned, turned);
  const patch_way gone{now_y - before_y, std::sqrt(glm::dot(turn, turn)) * radius_m};
  const patch_way come{now_y - asked.middle_y, std::sqrt(glm::dot(turned, turned)) * radius_m};
  const double here_m = glm::length(come.of_middle), before_m = glm::distance(before_y, asked.middle_y);
  known.come_to(p, asked.slopes.growth_m(gone, radius_m + std::max(here_m, before_m)));
  return asked.slopes.growth_m(come, radius_m + here_m);
}

}  // namespace

[[gnu::flatten]] status plane_depth::planes_at(const scene_pose& at, const near_samples& found,
                                               std::span<const near_plane>, const vec6& moved, double above_m,
                                               plane_list& out) const noexcept {
  readers_of_threads reading(*bodies_, at, at.T_wa * centre_of_mass_a_, *materials_);
  const vec6 step = moved - *asked_at_;
  *asked_at_ = moved;
  const double slid_m = std::sqrt(glm::dot(step.linear, step.linear));
  const double turned_rad = std::sqrt(glm::dot(step.angular, step.angular));
  const std::span<const near_patch> patches = found.patches();
  const auto look = [&](std::size_t p, unsigned thread, plane_list& to) noexcept {
    const near_patch& patch = patches[p];
    const way& of = ways_[patch.body];
    const double deeper_m = above_m + of.back_m;
    if (of.away || !(known_->asked_most_m(p) > deeper_m)) return;
    const leaf_reader& reader = reading.of(thread).of(patch, of.sinking_m);
    const double least_m = std::max(deeper_m, come_to(*known_, p, patch, reader, moved.angular) - told_m_ + of.back_m);
    if (!(known_->asked_most_m(p) > least_m)) return;
    known_->open(p, patch);
    const bool has_map = materials_->has_map(patch.body);
    for (std::size_t i = patch.first_leaf; i < patch.first_leaf + patch.leaf_count; ++i) {
      reader.each_deeper(found.leaves()[i], least_m, known_->asked_of(i), [&](support_plane plane) noexcept {
        plane.depth_m -= of.back_m;
        plane.back_m = of.back_m;
        if (has_map) {
          const double back_m = materials_->back_m(found.leaves()[i], patch.of_probe, plane);
          plane.depth_m -= back_m;
          plane.back_m += back_m;
        }
        if (plane.depth_m > above_m) keep_deepest(plane, to);
      });
    }
    known_->close(p, patch);
  };
  const auto look_from = [&](std::size_t begin, std::size_t end, unsigned thread, plane_list& to) noexcept {
    known_->move_on(begin, end, slid_m, turned_rad, above_m, [&](std::size_t p) noexcept { look(p, thread, to); });
  };
  const std::size_t parts = parts_.size();
  if (parts <= 1) {
    look_from(0, patches.size(), 0, out);
    return out.dropped() > 0 ? status::capacity_reached : status::ok;
  }
  share(team_.get(), parts, [&](std::size_t part, unsigned thread) noexcept {
    parts_[part].clear();
    const std::size_t begin = detail::part_begin(patches.size(), parts, part);
    const std::size_t end = detail::part_begin(patches.size(), parts, part + 1);
    look_from(begin, end, thread, parts_[part]);
  });
  bool all = true;
  for (const plane_list& part : parts_) {
    all = all && part.dropped() == 0;
    for (const support_plane& p : part) keep_deepest(p, out);
  }
  if (all && out.dropped() == 0) return status::ok;
  // Which planes make room for deeper ones depends on their order: one thread takes them in that of the patches.
  out.clear();
  for (std::size_t p = 0; p < patches.size(); ++p) look(p, 0, out);
  return out.dropped() > 0 ? status::capacity_reached : status::ok;
}

}  // namespace asperity
