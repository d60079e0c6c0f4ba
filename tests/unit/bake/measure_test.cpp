#include "bake/measure.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "bake/atlas.hpp"
#include "bake/geometry.hpp"
#include "bake/project.hpp"
#include "shapes.hpp"

namespace asperity::bake {
namespace {

constexpr std::uint32_t side = 256;

struct textured {
  coarse_mesh mesh;
  haptic_texture texture;
  double texel_m = 0.0;
};

textured textured_box() {
  const triangle_mesh box = shapes::box({0.04, 0.04, 0.04}, {1, 1, 1});
  const triangle_bvh tree(box.positions, box.triangles);
  const atlas charts = *make_atlas(box, side);
  stage_monitor monitor;
  textured out;
  out.texel_m = charts.texel_m;
  out.mesh.positions = box.positions;
  for (std::size_t t = 0; t < box.triangles.size(); ++t) out.mesh.triangles.push_back({box.triangles[t], charts.uv[t]});
  const crease_normals directions(box, tree, 0.5 * charts.texel_m);
  out.texture = project(box, charts, directions, tree, 0.01, side, 1, monitor)->texture;
  return out;
}

surface_error measure_against(const triangle_mesh& full, const textured& t, unsigned threads = 1) {
  const triangle_bvh tree(full.positions, full.triangles);
  stage_monitor monitor;
  return *measure(full, tree, t.mesh, t.texture, t.texel_m, threads, monitor);
}

TEST(Measure, TheSameSurfaceIsNoDistanceAway) {
  const surface_error e = measure_against(shapes::box({0.04, 0.04, 0.04}, {6, 6, 6}), textured_box());
  EXPECT_LT(e.max_m(), 1e-7);
  EXPECT_LT(e.crack_max_m, 1e-6);
}

TEST(Measure, AScaledOriginalIsAsFarAsItsFacesAndCorners) {
  const double gap = 0.001;
  const surface_error e = measure_against(shapes::box({0.042, 0.042, 0.042}, {12, 12, 12}), textured_box());
  EXPECT_NEAR(e.to_original.max_m, gap, 1e-6);  // the faces
  EXPECT_NEAR(e.to_original_rms_m, gap, 1e-6);
  EXPECT_NEAR(e.to_textured.max_m, gap * std::sqrt(3.0), 1e-6);  // the corners
  EXPECT_GT(e.to_textured_rms_m, gap);
  EXPECT_DOUBLE_EQ(e.max_m(), e.to_textured.max_m);
  EXPECT_NEAR(e.rms_m(), std::hypot(e.to_original_rms_m, e.to_textured_rms_m) / std::sqrt(2.0), 1e-15);
}

TEST(Measure, OneWrongTexelShows) {
  textured t = textured_box();
  const vec2 uv = (t.mesh.triangles[0].uv[0] + t.mesh.triangles[0].uv[1] + t.mesh.triangles[0].uv[2]) / 3.0;
  const auto i = static_cast<std::size_t>(uv.x * side);
  const auto j = static_cast<std::size_t>(uv.y * side);
  t.texture.texels[j * side + i] *= 1.1F;
  EXPECT_GT(measure_against(shapes::box({0.04, 0.04, 0.04}, {6, 6, 6}), t).to_original.max_m, 0.0005);
}

TEST(Measure, SeesACrack) {
  textured t = textured_box();
  for (glm::vec3& texel : t.texture.texels)
    if (texel.z > 0.01999F && texel.z < 0.02001F) texel.x += 0.0002F;  // slides the top sideways
  EXPECT_GT(measure_against(shapes::box({0.04, 0.04, 0.04}, {6, 6, 6}), t).crack_max_m, 0.00015);
}

TEST(Measure, PercentilesAreByWeight) {
  EXPECT_EQ(spread_of({}, {}), length_spread{});
  EXPECT_EQ(spread_of({3.0}, {2.0}), (length_spread{3.0, 3.0, 3.0}));
  // 0 to 99, in no order: half lies within the 50th, 99 % within the 99th.
  std::vector<double> values;
  for (int i = 0; i < 100; ++i) values.push_back((37 * i) % 100);
  EXPECT_EQ(spread_of(values, std::vector<double>(100, 0.1)), (length_spread{49.0, 98.0, 99.0}));
  // The largest weighs nothing: it shows in the maximum only.
  EXPECT_EQ(spread_of({1.0, 2.0, 50.0}, {0.3, 0.7, 0.0}), (length_spread{2.0, 2.0, 50.0}));
}

// A dent of 1 mm that the texture does not have, in a hundred-and-twentieth of the surface.
TEST(Measure, PercentilesTellASmallPlaceFromAllOfIt) {
  const textured box = textured_box();
  const surface_error e =
      measure_against(shapes::box({0.04, 0.04, 0.04}, {40, 40, 40},
                                  [](vec3 p) {
                                    const bool dent = p.z > 0.0199 && std::abs(p.x) < 0.0045 && std::abs(p.y) < 0.0045;
                                    return dent ? p - vec3(0.0, 0.0, 0.001) : p;
                                  }),
                      box);
  EXPECT_LT(e.to_textured.median_m, 1e-7);
  EXPECT_NEAR(e.to_textured.max_m, 0.001, 1e-6);
  EXPECT_NEAR(e.to_original.max_m, 0.001, 1e-6);
  EXPECT_LT(e.to_original.median_m, 1e-7);
  EXPECT_NEAR(e.lost.share, 81.0 / 9600.0, 0.001);  // 9 by 9 mm, deeper than two texels
}

TEST(Measure, SeesTheMiddleOfALargeTriangle) {
  // The original's corners are where the texture is; the middles of its faces are not.
  textured t = textured_box();
  for (glm::vec3& texel : t.texture.texels)
    if (texel.z > 0.01999F && texel.z < 0.02001F && std::abs(texel.x) < 0.01F && std::abs(texel.y) < 0.01F)
      texel.z -= 0.001F;
  EXPECT_NEAR(measure_against(shapes::box({0.04, 0.04, 0.04}, {1, 1, 1}), t).to_textured.max_m, 0.001, 1e-6);
}

TEST(Measure, SpacingIsATexelOnAFlatFaceAndMoreOnASlope) {
  haptic_texture texture{4, 3, {}};
  std::vector<std::uint32_t> chart;
  for (std::uint32_t j = 0; j < 3; ++j)
    for (std::uint32_t i = 0; i < 4; ++i) {
      texture.texels.emplace_back(0.001F * static_cast<float>(i), 0.001F * static_cast<float>(j),
                                  i == 1 ? 0.002F : 0.0F);
      chart.push_back(i == 3 ? 1 : 0);
    }
  // Along the rows 6 pairs are steep; along the columns 8 pairs are flat. Pairs between the charts do not count.
  const length_spread s = texel_spacing(texture, chart);
  EXPECT_NEAR(s.median_m, 0.001, 1e-9);
  EXPECT_NEAR(s.max_m, std::sqrt(5.0) * 0.001, 1e-9);
  chart.assign(12, no_halfedge);
  EXPECT_EQ(texel_spacing(texture, chart), length_spread{});
}

TEST(Measure, DoesNotDependOnTheNumberOfThreads) {
  const triangle_mesh full = shapes::box({0.041, 0.041, 0.041}, {20, 20, 20});
  const textured t = textured_box();
  const surface_error one = measure_against(full, t, 1);
  const surface_error four = measure_against(full, t, 4);
  EXPECT_EQ(one.to_original_rms_m, four.to_original_rms_m);
  EXPECT_EQ(one.to_textured_rms_m, four.to_textured_rms_m);
  EXPECT_EQ(one.max_m(), four.max_m());
}

}  // namespace
}  // namespace asperity::bake
