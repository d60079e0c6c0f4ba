// Samples stand for the whole surface, are the highest points of it, and lie where their tiles say.
#include "asperity/cells/surface_sampler.hpp"

#include <array>
#include <gtest/gtest.h>
#include <limits>
#include <map>

#include "asperity/cells/make_surface_cells.hpp"
#include "support/height_models.hpp"
#include "support/random_hulls.hpp"
#include "support/small_models.hpp"

namespace asperity {
namespace {

using namespace test_support;

surface_cells cut(const textured_model& model, double sample_pitch = 0.0, double pitch = 4e-4) {
  cell_settings settings;
  settings.pitch_m = pitch;
  settings.sample_pitch_m = sample_pitch;
  auto made = make_surface_cells(model, settings);
  EXPECT_TRUE(made);
  return made ? std::move(made).value() : surface_cells{};
}

/// Area of the samples on faces that look along n.
double area_of(const surface_cells& body, const vec3& n) {
  double sum = 0.0;
  for (const sample_tile& t : body.tiles) {
    const sample_origin& origin = body.origins[t.origin];
    if (origin.outgoing > 0 || glm::dot(origin.normal_b, n) < 0.99) continue;
    for (std::uint32_t i = 0; i < t.count; ++i) sum += body.samples[t.first + i].area_m2;
  }
  return sum;
}

TEST(SurfaceSamples, AreasOfAFaceAddUpToItsArea) {
  const textured_model box = make_flat_box({0.01, 0.005, 0.008}, 192);
  for (const double pitch : {1e-5, 5e-4, 2e-3}) {
    const surface_cells body = cut(box, pitch);
    double whole = 0.0, expected = 0.0;
    for (const surface_cell& c : body.cells) {
      const double area = area_of(body, c.n_b);
      EXPECT_NEAR(area, c.area_m2, 0.03 * c.area_m2);  // a face's diagonal runs through texels, which count twice
      whole += area;
      expected += c.area_m2;
    }
    EXPECT_NEAR(whole, expected, 0.03 * expected);
    EXPECT_NEAR(expected, 8.0 * (0.01 * 0.005 + 0.005 * 0.008 + 0.008 * 0.01), 1e-9);
  }
}

TEST(SurfaceSamples, AreOnePitchApart) {
  const textured_model box = make_flat_box({0.01, 0.01, 0.01}, 384);
  const double texel = 0.02 / std::sqrt(124.0 * 188.0);  // of a face's chart
  for (const double pitch : {1e-5, 5e-4, 1e-3, 2e-3}) {
    const surface_cells body = cut(box, pitch);
    std::size_t on_faces = 0;
    for (const sample_tile& t : body.tiles) on_faces += body.origins[t.origin].outgoing == 0 ? t.count : 0;
    const double blocks = 6.0 * 4e-4 / std::pow(std::max(texel, pitch), 2);
    EXPECT_GE(static_cast<double>(on_faces), 0.9 * blocks);
    EXPECT_LE(static_cast<double>(on_faces),
              1.6 * blocks);  // a block that a diagonal or a border cuts is two, or small
  }
}

TEST(SurfaceSamples, AreTheHighestTexelOfTheirBlock) {
  // A random height per texel; found again by the position, which is exact.
  plate_spec spec;
  spec.texels = 120;
  textured_model plate = *make_plate(spec);
  test::uniform_source random(1);
  for (std::uint32_t j = 0; j < 124; ++j) {
    for (std::uint32_t i = 0; i < 124; ++i) {
      plate.texture.texels[std::size_t{j} * plate.texture.width + i].z = static_cast<float>(random(0.0, 1e-3));
    }
  }
  const double texel = 0.02 / 120.0;
  constexpr std::size_t block = 4;
  const surface_cells body = cut(plate, block * texel);
  const detail::surface_index index(plate);

  // The highest texel of each triangle in each block, by looking at all of them.
  using key = std::array<std::size_t, 3>;  // triangle, block column, block row
  std::map<key, std::pair<float, glm::vec3>> highest;
  std::map<key, int> texels;
  for (std::size_t t = 0; t < plate.mesh.triangles.size(); ++t) {
    if (index.normal[t].z < 0.9) continue;
    for (std::size_t j = 0; j < plate.texture.height; ++j) {
      for (std::size_t i = 0; i < plate.texture.width; ++i) {
        const vec3 bary = index.texels[t].barycentric({static_cast<double>(i), static_cast<double>(j)});
        if (std::min({bary.x, bary.y, bary.z}) < 0.0) continue;
        const glm::vec3 p(plate.texture.at(i, j));
        const key k{t, i / block, j / block};
        ++texels[k];
        if (!highest.count(k) || p.z > highest[k].first) highest[k] = {p.z, p};
      }
    }
  }
  std::map<std::array<float, 3>, double> samples;  // by position, with the area
  for (const sample_tile& t : body.tiles) {
    if (body.origins[t.origin].normal_b.z < 0.9) continue;
    for (std::uint32_t i = 0; i < t.count; ++i) {
      const surface_sample& s = body.samples[t.first + i];
      samples[{s.position_b.x, s.position_b.y, s.position_b.z}] += static_cast<double>(s.area_m2);
    }
  }
  std::map<std::array<float, 3>, double> expected;
  for (const auto& [k, top] : highest) {
    expected[{top.second.x, top.second.y, top.second.z}] += texel * texel * texels[k];
  }
  ASSERT_EQ(samples.size(), expected.size());
  for (const auto& [p, area] : expected) {
    ASSERT_TRUE(samples.count(p));
    EXPECT_NEAR(samples[p], area, 1e-4 * area);
  }
}

TEST(SurfaceSamples, ATriangleWithoutATexelCentreHasASampleAllTheSame) {
  plate_spec spec;
  spec.texels = 8;
  spec.cells_x = spec.cells_y = 16;
  const textured_model plate = *make_plate(spec);
  const surface_cells body = cut(plate);
  std::size_t on_top = 0;
  for (const sample_tile& t : body.tiles) on_top += body.origins[t.origin].normal_b.z > 0.9 ? t.count : 0;
  EXPECT_GE(on_top, 2U * 16U * 16U);
}

TEST(SurfaceSamples, ATriangleThatIsTinyInTheWorldAndLargeInTheTextureIsOneBlock) {
  textured_model box = make_flat_box({0.01, 0.01, 0.01}, 48);
  // A needle between two vertices: 1e-150 of area per texel, more blocks per texel than an integer holds.
  const std::uint32_t first = box.mesh.triangles[0].vertex[0], second = box.mesh.triangles[0].vertex[1];
  const vec3 tip = 0.5 * (box.mesh.positions[first] + box.mesh.positions[second]) + vec3(0.0, 0.0, 1e-17);
  box.mesh.positions.push_back(tip);
  box.mesh.triangles.push_back({{first, second, static_cast<std::uint32_t>(box.mesh.positions.size() - 1)},
                                {vec2(0.0, 0.0), vec2(1.0, 0.0), vec2(0.0, 1.0)}});
  const surface_cells body = cut(box);
  EXPECT_FALSE(body.samples.empty());
  for (const surface_sample& s : body.samples) ASSERT_TRUE(is_finite(vec3(s.position_b)) && std::isfinite(s.area_m2));
}

TEST(SurfaceSamples, SharpEdgesAreSampledAlongTheirLengthAndAtTheirEnds) {
  const textured_model box = make_flat_box({0.01, 0.005, 0.008}, 192);
  const surface_cells body = cut(box);
  const double pitch = body.settings.feature_pitch_m;
  double on_edges = 0.0;
  int vertices = 0;
  for (const sample_tile& t : body.tiles) {
    const sample_origin& o = body.origins[t.origin];
    if (o.outgoing == 0) continue;
    EXPECT_EQ(o.normal_b, vec3(0.0));
    const auto leaving = std::span(body.outgoing).subspan(o.first_outgoing, o.outgoing);
    for (const vec3& d : leaving) EXPECT_NEAR(glm::length(d), 1.0, 1e-12);
    // All directions lead back, seen along the outward diagonal at the sample.
    const vec3 p = vec3(body.samples[t.first].position_b) / vec3(0.01, 0.005, 0.008);
    const vec3 outwards(std::fabs(p.x) > 0.9999 ? p.x : 0.0, std::fabs(p.y) > 0.9999 ? p.y : 0.0,
                        std::fabs(p.z) > 0.9999 ? p.z : 0.0);
    for (const vec3& d : leaving) EXPECT_LE(glm::dot(d, outwards), 1e-9);
    const double sides = glm::dot(outwards, outwards);
    if (sides > 2.5) {  // a corner: three edges, and the diagonals of its faces
      ++vertices;
      EXPECT_EQ(t.count, 1U);
      EXPECT_NEAR(body.samples[t.first].area_m2, pitch * pitch, 1e-6 * pitch * pitch);
      continue;
    }
    EXPECT_GT(sides, 1.5);
    EXPECT_EQ(o.outgoing, 4U);
    for (std::uint32_t i = 0; i < t.count; ++i) on_edges += static_cast<double>(body.samples[t.first + i].area_m2);
  }
  EXPECT_EQ(vertices, 8);
  EXPECT_NEAR(on_edges, 4.0 * (0.02 + 0.01 + 0.016) * pitch, 1e-5 * on_edges);
}

TEST(SurfaceSamples, AnEdgeBetweenChartsLiesBetweenTheirReliefs) {
  const textured_model box =
      make_textured_box({0.01, 0.01, 0.01}, 192, [](const vec3&, const vec3& n) { return n.z > 0.5 ? 2e-4 : 0.0; });
  const surface_cells body = cut(box);
  int seen = 0;
  for (const sample_tile& t : body.tiles) {
    if (body.origins[t.origin].outgoing != 4) continue;
    for (std::uint32_t i = 0; i < t.count; ++i) {
      const glm::vec3 p = body.samples[t.first + i].position_b;
      const bool upright = std::fabs(p.x) > 0.0099F && std::fabs(p.y) > 0.0099F;
      if (p.z < 0.0F || upright) continue;
      EXPECT_NEAR(p.z, 0.0101, 1e-6);
      ++seen;
    }
  }
  EXPECT_GT(seen, 100);
}

TEST(SurfaceSamples, TilesHoldAFewNeighboursInTheirBalls) {
  const surface_cells body = cut(make_textured_box({0.01, 0.005, 0.008}, 192, ridges(1e-4, 2e-3)));
  std::vector<int> owners(body.samples.size(), 0);
  double radii = 0.0;
  for (std::uint32_t i = 0; i < body.tiles.size(); ++i) {
    const sample_tile& t = body.tiles[i];
    ASSERT_GE(t.count, 1U);
    ASSERT_LE(t.count, 16U);
    ASSERT_LT(t.origin, body.origins.size());
    radii += t.radius_m;
    for (std::uint32_t s = 0; s < t.count; ++s) {
      ++owners[t.first + s];
      ASSERT_LE(glm::distance(vec3(body.samples[t.first + s].position_b), t.centre_b), t.radius_m);
    }
    int found = 0;
    body.tile_tree.query({t.centre_b, t.centre_b}, [&](std::uint32_t n) noexcept { found += n == i ? 1 : 0; });
    EXPECT_EQ(found, 1);
  }
  for (const int n : owners) ASSERT_EQ(n, 1);
  // Neighbours: a tile of 16 samples a pitch apart is a few pitches wide.
  EXPECT_LT(radii / static_cast<double>(body.tiles.size()), 4.0 * body.settings.sample_pitch_m);
}

}  // namespace
}  // namespace asperity
