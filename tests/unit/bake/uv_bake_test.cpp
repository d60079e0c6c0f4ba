// Whole bakes that keep a mesh's own texture coordinates, against the surface that was baked and the atlas that a bake
// makes.
#include <cstring>
#include <gtest/gtest.h>
#include <string>
#include <utility>

#include "asperity/bake/bake.hpp"
#include "asperity/model/validate.hpp"
#include "slab_feel.hpp"

namespace asperity::bake {
namespace {

const shapes::wavy_slab slab;
constexpr double gap_m = 0.002, margin_m = 0.001;

const triangle_mesh& original() {
  static const triangle_mesh mesh = slab.fine_mesh(88);
  return mesh;
}

bake_settings keeping(triangle_mesh coarse) {
  bake_settings out;
  out.name = "slab";
  out.texture_size = 352;
  out.threads = 2;
  out.keep_uvs = true;
  out.coarse = std::move(coarse);
  return out;
}

triangle_mesh low() { return shapes::wavy_slab::unwrapped(1, gap_m, margin_m); }

triangle_mesh mirrored(triangle_mesh mesh) {
  for (auto& t : mesh.uvs)
    for (vec2& p : t) p.x = 1.0 - p.x;
  return mesh;
}

const textured_model& kept() {
  static const textured_model model = [] {
    auto r = bake(original(), keeping(low()));
    EXPECT_TRUE(r) << r.error().message;
    return *r;
  }();
  return model;
}

void expect_same_bits(const textured_model& a, const result<textured_model>& b) {
  ASSERT_TRUE(b) << b.error().message;
  ASSERT_EQ(a.texture.texels.size(), b->texture.texels.size());
  EXPECT_EQ(std::memcmp(a.texture.texels.data(), b->texture.texels.data(), a.texture.texels.size() * 12), 0);
  EXPECT_EQ(a.mesh.positions, b->mesh.positions);
}

TEST(KeptUvs, BakeAsWellAsAnAtlasThatIsMade) {
  const auto sound = validate(kept());
  EXPECT_TRUE(sound) << sound.error().message;
  const triangle_mesh given = low();
  for (std::size_t t = 0; t < given.uvs.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(glm::length(kept().mesh.triangles[t].uv[k] - given.uvs[t][k]), 0.0, 1e-7);
  bake_settings making = keeping(low());
  making.keep_uvs = false;
  const auto made = bake(original(), making);
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_NE(made->mesh.triangles[0].uv, kept().mesh.triangles[0].uv);
  // What both miss is mostly the facets of the original.
  EXPECT_LT(shapes::slab_miss(slab, kept()), 0.05);
  EXPECT_NEAR(shapes::slab_miss(slab, kept()), shapes::slab_miss(slab, *made), 0.005);
  // Errors go with the texel's size squared.
  const double texels = kept().report.quality->texel_m / made->report.quality->texel_m;
  EXPECT_LT(kept().report.rms_error_m, 1.3 * texels * texels * made->report.rms_error_m);
  EXPECT_LT(kept().report.max_error_m, 0.1 * slab.amplitude_m);
  EXPECT_EQ(kept().report.quality->lost_share, 0.0);
  EXPECT_NEAR(kept().report.quality->texel_m, (0.08 + gap_m + 2.0 * margin_m) / 352, 1e-8);
}

TEST(KeptUvs, FeelLikeTheSurface) { shapes::expect_slab_feel(slab, kept(), 0.05, 0.05); }

TEST(KeptUvs, FeelTheSameInAMirroredChart) {
  const auto model = bake(original(), keeping(mirrored(low())));
  ASSERT_TRUE(model) << model.error().message;
  shapes::expect_slab_feel(slab, *model, 0.05, 0.05);
  EXPECT_NEAR(model->report.rms_error_m, kept().report.rms_error_m, 0.02 * kept().report.rms_error_m);
}

// Twice as many texels along x as along y: the map is no similarity, and the gradient has to know.
TEST(KeptUvs, FeelTheSameWhereTexelsAreStretched) {
  triangle_mesh mesh = low();
  for (auto& t : mesh.uvs)
    for (vec2& p : t) p.y = 0.25 + 0.5 * p.y + 0.1 * p.x;
  bake_settings options = keeping(mesh);
  options.texture_size = 576;
  std::string said;
  options.remark = [&](std::string_view sentence) { said += sentence; };
  const auto model = bake(original(), options);
  ASSERT_TRUE(model) << model.error().message;
  shapes::expect_slab_feel(slab, *model, 0.05, 0.05);
  EXPECT_NEAR(shapes::slab_miss(slab, *model), shapes::slab_miss(slab, kept()), 0.01);
  EXPECT_NE(said.find("stretch the texels"), std::string::npos) << said;
}

TEST(KeptUvs, StayAtTheirCornersWhenTrianglesAreTurned) {
  const auto turn = [](triangle_mesh& mesh, std::size_t t) {
    std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
    std::swap(mesh.uvs[t][1], mesh.uvs[t][2]);
  };
  triangle_mesh inside_out = low(), mixed = low();
  for (std::size_t t = 0; t < inside_out.triangles.size(); ++t) turn(inside_out, t);
  for (const std::size_t t : {1UL, 6UL, 11UL}) turn(mixed, t);
  const auto small_bake = [](const triangle_mesh& coarse) {
    bake_settings options = keeping(coarse);
    options.texture_size = 192;
    return bake(slab.fine_mesh(24), options);
  };
  const auto straight = small_bake(low());
  ASSERT_TRUE(straight) << straight.error().message;
  expect_same_bits(*straight, small_bake(inside_out));
  expect_same_bits(*straight, small_bake(mixed));
}

TEST(KeptUvs, OfAMeshThatIsItsOwnCoarseMesh) {
  bake_settings options = keeping(low());
  options.coarse.reset();
  options.texture_size = 240;
  options.relief.height_m = [](const relief_point& p) {
    return std::abs(p.normal.z) > 0.5 ? slab.height(p.position.x, p.position.y) : 0.0;
  };
  const auto model = bake(low(), options);
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_LT(shapes::slab_miss(slab, *model), 0.03);
  EXPECT_EQ(model->mesh.triangles[0].uv, kept().mesh.triangles[0].uv);
}

TEST(KeptUvs, AreRefusedWhereThereAreNone) {
  const auto expect_refused = [](const triangle_mesh& mesh, const bake_settings& options, error_code code,
                                 const std::string& says) {
    const auto r = bake(mesh, options);
    ASSERT_FALSE(r);
    EXPECT_EQ(r.error().code, code) << r.error().message;
    EXPECT_NE(r.error().message.find(says), std::string::npos) << r.error().message;
  };
  triangle_mesh bare = low();
  bare.uvs.clear();
  expect_refused(original(), keeping(bare), error_code::bad_mesh, "no texture coordinates to keep");
  bake_settings simplifying = keeping(low());
  simplifying.coarse.reset();
  expect_refused(original(), simplifying, error_code::invalid_argument, "simplifying it to 600");
  expect_refused(bare, simplifying, error_code::bad_mesh, "no texture coordinates to keep");
}

}  // namespace
}  // namespace asperity::bake
