// What cannot be made is refused with a sentence; what is made keeps to its limits.
#include <gtest/gtest.h>
#include <limits>

#include "field/fine_surface.hpp"
#include "support/small_models.hpp"
#include "unit/field/charted_model.hpp"
#include "unit/field/field_measures.hpp"

namespace asperity {
namespace {

using namespace test_support;

TEST(MakeBodyField, RefusesSettingsOutOfRange) {
  const textured_model box = make_flat_box({0.01, 0.01, 0.01});
  for (double field_settings::*length :
       {&field_settings::pitch_m, &field_settings::relief_pitch_m, &field_settings::margin_m}) {
    for (const double v : {-1e-3, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
      field_settings s;
      s.*length = v;
      const auto made = built_field(box, s);
      ASSERT_FALSE(made);
      EXPECT_EQ(made.error().code, error_code::invalid_argument);
    }
  }
  field_settings s;
  s.most_nodes = 9'999;
  EXPECT_EQ(built_field(box, s).error().code, error_code::invalid_argument);
  s = {};
  s.relief_bytes = 99'999;
  EXPECT_EQ(built_field(box, s).error().code, error_code::invalid_argument);
}

TEST(MakeBodyField, RefusesModelsWithoutSurfaceOrTexture) {
  textured_model bare = make_flat_box({0.01, 0.01, 0.01});
  bare.texture = {};
  EXPECT_EQ(built_field(bare).error().code, error_code::bad_texture);
  textured_model empty = make_flat_box({0.01, 0.01, 0.01});
  empty.mesh.triangles.clear();
  EXPECT_EQ(built_field(empty).error().code, error_code::bad_mesh);
  textured_model flat = make_flat_box({0.01, 0.01, 0.01});
  flat.box = {};
  EXPECT_EQ(built_field(flat).error().code, error_code::bad_mesh);
}

TEST(MakeBodyField, RefusesABodyTurnedInsideOut) {
  textured_model box = make_flat_box({0.01, 0.01, 0.01});
  for (coarse_triangle& t : box.mesh.triangles) {
    std::swap(t.vertex[1], t.vertex[2]);
    std::swap(t.uv[1], t.uv[2]);
  }
  const auto made = built_field(box);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, error_code::bad_mesh);
}

TEST(MakeBodyField, RefusesWallsThatItsNodesCannotShow) {
  field_settings few;
  few.most_nodes = 50'000;
  const auto made = built_field(make_flat_box({0.03, 0.03, 0.0003}, 64), few);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, error_code::limit_exceeded);
  EXPECT_NE(made.error().message.find("0.600000 mm"), std::string::npos) << made.error().message;
  EXPECT_TRUE(built_field(make_flat_box({0.03, 0.03, 0.002}, 64), few));
}

// A needle's points are far from its middle: corners of single triangles, in every order of their corners.
TEST(MakeBodyField, ThePointsOfAFitReachEveryCorner) {
  const double step = 0.1e-3;
  for (const vec3& far :
       {vec3(0.03, 0.0003, 0.0), vec3(0.0, 0.0003, 0.0), vec3(0.03, 0.003, 0.0), vec3(0.005, 0.03, 0.0)}) {
    for (std::uint32_t turn = 0; turn < 3; ++turn) {
      plain_mesh one;
      one.positions = {vec3(0.0), vec3(0.03, 0.0, 0.0), far};
      one.triangles = {{turn, (turn + 1) % 3, (turn + 2) % 3}};
      const textured_model model = make_charted_model(one, 64, [](const vec3& p) { return p; });
      std::array<double, 3> nearest{1.0, 1.0, 1.0};
      detail::for_each_fine_point(model, {0, model.mesh.triangles.size()}, step, [&](const vec3& p) {
        for (std::size_t k = 0; k < 3; ++k) nearest[k] = std::min(nearest[k], glm::length(p - one.positions[k]));
      });
      for (const double d : nearest) EXPECT_LE(d, 1.5 * step);
    }
  }
}

TEST(MakeBodyField, KeepsToItsLimits) {
  field_settings s;
  s.most_nodes = 100'000;
  s.relief_bytes = 1'000'000;
  const body_field f = built_field(make_textured_box({0.02, 0.02, 0.02}, 512, ridges(20e-6, 1e-3)), s).value();
  EXPECT_LE(f.smooth.value.size(), s.most_nodes);
  EXPECT_LE(f.fine.bricks.size() * sizeof(detail::relief_bricks::brick), 2 * s.relief_bytes);
  EXPECT_GE(f.heap_bytes(), f.smooth.value.size() * sizeof(float));
  s = {};
  s.pitch_m = 0.9e-3;
  s.relief_pitch_m = 0.4e-3;
  const body_field given = built_field(make_flat_box({0.02, 0.02, 0.02}), s).value();
  EXPECT_EQ(given.smooth.pitch_m, 0.9e-3);
  EXPECT_EQ(given.fine.pitch_m, 0.4e-3);
  // What nobody can have is not tried.
  s.pitch_m = 1e-9;
  s.relief_pitch_m = 1e-9;
  s.most_nodes = 50'000;
  s.relief_bytes = 200'000;
  const body_field least = built_field(make_flat_box({0.02, 0.02, 0.02}), s).value();
  EXPECT_LE(least.smooth.value.size(), s.most_nodes);
  EXPECT_LE(least.fine.bricks.size() * sizeof(detail::relief_bricks::brick), 2 * s.relief_bytes);
}

}  // namespace
}  // namespace asperity
