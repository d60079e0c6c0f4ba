// A tree of balls loses no sample; the samples of a body cover it.
#include "asperity/field/sample_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "field/surface_samples.hpp"
#include "support/fresh_seed.hpp"
#include "support/small_models.hpp"

namespace asperity {
namespace {

using namespace test_support;

std::vector<field_sample> scattered(std::size_t count, std::mt19937_64& bits) {
  std::uniform_real_distribution<float> side(-0.1F, 0.1F);
  std::vector<field_sample> out(count);
  for (field_sample& s : out) s.position_b = {side(bits), side(bits), 0.2F * side(bits)};
  return out;
}

// Indices of the points that a query for a ball brings, and how many points it brought in all.
struct brought {
  std::vector<glm::vec3> inside;
  std::size_t points = 0;
  int outside = 0;  // of their leaf's ball, or beyond its planes
};

brought query_ball(const sample_tree& tree, const vec3& centre, double radius) {
  brought out;
  using answer = sample_tree::branch_answer;
  tree.query(
      [&](const sample_ball& ball, bool is_leaf) noexcept {
        if (glm::length(ball.centre_b - centre) > ball.radius_m + radius) return answer::away;
        // Some balls are taken whole: their leaves come without another look.
        return is_leaf || ball.radius_m < 0.5 * radius ? answer::taken : answer::open;
      },
      [&](const sample_ball& ball, std::span<const field_sample> leaf) noexcept {
        out.points += leaf.size();
        for (const field_sample& s : leaf) {
          const vec3 off = vec3(s.position_b) - ball.centre_b;
          out.outside += glm::length(off) > ball.radius_m || std::fabs(glm::dot(off, ball.axis_b)) > ball.half_m;
          if (glm::length(vec3(s.position_b) - centre) <= radius) out.inside.push_back(s.position_b);
        }
      });
  return out;
}

TEST(SampleTree, BringsEveryPointOfABallOnce) {
  std::mt19937_64 bits(fresh_seed("SampleTree.BringsEveryPointOfABallOnce", "40 trees, 50 balls each"));
  for (int n = 0; n < 40; ++n) {
    const std::size_t count = 1 + bits() % 3000;
    const std::vector<field_sample> points = scattered(count, bits);
    const sample_tree tree(points);
    ASSERT_EQ(tree.samples().size(), count);
    for (int q = 0; q < 50; ++q) {
      const vec3 centre(scattered(1, bits)[0].position_b);
      const double radius = 0.05 * static_cast<double>(bits() % 1000) / 1000.0;
      const auto expected =
          static_cast<std::size_t>(std::count_if(points.begin(), points.end(), [&](const field_sample& s) {
            return glm::length(vec3(s.position_b) - centre) <= radius;
          }));
      const brought found = query_ball(tree, centre, radius);
      EXPECT_EQ(found.inside.size(), expected);
      EXPECT_EQ(found.outside, 0);
    }
  }
}

TEST(SampleTree, LeavesOutWhatIsFar) {
  std::mt19937_64 bits(fresh_seed("SampleTree.LeavesOutWhatIsFar", "one tree of 20,000"));
  const sample_tree tree(scattered(20'000, bits));
  const brought found = query_ball(tree, vec3(0.0), 0.005);
  EXPECT_LT(found.points, 1000U) << "of 20,000; the ball holds " << found.inside.size();
  EXPECT_EQ(query_ball(tree, {1.0, 0.0, 0.0}, 0.1).points, 0U);
}

TEST(SampleTree, IsTheSameForTheSamePointsInAnyOrder) {
  std::mt19937_64 bits(fresh_seed("SampleTree.IsTheSameForTheSamePointsInAnyOrder", "one tree"));
  std::vector<field_sample> points = scattered(1000, bits);
  const sample_tree one(points);
  std::shuffle(points.begin(), points.end(), bits);
  const sample_tree other(points);
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(one.samples()[i].position_b, other.samples()[i].position_b);
}

// On a plane a ball's two planes lie on each other, and a slope across them adds nothing to a bound.
TEST(SampleTree, KnowsHowFlatALeafIs) {
  std::mt19937_64 bits(fresh_seed("SampleTree.KnowsHowFlatALeafIs", "a plane of 2000 points, a slope per leaf"));
  std::vector<field_sample> points = scattered(2000, bits);
  for (field_sample& s : points) s.position_b.z = 0.25F * s.position_b.x;
  const vec3 normal = glm::normalize(vec3(-0.25, 0.0, 1.0));
  const sample_tree tree(points);
  std::uniform_real_distribution<double> side(-1.0, 1.0);
  double thickness = 0.0, growth = 0.0;
  int leaves = 0;
  const auto every = [](const sample_ball&, bool is_leaf) noexcept {
    return is_leaf ? sample_tree::branch_answer::taken : sample_tree::branch_answer::open;
  };
  tree.query(every, [&](const sample_ball& ball, std::span<const field_sample> leaf) noexcept {
    thickness += ball.half_m / ball.radius_m;
    growth += ball.growth(normal) / ball.radius_m;
    ++leaves;
    const vec3 slope(side(bits), side(bits), side(bits));
    double most = 0.0;
    for (const field_sample& s : leaf) most = std::max(most, glm::dot(slope, vec3(s.position_b) - ball.centre_b));
    EXPECT_GE(ball.growth(slope), most);
  });
  // An axis is found by 20 steps of the power method, which long rows of samples would need more of.
  EXPECT_LT(thickness, 0.02 * leaves);
  EXPECT_LT(growth, 0.1 * leaves);
}

// A leaf holds all samples of a place or none, and no more leaves than if each place had one sample.
TEST(SampleTree, KeepsPlacesWhole) {
  std::mt19937_64 bits(fresh_seed("SampleTree.KeepsPlacesWhole", "40 trees"));
  const auto every = [](const sample_ball&, bool is_leaf) noexcept {
    return is_leaf ? sample_tree::branch_answer::taken : sample_tree::branch_answer::open;
  };
  for (int n = 0; n < 40; ++n) {
    // The cone tells which place a sample is of.
    const std::vector<field_sample> middles = scattered(1 + bits() % 3000, bits);
    placed_samples placed;
    for (const field_sample& middle : middles) {
      placed.at_place.push_back(static_cast<std::uint8_t>(1 + bits() % placed_samples::most));
      for (std::uint8_t i = 0; i < placed.at_place.back(); ++i) {
        field_sample s = scattered(1, bits)[0];
        s.position_b = middle.position_b + 0.01F * s.position_b;
        s.cone_rad = static_cast<float>(placed.at_place.size());
        placed.all.push_back(s);
      }
    }
    const sample_tree tree(placed);
    ASSERT_EQ(tree.samples().size(), placed.all.size());
    EXPECT_EQ(tree.balls(), sample_tree::balls_of(middles.size()));
    std::size_t told = 0;
    tree.query(every, [&](const sample_ball& ball, std::span<const field_sample> leaf) noexcept {
      told += leaf.size();
      EXPECT_LE(leaf.size(), sample_tree::leaf_samples);
      std::vector<float> places;
      for (const field_sample& s : leaf) {
        const vec3 off = vec3(s.position_b) - ball.centre_b;
        EXPECT_LE(glm::length(off), ball.radius_m);
        EXPECT_LE(std::fabs(glm::dot(off, ball.axis_b)), ball.half_m);
        places.push_back(s.cone_rad);
      }
      for (const float place : places) {
        EXPECT_EQ(static_cast<std::uint8_t>(std::count(places.begin(), places.end(), place)),
                  placed.at_place[static_cast<std::size_t>(place) - 1]);
      }
    });
    EXPECT_EQ(told, placed.all.size());
  }
}

TEST(SampleTree, OfNothingBringsNothing) {
  const sample_tree tree;
  EXPECT_EQ(query_ball(tree, vec3(0.0), 1.0).points, 0U);
  EXPECT_EQ(sample_tree(std::vector<field_sample>{}).samples().size(), 0U);
}

std::vector<field_sample> samples_of(const textured_model& model, double pitch_m) {
  const detail::surface_index index(model);
  return detail::surface_samples(model, index, pitch_m).make().all;
}

double distance_to(const std::vector<field_sample>& samples, const vec3& p) {
  double best = 1e30;
  for (const field_sample& s : samples) best = std::min(best, glm::length(vec3(s.position_b) - p));
  return best;
}

TEST(SurfaceSamples, CoverABodyAtTheirPitch) {
  std::mt19937_64 bits(fresh_seed("SurfaceSamples.CoverABodyAtTheirPitch", "3 pitches, 300 points each"));
  const vec3 half(0.02, 0.015, 0.01);
  const textured_model box = make_flat_box(half, 384);
  for (const double pitch : {0.5e-3, 1e-3, 3e-3}) {
    const std::vector<field_sample> samples = samples_of(box, pitch);
    std::uniform_real_distribution<double> side(-1.0, 1.0);
    for (int i = 0; i < 300; ++i) {
      vec3 p(side(bits), side(bits), side(bits));
      const int axis = static_cast<int>(bits() % 3);
      p[axis] = p[axis] < 0.0 ? -1.0 : 1.0;
      // A block's sample may lie anywhere in it where the block is cut by a triangle's side.
      EXPECT_LT(distance_to(samples, p * half), 1.6 * pitch) << "pitch " << pitch;
    }
  }
}

TEST(SurfaceSamples, HoldEveryVertexAndEdge) {
  const vec3 half(0.02, 0.015, 0.01);
  const std::vector<field_sample> samples = samples_of(make_flat_box(half, 96), 1e-3);
  for (int corner = 0; corner < 8; ++corner) {
    const vec3 sign((corner & 1) != 0 ? 1.0 : -1.0, (corner & 2) != 0 ? 1.0 : -1.0, (corner & 4) != 0 ? 1.0 : -1.0);
    EXPECT_LT(distance_to(samples, sign * half), 1e-8);
  }
  for (double x = -0.95; x <= 0.95; x += 0.1) {
    EXPECT_LT(distance_to(samples, {x * half.x, half.y, half.z}), 0.14e-3) << "along an edge, at " << x;
  }
}

// Flanks of 63 degrees have four samples for one of a plain face, and none less steep than an edge has more.
TEST(SurfaceSamples, AreFourTimesAsManyWhereReliefIsSteep) {
  const vec3 half(0.02, 0.015, 0.01);
  const auto on_top = [&](double steepness) {
    const relief_function flanks = [=](const vec3& p, const vec3&) {
      constexpr double wave_m = 4e-3;
      return steepness * (std::fabs(p.x / wave_m - std::round(p.x / wave_m)) - 0.25) * wave_m;
    };
    const std::vector<field_sample> all = samples_of(make_textured_box(half, 768, flanks), 1e-3);
    return static_cast<double>(std::count_if(all.begin(), all.end(), [&](const field_sample& s) {
      return std::fabs(s.position_b.x) < 0.9 * half.x && std::fabs(s.position_b.y) < 0.9 * half.y &&
             s.position_b.z > 0.F;
    }));
  };
  const double plain = on_top(0.0);
  EXPECT_GT(plain, 500.0);
  EXPECT_LT(on_top(1.0), 1.3 * plain);
  EXPECT_GT(on_top(2.0), 3.5 * plain);
  EXPECT_LT(on_top(2.0), 4.5 * plain);
}

// A tip whose edges are too blunt to be sharp has samples only because it is a vertex.
TEST(SurfaceSamples, HoldTheTipOfAConeOfManySides) {
  constexpr std::uint32_t sides = 120;
  textured_model cone = make_flat_box({0.01, 0.01, 0.01}, 64);  // for its texture, which this test fills anew
  cone.mesh = {};
  cone.mesh.positions.emplace_back(0.0, 0.0, 0.01);
  cone.mesh.positions.emplace_back(0.0, 0.0, 0.0);
  for (std::uint32_t i = 0; i < sides; ++i) {
    const double a = 6.283185307179586 * i / sides;
    cone.mesh.positions.emplace_back(0.01 * std::cos(a), 0.01 * std::sin(a), 0.0);
  }
  // Every texel holds the tip: whatever a triangle reads, only the way to its samples differs.
  cone.texture.width = cone.texture.height = 64;
  cone.texture.texels.assign(std::size_t{64} * 64, glm::vec3(0.0F, 0.0F, 0.01F));
  for (std::uint32_t i = 0; i < sides; ++i) {
    const std::uint32_t a = 2 + i, b = 2 + (i + 1) % sides;
    cone.mesh.triangles.push_back({{0, a, b}, {vec2(0.1, 0.1), vec2(0.1, 0.1), vec2(0.1, 0.1)}});
  }
  const std::vector<field_sample> samples = samples_of(cone, 1e-3);
  EXPECT_LT(distance_to(samples, {0.0, 0.0, 0.01}), 1e-8);
}

// On a box: faces look one way, edges over 45 degrees to either side, corners to three faces.
TEST(SurfaceSamples, KnowWhereTheirSurfaceLooks) {
  const vec3 half(0.02, 0.015, 0.01);
  constexpr double edge_rad = 0.78539816, corner_rad = 0.95531662;
  for (const field_sample& s : samples_of(make_flat_box(half, 96), 1e-3)) {
    vec3 out(0.0);
    for (int k = 0; k < 3; ++k) {
      if (std::fabs(std::fabs(s.position_b[k]) - half[k]) < 1e-7) out[k] = s.position_b[k] < 0.0F ? -1.0 : 1.0;
    }
    const double sides = glm::dot(out, out);
    ASSERT_GE(sides, 1.0);
    if (sides == 1.0) {
      EXPECT_GT(glm::dot(vec3(s.axis_b), out), 0.999999);
      EXPECT_EQ(s.cone_rad, 0.0F);
    } else if (sides == 2.0 && s.cone_rad > 0.0F) {
      EXPECT_GT(glm::dot(vec3(s.axis_b), glm::normalize(out)), 0.999999);
      EXPECT_NEAR(s.cone_rad, edge_rad, 1e-5);
    } else if (sides == 3.0) {
      // The mean over triangles leans to faces that have two of them at the corner.
      EXPECT_GT(glm::dot(vec3(s.axis_b), glm::normalize(out)), 0.93);
      EXPECT_GE(s.cone_rad, corner_rad - 1e-5);
    }
  }
}

TEST(SurfaceSamples, LeaveOutTexelsWithoutASurface) {
  textured_model box = make_flat_box({0.01, 0.01, 0.01}, 96);
  for (std::size_t i = 0; i < box.texture.texels.size(); i += 3) {
    box.texture.texels[i] = glm::vec3(std::numeric_limits<float>::quiet_NaN());
  }
  for (const field_sample& s : samples_of(box, 1e-3)) EXPECT_TRUE(is_finite(vec3(s.position_b)));
}

}  // namespace
}  // namespace asperity
