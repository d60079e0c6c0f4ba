// The six models: counts, topology, size, determinism.
#include "benchmark_models.hpp"

#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <ostream>
#include <string>

#include "mesh_checks.hpp"

namespace asperity::models {
namespace {

struct expectation {
  benchmark model;
  std::size_t triangles;
  std::ptrdiff_t euler;
};

void PrintTo(const expectation& e, std::ostream* out) { *out << to_string(e.model); }

/// The model, made once for all tests.
const triangle_mesh& full(benchmark b) {
  static std::array<triangle_mesh, all_benchmarks.size()> made;
  triangle_mesh& mesh = made[static_cast<std::size_t>(b)];
  if (mesh.triangles.empty()) mesh = make_full(b);
  return mesh;
}

class full_model : public ::testing::TestWithParam<expectation> {};

TEST_P(full_model, has_the_paper_s_triangle_count) {
  EXPECT_EQ(full(GetParam().model).triangles.size(), GetParam().triangles);
  EXPECT_EQ(full_triangle_count(GetParam().model), GetParam().triangles);
}

TEST_P(full_model, is_one_closed_outward_oriented_surface) {
  const triangle_mesh& mesh = full(GetParam().model);
  for (const vec3& p : mesh.positions) ASSERT_TRUE(is_finite(p));
  const test::topology topology = test::topology_of(mesh);
  EXPECT_TRUE(topology.closed_manifold);
  EXPECT_EQ(topology.components, 1U);
  EXPECT_EQ(topology.euler, GetParam().euler);
  EXPECT_GT(test::volume_of(mesh), 5e-6);
  EXPECT_TRUE(mesh.uvs.empty());
}

TEST_P(full_model, has_no_sliver_without_area) {
  // 1e-9 m^2 is a thousandth of a square millimetre; a single-precision position is good to about 1e-8 m here.
  EXPECT_GT(test::smallest_area(full(GetParam().model)), 1e-9);
}

TEST_P(full_model, does_not_cut_itself) { EXPECT_EQ(test::self_intersections(full(GetParam().model)), 0U); }

TEST_P(full_model, is_as_large_as_a_hand_tool) {
  vec3 low(1.0);
  vec3 high(-1.0);
  for (const vec3& p : full(GetParam().model).positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const vec3 size = high - low;
  const double longest = std::max(size.x, std::max(size.y, size.z));
  EXPECT_GE(longest, 0.039);
  EXPECT_LE(longest, 0.3);
}

TEST_P(full_model, is_the_same_to_the_bit_every_time) {
  EXPECT_EQ(test::digest_of(make_full(GetParam().model)), test::digest_of(full(GetParam().model)));
}

TEST_P(full_model, has_positions_that_single_precision_holds) {
  for (const vec3& p : full(GetParam().model).positions)
    for (int axis = 0; axis < 3; ++axis) {
      const double steps = p[axis] / position_step_m;
      ASSERT_EQ(steps, std::round(steps));
      ASSERT_LE(std::abs(steps), 0x1p24);
    }
}

// Euler characteristic 2 - 2 x holes: the CAD part has three round holes and a slot, the torus its own.
INSTANTIATE_TEST_SUITE_P(
    table_1, full_model,
    ::testing::Values(expectation{benchmark::block, 65536, 2}, expectation{benchmark::gear, 25600, 2},
                      expectation{benchmark::hammer, 433152, 2}, expectation{benchmark::cad_part, 658432, -6},
                      expectation{benchmark::file, 285824, 2}, expectation{benchmark::torus, 128000, 0}),
    [](const auto& test) { return std::string(to_string(test.param.model)); });

TEST(benchmark_names, round_trip) {
  for (const benchmark b : all_benchmarks) EXPECT_EQ(parse_benchmark(to_string(b)), b);
  EXPECT_EQ(to_string(benchmark::cad_part), "cad_part");
  EXPECT_FALSE(parse_benchmark("bunny").has_value());
  EXPECT_FALSE(parse_benchmark("").has_value());
}

TEST(mesh_checks, see_the_faults_that_they_look_for) {
  const triangle_mesh& good = full(benchmark::block);
  triangle_mesh open = good;
  open.triangles.pop_back();
  EXPECT_FALSE(test::topology_of(open).closed_manifold);
  triangle_mesh turned = good;
  std::swap(turned.triangles[7][0], turned.triangles[7][1]);
  EXPECT_FALSE(test::topology_of(turned).closed_manifold);
  triangle_mesh pinched = good;  // two vertices of opposite faces become one: every edge is fine, the vertex is not
  const std::uint32_t from = 0;
  const auto to = static_cast<std::uint32_t>(good.positions.size() - 1);
  for (auto& t : pinched.triangles)
    for (auto& v : t) v = v == to ? from : v;
  pinched.positions.pop_back();
  EXPECT_FALSE(test::topology_of(pinched).closed_manifold);
  triangle_mesh pierced = good;  // a vertex of the bottom, pulled out through the top
  for (vec3& p : pierced.positions)
    if (std::abs(p.x) < 1e-3 && std::abs(p.y) < 1e-9 && p.z < -9e-3) p.z = 15e-3;
  EXPECT_GT(test::self_intersections(pierced), 0U);
}

}  // namespace
}  // namespace asperity::models
