// Which planes a tick of the plane renderer tells: what bounds leave out is what nobody meets, and what a renderer
// knows from ticks before changes nothing.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <gtest/gtest.h>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "asperity/field/field_body.hpp"
#include "asperity/planes/plane_renderer.hpp"
#include "planes/ball_bound.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"
#include "support/small_models.hpp"
#include "unit/planes/ridged_scene.hpp"
#include "unit/planes/scene_with_fields.hpp"

namespace asperity {
namespace {

using namespace test_support;

void expect_same(std::span<const support_plane> a, std::span<const support_plane> b, int n) {
  ASSERT_EQ(a.size(), b.size()) << "tick " << n;
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].sample, b[i].sample) << "tick " << n;
    EXPECT_EQ(a[i].body, b[i].body);
    EXPECT_EQ(a[i].depth_m, b[i].depth_m);
    EXPECT_EQ(a[i].gradient.angular, b[i].gradient.angular);
  }
}

// Steps of a slow hand, of a fast one, and leaps: a renderer that went all the way tells what a new one tells.
TEST(ToldPlanes, DoNotDependOnTheTicksBefore) {
  draws draw{
      std::mt19937_64(fresh_seed("ToldPlanes.DoNotDependOnTheTicksBefore", "10 walks of 20 ticks, 40 at length"))};
  plane_renderer old = make_ridged();
  const std::vector<pose> T_wb{{draw.rotation(), vec3(0.0)}, {draw.rotation(), {0.0, 0.02, 0.02}}};
  std::size_t reported = 0;
  const int walks = extent(10, 40);
  for (int walk = 0; walk < walks; ++walk) {
    pose T_wa = laid_down(draw, old, T_wb, 1e-4 * draw.unit());
    const double step_m = walk % 3 == 0 ? 1e-6 : (walk % 3 == 1 ? 5e-5 : 3e-4);
    for (int n = 0; n < 20; ++n) {
      T_wa.position += step_m * draw.vector();
      T_wa.rotation = glm::normalize(exp_rotation(20.0 * step_m * draw.vector()) * T_wa.rotation);
      plane_renderer fresh = make_ridged();
      tick a, b;
      ASSERT_EQ(old.step({T_wa, T_wb}, a), status::ok);
      ASSERT_EQ(fresh.step({T_wa, T_wb}, b), status::ok);
      expect_same(a.planes, b.planes, n);
      reported += a.planes.size();
      EXPECT_EQ(a.force.on_probe_w.force, b.force.on_probe_w.force);
      // Questions about poses near by: the old renderer is asked for a few, the new one for the last alone.
      vec6 moved{};
      plane_list of_old, of_fresh;
      for (int q = 0; q < 4; ++q) {
        moved = {1e-4 * draw.vector(), 3e-3 * draw.vector()};
        ASSERT_EQ(old.planes_at(moved, -1e-5, of_old) == status::invalid_pose, false);
      }
      static_cast<void>(fresh.planes_at(moved, -1e-5, of_fresh));
      expect_same({of_old.data(), of_old.size()}, {of_fresh.data(), of_fresh.size()}, n);
    }
  }
  EXPECT_GT(reported, 250U * static_cast<std::size_t>(walks));
}

// Bounds are kept for eight pairs of bodies. Among a dozen that the probe meets one after the other, and all at once, a
// renderer that went all the way tells what a new one tells.
TEST(ToldPlanes, DoNotDependOnWhichBodiesWereNearBefore) {
  draws draw{std::mt19937_64(fresh_seed("ToldPlanes.DoNotDependOnWhichBodiesWereNearBefore", "3 tours of 12 bodies"))};
  const auto many = [] {
    scene_with_fields out;
    out.of.probe = ridged().of.probe;
    out.fields = nullptr;
    field_scene fields{ridged().fields->probe, {}};
    for (int b = 0; b < 12; ++b) {
      out.of.fixed.push_back(ridged().of.fixed[b % 2 == 0 ? 0 : 1]);
      fields.fixed.push_back(ridged().fields->fixed[b % 2 == 0 ? 0 : 1]);
    }
    out.fields = std::make_shared<const field_scene>(std::move(fields));
    return out;
  }();
  const plane_renderer_settings roomy{.limits = {.leaves = 100'000}};
  plane_renderer old = make_plane_renderer(many.of, many.fields, roomy).value();
  std::size_t reported = 0;
  for (int tour = 0; tour < 3; ++tour) {
    // In a row; in the last tour in a heap, where the probe is near all of them.
    std::vector<pose> T_wb;
    for (int b = 0; b < 12; ++b) T_wb.push_back({draw.rotation(), {(tour < 2 ? 0.02 : 3e-4) * b, 0.0, -0.012}});
    for (int stop = 0; stop < (tour == 2 ? extent(4, 12) : 12); ++stop) {
      pose T_wa{draw.rotation(), T_wb[draw.bits() % 12U].position + vec3(0.0, 0.0, 0.012)};
      if (tour == 2) T_wa = laid_down(draw, old, T_wb, 1e-4 * draw.unit());
      for (int n = 0; n < 5; ++n) {
        T_wa.position += 2e-4 * draw.vector();
        tick x, y;
        ASSERT_EQ(old.step({T_wa, T_wb}, x), status::ok);
        if (!at_length() && n != 4) continue;  // making the new one takes most of the time
        plane_renderer fresh = make_plane_renderer(many.of, many.fields, roomy).value();
        ASSERT_EQ(fresh.step({T_wa, T_wb}, y), status::ok);
        expect_same(x.planes, y.planes, n);
        reported += x.planes.size();
      }
    }
  }
  EXPECT_GT(reported, extent(100U, 1000U));
}

// Every sample that is near has a plane beside it that is as deep, at the tick's pose and at poses that are asked for.
TEST(ToldPlanes, HoldEverySampleThatIsNear) {
  draws draw{std::mt19937_64(fresh_seed("ToldPlanes.HoldEverySampleThatIsNear", "20 poses, 60 at length"))};
  plane_renderer feel = make_ridged();
  const std::vector<pose> T_wb{{draw.rotation(), vec3(0.0)}, {draw.rotation(), {0.0, 0.02, 0.02}}};
  const vec3 c_a = feel.scene().probe->mass.centre_of_mass;
  int near = 0, asked_near = 0;
  const int poses = extent(20, 60);
  for (int n = 0; n < poses; ++n) {
    const pose T_wa = laid_down(draw, feel, T_wb, n % 2 == 0 ? 2e-6 : 3e-4);
    tick t;
    ASSERT_EQ(feel.step({T_wa, T_wb}, t), status::ok);
    const vec6 moved{5e-6 * draw.vector(), 1e-4 * draw.vector()};
    plane_list asked;
    const bool all_asked = feel.planes_at(moved, -1e-5, asked) == status::ok;
    const quat turn = exp_rotation(moved.angular);
    const vec3 c_w = T_wa * c_a;
    const pose moved_wa{glm::normalize(turn * T_wa.rotation), c_w + moved.linear + turn * (T_wa.position - c_w)};
    const auto look = [&](const pose& T, std::span<const support_plane> planes, double above_m, double beside_m,
                          int& count) {
      for (std::size_t b = 0; b < T_wb.size(); ++b) {
        const field_body &A = *ridged().fields->probe, &B = *ridged().fields->fixed[b];
        for (const bool of_probe : {true, false}) {
          const field_body &x = of_probe ? A : B, &y = of_probe ? B : A;
          const pose T_wx = of_probe ? T : T_wb[b], T_yx = inverse(of_probe ? T_wb[b] : T) * T_wx;
          for (const field_sample& s : x.samples.samples()) {
            const vec3 p_y = T_yx * vec3(s.position_b);
            if (y.field.coarse(p_y).value_m + y.field.highest_relief_m < above_m) continue;
            const field_reading d = y.field.read(p_y);
            const double steep = glm::length(d.slope);
            // One that looks away sinks, and holds nothing.
            const double facing = glm::dot(T_yx.rotation * vec3(s.axis_b), d.slope) / std::max(1e-9, steep);
            const double full = std::cos(std::min(3.1, static_cast<double>(s.cone_rad) + 0.03));
            if (!(d.value_m > above_m) || !(steep > 0.06) || !(facing > full)) continue;
            ++count;
            const vec3 r_w = T_wx * vec3(s.position_b) - T * c_a;
            constexpr double single_precision_m = 1e-9;
            const bool held = std::any_of(planes.begin(), planes.end(), [&](const support_plane& p) {
              return p.body == b && p.depth_m >= d.value_m - single_precision_m && glm::length(p.r_w - r_w) <= beside_m;
            });
            EXPECT_TRUE(held) << "pose " << n << ", depth " << 1e6 * d.value_m << " um";
          }
        }
      }
    };
    const double leaf_m = 0.003 * 8.0 * feel.scene().fixed[0]->box.diagonal();
    look(T_wa, t.planes, -0.99e-4, leaf_m, near);
    if (all_asked) look(moved_wa, {asked.data(), asked.size()}, -0.99e-5, 1e-9, asked_near);
  }
  EXPECT_GT(near, 4 * poses);
  EXPECT_GT(asked_near, poses / 2);
}

// A hand turns by 5 rad/s and slides by 0.1 m/s. Where it is after a period of a loop, planes of the pose before know
// how deep it is; those that are near alone do not.
TEST(ToldPlanes, KnowWhatMotionsMeetFirst) {
  draws draw{std::mt19937_64(fresh_seed("ToldPlanes.KnowWhatMotionsMeetFirst", "60 poses, 20 motions each"))};
  plane_renderer feel = make_ridged();
  const std::vector<pose> T_wb{{draw.rotation(), vec3(0.0)}, {draw.rotation(), {0.0, 0.02, 0.02}}};
  const vec3 c_a = feel.scene().probe->mass.centre_of_mass;
  int met = 0, unknown = 0, unknown_to_near = 0;
  for (int n = 0; n < 60; ++n) {
    const pose T_wa = laid_down(draw, feel, T_wb, 2e-6);
    tick t;
    ASSERT_EQ(feel.step({T_wa, T_wb}, t), status::ok);
    const std::vector<support_plane> before(t.planes.begin(), t.planes.end());
    for (int m = 0; m < 20; ++m) {
      const double turn_rad = m % 2 == 0 ? 5e-3 : 4e-2;
      const vec6 moved{5e-5 * draw.vector(), turn_rad * glm::normalize(draw.vector())};
      const quat turn = exp_rotation(moved.angular);
      const vec3 c_w = T_wa * c_a;
      const pose there{glm::normalize(turn * T_wa.rotation), c_w + moved.linear + turn * (T_wa.position - c_w)};
      ASSERT_EQ(feel.step({there, T_wb}, t), status::ok);
      const double true_m = deepest_m(t);
      if (!(true_m > 2e-5)) continue;
      double said_m = -1.0, near_said_m = -1.0;
      for (const support_plane& p : before) {
        const double there_m = p.depth_m + dot(p.gradient, moved);
        said_m = std::max(said_m, there_m);
        if (p.depth_m > -2e-5) near_said_m = std::max(near_said_m, there_m);
      }
      ++met;
      unknown += said_m < 0.5 * true_m ? 1 : 0;
      unknown_to_near += near_said_m < 0.5 * true_m ? 1 : 0;
    }
  }
  std::printf("  of %d motions into a body %d were not known, and %d would not be by near planes alone\n", met, unknown,
              unknown_to_near);
  EXPECT_GT(met, 300);
  // 1.3 % are unknown in the mean of eleven seeds, and 4 % by near planes alone; of so few motions it may be twice that.
  EXPECT_LT(unknown, 0.03 * met);
  EXPECT_GT(unknown_to_near, unknown + 4);
}

// A fifth of the gaps that are asked for is told whatever lies before it. So two renderers tell the same planes up to
// there, though the one with three times the reach tries larger motions and hides less beyond.
TEST(ToldPlanes, TellNearSurfaceWhateverLiesBeforeIt) {
  draws draw{std::mt19937_64(fresh_seed("ToldPlanes.TellNearSurfaceWhateverLiesBeforeIt", "12 poses"))};
  plane_renderer usual = make_ridged();
  plane_renderer far = make_plane_renderer(ridged().of, ridged().fields, {.reach_m = 5.4e-3}).value();
  const std::vector<pose> T_wb{{draw.rotation(), vec3(0.0)}, {draw.rotation(), {0.0, 0.02, 0.02}}};
  constexpr double gaps_m = 1e-3, near_m = 0.99 * gaps_m / 5.0;
  const auto near_of = [&](plane_renderer& feel, const pose& T_wa) {
    tick t;
    EXPECT_EQ(feel.step({T_wa, T_wb, gaps_m}, t), status::ok);
    std::vector<std::pair<std::uint32_t, double>> out;
    for (const support_plane& p : t.planes) {
      if (p.depth_m > -near_m) out.emplace_back(p.sample, p.depth_m);
    }
    std::sort(out.begin(), out.end());
    return out;
  };
  std::size_t told = 0;
  for (int n = 0; n < extent(12, 100); ++n) {
    const pose T_wa = laid_down(draw, usual, T_wb, 1e-4 * draw.unit());
    const auto of_usual = near_of(usual, T_wa);
    EXPECT_EQ(of_usual, near_of(far, T_wa)) << "pose " << n;
    told += of_usual.size();
  }
  EXPECT_GT(told, 50U);
}

// No sample of a ball is deeper than its bound, for balls of samples anywhere beside another body.
TEST(ToldPlanes, BallsBoundTheirSamples) {
  draws draw{std::mt19937_64(fresh_seed("ToldPlanes.BallsBoundTheirSamples", "30 poses"))};
  const field_body &A = *ridged().fields->probe, &B = *ridged().fields->fixed[0];
  int balls = 0;
  double sum_over_m = 0.0;
  for (int n = 0; n < 30; ++n) {
    const pose T_ba{draw.rotation(), vec3(0.035, 0.035, 0.015) * draw.vector()};
    A.samples.query(
        [&](const sample_ball& ball, bool is_leaf) noexcept {
          if (is_leaf) return sample_tree::branch_answer::taken;
          return ball.radius_m < 1.5e-3 ? sample_tree::branch_answer::taken : sample_tree::branch_answer::open;
        },
        [&](const sample_ball& ball, std::span<const field_sample> samples) noexcept {
          const depth_bound bound = bound_of_ball(B.field, T_ba, ball);
          double most_m = -1.0;
          for (const field_sample& s : samples) {
            const vec3 p_b = T_ba * vec3(s.position_b);
            const double depth_m = B.field.read(p_b).value_m;
            most_m = std::max(most_m, depth_m);
            EXPECT_LE(depth_m, bound.most_at(p_b - T_ba * ball.centre_b));
          }
          EXPECT_LE(most_m, bound.most_m);
          ++balls;
          sum_over_m += bound.most_m - most_m;
        });
  }
  EXPECT_GT(balls, 2000);
  EXPECT_LT(sum_over_m / balls, 1.2e-3) << "on average a bound is too large by this";
}

}  // namespace
}  // namespace asperity
