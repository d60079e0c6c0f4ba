// The law of least motion where the right answer is known by formula.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>

#include "exit_lab.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"

namespace asperity {
namespace {

using namespace test_support;

constexpr double ball_m = 10.0 * mm;

// z < 0 is inside, 30 mm deep.
field_body_ptr half_space() {
  return make_formula_body({}, vec3(-20, -20, -30) * mm, vec3(20, 20, 20) * mm, 0.3 * mm,
                           [](const vec3& p) { return -p.z; });
}

// The three walls x, y, z < 0, which meet in an edge each and in a corner that opens towards (1, 1, 1).
field_body_ptr concave_corner() {
  return make_formula_body({}, vec3(-5.0 * mm), vec3(30.0 * mm), 0.2 * mm, [](const vec3& p) {
    const double into = glm::length(glm::min(p, vec3(0.0)));
    return into > 0.0 ? into : -std::min({p.x, p.y, p.z});
  });
}

// -5 mm < z < 0.
field_body_ptr plate() {
  return make_formula_body({}, vec3(-20, -20, -30) * mm, vec3(20, 20, 20) * mm, 0.3 * mm,
                           [](const vec3& p) { return std::min(-p.z, p.z + 5.0 * mm); });
}

TEST(ExitClosedForms, AFlatContactIsASpring) {
  drawing draw{std::mt19937_64(fresh_seed("ExitClosedForms.AFlatContactIsASpring", "15 depths, 40 at length"))};
  exit_lab lab(make_points_body(box_points(vec3(ball_m), 12)), {half_space()});
  const double k = lab.rule().stiffness_n_per_m;
  for (int i = 0; i < extent(15, 40); ++i) {
    const double depth = draw.between(0.02, 8.0) * mm;
    const exit_answer a = lab.at(vec3(draw.between(-2, 2) * mm, draw.between(-2, 2) * mm, ball_m - depth));
    EXPECT_FALSE(a.hit.any());
    // One sample or thousands share the bed: 1 %, and at first what it takes to come up.
    EXPECT_NEAR(a.on_probe_w.force.z, k * depth, k * (0.011 * depth + 1e-6)) << depth;
    EXPECT_NEAR(glm::length(vec3(a.on_probe_w.force.x, a.on_probe_w.force.y, 0.0)), 0.0, 1e-9);
    EXPECT_NEAR(a.energy_j, 0.5 * k * depth * depth, 0.03 * k * depth * depth + 1e-9);
    EXPECT_NEAR(a.deepest_m, depth, 1e-9);
  }
}

TEST(ExitClosedForms, ASingleSampleIsTheSameSpring) {
  drawing draw{std::mt19937_64(fresh_seed("ExitClosedForms.ASingleSample", "40 depths"))};
  exit_lab lab(make_points_body({vec3(3.0 * mm, -4.0 * mm, -ball_m)}), {half_space()});
  const double k = lab.rule().stiffness_n_per_m;
  for (int i = 0; i < 40; ++i) {
    const double depth = draw.between(0.0, 8.0) * mm;
    const exit_answer a = lab.at(vec3(0.0, 0.0, ball_m - depth));
    EXPECT_LE(a.on_probe_w.force.z, k * depth * 1.0001);
    EXPECT_GE(a.on_probe_w.force.z, k * (0.989 * depth - lab.rule().onset_m)) << depth;
    // The torque is that of the force at the sample.
    const vec3 lever(3.0 * mm, -4.0 * mm, -ball_m);
    EXPECT_LT(glm::length(a.on_probe_w.torque - glm::cross(lever, a.on_probe_w.force)), 1e-8);
  }
}

// As many samples as one likes, wherever they come twice: the borders of the pieces.
TEST(ExitClosedForms, AFaceCutInPiecesIsAsStiff) {
  const field_body_ptr ground = half_space();
  for (const double depth : {0.1 * mm, 1.0 * mm}) {
    double least = 1e30, most = 0.0;
    for (const std::size_t across : {1U, 2U, 4U, 8U}) {
      std::vector<vec3> points;
      const double size = 2.0 * ball_m / static_cast<double>(across);
      for (std::size_t i = 0; i < across * across; ++i) {
        const vec3 first(-ball_m + size * static_cast<double>(i % across),
                         -ball_m + size * static_cast<double>(i / across), -ball_m);
        for (int n = 0; n < 25; ++n) points.push_back(first + 0.25 * size * vec3(n % 5, n / 5, 0.0));
      }
      exit_lab lab(make_points_body(points), {ground});
      const double f = lab.at(vec3(0.0, 0.0, ball_m - depth)).on_probe_w.force.z;
      least = std::min(least, f);
      most = std::max(most, f);
    }
    EXPECT_LT(most - least, 0.01 * most);
    EXPECT_NEAR(most, 2000.0 * depth, 0.02 * 2000.0 * depth);
  }
}

TEST(ExitClosedForms, EachWallOfAConcaveCornerHasItsOwnSpring) {
  drawing draw{std::mt19937_64(fresh_seed("ExitClosedForms.EachWallOfAConcaveCorner", "5 poses, 30 at length"))};
  const field_body_ptr corner = concave_corner();
  exit_lab ball(make_points_body(sphere_points(ball_m, 40000)), {corner});
  exit_lab box(make_points_body(box_points(vec3(ball_m), 12)), {corner});
  const double k = ball.rule().stiffness_n_per_m;
  for (int i = 0; i < extent(5, 30); ++i) {
    const vec3 depth(draw.between(0.5, 3) * mm, draw.between(0.5, 3) * mm, draw.between(0.5, 3) * mm);
    const exit_answer of_ball = ball.at(vec3(ball_m) - depth), of_box = box.at(vec3(ball_m) - depth);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(of_ball.on_probe_w.force[axis], k * depth[axis], 0.02 * k * depth[axis]);
      // The smooth part of a field fills a concave edge by a part of its pitch, and the box reaches into it: by up to
      // 0.11 mm for a pitch of 0.2 mm, in 1,200 drawn poses.
      EXPECT_NEAR(of_box.on_probe_w.force[axis], k * depth[axis], k * (0.01 * depth[axis] + 0.65 * 0.2 * mm));
    }
  }
}

// Past the middle of the plate the ball itself is what has to come out: the plate's own samples lie in its field.
TEST(ExitClosedForms, ABallIsHeldPastTheMiddleOfAPlate) {
  std::vector<vec3> faces = box_points(vec3(15.0, 15.0, 2.5) * mm, 60);
  for (vec3& p : faces) p.z -= 2.5 * mm;
  const field_body_ptr both = make_formula_body(faces, vec3(-20, -20, -30) * mm, vec3(20, 20, 20) * mm, 0.3 * mm,
                                                [](const vec3& p) { return std::min(-p.z, p.z + 5.0 * mm); });
  const field_body_ptr ball = make_formula_body(sphere_points(ball_m, 20000), vec3(-14.0 * mm), vec3(14.0 * mm),
                                                0.3 * mm, [](const vec3& p) { return ball_m - glm::length(p); });
  exit_lab lab(ball, {both});
  const double k = lab.rule().stiffness_n_per_m;
  for (const double depth : {0.1 * mm, 1.0 * mm, 2.4 * mm, 3.0 * mm, 4.5 * mm}) {
    const exit_answer a = lab.at(vec3(0.0, 0.0, ball_m - depth));
    EXPECT_NEAR(a.on_probe_w.force.z, k * depth, k * (0.015 * depth + 6e-6)) << depth;
    EXPECT_FALSE(a.hit.any());
  }
}

// A thin body in a slot: both ways out are walls, and the only rest is in the middle.
TEST(ExitClosedForms, ATightSlotCentresABox) {
  const field_body_ptr slot = make_formula_body({}, vec3(-14.0 * mm), vec3(14.0 * mm), 0.3 * mm,
                                                [](const vec3& p) { return std::fabs(p.x) - (ball_m - 50e-6); });
  exit_lab lab(make_points_body(box_points(vec3(ball_m), 6)), {slot});
  const double k = lab.rule().stiffness_n_per_m;
  for (const double x : {0.01 * mm, -0.03 * mm, 0.1 * mm, 0.5 * mm}) {
    EXPECT_NEAR(lab.at(vec3(x, 0.0, 0.0)).on_probe_w.force.x, -k * x, 0.02 * k * std::fabs(x));
  }
}

// Where two ways out are equally near the force turns from one to the other by no more than C per metre.
TEST(ExitClosedForms, TwoWaysOutMixAcrossTheMiddle) {
  exits::exit_rule sharp;
  sharp.mixed = 12.0;
  exit_lab lab(make_points_body({vec3(0.0)}), {plate()}, sharp);  // a point: the plate's middle is a ridge for it
  const double k = lab.rule().stiffness_n_per_m, bound = lab.rule().mixed * k, middle = -2.5 * mm;
  double before = lab.at(vec3(0.0, 0.0, middle - 0.4 * mm)).on_probe_w.force.z, steepest = 0.0;
  EXPECT_LT(before, -0.9 * k * 2.0 * mm);
  int mixed = 0;
  const double step = 2e-6;
  for (double z = -0.4 * mm + step; z < 0.4 * mm; z += step) {
    const exit_answer a = lab.at(vec3(0.0, 0.0, middle + z));
    mixed += a.ways.size() > 1 ? 1 : 0;
    steepest = std::max(steepest, std::fabs(a.on_probe_w.force.z - before) / step);
    before = a.on_probe_w.force.z;
  }
  EXPECT_GT(before, 0.9 * k * 2.0 * mm);
  EXPECT_LT(steepest, 1.05 * bound);
  EXPECT_GT(steepest, 0.5 * bound);
  EXPECT_GT(mixed, 50);
}

// Under the crest of a shallow wave the way out over the crest is still at rest where two beside it are cheaper
// together. They lie a few degrees from each other, closer than the rays of the search.
TEST(ExitClosedForms, AWayOverACrestPartsWithoutAJump) {
  constexpr double wave_m = 0.4 * mm, high_m = 0.01 * mm;
  const field_body_ptr waved = make_formula_body(
      {}, vec3(-1.2, -1.2, -4) * mm, vec3(1.2, 1.2, 1.2) * mm, 0.04 * mm,
      [](const vec3& p) { return -p.z - 0.5 * high_m * (1.0 - std::cos(6.283185307179586 * p.x / wave_m)); });
  exit_lab lab(make_points_body({vec3(0.0)}), {waved});
  drawing draw{std::mt19937_64(fresh_seed("ExitClosedForms.AWayOverACrest", "3 paths"))};
  const double c = lab.rule().mixed * lab.rule().stiffness_n_per_m;
  for (const double under_m : {0.5 * mm, 0.76 * mm, 0.78 * mm, 0.8 * mm, draw.between(0.8, 1.6) * mm}) {
    const vec3 from(-0.06 * mm, draw.between(-0.2, 0.2) * mm, -under_m), way(0.12 * mm, 0.01 * mm, 0.0);
    constexpr int ticks = 240;
    vec3 before = lab.at(from).on_probe_w.force;
    double steepest = 0.0;
    std::size_t ways = 1;
    for (int i = 1; i <= ticks; ++i) {
      const exit_answer a = lab.at(from + (static_cast<double>(i) / ticks) * way);
      steepest = std::max(steepest, glm::length(a.on_probe_w.force - before) * ticks / glm::length(way));
      ways = std::max(ways, a.ways.size());
      before = a.on_probe_w.force;
    }
    std::printf("  %.2f mm under the crest: at most %.2f C per metre, %zu ways out\n", under_m / mm, steepest / c,
                ways);
    EXPECT_LT(steepest, 1.05 * c);
    if (under_m > 0.79 * mm) {
      EXPECT_GT(ways, 1U);
    }
  }
}

// In a cylinder a point's ways out lie on a circle. From a fifth of the radius on there is one, and the force is k
// times it; nearer to the axis a single way out would still be at rest, but two beside it are cheaper together, and the
// force turns about the axis by C per metre: C r.
TEST(ExitClosedForms, WaysOutBesideEachOtherMixOverACrest) {
  constexpr double radius_m = 2.0 * mm;
  const field_body_ptr cylinder = make_formula_body({}, vec3(-3, -15, -3) * mm, vec3(3, 15, 3) * mm, 0.06 * mm,
                                                    [](const vec3& p) { return radius_m - std::hypot(p.x, p.z); });
  exit_lab lab(make_points_body({vec3(0.0)}), {cylinder});
  drawing draw{std::mt19937_64(fresh_seed("ExitClosedForms.WaysOutBesideEachOther", "4 directions"))};
  const double k = lab.rule().stiffness_n_per_m, c = lab.rule().mixed * k, step = 1e-6;
  for (int i = 0; i < 4; ++i) {
    const double angle = draw.between(-3.0, 3.0);
    const vec3 out(std::cos(angle), 0.0, std::sin(angle));
    const auto force = [&](double r) { return glm::dot(out, lab.at(r * out).on_probe_w.force); };
    double before = force(0.1 * radius_m);
    double steepest = 0.0, off = 0.0;
    for (double r = 0.1 * radius_m + step; r < 0.3 * radius_m; r += step) {
      const double now = force(r);
      steepest = std::max(steepest, std::fabs(now - before) / step);
      off = std::max(off, std::fabs(now - std::min(c * r, k * (radius_m - r))));
      before = now;
    }
    std::printf("  towards %+.2f rad: at most %.2f C per metre, %.3f of k R off\n", angle, steepest / c,
                off / (k * radius_m));
    EXPECT_LT(steepest, 1.2 * c);
    EXPECT_LT(off, 0.05 * k * radius_m);
  }
}

TEST(ExitClosedForms, TheProbeHasToClearAllBodies) {
  const field_body_ptr ground = half_space();
  exit_lab lab(make_points_body(sphere_points(ball_m, 20000)), {ground, ground});
  // The second one stands upright: x < 0 is inside.
  lab.T_wb[1].rotation = exp_rotation({0.0, 0.5 * 3.14159265358979323846, 0.0});
  const double k = lab.rule().stiffness_n_per_m;
  const vec3 depth(1.0 * mm, 0.0, 2.0 * mm);
  const exit_answer a = lab.at(vec3(ball_m, 0.0, ball_m) - depth);
  EXPECT_LT(glm::length(a.on_probe_w.force - k * depth), 0.02 * k * glm::length(depth));
  EXPECT_EQ(a.ways.size(), 1U);
}

}  // namespace
}  // namespace asperity
