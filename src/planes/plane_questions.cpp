// Questions for planes at poses near that of the last tick: plane_depth::planes_at().
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
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

// The order in which the planes of one pose are told: by body, the probe's samples first.
bool is_told_before(const support_plane& p, const support_plane& q) noexcept {
  if (p.body != q.body) return p.body < q.body;
  const sample_number of_p = sample_number::from(p.sample), of_q = sample_number::from(q.sample);
  return of_p.of_probe != of_q.of_probe ? of_p.of_probe : of_p.index < of_q.index;
}

// The deepest planes that a list has room for. Which they are does not depend on the order in which they are added.
class deepest_planes {
 public:
  deepest_planes(double above_m, plane_list& in) noexcept : in_(&in), above_m_(above_m) {}

  // No deeper than this, a plane changes nothing. A list that is full waits for one more plane, so that it is known
  // whether there are more than it takes.
  [[nodiscard]] double above_m() const noexcept { return above_m_; }

  void add(const support_plane& p) noexcept {
    if (!(p.depth_m > above_m_)) return;
    if (in_->push_back(p)) {
      if (in_->full()) std::make_heap(in_->begin(), in_->end(), is_deeper);
      return;
    }
    const support_plane& least = (*in_)[0];
    if (is_deeper(p, least)) {
      std::pop_heap(in_->begin(), in_->end(), is_deeper);
      in_->back() = p;
      std::push_heap(in_->begin(), in_->end(), is_deeper);
    }
    above_m_ = std::nextafter(least.depth_m, -std::numeric_limits<double>::infinity());
  }

 private:
  [[nodiscard]] static bool is_deeper(const support_plane& p, const support_plane& q) noexcept {
    return p.depth_m != q.depth_m ? p.depth_m > q.depth_m : is_told_before(p, q);
  }

  plane_list* in_;  // once it is full a heap, the least deep first
  double above_m_;
};

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
  const auto look = [&](std::size_t p, unsigned thread, deepest_planes& to) noexcept {
    const near_patch& patch = patches[p];
    const way& of = ways_[patch.body];
    if (of.away || !(known_->asked_most_m(p) > to.above_m() + of.back_m)) return;
    const leaf_reader& reader = reading.of(thread).of(patch, of.shallow_m);
    const double beyond_m = come_to(*known_, p, patch, reader, moved.angular) - told_m_;
    const auto least_m = [&]() noexcept { return std::max(to.above_m(), beyond_m) + of.back_m; };
    if (!(known_->asked_most_m(p) > least_m())) return;
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
        to.add(plane);
      });
    }
    known_->close(p, patch);
  };
  const auto look_from = [&](std::size_t begin, std::size_t end, unsigned thread, plane_list& in) noexcept {
    deepest_planes to(above_m, in);
    known_->move_on(
        begin, end, slid_m, turned_rad, [&]() noexcept { return to.above_m(); },
        [&](std::size_t p) noexcept { look(p, thread, to); });
  };
  const std::size_t parts = parts_.size();
  bool all = true;
  if (parts <= 1) {
    look_from(0, patches.size(), 0, out);
  } else {
    share(team_.get(), parts, [&](std::size_t part, unsigned thread) noexcept {
      parts_[part].clear();
      const std::size_t begin = detail::part_begin(patches.size(), parts, part);
      const std::size_t end = detail::part_begin(patches.size(), parts, part + 1);
      look_from(begin, end, thread, parts_[part]);
    });
    deepest_planes of_all(above_m, out);
    for (const plane_list& part : parts_) {
      all = all && part.dropped() == 0;
      for (const support_plane& p : part) of_all.add(p);
    }
  }
  std::sort(out.begin(), out.end(), is_told_before);
  return all && out.dropped() == 0 ? status::ok : status::capacity_reached;
}

}  // namespace asperity
