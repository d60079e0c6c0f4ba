// The bounded search for deep samples against one that looks at every sample.
#include "least_motion/posed_samples.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <gtest/gtest.h>
#include <set>
#include <utility>

#include "exit_lab.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"

namespace asperity {
namespace {

using namespace test_support;
using namespace exits;

struct two_boxes {
  field_body_ptr probe = waved_box(vec3(7, 6, 5) * mm, 0.04 * mm, 0.4 * mm);
  field_body_ptr fixed = waved_box(vec3(12, 11, 6) * mm, 0.06 * mm, 0.7 * mm);
  std::shared_ptr<const exit_scene> scene = std::make_shared<const exit_scene>(field_scene{probe, {fixed}});
  std::shared_ptr<const exit_scene> swapped = std::make_shared<const exit_scene>(field_scene{fixed, {probe}});
};

const two_boxes& boxes() {
  static const two_boxes made;
  return made;
}

// D of every sample by its definition, the probe's first.
std::vector<double> all_depths(const pose& T_wa, const pose& T_wb, const vec3& x_w) {
  std::vector<double> out;
  const auto add = [&](const exit_body& of, const exit_body& in, const pose& T_wx, const pose& T_wy, double sign) {
    for (const field_sample& s : of.samples().samples()) {
      const vec3 p_w = T_wx * vec3(s.position_b);
      const body_field& f = in.body->field;
      out.push_back(in.shape.read(inverse(T_wy) * (p_w + sign * x_w)).value_m +
                    in.relief.read(f, inverse(T_wy) * p_w).value_m);
    }
  };
  add(*boxes().scene->probe, *boxes().scene->fixed[0], T_wa, T_wb, 1.0);
  add(*boxes().scene->fixed[0], *boxes().scene->probe, T_wb, T_wa, -1.0);
  return out;
}

pose drawn_pose(drawing& draw) { return {draw.rotation(), 8.0 * mm * draw.vector() + vec3(0.0, 0.0, 8.0 * mm)}; }

TEST(PosedSamples, FindsTheDeepestOfAll) {
  drawing draw{std::mt19937_64(fresh_seed("PosedSamples.FindsTheDeepestOfAll", "20 poses, 60 at length"))};
  posed_samples samples(boxes().scene, vec3(0.0));
  int inside = 0;
  const int poses = extent(20, 60);
  for (int i = 0; i < poses; ++i) {
    pose T_wa = drawn_pose(draw);
    if (i % 8 == 0) T_wa.position.z += 14.0 * mm;  // mostly apart
    const pose T_wb{draw.rotation(), 0.5 * mm * draw.vector()};
    const vec3 x_w = 2.0 * mm * draw.vector();
    samples.place({T_wa, {&T_wb, 1}}, 10'000'000);
    const std::vector<double> all = all_depths(T_wa, T_wb, x_w);
    const double most = *std::max_element(all.begin(), all.end());
    mark m;
    EXPECT_FALSE(samples.deepest(x_w, most + 1e-12, m));
    ASSERT_TRUE(samples.deepest(x_w, most - 0.3 * mm, m));
    EXPECT_NEAR(m.depth_m, most, 1e-12);
    EXPECT_NEAR(samples.depth(m, x_w), most, 1e-12);
    EXPECT_FALSE(samples.count.cut);
    EXPECT_LT(samples.count.spent, all.size());
    inside += most > 0.0 ? 1 : 0;
  }
  EXPECT_GT(inside, poses / 5);
  if (at_length()) {  // few poses may all be inside
    EXPECT_LT(inside, poses);
  }
  std::printf("  %d of %d overlap\n", inside, poses);
}

// What a search has read at a pose bounds what it asks for next; a bound that is too low hides a sample.
TEST(PosedSamples, FindsTheDeepestOfAllAtMotionAfterMotion) {
  drawing draw{std::mt19937_64(fresh_seed("PosedSamples.MotionAfterMotion", "6 poses, 8 motions each"))};
  posed_samples samples(boxes().scene, vec3(0.0)), forgetful(boxes().scene, vec3(0.0));
  std::size_t spent = 0, spent_by_forgetful = 0;  // forgetful takes the pose anew for each search
  for (int i = 0; i < 6; ++i) {
    const pose T_wa = drawn_pose(draw), T_wb{draw.rotation(), 0.5 * mm * draw.vector()};
    samples.place({T_wa, {&T_wb, 1}}, 100'000'000);
    for (int n = 0; n < 8; ++n) {
      const vec3 x_w = n == 0 ? vec3(0.0) : draw.between(0.0, 3.0) * mm * draw.vector();
      const std::vector<double> all = all_depths(T_wa, T_wb, x_w);
      const double most = *std::max_element(all.begin(), all.end());
      const double less = most - draw.between(0.0, 0.3) * mm - 1e-9;
      mark m;
      ASSERT_FALSE(samples.deepest(x_w, most + 1e-12, m)) << i << ", " << n;
      ASSERT_TRUE(samples.deepest(x_w, less, m)) << i << ", " << n;
      ASSERT_NEAR(m.depth_m, most, 1e-12) << i << ", " << n;
      for (const double above_m : {most + 1e-12, less}) {
        forgetful.place({T_wa, {&T_wb, 1}}, 100'000'000);
        ASSERT_EQ(forgetful.deepest(x_w, above_m, m), above_m < most) << i << ", " << n;
        spent_by_forgetful += forgetful.count.spent;
      }
    }
    spent += samples.count.spent;
  }
  // 0.56 to 0.60 of it in 20 seeds; where branches forget, all of it.
  EXPECT_LT(static_cast<double>(spent), 0.8 * static_cast<double>(spent_by_forgetful))
      << "what was read before saves next to nothing";
}

// A motion with a turn takes each sample another way, and branches by as much as their size.
TEST(PosedSamples, FindsTheDeepestOfAllAtTurns) {
  drawing draw{std::mt19937_64(fresh_seed("PosedSamples.FindsTheDeepestOfAllAtTurns", "8 poses, 6 motions each"))};
  posed_samples samples(boxes().scene, vec3(0.0));
  for (int i = 0; i < 8; ++i) {
    const pose T_wa = drawn_pose(draw), T_wb{draw.rotation(), 0.5 * mm * draw.vector()};
    samples.place({T_wa, {&T_wb, 1}}, 100'000'000);
    samples.find_pivot(10.0 * mm);
    const vec3 pivot_w = samples.centre_w() + samples.about().centre;
    for (int n = 0; n < 6; ++n) {
      const motion x(draw.between(0.0, 1.0) * mm * draw.vector(), draw.between(0.0, 0.1) * draw.vector());
      double most = -1.0;
      const auto look = [&](const exit_body& of, const exit_body& in, const pose& T_wx, const pose& T_wy, double sign) {
        for (const field_sample& s : of.samples().samples()) {
          const vec3 p_w = T_wx * vec3(s.position_b), moved = x.shift_w + glm::cross(x.turn_w, p_w - pivot_w);
          const double depth = in.shape.read(inverse(T_wy) * (p_w + sign * moved)).value_m +
                               in.relief.read(in.body->field, inverse(T_wy) * p_w).value_m;
          most = std::max(most, depth);
        }
      };
      look(*boxes().scene->probe, *boxes().scene->fixed[0], T_wa, T_wb, 1.0);
      look(*boxes().scene->fixed[0], *boxes().scene->probe, T_wb, T_wa, -1.0);
      mark m;
      ASSERT_FALSE(samples.deepest(x, most + 1e-12, m)) << i << ", " << n;
      ASSERT_TRUE(samples.deepest(x, most - draw.between(0.0, 0.3) * mm - 1e-9, m)) << i << ", " << n;
      ASSERT_NEAR(m.depth_m, most, 1e-12) << i << ", " << n;
      ASSERT_TRUE(samples.deep_one(x, most - 0.3 * mm, m));
      ASSERT_GE(m.depth_m, std::min(most, 0.5 * most) - 1e-12);
    }
  }
}

TEST(ReliefBounds, HoldForEveryFootInABall) {
  drawing draw{std::mt19937_64(fresh_seed("ReliefBounds.HoldForEveryFootInABall", "20000 balls"))};
  const exit_body& body = *boxes().scene->fixed[0];
  double highest = 0.0, mean_of_small = 0.0;
  int small = 0;
  for (int i = 0; i < 20000; ++i) {
    const vec3 c = vec3(13, 12, 7) * mm * draw.vector();
    const double radius = std::exp(draw.between(std::log(0.01), std::log(30.0))) * mm;
    vec3 step;
    do step = draw.vector();
    while (glm::dot(step, step) > 1.0);
    const double bound = body.body->field.most_relief.most_m(c, radius);
    ASSERT_LE(body.body->field.fine.read(c + radius * step).value, bound + 1e-12);
    highest = std::max(highest, bound);
    if (radius > 0.1 * mm) continue;
    mean_of_small += bound;
    ++small;
  }
  EXPECT_LT(mean_of_small / small, 0.5 * highest);  // and say something
  EXPECT_EQ(detail::relief_bounds(detail::relief_bricks{}).most_m(vec3(0.0), 1.0), 0.0);
}

TEST(PosedSamples, GathersAllAboveALimit) {
  drawing draw{std::mt19937_64(fresh_seed("PosedSamples.GathersAllAboveALimit", "40 poses"))};
  posed_samples samples(boxes().scene, vec3(0.0));
  for (int i = 0; i < 40; ++i) {
    const pose T_wa = drawn_pose(draw), T_wb;
    const vec3 x_w = 2.0 * mm * draw.vector();
    samples.place({T_wa, {&T_wb, 1}}, 10'000'000);
    const std::vector<double> all = all_depths(T_wa, T_wb, x_w);
    double above_m = *std::max_element(all.begin(), all.end()) - draw.between(0.0, 0.5) * mm;
    std::set<std::pair<std::uint32_t, std::uint32_t>> found;
    samples.walk(x_w, above_m, [&](const mark& m) { found.insert({m.meeting, m.sample}); });
    const std::size_t of_probe = boxes().scene->probe->samples().samples().size();
    std::size_t expected = 0;
    for (std::size_t s = 0; s < all.size(); ++s) {
      if (!(all[s] > above_m + 1e-12)) continue;
      ++expected;
      const bool probes = s < of_probe;
      EXPECT_TRUE(found.contains({probes ? 0U : 1U, static_cast<std::uint32_t>(probes ? s : s - of_probe)}));
    }
    EXPECT_GE(found.size(), expected);
    EXPECT_LE(found.size(), expected + 2);
  }
}

// The slopes of D by the motion and by the pose, and the levers that rotations go by.
TEST(PosedSamples, SlopesAreThoseOfTheDepth) {
  drawing draw{std::mt19937_64(fresh_seed("PosedSamples.SlopesAreThoseOfTheDepth", "200 samples"))};
  const vec3 centre_of_mass_a = 2.0 * mm * draw.vector();
  // The small box's corners lie in the large one: as the probe, and as the fixed body.
  posed_samples of_small(boxes().scene, centre_of_mass_a), of_large(boxes().swapped, centre_of_mass_a);
  posed_samples small_again(boxes().scene, centre_of_mass_a), large_again(boxes().swapped, centre_of_mass_a);
  int seen = 0, of_fixed = 0;
  for (int i = 0; i < 200; ++i) {
    posed_samples &here = i % 2 == 0 ? of_small : of_large, &there = i % 2 == 0 ? small_again : large_again;
    pose T_wa = drawn_pose(draw), T_wb{draw.rotation(), 0.5 * mm * draw.vector()};
    if (i % 2 != 0) std::swap(T_wa, T_wb);
    const vec3 x_w = 1.0 * mm * draw.vector(), axis = glm::normalize(draw.vector());
    const auto place = [&](posed_samples& s, const pose& T) { s.place({T, {&T_wb, 1}}, 10'000'000); };
    place(here, T_wa);
    mark m;
    if (!here.deepest(x_w, -1.0 * mm, m)) continue;
    ++seen;
    const coarse_reading d = here.read(m, x_w);
    const vec3 relief = here.relief_slope(m);
    const double h = 2e-8;
    EXPECT_NEAR((here.depth(m, x_w + h * axis) - here.depth(m, x_w - h * axis)) / (2.0 * h), glm::dot(d.slope, axis),
                1e-6);
    const vec3 bent = (here.read(m, x_w + h * axis).slope - here.read(m, x_w - h * axis).slope) / (2.0 * h);
    EXPECT_LT(glm::length(bent - d.hessian_per_m * axis), 1e-4 * (100.0 + glm::length(bent)));
    // The same sample at a pose moved by h, and turned by h rad per 10 mm.
    const auto depth_at = [&](const vec3& by, const vec3& turned) {
      const pose T{exp_rotation(turned) * T_wa.rotation, vec3(0.0)};
      const vec3 c_w = T_wa * centre_of_mass_a + by;
      place(there, {T.rotation, c_w - T.rotation * centre_of_mass_a});
      double above_m = -1.0, depth_m = -1.0;
      there.walk(x_w, above_m, [&](const mark& n) {
        if (n.meeting == m.meeting && n.sample == m.sample) depth_m = n.depth_m;
      });
      return depth_m;
    };
    if (seen > 16) continue;  // it visits all samples
    of_fixed += here.meeting_of(m).of_probe ? 0 : 1;
    const double shifted = (depth_at(h * axis, {}) - depth_at(-h * axis, {})) / (2.0 * h);
    EXPECT_NEAR(shifted, glm::dot(d.slope + relief, axis), 2e-5);
    const double r = h / 0.01, turned = (depth_at({}, r * axis) - depth_at({}, -r * axis)) / (2.0 * r);
    const vec3 by_rotation = glm::cross(here.lever_w(m) - (here.meeting_of(m).of_probe ? vec3(0.0) : x_w), d.slope) +
                             glm::cross(here.lever_w(m), relief);
    EXPECT_NEAR(turned, glm::dot(by_rotation, axis), 2e-7);
  }
  EXPECT_GT(seen, 16);
  EXPECT_GT(of_fixed, 3);
}

TEST(PosedSamples, AWalkEndsWhereNoReadingsAreLeft) {
  posed_samples samples(boxes().scene, vec3(0.0));
  const pose T_wa{quat(1.0, 0.0, 0.0, 0.0), vec3(0.0, 0.0, 10.0 * mm)}, T_wb;
  mark m;
  for (const std::size_t most : {1U, 10U, 100U}) {
    samples.place({T_wa, {&T_wb, 1}}, most);
    static_cast<void>(samples.deepest(vec3(0.0), -1.0, m));
    EXPECT_TRUE(samples.count.cut);
    EXPECT_LT(samples.count.spent, most + 32);
  }
}

TEST(KeptRelief, IsTheReliefOfATexture) {
  drawing draw{std::mt19937_64(fresh_seed("KeptRelief.IsTheReliefOfATexture", "2000 points"))};
  const exit_body& body = *boxes().scene->fixed[0];
  const body_field& field = body.body->field;
  // The edges of the box have relief of a third of a pitch; what is kept is bounded by what the waves have.
  EXPECT_GT(field.highest_relief_m, 0.25 * field.smooth.pitch_m);
  EXPECT_GT(body.relief.limit_m(), 3e-6);
  EXPECT_LE(body.relief.limit_m(), 0.1 * field.smooth.pitch_m);
  int flat = 0;
  for (int i = 0; i < 2000; ++i) {
    const vec3 p = vec3(13, 12, 7) * mm * draw.vector();
    const field_reading t = body.relief.read(field, p), whole = field.relief(p, field.coarse(p));
    EXPECT_LE(std::fabs(t.value_m), std::min(std::fabs(whole.value_m) + 1e-15, body.relief.limit_m()));
    // In the middle of a face it is all there.
    if (std::fabs(p.x) < 6.0 * mm && std::fabs(p.y) < 5.0 * mm && std::fabs(p.z) > 5.0 * mm) {
      ++flat;
      EXPECT_NEAR(t.value_m, whole.value_m, 0.25 * std::fabs(whole.value_m) + 1e-9);
    }
    const vec3 axis = glm::normalize(draw.vector());
    const double h = 1e-8;
    const double slope =
        (body.relief.read(field, p + h * axis).value_m - body.relief.read(field, p - h * axis).value_m) / (2.0 * h);
    EXPECT_NEAR(slope, glm::dot(t.slope, axis), 1e-4);
  }
  EXPECT_GT(flat, 20);
}

}  // namespace
}  // namespace asperity
