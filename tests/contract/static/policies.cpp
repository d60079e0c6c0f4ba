// Each policy concept accepts the least that keeps its contract, and rejects what only looks like it.

#include <asperity/planes/near_samples.hpp>
#include <asperity/render/renderer.hpp>

namespace {

using namespace asperity;

struct finder {
  using policy_tag = collision_tag;
  status find(const scene_pose&, contact_set&) noexcept { return status::ok; }
};
struct finder_may_throw {
  using policy_tag = collision_tag;
  status find(const scene_pose&, contact_set&) { return status::ok; }
};
struct finder_answers_bool {
  using policy_tag = collision_tag;
  bool find(const scene_pose&, contact_set&) noexcept { return true; }
};
struct finder_without_tag {
  status find(const scene_pose&, contact_set&) noexcept { return status::ok; }
};
struct finder_with_wrong_tag {
  using policy_tag = depth_tag;
  status find(const scene_pose&, contact_set&) noexcept { return status::ok; }
};
struct finder_wants_to_change_poses {
  using policy_tag = collision_tag;
  status find(scene_pose&, contact_set&) noexcept { return status::ok; }
};
static_assert(collision_finder<finder>);
static_assert(!collision_finder<finder_may_throw>);
static_assert(!collision_finder<finder_answers_bool>);
static_assert(!collision_finder<finder_without_tag>);
static_assert(!collision_finder<finder_with_wrong_tag>);
static_assert(!collision_finder<finder_wants_to_change_poses>);
static_assert(!collision_finder<int>);

struct depth {
  using policy_tag = depth_tag;
  status measure(const scene_pose&, const contact_set&, std::span<penetration>) noexcept { return status::ok; }
};
struct depth_may_throw {
  using policy_tag = depth_tag;
  status measure(const scene_pose&, const contact_set&, std::span<penetration>) { return status::ok; }
};
struct depth_answers_nothing {
  using policy_tag = depth_tag;
  void measure(const scene_pose&, const contact_set&, std::span<penetration>) noexcept {}
};
struct depth_without_tag {
  status measure(const scene_pose&, const contact_set&, std::span<penetration>) noexcept { return status::ok; }
};
struct depth_one_at_a_time {
  using policy_tag = depth_tag;
  status measure(const scene_pose&, const contact&, penetration&) noexcept { return status::ok; }
};
struct depth_changes_contacts {
  using policy_tag = depth_tag;
  status measure(const scene_pose&, contact_set&, std::span<penetration>) noexcept { return status::ok; }
};
static_assert(depth_backend<depth>);
static_assert(!depth_backend<depth_may_throw>);
static_assert(!depth_backend<depth_answers_nothing>);
static_assert(!depth_backend<depth_without_tag>);
static_assert(!depth_backend<depth_one_at_a_time>);
static_assert(!depth_backend<depth_changes_contacts>);
static_assert(!depth_backend<finder>);

struct force {
  using policy_tag = force_tag;
  status accumulate(const scene_pose&, const contact_set&, std::span<const penetration>, force_report&) noexcept {
    return status::ok;
  }
};
struct force_may_throw {
  using policy_tag = force_tag;
  status accumulate(const scene_pose&, const contact_set&, std::span<const penetration>, force_report&) {
    return status::ok;
  }
};
struct force_without_tag {
  status accumulate(const scene_pose&, const contact_set&, std::span<const penetration>, force_report&) noexcept {
    return status::ok;
  }
};
struct force_without_report {
  using policy_tag = force_tag;
  status accumulate(const scene_pose&, const contact_set&, std::span<const penetration>, contact_force&) noexcept {
    return status::ok;
  }
};
struct force_changes_depths {
  using policy_tag = force_tag;
  status accumulate(const scene_pose&, const contact_set&, std::span<penetration>, force_report&) noexcept {
    return status::ok;
  }
};
static_assert(force_model<force>);
static_assert(!force_model<force_may_throw>);
static_assert(!force_model<force_without_tag>);
static_assert(!force_model<force_without_report>);
static_assert(!force_model<force_changes_depths>);
static_assert(!force_model<depth>);

// A stage may know support planes; one that might throw, or hands out what others may change, does not count.
struct knows_planes {
  std::span<const support_plane> support_planes() const noexcept { return {}; }
};
struct planes_may_throw {
  std::span<const support_plane> support_planes() const { return {}; }
};
struct planes_may_be_changed {
  std::span<support_plane> support_planes() const noexcept { return {}; }
};
struct planes_change_the_stage {
  std::span<const support_plane> support_planes() noexcept { return {}; }
};
static_assert(reports_support_planes<knows_planes>);
static_assert(!reports_support_planes<planes_may_throw>);
static_assert(!reports_support_planes<planes_may_be_changed>);
static_assert(!reports_support_planes<planes_change_the_stage>);
static_assert(!reports_support_planes<depth>);

// The renderer takes exactly three policies, each in its place.
template <class... Policies>
concept makes_a_renderer = requires {
  typename basic_renderer<Policies...>;
};
static_assert(makes_a_renderer<finder, depth, force>);
static_assert(!makes_a_renderer<depth, finder, force>);
static_assert(!makes_a_renderer<finder, depth, force_may_throw>);
static_assert(noexcept(std::declval<basic_renderer<finder, depth, force>&>().step(std::declval<const scene_pose&>(),
                                                                                  std::declval<tick&>())));

// Policies of the other kind hand on near samples and their planes; the three must agree.
struct sample_finder_like {
  using policy_tag = collision_tag;
  using found_type = near_samples;
  status find(const scene_pose&, near_samples&) noexcept { return status::ok; }
};
struct sample_depth_like {
  using policy_tag = depth_tag;
  using found_type = near_samples;
  using reading_type = near_plane;
  status measure(const scene_pose&, const near_samples&, std::span<near_plane>) noexcept { return status::ok; }
};
struct sample_force_like {
  using policy_tag = force_tag;
  using found_type = near_samples;
  using reading_type = near_plane;
  status accumulate(const scene_pose&, const near_samples&, std::span<const near_plane>, force_report&) noexcept {
    return status::ok;
  }
};
static_assert(collision_finder<sample_finder_like> && depth_backend<sample_depth_like> &&
              force_model<sample_force_like>);
static_assert(makes_a_renderer<sample_finder_like, sample_depth_like, sample_force_like>);
static_assert(!makes_a_renderer<finder, sample_depth_like, sample_force_like>);
static_assert(!makes_a_renderer<sample_finder_like, depth, sample_force_like>);
static_assert(!makes_a_renderer<sample_finder_like, sample_depth_like, force>);
static_assert(!makes_a_renderer<finder, depth, sample_force_like>);
static_assert(!makes_a_renderer<sample_finder_like, depth, force>);

// They agree on what was found, and not on what is read of it.
struct depth_of_penetrations {
  using policy_tag = depth_tag;
  using found_type = near_samples;
  status measure(const scene_pose&, const near_samples&, std::span<penetration>) noexcept { return status::ok; }
};
static_assert(depth_backend<depth_of_penetrations>);
static_assert(!makes_a_renderer<sample_finder_like, depth_of_penetrations, sample_force_like>);

// Saying one thing and taking another is no policy.
struct finder_of_two_minds {
  using policy_tag = collision_tag;
  using found_type = near_samples;
  status find(const scene_pose&, contact_set&) noexcept { return status::ok; }
};
struct force_of_two_minds {
  using policy_tag = force_tag;
  using found_type = near_samples;
  using reading_type = near_plane;
  status accumulate(const scene_pose&, const near_samples&, std::span<const penetration>, force_report&) noexcept {
    return status::ok;
  }
};
static_assert(!collision_finder<finder_of_two_minds>);
static_assert(!force_model<force_of_two_minds>);

}  // namespace
