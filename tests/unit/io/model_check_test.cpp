// validate(): every fault that it promises to find, planted one at a time into a model that passes.
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <string>

#include "asperity/model/validate.hpp"
#include "support/piece_models.hpp"
#include "support/small_models.hpp"

namespace asperity {
namespace {

using test_support::make_flat_box;

constexpr float nan_f = std::numeric_limits<float>::quiet_NaN();

void expect_fault(error_code code, const std::string& says, const std::function<void(textured_model&)>& plant) {
  SCOPED_TRACE(says);
  textured_model model = make_flat_box({1, 1, 1}, 48);
  ASSERT_TRUE(validate(model)) << validate(model).error().message;
  plant(model);
  const auto valid = validate(model);
  ASSERT_FALSE(valid);
  EXPECT_EQ(valid.error().code, code) << valid.error().message;
  EXPECT_NE(valid.error().message.find(says), std::string::npos) << valid.error().message;
}

TEST(ModelCheck, NamesFaultsOfTheMesh) {
  using m = textured_model&;
  constexpr auto bad = error_code::bad_mesh;
  expect_fault(bad, "has 0 triangles", [](m x) { x.mesh = {}; });
  expect_fault(bad, "has 1 triangles", [](m x) { x.mesh.triangles.resize(1); });
  expect_fault(bad, "vertex 3 of the coarse mesh has a coordinate", [](m x) { x.mesh.positions[3].y = NAN; });
  expect_fault(bad, "vertex 3 of the coarse mesh has a coordinate", [](m x) { x.mesh.positions[3].y = -10001.0; });
  expect_fault(bad, "coarse triangle 5 names vertex 8 of 8", [](m x) { x.mesh.triangles[5].vertex[1] = 8; });
  expect_fault(bad, "coarse triangle 5 has no area",
               [](m x) { x.mesh.triangles[5].vertex[1] = x.mesh.triangles[5].vertex[0]; });
  expect_fault(bad, "coarse triangle 0 has no area", [](m x) {  // a needle within rounding of its longest edge
    const auto& v = x.mesh.triangles[0].vertex;
    x.mesh.positions[v[1]] = 0.5 * (x.mesh.positions[v[0]] + x.mesh.positions[v[2]]);
  });
  expect_fault(bad, "vertex 8 of the coarse mesh belongs to no triangle",
               [](m x) { x.mesh.positions.emplace_back(0.0); });
  expect_fault(bad, "is open", [](m x) { x.mesh.triangles.pop_back(); });
  expect_fault(bad, "is shared by 3 triangles", [](m x) { x.mesh.triangles.push_back(x.mesh.triangles[0]); });
  expect_fault(bad, "same direction in both",
               [](m x) { std::swap(x.mesh.triangles[4].vertex[0], x.mesh.triangles[4].vertex[1]); });
  expect_fault(bad, "inside out", [](m x) {
    for (auto& t : x.mesh.triangles) std::swap(t.vertex[0], t.vertex[1]);
  });
}

TEST(ModelCheck, NamesAVertexWhereSurfacesTouchInAPoint) {
  using m = textured_model&;
  // A second box, corner 0 of it at corner 7 of the first: as a vertex of its own, or as the same one.
  const auto add_box = [](textured_model& x, bool shared) {
    const coarse_mesh box = x.mesh;
    for (std::size_t v = shared ? 1 : 0; v < 8; ++v) x.mesh.positions.push_back(box.positions[v] + 2.0);
    for (coarse_triangle t : box.triangles) {
      for (std::uint32_t& v : t.vertex) v = shared && v == 0 ? 7 : v + (shared ? 7 : 8);
      x.mesh.triangles.push_back(t);
    }
  };
  expect_fault(error_code::bad_mesh, "vertex 7 of the coarse mesh joins surfaces that touch only there",
               [&](m x) { add_box(x, true); });
  textured_model apart = make_flat_box({1, 1, 1}, 48);
  add_box(apart, false);
  EXPECT_TRUE(detail::check_fans(apart.mesh));
  EXPECT_TRUE(detail::check_fans(test::torus_mesh(2.0, 1.0, 7, 5)));
}

TEST(ModelCheck, NamesAMeshBeyondTheLimit) {
  expect_fault(error_code::limit_exceeded, "has 1000001 triangles, more than the limit of 1000000",
               [](textured_model& x) { x.mesh.triangles.resize(max_coarse_triangles + 1); });
}

TEST(ModelCheck, NamesFaultsOfTheTexture) {
  using m = textured_model&;
  constexpr auto bad = error_code::bad_texture;
  expect_fault(bad, "coarse triangle 2 has a texture coordinate outside",
               [](m x) { x.mesh.triangles[2].uv[0].x = 1.001; });
  expect_fault(bad, "coarse triangle 2 has a texture coordinate outside",
               [](m x) { x.mesh.triangles[2].uv[0].y = NAN; });
  expect_fault(bad, "coarse triangle 2 has no area in the texture", [](m x) { x.mesh.triangles[2].uv = {}; });
  expect_fault(bad, "some overlap", [](m x) {
    for (auto& t : x.mesh.triangles) t.uv = {vec2(0, 0), vec2(1, 0), vec2(0, 1)};
  });
  expect_fault(bad, "holds 2303 texels for a declared size of 48 x 48", [](m x) { x.texture.texels.pop_back(); });
  expect_fault(bad, "0 x 48", [](m x) { x.texture.width = 0; });
  expect_fault(bad, "is not a position", [](m x) { x.texture.texels[48 * 12 + 8].z = nan_f; });
  expect_fault(bad, "is not a position", [](m x) { x.texture.texels[48 * 12 + 8].z = 10001.0F; });
}

TEST(ModelCheck, NamesFaultsOfThePieces) {
  using m = textured_model&;
  constexpr auto bad = error_code::bad_mesh;
  expect_fault(bad, "coarse triangle 0 belongs to no convex piece", [](m x) { x.pieces.clear(); });
  expect_fault(bad, "coarse triangle 11 belongs to no", [](m x) { x.pieces[0].triangles.pop_back(); });
  expect_fault(bad, "coarse triangle 3 belongs to convex pieces 0 and 0", [](m x) { x.pieces[0].triangles[7] = 3; });
  expect_fault(bad, "convex piece 0 covers coarse triangle 12 of 12", [](m x) { x.pieces[0].triangles[7] = 12; });
  expect_fault(bad, "names vertex 8 of 8", [](m x) { x.pieces[0].hull[3][1] = 8; });
  expect_fault(bad, "convex piece 0 is empty", [](m x) { x.pieces[0].hull.clear(); });
  expect_fault(bad, "convex piece 0 has a vertex", [](m x) { x.pieces[0].vertices[2].x = INFINITY; });
}

// The footprint is exact: a texel matters if, and only if, a lookup inside a chart multiplies it in.
TEST(ModelCheck, MissesNoTexelThatALookupTouches) {
  std::mt19937_64 random(7);
  const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  for (int round = 0; round < 200; ++round) {
    haptic_texture texture;
    texture.width = 1 + static_cast<std::uint32_t>(random() % 9);
    texture.height = 1 + static_cast<std::uint32_t>(random() % 9);
    const std::array<vec2, 3> uv{vec2(unit(), unit()), vec2(unit(), unit()), vec2(unit(), unit())};
    const detail::chart_footprint footprint(texture, uv);
    const auto holds = [&](std::size_t i, std::size_t j) {
      const auto rows = footprint.rows();
      const auto columns = footprint.columns(static_cast<std::uint32_t>(j));
      return rows.first <= j && j <= rows.last && columns.first <= i && i <= columns.last;
    };
    for (int k = 0; k < 200; ++k) {
      double a = unit();
      double b = unit();
      if (a + b > 1.0) a = 1.0 - a, b = 1.0 - b;
      const vec2 p = uv[0] + a * (uv[1] - uv[0]) + b * (uv[2] - uv[0]);
      const double x = std::clamp(p.x * texture.width - 0.5, 0.0, texture.width - 1.0);
      const double y = std::clamp(p.y * texture.height - 0.5, 0.0, texture.height - 1.0);
      const auto i = static_cast<std::size_t>(x);
      const auto j = static_cast<std::size_t>(y);
      for (const std::size_t jj : {j, std::min<std::size_t>(j + 1, texture.height - 1)}) {
        for (const std::size_t ii : {i, std::min<std::size_t>(i + 1, texture.width - 1)}) {
          ASSERT_TRUE(holds(ii, jj)) << "round " << round << " texel " << ii << ", " << jj;
        }
      }
    }
  }
}

TEST(ModelCheck, LeavesTexelsAloneThatNoLookupTouches) {
  textured_model model = make_flat_box({1, 1, 1}, 48);
  // The outer ring of a cell's gutter is two texels from its chart.
  for (std::size_t j = 0; j < 48; ++j) {
    for (std::size_t i = 0; i < 48; ++i) {
      if (i % 16 == 0 || i % 16 == 15 || j % 24 == 0 || j % 24 == 23)
        model.texture.texels[j * 48 + i] = glm::vec3(nan_f);
    }
  }
  EXPECT_TRUE(validate(model)) << validate(model).error().message;
  model.texture.texels[48 * 5 + 1] = glm::vec3(nan_f);  // the inner ring is half a texel from it
  EXPECT_FALSE(validate(model));
}

}  // namespace
}  // namespace asperity
