// Closed loops of the probe do no work (C4 of the acceptance numbers).
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <gtest/gtest.h>
#include <numbers>
#include <vector>

#include "asperity/window/window_renderer.hpp"
#include "contact_meter.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"

namespace {

using namespace asperity;
using namespace asperity::contacts_test;

/// Work of a closed loop over all the work exchanged in it. The loop leaves the pose by 0.3 mm and 0.01 rad, in all six
/// directions, and comes back another way.
template <class Renderer>
double loop_work(Renderer& r, const pose& start, std::size_t steps) {
  const vec3 centre_b = r.scene().probe->mass.centre_of_mass;
  const double far = 0.3 * mm, turn = 0.01;
  double work = 0.0, exchanged = 0.0;
  pose last = start;
  wrench before = wrench_at(r, start);
  for (std::size_t i = 1; i <= steps; ++i) {
    const double t = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(steps);
    const vec3 translation =
        far * vec3(std::sin(t), std::cos(2 * t + 0.4) - std::cos(0.4), 0.6 * (std::sin(t + 1) - std::sin(1.0)));
    const vec3 rotation = turn * vec3(std::sin(t + 0.3) - std::sin(0.3), std::cos(t) - 1, std::sin(2 * t));
    const pose now = moved(start, centre_b, translation, rotation);
    const wrench after = wrench_at(r, now);
    const wrench mean = 0.5 * (before + after);
    const double done = glm::dot(mean.force, now * centre_b - last * centre_b) +
                        glm::dot(mean.torque, log_rotation(now.rotation * glm::conjugate(last.rotation)));
    work += done;
    exchanged += std::fabs(done);
    last = now;
    before = after;
  }
  return std::fabs(work) / exchanged;
}

TEST(Loop, ClosedLoopsDoNoWork) {
  const std::vector<contact_scene> scenes{slide(), concave_corner(), v_groove(), stepped_block(), peg_in_hole()};
  const std::uint64_t seed =
      test_support::fresh_seed("closed loops", "1 of 5 scenes, plain and textured; at length all");
  const std::size_t today = test_support::seed_of(seed, "scene") % scenes.size();
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    if (!test_support::at_length() && i != today) continue;
    const contact_scene& s = scenes[i];
    for (const bool textured : {false, true}) {
      SCOPED_TRACE(s.name);
      least_motion_renderer r = make_waved_renderer(s, textured, scene_settings());
      const double part = loop_work(r, s.path(0.37), 1000);
      std::printf("%-14s %-8s loop work %.1e of the work exchanged\n", s.name.c_str(), textured ? "textured" : "plain",
                  part);
      EXPECT_LE(part, 1e-5);
    }
  }
}

TEST(Loop, ThePapersClustersDoWorkInALoop) {
  const contact_scene s = v_groove();
  model_plan plan;
  plan.halvings = 1;
  window_renderer r = value_of(make_window_renderer({make_model(s.probe, plan), {make_model(s.fixed, plan)}}));
  const double part = loop_work(r, s.path(0.37), 1000);
  std::printf("%-14s the paper's: loop work %.1e\n", s.name.c_str(), part);
  EXPECT_GT(part, 1e-3);
}

}  // namespace
