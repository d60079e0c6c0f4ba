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
