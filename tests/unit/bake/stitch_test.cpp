#include "bake/stitch.hpp"

#include <cmath>
#include <cstring>
#include <gtest/gtest.h>

#include "bake/atlas.hpp"
#include "bake/geometry.hpp"
#include "bake/measure.hpp"
#include "bake/project.hpp"
#include "shapes.hpp"

namespace asperity::bake {
namespace {

constexpr std::uint32_t side = 256;
const vec3 size{0.04, 0.04, 0.04};

struct textured {
  coarse_mesh mesh;
  haptic_texture texture;
  double texel_m = 0.0;
};

textured textured_box(const triangle_bvh& full) {
  const triangle_mesh box = shapes::box(size, {1, 1, 1});
  const atlas charts = *make_atlas(box, side);
  stage_monitor monitor;
  textured out;
  out.mesh.positions = box.positions;
  for (std::size_t t = 0; t < box.triangles.size(); ++t) out.mesh.triangles.push_back({box.triangles[t], charts.uv[t]});
  out.texel_m = charts.texel_m;
  const crease_normals directions(box, full, 0.5 * charts.texel_m);
  out.texture = project(box, charts, directions, full, 0.01, side, 1, monitor)->texture;
  return out;
}

TEST(Stitch, LeavesATextureWithoutGapsAsItIs) {
  const triangle_mesh full = shapes::box(size, {4, 4, 4});
  const triangle_bvh tree(full.positions, full.triangles);
  textured t = textured_box(tree);
  const haptic_texture before = t.texture;
  EXPECT_EQ(stitch(t.mesh, tree, 0.25 * t.texel_m, t.texture), 0u);
  EXPECT_EQ(std::memcmp(before.texels.data(), t.texture.texels.data(), before.texels.size() * sizeof(glm::vec3)), 0);
}

TEST(Stitch, ClosesAGapOnTheOriginal) {
  const triangle_mesh full = shapes::box(size, {4, 4, 4});
  const triangle_bvh tree(full.positions, full.triangles);
  textured t = textured_box(tree);
  // The top's texels near the edge at +x have slid along it, as if their rays had found the surface elsewhere.
  const haptic_texture before = t.texture;
  for (glm::vec3& texel : t.texture.texels)
    if (texel.z > 0.01999F && texel.z < 0.02001F && texel.x > 0.0185F && std::abs(texel.y) < 0.01F)
      texel.y += static_cast<float>(3.0 * t.texel_m);
  const double limit = 0.25 * t.texel_m;
  ASSERT_GT(largest_crack(t.mesh, t.texture), 2.0 * t.texel_m);
  EXPECT_GT(stitch(t.mesh, tree, limit, t.texture), 0u);
  EXPECT_LT(largest_crack(t.mesh, t.texture), 1.5 * limit);  // measured between the points that were closed
  std::size_t moved = 0;
  for (std::size_t i = 0; i < t.texture.texels.size(); ++i) {
    EXPECT_EQ(std::isnan(before.texels[i].x), std::isnan(t.texture.texels[i].x));
    if (std::isnan(before.texels[i].x) || before.texels[i] == t.texture.texels[i]) continue;
    ++moved;
    EXPECT_LT(tree.closest(vec3(t.texture.texels[i])).distance_m, 3.0 * t.texel_m) << i;
  }
  EXPECT_LT(moved, t.texture.texels.size() / 50);
}

}  // namespace
}  // namespace asperity::bake
