// The moving shape of a body with a notch, and its bounds.
#include "least_motion/moving_shape.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <memory>

#include "exit_lab.hpp"
#include "least_motion/finer_readings.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"

namespace asperity {
namespace {

using namespace test_support;
using namespace exits;

const exit_body& block() {
  static const exit_body made(grooved_block(), 1);
  return made;
}

// Most of them in and about the groove.
vec3 drawn_place(drawing& draw) {
  const vec3 about = draw.between(0.0, 1.0) < 0.7 ? vec3(1.0, 7.0, 1.0) : vec3(13.0, 9.0, 7.0);
  return mm * (about * draw.vector() + (about.x < 2.0 ? vec3(0.0, 0.0, 3.0) : vec3(0.0)));
}

TEST(MovingShape, IsTheSameForAnyNumberOfThreads) {
  drawing draw{std::mt19937_64(fresh_seed("MovingShape.IsTheSameForAnyNumberOfThreads", "20000 points"))};
  const exit_body several(grooved_block(), 3);
  EXPECT_EQ(several.shape.heap_bytes(), block().shape.heap_bytes());
  EXPECT_EQ(several.bounds.steepest(), block().bounds.steepest());
  int finer = 0;
  for (int i = 0; i < 20000; ++i) {
    const vec3 p = drawn_place(draw);
    const double radius_m = several.body->field.smooth.pitch_m * draw.between(0.0, 8.0);
    EXPECT_EQ(several.shape.value_m(p), block().shape.value_m(p));
    EXPECT_EQ(several.bounds.most_by_table(p, radius_m), block().bounds.most_by_table(p, radius_m));
    EXPECT_EQ(several.bounds.bend_per_m(p, radius_m), block().bounds.bend_per_m(p, radius_m));
    finer += several.shape.is_finer(p) ? 1 : 0;
  }
  EXPECT_GT(finer, 1000);
}

// The quick look at a brick's nodes tells what the reading tells, but where they differ by rounding.
TEST(MovingShape, TheQuickLookIsAReading) {
  drawing draw{std::mt19937_64(fresh_seed("MovingShape.TheQuickLookIsAReading", "2000 bricks"))};
  constexpr std::size_t own = moving_shape::cells * moving_shape::finer;
  std::size_t named = 0, kept = 0;
  for (int i = 0; i < 2000; ++i) {
    detail::coarse_grid grid;
    grid.pitch_m = 1e-3 * draw.between(0.1, 10.0);
    grid.nodes = {9, 8, 10};
    const vec3 slope = draw.between(0.3, 1.2) * glm::normalize(draw.vector()), bent = draw.vector();
    const double offset = draw.between(-2.0, 2.0), bend = draw.between(-0.2, 0.4);
    grid.value.resize(grid.nodes[0] * grid.nodes[1] * grid.nodes[2]);
    for (std::size_t n = 0; n < grid.value.size(); ++n) {
      const vec3 off = vec3(n % 9, n / 9 % 8, n / 72) - vec3(4.0);
      const double bow = glm::dot(bent, off);
      grid.value[n] = static_cast<float>(grid.pitch_m * (offset + glm::dot(slope, off) + 0.5 * bend * bow * bow));
    }
    const finer_readings near(grid, {2, 2, 4});
    for (std::size_t n = 0; n < own * own * own; ++n) {
      const vec3 finer(n % own, n / own % own, n / (own * own));
      const coarse_reading s = grid.read(grid.pitch_m * (vec3(2.0, 2.0, 4.0) + finer / 3.0));
      const double off = std::fabs(s.value_m) / grid.pitch_m, square = glm::dot(s.slope, s.slope);
      const double trace = grid.pitch_m * (s.hessian_per_m[0][0] + s.hessian_per_m[1][1] + s.hessian_per_m[2][2]);
      if (kept_relief::may_move(off, square, trace, 0.0)) {
        EXPECT_TRUE(near.may_move(n));
        ++named;
      } else if (!kept_relief::may_move(off, square, trace, 2e-3)) {
        EXPECT_FALSE(near.may_move(n));
        ++kept;
      }
    }
  }
  EXPECT_GT(named, 10000U);
  EXPECT_GT(kept, 10000U);
}

// It may name too many, never too few.
TEST(MovingShape, NoNodeThatMovesIsPassedOver) {
  drawing draw{std::mt19937_64(fresh_seed("MovingShape.NoNodeThatMovesIsPassedOver", "a fifth of all bricks"))};
  const body_field& field = block().body->field;
  const detail::coarse_grid& grid = field.smooth;
  constexpr std::size_t cells = moving_shape::cells, own = cells * moving_shape::finer;
  const double pitch_m = grid.pitch_m / static_cast<double>(moving_shape::finer);
  std::size_t nodes = 0, named = 0, moving = 0;
  const auto bricks = moving_shape::bricks_over(grid);
  for (std::size_t b = 0; b < bricks[0] * bricks[1] * bricks[2]; ++b) {
    if (draw.bits() % 5 != 0) continue;
    const std::array<std::size_t, 3> at{b % bricks[0], b / bricks[0] % bricks[1], b / (bricks[0] * bricks[1])};
    const finer_readings near(grid, {at[0] * cells, at[1] * cells, at[2] * cells});
    for (std::size_t n = 0; n < own * own * own; ++n, ++nodes) {
      const vec3 p_b =
          grid.low + pitch_m * vec3(at[0] * own + n % own, at[1] * own + n / own % own, at[2] * own + n / (own * own));
      const bool moves = block().relief.moving_m(field, p_b) != 0.0;
      named += near.may_move(n) ? 1U : 0U;
      moving += moves ? 1U : 0U;
      EXPECT_TRUE(near.may_move(n) || !moves)
          << "node " << n << " of the brick " << at[0] << " " << at[1] << " " << at[2];
    }
  }
  std::printf("  of %zu nodes %zu are named, %zu move\n", nodes, named, moving);
  EXPECT_GT(moving, 500U);
  EXPECT_LT(named, nodes / 2);
}

TEST(MovingShape, IsTheSmoothPartAndWhatMovesInNotches) {
  drawing draw{std::mt19937_64(fresh_seed("MovingShape.IsTheSmoothPartAndWhatMovesInNotches", "40000 points"))};
  const body_field& field = block().body->field;
  const double pitch = field.smooth.pitch_m;
  int away = 0, moved = 0;
  double most = 0.0, worst = 0.0, sum = 0.0;
  for (int i = 0; i < 40000; ++i) {
    const vec3 p = drawn_place(draw);
    const double smooth_m = field.coarse(p).value_m, moves_m = block().relief.moving_m(field, p);
    if (!block().shape.is_finer(p)) {
      EXPECT_EQ(block().shape.value_m(p), smooth_m);
      EXPECT_EQ(moves_m, 0.0);
      ++away;
      continue;
    }
    const double off = std::fabs(block().shape.value_m(p) - smooth_m - moves_m);
    worst = std::max(worst, off);
    if (moves_m == 0.0) continue;
    ++moved;
    sum += off;
    most = std::max(most, -moves_m);
  }
  std::printf("  relief moves at %d places, by up to %.3f pitches; the shape is off by %.4f, at worst by %.4f\n", moved,
              most / pitch, sum / moved / pitch, worst / pitch);
  EXPECT_GT(away, 10000);
  EXPECT_GT(moved, 1000);
  EXPECT_GT(most, 0.05 * pitch);
  EXPECT_LT(worst, 0.4 * most);
  EXPECT_LT(sum / moved, 0.06 * most);
}

TEST(MovingShape, IsContinuousWithTwoDerivatives) {
  drawing draw{std::mt19937_64(fresh_seed("MovingShape.IsContinuousWithTwoDerivatives", "1500 points"))};
  const moving_shape& shape = block().shape;
  const detail::coarse_grid& grid = shape.grid();
  const double brick_m = static_cast<double>(moving_shape::cells) * grid.pitch_m;
  int finer = 0;
  for (int i = 0; i < 100000 && finer < 1500; ++i) {
    vec3 p = drawn_place(draw);
    // On a face between two bricks.
    const int axis = i % 3;
    p[axis] = grid.low[axis] + brick_m * std::round((p[axis] - grid.low[axis]) / brick_m);
    vec3 step(0.0);
    step[axis] = 1e-9;
    if (!shape.is_finer(p + step) && !shape.is_finer(p - step)) continue;
    ++finer;
    const coarse_reading a = shape.read(p - step), b = shape.read(p + step);
    // Coefficients are floats: they are a billionth of a body's size off.
    EXPECT_NEAR(a.value_m, b.value_m, 1e-8 * mm + 2e-9 * glm::length(b.slope));
    EXPECT_LT(glm::length(a.slope - b.slope), 2e-5 + 4e-9 * glm::length(b.hessian_per_m[axis]));
    EXPECT_LT(glm::length(a.hessian_per_m[axis] - b.hessian_per_m[axis]), 0.02 / grid.pitch_m);
    const vec3 along = draw.vector();
    const double h = 1e-7;
    const double rise = (shape.value_m(p + h * along) - shape.value_m(p - h * along)) / (2.0 * h);
    EXPECT_NEAR(rise, glm::dot(b.slope, along), 4e-4);
  }
  EXPECT_EQ(finer, 1500);
}

TEST(MovingShape, AConvexBodyHasNoFinerNodes) {
  const exit_body box(waved_box(vec3(7, 6, 5) * mm, 0.0, 1.0), 1);
  EXPECT_LT(box.shape.heap_bytes(), sizeof(std::uint32_t) * box.body->field.smooth.value.size());
}

TEST(FieldBounds, HoldWithinABrick) {
  drawing draw{std::mt19937_64(fresh_seed("FieldBounds.HoldWithinABrick", "300 bricks"))};
  constexpr std::size_t finer = moving_shape::finer, along = moving_shape::along;
  detail::coarse_grid grid;
  grid.nodes = {8, 8, 8};
  double closest = 0.0;
  for (int i = 0; i < 300; ++i) {
    grid.pitch_m = 1e-3 * draw.between(0.1, 10.0);
    // Bent beyond a plane, straight before it: a bound of too few nodes would miss the bend.
    const vec3 along_n = glm::normalize(draw.vector());
    const double from = draw.between(-2.0, 6.0), bend = draw.between(0.01, 0.2) * grid.pitch_m;
    moving_shape::brick nodes;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      const vec3 place(n % along, n / along % along, n / (along * along));
      const double beyond = std::max(0.0, glm::dot(along_n, place) - from);
      nodes[n] = static_cast<float>(bend * beyond * beyond);
    }
    finer_brick bounds;
    bounds.place = {1, 1, 1};
    bounds.measure(nodes, grid);
    float highest_m = nodes[0], bound_per_m = 0.0F;
    for (const finer_brick::cell& cell : bounds.cells) {
      highest_m = std::max(highest_m, cell.highest_m);
      bound_per_m = std::max(bound_per_m, cell.bend_per_m);
    }
    // At the brick's rim the cells of its neighbours count too.
    for (int j = 0; j < 200; ++j) {
      detail::cubic_nodes at;
      std::size_t first[3];
      for (std::size_t k = 0; k < 3; ++k) {
        first[k] = 1 + draw.bits() % (along - 5);
        at.f[k] = draw.between(0.0, 1.0);
      }
      at.first = nodes.data() + moving_shape::node(first[0], first[1], first[2]);
      at.row = along;
      at.layer = along * along;
      at.per_pitch = static_cast<double>(finer) / grid.pitch_m;
      const coarse_reading read = at.read();
      double squares = 0.0;
      for (int k = 0; k < 3; ++k) squares += glm::dot(read.hessian_per_m[k], read.hessian_per_m[k]);
      const double bend_per_m = std::sqrt(squares);
      EXPECT_LE(bend_per_m, static_cast<double>(bound_per_m) + 1e-4 / grid.pitch_m);  // nodes are floats
      EXPECT_LE(read.value_m, static_cast<double>(highest_m) * 1.000001);
      if (bend_per_m * grid.pitch_m > 0.01) closest = std::max(closest, bend_per_m / static_cast<double>(bound_per_m));
    }
  }
  // A bound that is never approached would be worth little.
  EXPECT_GT(closest, 0.9);
}

TEST(FieldBounds, HoldForEveryPointOfABall) {
  drawing draw{std::mt19937_64(fresh_seed("FieldBounds.HoldForEveryPointOfABall", "6000 balls"))};
  const exit_body box(waved_box(vec3(12, 11, 6) * mm, 0.06 * mm, 0.7 * mm), 2);
  int finer = 0;
  for (int i = 0; i < 6000; ++i) {
    const exit_body& body = i % 2 == 0 ? box : block();
    const detail::coarse_grid& grid = body.shape.grid();
    const vec3 c = i % 2 == 0 ? 14.0 * mm * draw.vector() : drawn_place(draw);
    const double radius = std::exp(draw.between(std::log(0.02), std::log(4.0))) * mm;
    vec3 step;
    do step = draw.vector();
    while (glm::dot(step, step) > 1.0);
    const vec3 p = c + radius * step;
    const coarse_reading at = body.shape.read(p);
    EXPECT_NEAR(body.shape.value_m(p), at.value_m, 1e-15);
    finer += body.shape.is_finer(p) ? 1 : 0;
    EXPECT_LE(at.value_m, body.bounds.most_by_table(c, radius) + 1e-12);
    if (grid.clamped(p) != p) continue;
    EXPECT_LE(glm::length(at.slope), body.bounds.steepest());
    double squares = 0.0;
    for (int k = 0; k < 3; ++k) squares += glm::dot(at.hessian_per_m[k], at.hessian_per_m[k]);
    EXPECT_LE(std::sqrt(squares), body.bounds.bend_per_m(c, radius) * (1.0 + 1e-6) + 1e-6);
  }
  EXPECT_GT(finer, 300);
}

// The search may not leave out a sample because its bounds do not know of the finer nodes.
TEST(PosedSamples, FindTheDeepestInANotch) {
  drawing draw{std::mt19937_64(fresh_seed("PosedSamples.FindTheDeepestInANotch", "15 poses, 40 at length"))};
  const field_body_ptr probe = waved_box(vec3(3, 5, 3) * mm, 0.03 * mm, 0.4 * mm);
  const field_scene bodies{probe, {block().body}};
  const auto scene = std::make_shared<const exit_scene>(bodies);
  posed_samples samples(scene, vec3(0.0));
  int in_notch = 0;
  const int poses = extent(15, 40);
  for (int i = 0; i < poses; ++i) {
    // An edge of the probe in the groove, 0.3 mm deep.
    const pose T_wa{exp_rotation(vec3(0.0, 0.7854, 0.0) + 0.02 * draw.vector()),
                    mm * (vec3(0.0, 0.0, 6.94) + vec3(0.1, 0.4, 0.3) * draw.vector())};
    const pose T_wb;
    const vec3 x_w = 0.3 * mm * draw.vector();
    samples.place({T_wa, {&T_wb, 1}}, 10'000'000);
    double most = -1.0;
    vec3 deepest_b(0.0);
    const auto look = [&](const exit_body& of, const exit_body& in, const pose& T_yx, const vec3& moved_y, bool own) {
      for (const field_sample& s : of.samples().samples()) {
        const vec3 p_y = T_yx * vec3(s.position_b);
        const double depth_m = in.shape.value_m(p_y + moved_y) + in.relief.read(in.body->field, p_y).value_m;
        if (depth_m <= most) continue;
        most = depth_m;
        deepest_b = own ? p_y + moved_y : vec3(1.0);
      }
    };
    look(*scene->probe, *scene->fixed[0], T_wa, x_w, true);
    look(*scene->fixed[0], *scene->probe, inverse(T_wa), -(glm::conjugate(T_wa.rotation) * x_w), false);
    in_notch += scene->fixed[0]->shape.is_finer(deepest_b) ? 1 : 0;
    mark m;
    EXPECT_FALSE(samples.deepest(x_w, most + 1e-12, m));
    ASSERT_TRUE(samples.deepest(x_w, most - 0.3 * mm, m));
    EXPECT_NEAR(m.depth_m, most, 1e-12);
    EXPECT_NEAR(samples.depth(m, x_w), most, 1e-12);
  }
  std::printf("  %d of %d poses are deepest where nodes are finer\n", in_notch, poses);
  EXPECT_GT(in_notch, poses / 8);
}

}  // namespace
}  // namespace asperity
