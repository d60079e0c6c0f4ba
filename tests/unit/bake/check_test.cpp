#include "bake/check.hpp"

#include <array>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <utility>

#include "shapes.hpp"

namespace asperity::bake {
namespace {

double enclosed_volume(const triangle_mesh& mesh) {
  double six = 0.0;
  for (const auto& t : mesh.triangles)
    six += glm::dot(mesh.positions[t[0]], glm::cross(mesh.positions[t[1]], mesh.positions[t[2]]));
  return six / 6.0;
}

void expect_fault(const triangle_mesh& mesh, std::initializer_list<std::string> words) {
  const auto r = check(mesh);
  ASSERT_FALSE(r.has_value());
  EXPECT_EQ(r.error().code, error_code::bad_mesh);
  for (const std::string& word : words) EXPECT_NE(r.error().message.find(word), std::string::npos) << r.error().message;
}

TEST(Check, AcceptsSoundMeshes) {
  const auto box = check(shapes::box({0.1, 0.2, 0.3}, {2, 3, 4}));
  ASSERT_TRUE(box.has_value()) << box.error().message;
  EXPECT_EQ(box->euler, 2);
  EXPECT_EQ(box->components, 1u);
  EXPECT_FALSE(box->flipped);
  const auto torus = check(shapes::wavy_torus{}.mesh(40, 20));
  ASSERT_TRUE(torus.has_value()) << torus.error().message;
  EXPECT_EQ(torus->euler, 0);
}

TEST(Check, RefusesTheEmptyMesh) { expect_fault({}, {"empty"}); }

TEST(Check, RefusesOneTriangle) {
  expect_fault({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, {}}, {"1 triangle,", "at least 4"});
}

TEST(Check, NamesAnIndexOutOfRange) {
  triangle_mesh mesh = shapes::tetrahedron();
  mesh.triangles[2][1] = 17;
  expect_fault(mesh, {"index out of range", "triangle 2", "vertex 17 of 4"});
}

TEST(Check, NamesACoordinateThatIsNotANumber) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    triangle_mesh mesh = shapes::tetrahedron();
    mesh.positions[3].y = bad;
    expect_fault(mesh, {"not a number", "vertex 3"});
  }
}

TEST(Check, CountsTrianglesWithoutArea) {
  triangle_mesh mesh = shapes::box({0.1, 0.1, 0.1}, {4, 4, 4});
  const auto victim = mesh.triangles[5];
  mesh.positions[victim[0]] = mesh.positions[victim[1]];
  expect_fault(mesh, {"without area", "2 triangles"});
}

TEST(Check, CountsOpenEdgesAndSaysWhere) {
  triangle_mesh mesh = shapes::tetrahedron();
  mesh.triangles.push_back(mesh.triangles.front());  // keeps 4 triangles when the first goes
  mesh = shapes::box({0.2, 0.2, 0.2}, {1, 1, 1});
  mesh.triangles.erase(mesh.triangles.begin());
  expect_fault(mesh, {"not closed", "3 open edges", "close the holes"});
}

TEST(Check, FindsEdgesWithMoreThanTwoTriangles) {
  triangle_mesh mesh = shapes::box({0.1, 0.1, 0.1}, {1, 1, 1});
  mesh.triangles.push_back(mesh.triangles[0]);
  expect_fault(mesh, {"3 edges with more than two triangles"});
}

TEST(Check, FindsVerticesWhereSurfacesTouch) {
  triangle_mesh mesh = shapes::both(shapes::tetrahedron(), shapes::tetrahedron(vec3(0.0), -0.1));
  mesh = shapes::both(shapes::tetrahedron(), shapes::reversed(shapes::tetrahedron(vec3(0.0), -0.1)));
  for (auto& t : mesh.triangles)
    for (auto& v : t)
      if (v == 4) v = 0;  // the apex of the second one, at the same place
  expect_fault(mesh, {"1 vertex where surfaces touch", "vertex 0"});
}

TEST(Check, TurnsTrianglesThatWindAgainstTheirNeighbours) {
  const triangle_mesh sound = shapes::box({0.1, 0.1, 0.1}, {3, 3, 3});
  std::mt19937_64 rng(5);
  for (const std::size_t every : std::array<std::size_t, 3>{108, 7, 3}) {  // one triangle, some, nearly half
    triangle_mesh mesh = sound;
    std::size_t turned = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (rng() % every != 0 && (every != 108 || t != 4)) continue;
      std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
      ++turned;
    }
    ASSERT_LT(2 * turned, mesh.triangles.size());
    const auto r = check(mesh);
    ASSERT_TRUE(r) << r.error().message;
    EXPECT_EQ(r->turned_triangles, turned);
    EXPECT_FALSE(r->flipped);
    EXPECT_NEAR(enclosed_volume(r->mesh), 0.001, 1e-12);
    const auto again = check(r->mesh);
    ASSERT_TRUE(again);
    EXPECT_EQ(again->turned_triangles, 0U);
  }
}

// Where most of a surface is inside-out, most of it decides, and the whole is turned afterwards.
TEST(Check, MixedWindingThatIsMostlyInsideOutComesOutRight) {
  triangle_mesh mesh = shapes::reversed(shapes::box({0.1, 0.1, 0.1}, {2, 2, 2}));
  for (const std::size_t t : std::array<std::size_t, 4>{0, 9, 10, 30})
    std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
  const auto r = check(mesh);
  ASSERT_TRUE(r) << r.error().message;
  EXPECT_EQ(r->turned_triangles, 4U);
  EXPECT_TRUE(r->flipped);
  EXPECT_NEAR(enclosed_volume(r->mesh), 0.001, 1e-12);
}

TEST(Check, RefusesASurfaceWithOneSide) {
  // A Klein bottle: a grid whose one end is joined to the other turned over.
  constexpr std::uint32_t around = 12, along = 16;
  triangle_mesh mesh;
  for (std::uint32_t i = 0; i < along; ++i)
    for (std::uint32_t j = 0; j < around; ++j) {
      const double u = 2 * std::numbers::pi * i / along, v = 2 * std::numbers::pi * j / around;
      const double r = 0.1 + 0.02 * (std::cos(u / 2) * std::sin(v) - std::sin(u / 2) * std::sin(2 * v));
      mesh.positions.emplace_back(r * std::cos(u), r * std::sin(u),
                                  0.02 * (std::sin(u / 2) * std::sin(v) + std::cos(u / 2) * std::sin(2 * v)));
    }
  const auto at = [&](std::uint32_t i, std::uint32_t j) {
    return i < along ? i * around + j % around : (around - j % around) % around;
  };
  for (std::uint32_t i = 0; i < along; ++i)
    for (std::uint32_t j = 0; j < around; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  expect_fault(mesh, {"12 edges", "opposite senses", "only one side"});
}

TEST(Check, TurnsAMeshThatIsInsideOut) {
  const auto r = check(shapes::reversed(shapes::box({0.1, 0.1, 0.1}, {2, 2, 2})));
  ASSERT_TRUE(r.has_value()) << r.error().message;
  EXPECT_TRUE(r->flipped);
  EXPECT_FALSE(check(r->mesh)->flipped);
}

TEST(Check, TakesSeveralComponentsAndCavities) {
  const triangle_mesh box = shapes::box({0.1, 0.1, 0.1}, {1, 1, 1});
  const auto apart = check(shapes::both(box, shapes::scaled(box, 0.5, {1.0, 0.0, 0.0})));
  ASSERT_TRUE(apart.has_value()) << apart.error().message;
  EXPECT_EQ(apart->components, 2u);
  EXPECT_EQ(apart->euler, 4);
  const auto hollow = check(shapes::both(box, shapes::reversed(shapes::scaled(box, 0.5))));
  ASSERT_TRUE(hollow.has_value()) << hollow.error().message;
  expect_fault(shapes::both(box, shapes::reversed(shapes::scaled(box, 0.5, {1.0, 0.0, 0.0}))),
               {"component that is inside-out"});
}

TEST(Check, AsksAboutUnits) {
  const triangle_mesh box = shapes::box({0.1, 0.1, 0.1}, {1, 1, 1});
  expect_fault(shapes::scaled(box, 1e5), {"units", "metres"});
  expect_fault(shapes::scaled(box, 1e-5), {"too small"});
  expect_fault(shapes::scaled(box, 1.0, {100.0, 0.0, 0.0}), {"single precision", "origin"});
}

TEST(Check, DropsUnusedVertices) {
  triangle_mesh mesh = shapes::tetrahedron();
  mesh.positions.insert(mesh.positions.begin(), vec3(std::numeric_limits<double>::quiet_NaN()));
  for (auto& t : mesh.triangles)
    for (auto& v : t) ++v;
  const auto r = check(mesh);
  ASSERT_TRUE(r.has_value()) << r.error().message;
  EXPECT_EQ(r->mesh.positions.size(), 4u);
}

TEST(Check, NamesTheMeshItIsToldOf) {
  const auto r = check({}, "the coarse mesh");
  EXPECT_EQ(r.error().message.rfind("the coarse mesh ", 0), 0u);
}

}  // namespace
}  // namespace asperity::bake
