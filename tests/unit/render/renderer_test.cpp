// The renderer alone, with policies that answer what the test tells them to.
#include "asperity/render/renderer.hpp"

#include <algorithm>
#include <array>
#include <gtest/gtest.h>
#include <limits>
#include <vector>

#include "asperity/planes/near_samples.hpp"
#include "asperity/render/force_model.hpp"

namespace {

using namespace asperity;

struct script {
  std::size_t contacts = 1;
  status found = status::ok;
  status measured = status::ok;
  status summed = status::ok;
  vec3 force{0, 0, 1};
  int finds = 0, measures = 0, sums = 0;
};

struct scripted_finder {
  using policy_tag = collision_tag;
  script* s;
  status find(const scene_pose&, contact_set& out) noexcept {
    ++s->finds;
    for (std::size_t i = 0; i < s->contacts; ++i) out.add({}, {}, {});
    return s->found;
  }
};
struct scripted_depth {
  using policy_tag = depth_tag;
  script* s;
  status measure(const scene_pose&, const contact_set& c, std::span<penetration> out) noexcept {
    ++s->measures;
    EXPECT_EQ(c.size(), out.size());
    return s->measured;
  }
};
struct scripted_force {
  using policy_tag = force_tag;
  script* s;
  status accumulate(const scene_pose&, const contact_set& found, std::span<const penetration> depths,
                    force_report& out) noexcept {
    ++s->sums;
    out = {{{s->force, {}}, {}}, found.contacts(), depths};
    return s->summed;
  }
};

/// Policies of the other kind: near samples, their planes, and contacts that the force model tells.
struct scripted_samples {
  using policy_tag = collision_tag;
  using found_type = near_samples;
  script* s;
  status find(const scene_pose&, near_samples& out) noexcept {
    ++s->finds;
    out.clear();
    for (std::size_t i = 0; i < s->contacts; ++i) out.add({});
    return s->found;
  }
};
struct scripted_readings {
  using policy_tag = depth_tag;
  using found_type = near_samples;
  using reading_type = near_plane;
  script* s;
  status measure(const scene_pose&, const near_samples& found, std::span<near_plane> out) noexcept {
    ++s->measures;
    EXPECT_EQ(found.size(), out.size());
    for (std::size_t i = 0; i < out.size(); ++i) out[i].plane.depth_m = 1e-3 * static_cast<double>(i + 1);
    return s->measured;
  }
};
struct reporting_force {
  using policy_tag = force_tag;
  using found_type = near_samples;
  using reading_type = near_plane;
  script* s;
  std::size_t tells = 2;
  std::vector<double> read{};
  reported_contacts reported{};
  status accumulate(const scene_pose&, const near_samples&, std::span<const near_plane> readings,
                    force_report& out) noexcept {
    ++s->sums;
    read.clear();
    for (const near_plane& r : readings) read.push_back(r.plane.depth_m);
    reported.clear();
    for (std::size_t i = 0; i < tells; ++i) {
      contact c;
      c.id = static_cast<std::uint32_t>(i);
      if (!reported.add(c, {.depth_m = 0.5 * static_cast<double>(i)})) break;
    }
    out = {{{s->force, {}}, {}}, reported.contacts(), reported.depths()};
    return s->summed;
  }
};

scene one_fixed_body() {
  auto probe = std::make_shared<textured_model>();
  probe->mass.centre_of_mass = {0.1, 0.0, 0.0};
  return {probe, {std::make_shared<textured_model>()}};
}

struct renderer_test : testing::Test {
  script s;
  basic_renderer<scripted_finder, scripted_depth, scripted_force> renderer{
      one_fixed_body(), scripted_finder{&s}, scripted_depth{&s}, scripted_force{&s}, contact_limits{4, 16}};
  std::array<pose, 1> fixed{};
  tick out;
};

TEST_F(renderer_test, runs_the_stages_in_order_and_hands_out_what_they_found) {
  s.contacts = 3;
  const pose T_wa{exp_rotation({0, 0, 1}), {1, 2, 3}};
  ASSERT_EQ(renderer.step({T_wa, fixed}, out), status::ok);
  EXPECT_EQ(s.finds + s.measures + s.sums, 3);
  EXPECT_EQ(out.contacts.size(), 3U);
  EXPECT_EQ(out.depths.size(), 3U);
  EXPECT_EQ(out.force.on_probe_w.force.z, 1.0);
  EXPECT_LE(glm::length(out.centre_of_mass_w - T_wa * vec3(0.1, 0, 0)), 1e-15);
}

TEST_F(renderer_test, invalid_poses_stop_before_any_stage) {
  pose bad;
  bad.position.x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(renderer.step({bad, fixed}, out), status::invalid_pose);
  fixed[0].rotation = quat(0, 0, 0, 0);
  EXPECT_EQ(renderer.step({{}, fixed}, out), status::invalid_pose);
  EXPECT_EQ(s.finds, 0);
}

TEST_F(renderer_test, a_wrong_number_of_poses_is_not_ready) {
  EXPECT_EQ(renderer.step({{}, {}}, out), status::not_ready);
}

TEST_F(renderer_test, contacts_that_do_not_fit_are_counted_and_the_rest_is_used) {
  s.contacts = 6;
  s.found = status::capacity_reached;
  EXPECT_EQ(renderer.step({{}, fixed}, out), status::capacity_reached);
  EXPECT_EQ(out.contacts.size(), 4U);
  EXPECT_EQ(out.dropped_contacts, 2U);
  EXPECT_EQ(out.force.on_probe_w.force.z, 1.0);
}

TEST_F(renderer_test, any_failing_stage_leaves_a_zero_wrench) {
  s.found = status::backend_failed;
  EXPECT_EQ(renderer.step({{}, fixed}, out), status::backend_failed);
  EXPECT_EQ(out.force.on_probe_w.force, vec3(0));
  s.found = status::ok;
  s.measured = status::backend_failed;
  EXPECT_EQ(renderer.step({{}, fixed}, out), status::backend_failed);
  EXPECT_EQ(out.force.on_probe_w.force, vec3(0));
  s.measured = status::ok;
  s.summed = status::not_finite;
  EXPECT_EQ(renderer.step({{}, fixed}, out), status::not_finite);
  EXPECT_EQ(out.force.on_probe_w.force, vec3(0));
  s.summed = status::ok;
  s.force.y = std::numeric_limits<double>::infinity();
  EXPECT_EQ(renderer.step({{}, fixed}, out), status::not_finite);
  EXPECT_EQ(out.force.on_probe_w.force, vec3(0));
}

struct renderer_of_samples : testing::Test {
  script s;
  basic_renderer<scripted_samples, scripted_readings, reporting_force> renderer{
      one_fixed_body(), scripted_samples{&s}, scripted_readings{&s}, reporting_force{&s}, near_sample_limits{4}};
  std::array<pose, 1> fixed{};
  tick out;
};

TEST_F(renderer_of_samples, reads_every_leaf_and_hands_out_the_contacts_that_are_reported) {
  s.contacts = 3;
  ASSERT_EQ(renderer.step({{}, fixed}, out), status::ok);
  EXPECT_EQ(renderer.force().read, (std::vector<double>{1e-3, 2e-3, 3e-3}));
  ASSERT_EQ(out.contacts.size(), 2U);
  ASSERT_EQ(out.depths.size(), 2U);
  EXPECT_EQ(out.contacts[1].id, 1U);
  EXPECT_EQ(out.depths[1].depth_m, 0.5);
  EXPECT_EQ(renderer.found().size(), 3U);
  EXPECT_EQ(out.force.on_probe_w.force.z, 1.0);
  EXPECT_EQ(out.dropped_contacts, 0U);
}

/// A depth backend that knows planes.
struct knowing_planes : scripted_depth {
  std::array<support_plane, 2> planes{support_plane{.depth_m = -1e-3}, support_plane{.depth_m = 2e-3}};
  [[nodiscard]] std::span<const support_plane> support_planes() const noexcept { return planes; }
};

TEST_F(renderer_test, hands_out_the_planes_that_a_depth_backend_knows) {
  ASSERT_EQ(renderer.step({{}, fixed}, out), status::ok);
  EXPECT_TRUE(out.planes.empty());
  basic_renderer<scripted_finder, knowing_planes, scripted_force> by_depth{
      one_fixed_body(), scripted_finder{&s}, {{&s}}, scripted_force{&s}};
  ASSERT_EQ(by_depth.step({{}, fixed}, out), status::ok);
  ASSERT_EQ(out.planes.size(), 2U);
  EXPECT_EQ(out.planes[0].depth_m, -1e-3);
  EXPECT_EQ(out.planes.data(), by_depth.depth().planes.data());
  // What failed has none, whatever its stages still hold.
  s.measured = status::backend_failed;
  EXPECT_EQ(by_depth.step({{}, fixed}, out), status::backend_failed);
  EXPECT_TRUE(out.planes.empty());
}

TEST_F(renderer_of_samples, reports_no_more_contacts_than_it_has_room_for) {
  renderer.force().tells = 1000;
  ASSERT_EQ(renderer.step({{}, fixed}, out), status::ok);
  EXPECT_EQ(out.contacts.size(), 64U);
  EXPECT_EQ(out.depths.size(), 64U);
}

TEST_F(renderer_of_samples, leaves_that_do_not_fit_are_counted_and_the_rest_is_used) {
  s.contacts = 6;
  s.found = status::capacity_reached;
  EXPECT_EQ(renderer.step({{}, fixed}, out), status::capacity_reached);
  EXPECT_EQ(out.dropped_contacts, 2U);
  EXPECT_EQ(renderer.force().read.size(), 4U);
  EXPECT_EQ(out.force.on_probe_w.force.z, 1.0);
}

TEST_F(renderer_of_samples, a_failing_stage_leaves_a_zero_wrench_and_no_contacts) {
  ASSERT_EQ(renderer.step({{}, fixed}, out), status::ok);
  s.summed = status::not_finite;
  EXPECT_EQ(renderer.step({{}, fixed}, out), status::not_finite);
  EXPECT_EQ(out.force.on_probe_w.force, vec3(0));
  EXPECT_TRUE(out.contacts.empty());
  s.measured = status::backend_failed;
  EXPECT_EQ(renderer.step({{}, fixed}, out), status::backend_failed);
  EXPECT_TRUE(out.contacts.empty());
  EXPECT_TRUE(out.depths.empty());
}

}  // namespace
