// Block and gear: ridges that interlock, and coarse partners that carry them.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>
#include <optional>
#include <vector>

#include "benchmark_models.hpp"
#include "mesh_checks.hpp"

namespace asperity::models {
namespace {

constexpr double two_pi = 6.283185307179586;

/// Relief across the ridges: places along the surface, heights outward from mid height, both metres.
struct profile {
  std::vector<double> place_m;
  std::vector<double> height_m;
};

profile sorted(std::vector<std::pair<double, double>> points) {
  std::sort(points.begin(), points.end());
  profile out;
  for (const auto& [s, h] : points) {
    out.place_m.push_back(s);
    out.height_m.push_back(h);
  }
  return out;
}

/// Along y, over the middle row of the block's top (side = 1) or bottom (side = -1).
profile block_profile(const triangle_mesh& block, double side) {
  double row = std::numeric_limits<double>::infinity();
  for (const vec3& p : block.positions) row = std::min(row, std::abs(p.x));
  std::vector<std::pair<double, double>> points;
  for (const vec3& p : block.positions)
    if (p.x >= 0.0 && p.x < row + 1e-6 && side * p.z > 0.5 * block_size_m[2] - 1.1 * ridge_amplitude_m &&
        std::abs(p.y) < 0.5 * block_size_m[1] - 1e-6)
      points.emplace_back(p.y, side * p.z - 0.5 * block_size_m[2]);
  return sorted(points);
}

/// Around the gear from -pi to pi, place = gear_radius_m x angle from +z towards +y.
profile gear_profile(const triangle_mesh& gear) {
  std::vector<std::pair<double, double>> points;
  for (const vec3& p : gear.positions)
    if (p.x == 0.0) points.emplace_back(gear_radius_m * std::atan2(p.y, p.z), std::hypot(p.y, p.z) - gear_radius_m);
  return sorted(points);
}

/// Mean distance between upward crossings of mid height.
double wavelength_of(const profile& p) {
  std::vector<double> crossing;
  for (std::size_t i = 0; i + 1 < p.place_m.size(); ++i) {
    const double a = p.height_m[i];
    const double b = p.height_m[i + 1];
    if (a < 0.0 && b >= 0.0) crossing.push_back(p.place_m[i] - a / (b - a) * (p.place_m[i + 1] - p.place_m[i]));
  }
  return (crossing.back() - crossing.front()) / static_cast<double>(crossing.size() - 1);
}

double at(const profile& p, double place) {
  const auto above = std::upper_bound(p.place_m.begin(), p.place_m.end(), place);
  const auto i = static_cast<std::size_t>(above - p.place_m.begin());
  const double share = (place - p.place_m[i - 1]) / (p.place_m[i] - p.place_m[i - 1]);
  return p.height_m[i - 1] + share * (p.height_m[i] - p.height_m[i - 1]);
}

void expect_sine_ridges(const profile& p, double sign) {
  EXPECT_NEAR(wavelength_of(p), ridge_wavelength_m, 1e-3 * ridge_wavelength_m);
  EXPECT_NEAR(*std::max_element(p.height_m.begin(), p.height_m.end()), ridge_amplitude_m, 1e-7);
  EXPECT_NEAR(*std::min_element(p.height_m.begin(), p.height_m.end()), -ridge_amplitude_m, 1e-7);
  for (std::size_t i = 0; i < p.place_m.size(); ++i)
    ASSERT_NEAR(p.height_m[i], sign * ridge_amplitude_m * std::cos(two_pi * p.place_m[i] / ridge_wavelength_m), 1e-7);
}

TEST(ridges, are_sines_of_the_stated_pitch_and_height) {
  const triangle_mesh block = make_full(benchmark::block);
  expect_sine_ridges(block_profile(block, 1.0), 1.0);
  expect_sine_ridges(block_profile(block, -1.0), -1.0);
  const profile gear = gear_profile(make_full(benchmark::gear));
  EXPECT_EQ(gear.place_m.size(), gear_ridges * 16U);
  expect_sine_ridges(gear, 1.0);
}

TEST(ridges, of_two_blocks_and_of_block_and_gear_interlock) {
  const triangle_mesh block = make_full(benchmark::block);
  const profile bottom = block_profile(block, -1.0);
  const profile top = block_profile(block, 1.0);
  const profile gear = gear_profile(make_full(benchmark::gear));
  double blocks_off = 0.0;
  double gear_off = 0.0;
  for (double y = -15e-3; y < 15e-3; y += 0.05e-3) {
    blocks_off = std::max(blocks_off, std::abs(at(bottom, y) + at(top, y)));
    gear_off = std::max(gear_off, std::abs(at(bottom, y) + at(gear, y)));
  }
  EXPECT_LT(blocks_off, 1e-7);  // the same grid: they fit exactly
  EXPECT_LT(gear_off, 12e-6);   // chords of 32 and of 16 edges to a ridge: a (1 - cos(pi / 16)) = 9.6 um at most
}

TEST(ridges, do_not_vary_along_x_but_for_the_faded_ends) {
  int on_gear = 0, on_block = 0;
  for (const vec3& p : make_full(benchmark::gear).positions)
    if (std::abs(p.x) <= 0.5 * gear_length_m - ridge_fade_m + 1e-9) {
      ++on_gear;
      const double s = gear_radius_m * std::atan2(p.y, p.z);
      ASSERT_NEAR(std::hypot(p.y, p.z) - gear_radius_m, ridge_amplitude_m * std::cos(two_pi * s / ridge_wavelength_m),
                  1e-7);
    }
  for (const vec3& p : make_full(benchmark::block).positions) {
    if (std::abs(p.z) < 0.5 * block_size_m[2] - 1.01 * ridge_amplitude_m) continue;
    const bool side = std::abs(p.y) > 0.5 * block_size_m[1] - 1e-6;
    if (side || std::abs(p.x) > 0.5 * block_size_m[0] - ridge_fade_m + 1e-9) continue;
    ++on_block;
    const double h = std::abs(p.z) - 0.5 * block_size_m[2];
    const double sign = p.z > 0.0 ? 1.0 : -1.0;
    ASSERT_NEAR(h, sign * ridge_amplitude_m * std::cos(two_pi * p.y / ridge_wavelength_m), 1e-7);
  }
  EXPECT_GT(on_gear, 1000);
  EXPECT_GT(on_block, 1000);
}

class partner : public ::testing::TestWithParam<benchmark> {};

TEST_P(partner, is_closed_and_convex_with_the_paper_s_count) {
  const std::optional<triangle_mesh> coarse = make_coarse(GetParam());
  ASSERT_TRUE(coarse.has_value());
  EXPECT_EQ(coarse->triangles.size(), coarse_triangle_count(GetParam()));
  EXPECT_EQ(coarse->triangles.size(), GetParam() == benchmark::block ? 16U : 1600U);
  const test::topology topology = test::topology_of(*coarse);
  EXPECT_TRUE(topology.closed_manifold);
  EXPECT_EQ(topology.components, 1U);
  EXPECT_EQ(topology.euler, 2);
  double highest = -1.0;
  for (std::size_t t = 0; t < coarse->triangles.size(); ++t) {
    const auto c = test::corners(*coarse, t);
    const vec3 n = glm::normalize(glm::cross(c[1] - c[0], c[2] - c[0]));
    for (const vec3& p : coarse->positions) highest = std::max(highest, glm::dot(p - c[0], n));
  }
  EXPECT_LE(highest, 1e-9);
}

TEST_P(partner, lies_at_mid_height_of_the_ridges) {
  const triangle_mesh full = make_full(GetParam());
  const triangle_mesh coarse = *make_coarse(GetParam());
  // The gear's facets lie up to 33 um inside its circle.
  const double sagitta = GetParam() == benchmark::gear ? 33e-6 : 0.0;
  const double distance = test::largest_distance(full, coarse);
  EXPECT_LE(distance, ridge_amplitude_m + sagitta + 1e-7);
  EXPECT_GE(distance, ridge_amplitude_m - 1e-7);
  EXPECT_NEAR(test::volume_of(coarse) / test::volume_of(full), 1.0, 2e-3);
}

TEST_P(partner, has_its_sharp_edges_on_the_full_surface) {
  const triangle_mesh coarse = *make_coarse(GetParam());
  const double tolerance = GetParam() == benchmark::gear ? 33e-6 : 1e-7;
  triangle_mesh on_edges;
  for (int i = 0; i <= 20; ++i) {
    const double share = i / 20.0;
    if (GetParam() == benchmark::block) {
      const double y = (share - 0.5) * block_size_m[1];
      const double x = (share - 0.5) * block_size_m[0];
      on_edges.positions.emplace_back(0.5 * block_size_m[0], 0.5 * ridge_wavelength_m * (i - 10) / 5.0,
                                      0.5 * block_size_m[2]);
      on_edges.positions.emplace_back(-0.5 * block_size_m[0], y, -0.5 * block_size_m[2]);
      on_edges.positions.emplace_back(x, 0.5 * block_size_m[1], 0.5 * block_size_m[2]);
      on_edges.positions.emplace_back(x, -0.5 * block_size_m[1], -0.5 * block_size_m[2]);
    } else {
      const double angle = two_pi / gear_ridges * share;
      for (const double side : {-0.5, 0.5})
        on_edges.positions.emplace_back(side * gear_length_m, gear_radius_m * std::sin(angle),
                                        gear_radius_m * std::cos(angle));
    }
  }
  EXPECT_LE(test::largest_distance(on_edges, coarse), tolerance);
  EXPECT_LE(test::largest_distance(on_edges, make_full(GetParam())), tolerance);
}

/// Normals of the vertices, each triangle weighted with its angle there.
std::vector<vec3> angle_weighted_normals(const triangle_mesh& mesh) {
  std::vector<vec3> normals(mesh.positions.size(), vec3(0.0));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto c = test::corners(mesh, t);
    const vec3 n = glm::normalize(glm::cross(c[1] - c[0], c[2] - c[0]));
    for (std::size_t i = 0; i < 3; ++i) {
      const vec3 a = glm::normalize(c[(i + 1) % 3] - c[i]);
      const vec3 b = glm::normalize(c[(i + 2) % 3] - c[i]);
      normals[mesh.triangles[t][i]] += std::acos(std::clamp(glm::dot(a, b), -1.0, 1.0)) * n;
    }
  }
  for (vec3& n : normals) n = glm::normalize(n);
  return normals;
}

TEST_P(partner, meets_the_full_surface_once_along_every_interpolated_normal) {
  const triangle_mesh full = make_full(GetParam());
  const triangle_mesh coarse = *make_coarse(GetParam());
  const std::vector<vec3> normals = angle_weighted_normals(coarse);
  // A ray that leaves at the corner of a cube crosses a layer of the relief's height in sqrt(3) times that length.
  constexpr double reach = 2.0 * ridge_amplitude_m;
  const std::size_t stride = GetParam() == benchmark::gear ? 7 : 1;
  const int steps = GetParam() == benchmark::gear ? 5 : 23;
  for (std::size_t t = 0; t < coarse.triangles.size(); t += stride) {
    const auto c = test::corners(coarse, t);
    const auto& v = coarse.triangles[t];
    vec3 low = glm::min(c[0], glm::min(c[1], c[2])) - vec3(reach);
    vec3 high = glm::max(c[0], glm::max(c[1], c[2])) + vec3(reach);
    std::vector<std::array<vec3, 3>> near;
    for (std::size_t f = 0; f < full.triangles.size(); ++f) {
      const auto d = test::corners(full, f);
      const vec3 d_low = glm::min(d[0], glm::min(d[1], d[2]));
      const vec3 d_high = glm::max(d[0], glm::max(d[1], d[2]));
      if (glm::all(glm::lessThanEqual(d_low, high)) && glm::all(glm::lessThanEqual(low, d_high))) near.push_back(d);
    }
    for (int i = 0; i < steps; ++i)
      for (int j = 0; i + j < steps; ++j) {
        // Irrational-looking steps inside the triangle keep the rays off the edges of the full mesh.
        const double a = (i + 0.3137) / (steps + 0.1);
        const double b = (j + 0.2719) / (steps + 0.1);
        const vec3 from = (1.0 - a - b) * c[0] + a * c[1] + b * c[2];
        const vec3 along = glm::normalize((1.0 - a - b) * normals[v[0]] + a * normals[v[1]] + b * normals[v[2]]);
        std::size_t hits = 0;
        bool front = true;
        for (const auto& d : near) {
          if (!test::crosses(from - reach * along, from + reach * along, d)) continue;
          ++hits;
          front = front && glm::dot(glm::cross(d[1] - d[0], d[2] - d[0]), along) > 0.0;
        }
        ASSERT_EQ(hits, 1U) << "triangle " << t << " at " << a << ", " << b;
        ASSERT_TRUE(front) << "triangle " << t << " at " << a << ", " << b;
      }
  }
}

INSTANTIATE_TEST_SUITE_P(coarse, partner, ::testing::Values(benchmark::block, benchmark::gear),
                         [](const auto& test) { return std::string(to_string(test.param)); });

TEST(partners, exist_for_block_and_gear_only) {
  for (const benchmark b : {benchmark::hammer, benchmark::cad_part, benchmark::file, benchmark::torus})
    EXPECT_FALSE(make_coarse(b).has_value());
}

}  // namespace
}  // namespace asperity::models
