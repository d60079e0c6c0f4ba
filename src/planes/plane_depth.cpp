#include "asperity/planes/plane_depth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "asperity/core/memory.hpp"
#include "planes/facing.hpp"
#include "planes/first_met.hpp"
#include "planes/known_branches.hpp"
#include "planes/known_depths.hpp"
#include "planes/patch_readers.hpp"
#include "planes/plane_materials.hpp"
#include "planes/plane_watch.hpp"
#include "planes/surface_reader.hpp"
#include "planes/tick_team.hpp"

namespace asperity {
namespace {

// What a hand does in a period T of a contact loop whose reach is 3 v T with v = 0.6 m/s: 5 rad/s and 0.1 m/s, as
// plane_selection has it.
trial_motions trials_within(double reach_m) noexcept {
  const double period_s = reach_m / 1.8;
  return {.tilt_rad = 5.0 * period_s, .slide_m = 0.1 * period_s};
}

// Patches of a task where each takes little, and where each may take much.
constexpr std::size_t many_patches = 32, few_patches = 4;

}  // namespace

plane_depth::plane_depth(std::shared_ptr<const field_scene> bodies, const scene& of, double reach_m, std::size_t most,
                         std::shared_ptr<known_branches> branches, std::shared_ptr<tick_team> team)
    : bodies_(std::move(bodies)),
      centre_of_mass_a_(of.probe->mass.centre_of_mass),
      reach_m_(reach_m),
      told_m_(reach_m),
      ways_(of.fixed.size()),
      watch_(std::make_unique<plane_watch>(*bodies_, of)),
      met_(std::make_unique<first_met>(trials_within(reach_m))),
      known_(std::make_unique<known_depths>(most)),
      branches_(std::move(branches)),
      team_(std::move(team)),
      materials_(std::make_unique<plane_materials>(of, most)),
      reader_(std::make_unique<surface_reader>(bodies_, centre_of_mass_a_,
                                               std::vector<double>(of.fixed.size(), facing::shallow_m(of)))),
      asked_at_(std::make_unique<vec6>()) {
  for (way& w : ways_) w.shallow_m = facing::shallow_m(of);
  reserve(most);
}

plane_depth::plane_depth(const plane_scene& first, double reach_m, std::size_t most,
                         std::shared_ptr<known_branches> branches, std::shared_ptr<tick_team> team)
    : bodies_(first.fields),
      centre_of_mass_a_(first.bodies.probe->mass.centre_of_mass),
      reach_m_(reach_m),
      told_m_(reach_m),
      ways_(first.of.size()),
      watch_(std::make_unique<plane_watch>(first.probe, first.of.size())),
      met_(std::make_unique<first_met>(trials_within(reach_m))),
      known_(std::make_unique<known_depths>(most)),
      branches_(std::move(branches)),
      team_(std::move(team)),
      materials_(std::make_unique<plane_materials>(first, most)),
      asked_at_(std::make_unique<vec6>()) {
  reserve(most);
  take(first);
  probe_half_m_ = first.probe.half_m;
  // What is there from the beginning does not stand back.
  for (way& w : ways_) w.comes = false;
  come_ = false;
}

void plane_depth::reserve(std::size_t most) {
  if (team_ && team_->threads() > 1) parts_.resize(std::size_t{4} * team_->threads());
  detail::reserve_resident(reported_, most);
  detail::reserve_resident(order_, most);
  detail::reserve_resident(has_plane_, most);
  for (const field_sample& s : bodies_->probe->samples.samples()) {
    farthest_m_ = std::max(farthest_m_, glm::distance(vec3(s.position_b), centre_of_mass_a_));
  }
}
plane_depth::plane_depth(plane_depth&&) noexcept = default;
plane_depth& plane_depth::operator=(plane_depth&&) noexcept = default;
plane_depth::~plane_depth() = default;

const plane_reader* plane_depth::reader() const noexcept {
  return placed_ != nullptr ? placed_->reader.get() : reader_.get();
}
const placed_scene* plane_depth::placed() const noexcept { return placed_; }

status plane_depth::measure(const scene_pose& at, const near_samples& found, std::span<near_plane> out) noexcept {
  const vec3 c_a_w = at.T_wa * centre_of_mass_a_;
  readers_of_threads reading(*bodies_, at, c_a_w, *materials_);
  const auto reader_of = [&](const near_patch& patch, unsigned thread) noexcept -> const leaf_reader& {
    return reading.of(thread).of(patch, ways_[patch.body].shallow_m);
  };
  const std::span<const near_patch> patches = found.patches();
  reported_.clear();
  met_->clear();
  told_m_ = std::min(reach_m_, at.gaps_m);
  learn_ways(at, found);
  known_->begin(found);
  share_items(team_.get(), patches.size(), many_patches, [&](std::size_t p, unsigned thread) noexcept {
    known_->grow(patches[p], growth_m(patches[p], reader_of(patches[p], thread), known_->brought_m(p)));
  });
  // What may be near is read first: it hides what lies behind it.
  sort_by_depth(patches);
  has_plane_.resize(patches.size());
  // Several patches are looked through at a time; what they have is compared in their order, so that what is told
  // does not depend on how many. The first ones hide most of what comes later: few at a time, then more.
  const std::size_t most_at_a_time = team_ ? std::size_t{few_patches} * 8 * team_->threads() : 1;
  std::size_t at_a_time = team_ ? few_patches : 1;
  for (std::size_t begin = 0; begin < order_.size();) {
    const std::size_t count = std::min(at_a_time, order_.size() - begin);
    const auto leaves_out = [&](const near_patch& patch) noexcept {
      return out.subspan(patch.first_leaf, patch.leaf_count);
    };
    share_items(team_.get(), count, few_patches, [&](std::size_t i, unsigned thread) noexcept {
      const near_patch& patch = patches[order_[begin + i]];
      has_plane_[order_[begin + i]] =
          look_through(patch, found.leaves_of(patch), reader_of(patch, thread), count == 1, leaves_out(patch)) ? 1 : 0;
    });
    for (std::size_t i = begin; i < begin + count; ++i) {
      const near_patch& patch = patches[order_[i]];
      if (has_plane_[order_[i]] != 0) keep_what_matters(patch, reader_of(patch, 0), leaves_out(patch));
    }
    begin += count;
    at_a_time = std::min(2 * at_a_time, most_at_a_time);
  }
  if (come_) stand_back(found, way_ahead(at.T_wa), out);
  before_wa_ = at.T_wa;
  went_ = true;
  if (materials_->any()) materials_->hold_back(found, out);
  for (std::size_t i = 0; i < patches.size(); ++i) {
    if (has_plane_[i] == 0) continue;
    for (const near_plane& p : out.subspan(patches[i].first_leaf, patches[i].leaf_count)) {
      if (p.plane.depth_m > -told_m_ && reported_.size() < reported_.capacity()) reported_.push_back(p.plane);
    }
  }
  teach(found);
  known_->ask(found);
  share_items(team_.get(), patches.size(), many_patches, [&](std::size_t p, unsigned thread) noexcept {
    const leaf_reader& reader = reader_of(patches[p], thread);
    const sample_ball& ball = patches[p].ball;
    const vec3 r_w = reader.from_centre_of_mass_w(ball.centre_b);
    known_->ask_of(p, patches[p], reader.in_field(ball.centre_b), std::sqrt(glm::dot(r_w, r_w)) + ball.radius_m);
  });
  *asked_at_ = {};
  work_ = reading.work();
  work_.looked_at = found.looked_at();
  known_motion_ = {-found.most_left_m(), -found.most_left_m() / farthest_m_};
  for (const near_leaf& leaf : found.leaves()) work_.listed += leaf.count;
  flags_ = watch_->look(*bodies_, at, reported_, c_a_w);
  if (come_) flags_ |= tick_flag::stands_back;
  return status::ok;
}

void plane_depth::learn_ways(const scene_pose& at, const near_samples& found) noexcept {
  // Patches come body by body. Nothing is known of one that was not listed in the tick before.
  const near_patch* last = nullptr;
  for (const near_patch& patch : found.patches()) {
    if (last != nullptr && last->body == patch.body) continue;
    last = &patch;
    way& w = ways_[patch.body];
    w.before_ba = w.T_ba;
    w.before_ab = inverse(w.T_ba);
    w.T_ba = inverse(at.T_wb[patch.body]) * at.T_wa;
    const quat turn = glm::conjugate(w.before_ba.rotation) * w.T_ba.rotation;
    w.chord = 2.0 * std::sqrt(turn.x * turn.x + turn.y * turn.y + turn.z * turn.z);
  }
}

[[gnu::flatten]] double plane_depth::growth_m(const near_patch& patch, const leaf_reader& reader,
                                              double most_m) const noexcept {
  const way& w = ways_[patch.body];
  const vec3 now_y = reader.in_field(patch.ball.centre_b);
  const vec3 before_y = (patch.of_probe ? w.before_ba : w.before_ab) * patch.ball.centre_b;
  const patch_way gone{now_y - before_y, w.chord * patch.ball.radius_m};
  const double at_most_m = steepest_depth * gone.most_m();
  // Slopes are asked for where they can spare readings.
  if (!(most_m + at_most_m > -told_m_)) return at_most_m;
  const double far_m = patch.ball.radius_m + gone.most_m();
  return reader.slopes_about(patch, now_y, far_m).growth_m(gone, far_m);
}

void plane_depth::teach(const near_samples& found) noexcept {
  if (!branches_) return;
  for (const near_patch& patch : found.patches()) {
    branches_->note(patch.body, patch.of_probe, patch.branch, static_cast<double>(known_->most_m(patch)));
  }
  branches_->fold();
}

void plane_depth::sort_by_depth(std::span<const near_patch> patches) noexcept {
  constexpr std::size_t bins = 64;
  std::array<std::uint32_t, bins + 1> first{};
  const auto bin_of = [&](const near_patch& p) noexcept {
    const double from_top = (reach_m_ - p.in_other.most_m) * static_cast<double>(bins) / (2.0 * reach_m_);
    return from_top > 0.0 ? static_cast<std::size_t>(std::min(from_top, static_cast<double>(bins - 1))) : 0;
  };
  for (const near_patch& p : patches) ++first[bin_of(p) + 1];
  for (std::size_t b = 0; b < bins; ++b) first[b + 1] += first[b];
  order_.resize(patches.size());
  for (std::size_t i = 0; i < patches.size(); ++i) order_[first[bin_of(patches[i])]++] = static_cast<std::uint32_t>(i);
}

struct plane_depth::told_from {
  double always_m;  // gaps up to this are reported whatever lies before them
  double least_m;   // and none beyond this

  // Above which depth a leaf's plane is told.
  [[nodiscard]] double above_m(const first_met::group* group, const first_met::depths& moved) const noexcept {
    if (group == nullptr) return least_m;
    return std::max(least_m, std::min(-always_m, first_met::least_that_matters_m(*group, moved)));
  }
};

plane_depth::told_from plane_depth::told_of(const near_patch& patch) const noexcept {
  const double back_m = ways_[patch.body].back_m;
  // What stands back is read a little further than it is told, so that it comes forward as the probe leaves it.
  return {.always_m = std::min(reach_m_ / 9.0, told_m_ / 5.0) - back_m,
          .least_m = back_m > 0.0 ? back_m - 1.25 * told_m_ : -told_m_};
}

[[gnu::flatten]] bool plane_depth::look_through(const near_patch& patch, std::span<const near_leaf> leaves,
                                                const leaf_reader& reader, bool alone,
                                                std::span<near_plane> out) const noexcept {
  const told_from told = told_of(patch);
  const vec3 slope_w = reader.by_probe_w(patch.in_other.slope);
  const first_met::group* group = met_->find_group(patch.body, slope_w);
  first_met::depths moved;
  if (group != nullptr) {
    met_->moved(*group, slope_w, reader.from_centre_of_mass_w(patch.ball.centre_b), moved);
  }
  std::optional<first_met::group> with_own;  // what is met first of the group and of this patch's leaves
  double above_m = told.above_m(group, moved);
  bool any = false;
  const auto most_of_patch_m = leaf_reader::rounded_up(patch.in_other.most_m);
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    const near_leaf& leaf = leaves[i];
    const std::span<float> known = known_->of(patch.first_leaf + i);
    std::size_t may_matter = leaf.count - known.size();
    for (float& m : known) {
      m = std::min(m, most_of_patch_m);
      may_matter += static_cast<double>(m) > above_m ? 1 : 0;
    }
    out[i].plane.depth_m = -std::numeric_limits<double>::infinity();
    if (may_matter == 0) continue;
    // One reading may dismiss all of them, at the price of a few quick ones.
    depth_bound near;
    if (may_matter >= 4) {
      near = reader.bound_of(leaf);
      if (!(near.most_m > above_m)) {
        for (float& m : known) m = std::min(m, leaf_reader::rounded_up(near.most_m));
        continue;
      }
    }
    out[i] = reader.deepest(leaf, near, above_m, known);
    if (!(out[i].plane.depth_m > above_m)) continue;
    any = true;
    if (group != nullptr) {
      if (!with_own) with_own = *group;
    } else if (alone) {
      // Of several patches at a time another one may have a group for this direction first.
      if (!with_own && (with_own = met_->next_group(patch.body, slope_w))) {
        met_->moved(*with_own, slope_w, reader.from_centre_of_mass_w(patch.ball.centre_b), moved);
      }
    }
    if (!with_own) continue;
    first_met::add(*with_own, moved, out[i].plane.depth_m);
    above_m = told.above_m(&*with_own, moved);
  }
  return any;
}

void plane_depth::keep_what_matters(const near_patch& patch, const leaf_reader& reader,
                                    std::span<near_plane> out) noexcept {
  // The pose alone decides which patches have a plane, and only these are compared with others. So it decides which
  // planes are reported; a patch without a plane may be listed or not.
  const told_from told = told_of(patch);
  const vec3 slope_w = reader.by_probe_w(patch.in_other.slope);
  first_met::group* group = met_->find_group(patch.body, slope_w);
  first_met::depths moved;
  const auto move = [&]() noexcept {
    if (group != nullptr) met_->moved(*group, slope_w, reader.from_centre_of_mass_w(patch.ball.centre_b), moved);
  };
  move();
  for (near_plane& p : out) {
    if (!(p.plane.depth_m > told.above_m(group, moved))) {
      p.plane.depth_m = -std::numeric_limits<double>::infinity();
      continue;
    }
    if (group == nullptr) {
      group = met_->add_group(patch.body, slope_w);
      move();
    }
    if (group != nullptr) first_met::add(*group, moved, p.plane.depth_m);
  }
}

std::size_t plane_depth::heap_bytes() const noexcept {
  return asperity::heap_bytes(reported_, order_, has_plane_, ways_, parts_) + sizeof(plane_watch) +
         watch_->heap_bytes() + sizeof(plane_materials) + materials_->heap_bytes() + sizeof(first_met) +
         sizeof(known_depths) + sizeof(vec6) + (reader_ ? sizeof(surface_reader) + reader_->heap_bytes() : 0) +
         known_->heap_bytes() + (branches_ ? sizeof(known_branches) + branches_->heap_bytes() : 0) +
         sizeof(field_scene) + bodies_->heap_bytes();
}

}  // namespace asperity
