// The wrench changes only as fast as the motion explains, at any tick rate (C1, C2, C9 of the acceptance numbers).
#include <algorithm>
#include <cstdio>
#include <gtest/gtest.h>

#include "contact_meter.hpp"

namespace {

using namespace asperity;
using namespace asperity::contacts_test;

/// Largest change that the scene may show, in units of k dx and of k dx lever.
struct allowance {
  double tau_m = contacts_test::tau_m;
  double force = 1.5;
  double torque = 15.0;
};

void expect_no_jump(const contact_scene& s, const allowance& allowed) {
  SCOPED_TRACE(s.name);
  built_renderer r = make_scene_renderer(s, scene_settings(allowed.tau_m));
  double most_n = 0.0;
  for (double t = 0.0; t <= 1.0; t += 0.05) most_n = std::max(most_n, glm::length(wrench_at(r, s.path(t)).force));
  EXPECT_GT(most_n, 0.5);  // nothing changes where nothing is felt
  const continuity c = measure_continuity(r, s, 20);
  std::printf("%-14s tau %.2f mm: |dF| %6.3f at 1 kHz, %6.3f at 10 kHz; |dT| %6.3f, %6.3f\n", s.name.c_str(),
              allowed.tau_m / mm, c.slow.force, c.fast.force, c.slow.torque, c.fast.torque);
  EXPECT_LE(c.fast.force, allowed.force) << "at path parameter " << c.fast.at;
  EXPECT_LE(c.slow.force, allowed.force) << "at path parameter " << c.slow.at;
  EXPECT_LE(c.force_ratio(), 2.0);
  EXPECT_LE(c.fast.torque, allowed.torque);
  EXPECT_LE(c.torque_ratio(), 2.0);
}

TEST(Continuity, SlideOnAFace) { expect_no_jump(slide(), {}); }
TEST(Continuity, SlideOffOverAnEdge) { expect_no_jump(slide_off(), {}); }
TEST(Continuity, RockingFlat) { expect_no_jump(rocking(), {}); }
TEST(Continuity, TippingOverAnEdge) { expect_no_jump(tipping(), {}); }
TEST(Continuity, ConcaveCorner) { expect_no_jump(concave_corner(), {}); }
TEST(Continuity, VGroove) { expect_no_jump(v_groove(), {}); }
TEST(Continuity, PegInHole) { expect_no_jump(peg_in_hole(), {}); }
TEST(Continuity, Graze) { expect_no_jump(graze(), {}); }
TEST(Continuity, EdgeOnEdge) { expect_no_jump(edge_on_edge(), {}); }

// Where a face gives way to another over a ridge, two slopes compete over a depth of tau: stiff, but not a jump. The
// limit is a number of tau's, not of ticks.
TEST(Continuity, SteppedBlockOverRidges) {
  expect_no_jump(stepped_block(), {.force = 12.0});
  expect_no_jump(stepped_block(), {.tau_m = 0.05 * mm, .force = 3.0});
}

// Peaks of 0.05 mm on both bodies: a force that rises and falls with the relief, faster than a plain face's, and no
// jump.
TEST(Continuity, TexturedSlide) {
  renderer_settings settings = scene_settings();
  settings.cells.sample_pitch_m = 0.6 * mm;
  contact_scene s = slide();
  built_renderer r = make_waved_renderer(s, true, settings);
  const continuity c = measure_continuity(r, s, 20);
  std::printf("textured slide               : |dF| %6.3f at 1 kHz, %6.3f at 10 kHz; |dT| %6.3f, %6.3f\n", c.slow.force,
              c.fast.force, c.slow.torque, c.fast.torque);
  EXPECT_LE(c.fast.force, 1.5);
  EXPECT_LE(c.force_ratio(), 2.0);
  EXPECT_LE(c.fast.torque, 15.0);
  EXPECT_LE(c.torque_ratio(), 2.0);
}

/// The paper's clusters on the same path. Every triangle is a piece, each face of four or eight of them. The finder
/// remembers its contacts and holds one that it has seen before, so each rate walks the whole path with a renderer of
/// its own: after the end of the path, a contact further back would be held that is new to who comes along the path.
continuity of_the_paper(const contact_scene& s) {
  model_plan plan;
  plan.halvings = 1;
  const auto ticks = static_cast<std::size_t>(path_length(s) / slow_step_m);
  const auto at_rate = [&](std::size_t times) {
    built_paper_renderer r = value_of(build_paper_renderer({make_model(s.probe, plan), {make_model(s.fixed, plan)}}));
    return largest(walk(r, s, 0.0, 1.0, times * ticks));
  };
  const continuity c{at_rate(1), at_rate(10)};
  std::printf("%-14s the paper's:  |dF| %6.3f at 1 kHz, %6.3f at 10 kHz\n", s.name.c_str(), c.slow.force, c.fast.force);
  return c;
}

// The control: a formulation that does jump is found out by the same measure. Slid on one face alone the paper's is no
// control, because it sees one contact from beginning to end.
TEST(Continuity, ThePapersClustersJump) {
  for (const contact_scene& s : {slide_off(), rocking(), v_groove()}) {
    SCOPED_TRACE(s.name);
    const continuity c = of_the_paper(s);
    EXPECT_GT(c.force_ratio(), 5.0);
    EXPECT_GT(c.fast.force, 50.0);
  }
}

// A face that slides off presses harder before it lets go: its samples fade while the edge takes over.
TEST(Continuity, SlideOffPressesLittleHarder) {
  const contact_scene s = slide_off();
  built_renderer r = make_scene_renderer(s, scene_settings());
  const double on_the_face = glm::length(wrench_at(r, s.path(0.0)).force);
  double most = 0.0;
  for (double t = 0.0; t < 1.1; t += 0.002) most = std::max(most, glm::length(wrench_at(r, s.path(t)).force));
  std::printf("slide-off: %.3f N on the face, at most %.3f N (%.2f times)\n", on_the_face, most, most / on_the_face);
  EXPECT_GT(on_the_face, 0.7);  // 0.4 mm deep, and tilted
  EXPECT_LE(most, 1.6 * on_the_face);
  EXPECT_EQ(glm::length(wrench_at(r, s.path(1.1)).force), 0.0);
}

// Near an edge, where a sample is deeper than its clearance, its depth falls as it goes deeper: the price of letting go
// without a jump. What comes of it is a pull, here downwards onto a body that lies below; this bounds it.
TEST(Continuity, APullNearEdgesIsSmall) {
  const contact_scene s = stepped_block();
  for (const double tau : {0.02 * mm, 0.05 * mm}) {
    built_renderer r = make_scene_renderer(s, scene_settings(tau));
    constexpr int ticks = 1000;
    double push_n = 0.0, pull_n = 0.0;
    int pulling = 0;
    for (int i = 0; i <= ticks; ++i) {
      const double up_n = wrench_at(r, s.path(static_cast<double>(i) / ticks)).force.z;
      push_n = std::max(push_n, up_n);
      pull_n = std::max(pull_n, -up_n);
      pulling += up_n < 0.0 ? 1 : 0;
    }
    std::printf("%s, tau %.2f mm: pushes by up to %.2f N, pulls by up to %.2f N, in %.1f %% of the ticks\n",
                s.name.c_str(), tau / mm, push_n, pull_n, 100.0 * pulling / ticks);
    EXPECT_GT(push_n, 0.5);
    EXPECT_LT(pull_n, (tau < 0.03 * mm ? 0.25 : 0.1) * push_n);
    EXPECT_LT(pulling, ticks / 50);
  }
}

}  // namespace
