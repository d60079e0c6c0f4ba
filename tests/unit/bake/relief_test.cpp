// Maps of surfaces in closed form, baked: is the relief the surface's, and does it feel like it?
#include "asperity/bake/relief.hpp"

#include <cstring>
#include <gtest/gtest.h>
#include <numeric>
#include <vector>

#include "asperity/bake/bake.hpp"
#include "asperity/bake/map_relief.hpp"
#include "asperity/model/validate.hpp"
#include "mapped_shapes.hpp"
#include "slab_feel.hpp"

namespace asperity::bake {
namespace {

const shapes::wavy_slab slab;
constexpr std::uint32_t map_side = 128;

height_map_settings slab_range() {
  return {-slab.amplitude_m, 2.0 * slab.amplitude_m, map_wrap::clamp, map_wrap::clamp};
}

bake_settings with_relief(relief heights) {
  bake_settings out;
  out.name = "slab";
  out.texture_size = 208;
  out.threads = 2;
  out.relief = std::move(heights);
  return out;
}

double miss(const textured_model& model, double within_m = 1.0) { return shapes::slab_miss(slab, model, within_m); }

textured_model baked_height_map(std::uint32_t bits) {
  const triangle_mesh mesh = slab.mesh(1);
  const auto heights = height_map_relief(mesh, slab.height_map(map_side, bits), slab_range());
  EXPECT_TRUE(heights) << heights.error().message;
  return *bake(mesh, with_relief(*heights));
}

const textured_model& baked_normal_map() {
  static const textured_model model = [] {
    const triangle_mesh mesh = slab.mesh(1);
    const auto made = integrate_normal_map(mesh, slab.normal_map(192, 8), {});
    EXPECT_TRUE(made) << made.error().message;
    return *bake(mesh, with_relief(made->heights));
  }();
  return model;
}

TEST(HeightMap, BakesToTheSurfaceThatItWasMadeFrom) {
  const textured_model model = baked_height_map(16);
  const auto sound = validate(model);
  EXPECT_TRUE(sound) << sound.error().message;
  EXPECT_EQ(model.mesh.triangles.size(), 12U) << "the low-poly mesh is its own coarse mesh";
  EXPECT_LT(miss(model), 0.03);
  EXPECT_LT(miss(baked_height_map(8)), 0.03);
  const triangle_mesh mesh = slab.mesh(1);
  map_image floats = slab.height_map(map_side, 0);
  for (float& h : floats.samples) h = static_cast<float>((h - 0.5) * 2.0 * slab.amplitude_m);
  EXPECT_LT(miss(*bake(mesh, with_relief(*height_map_relief(mesh, floats, {0.0, 1.0})))), 0.03);
  // The report's error is against the mesh with its relief, measured by closest points: about as small.
  EXPECT_GT(model.report.rms_error_m, 0.0);
  EXPECT_LT(model.report.rms_error_m, 0.02 * slab.amplitude_m);
  EXPECT_NEAR(model.report.peak_to_valley_m, 2.0 * slab.amplitude_m, 0.2 * slab.amplitude_m);
}

TEST(NormalMap, BakesToTheSurfaceThatItWasMadeFrom) { EXPECT_LT(miss(baked_normal_map()), 0.05); }

TEST(HeightMap, FeelsLikeTheSurface) { shapes::expect_slab_feel(slab, baked_height_map(16), 0.05, 0.05); }
TEST(NormalMap, FeelsLikeTheSurface) { shapes::expect_slab_feel(slab, baked_normal_map(), 0.05, 0.05); }

// Share of the closed form's RMS by which an integrated relief misses it on a stretched, curved unwrapping.
double torus_miss(const shapes::mapped_torus& torus, const triangle_mesh& mesh, const relief& heights) {
  shapes::dice roll(3);
  double squares = 0.0, own = 0.0;
  for (int i = 0; i < 20000; ++i) {
    relief_point p;
    p.triangle = static_cast<std::uint32_t>(roll.below(mesh.triangles.size()));
    const auto b = roll.barycentric();
    for (std::size_t k = 0; k < 3; ++k) {
      p.position += b[k] * mesh.positions[mesh.triangles[p.triangle][k]];
      p.uv += b[k] * mesh.uvs[p.triangle][k];
    }
    const double h = torus.height(p.uv.x, p.uv.y);
    squares += std::pow(heights.height_m(p) - h, 2);
    own += h * h;
  }
  return std::sqrt(squares / own);
}

TEST(NormalMap, IntegratesAcrossSeamsAndStretch) {
  const shapes::mapped_torus torus;
  const triangle_mesh mesh = torus.mesh(48, 32);
  const auto made = integrate_normal_map(mesh, torus.normal_map(map_side, 16), {});
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_LT(torus_miss(torus, mesh, made->heights), 0.05);
  EXPECT_LT(made->fit.residual_share(), 0.06);
  EXPECT_LT(made->fit.iterations, 400U);
  // Seen from the wrong side: nothing that has these slopes looks like it.
  const auto wrong = integrate_normal_map(mesh, torus.normal_map(map_side, 8), {.green_is_down = true});
  ASSERT_TRUE(wrong);
  EXPECT_GT(wrong->fit.residual_share(), 0.5);
  // A map for the other convention, said so, is the same map.
  map_image turned = torus.normal_map(map_side, 16);
  for (std::size_t i = 1; i < turned.samples.size(); i += 3) turned.samples[i] = 1.0F - turned.samples[i];
  const auto down = integrate_normal_map(mesh, turned, {.green_is_down = true});
  ASSERT_TRUE(down);
  EXPECT_LT(torus_miss(torus, mesh, down->heights), 0.05);
}

TEST(NormalMap, MirroredCoordinatesGiveTheSameSurface) {
  const shapes::mapped_torus torus;
  triangle_mesh mesh = torus.mesh(48, 32);
  for (auto& t : mesh.uvs)
    for (vec2& uv : t) uv.x = 1.0 - uv.x;
  const auto made = integrate_normal_map(mesh, torus.normal_map(map_side, 16), {});
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_LT(torus_miss(torus, mesh, made->heights), 0.05);
}

void expect_same_bits(const result<textured_model>& a, const result<textured_model>& b) {
  ASSERT_TRUE(a) << a.error().message;
  ASSERT_TRUE(b) << b.error().message;
  ASSERT_EQ(a->texture.texels.size(), b->texture.texels.size());
  EXPECT_EQ(std::memcmp(a->texture.texels.data(), b->texture.texels.data(), a->texture.texels.size() * 12), 0);
  EXPECT_EQ(a->mesh.positions, b->mesh.positions);
}

// A relief on the slab, and on one of which some triangles come with their other side up.
void expect_same_relief(const std::vector<std::size_t>& turned_triangles) {
  const triangle_mesh mesh = slab.mesh(2);
  triangle_mesh turned = mesh;
  for (const std::size_t t : turned_triangles) {
    std::swap(turned.triangles[t][1], turned.triangles[t][2]);
    std::swap(turned.uvs[t][1], turned.uvs[t][2]);
  }
  const auto small = [](const triangle_mesh& on, const relief& heights) {
    bake_settings options = with_relief(heights);
    options.texture_size = 96;
    return bake(on, options);
  };
  const map_image heights = slab.height_map(64, 16);
  expect_same_bits(small(turned, *height_map_relief(turned, heights, slab_range())),
                   small(mesh, *height_map_relief(mesh, heights, slab_range())));
  const map_image normals = slab.normal_map(64, 16);
  expect_same_bits(small(turned, integrate_normal_map(turned, normals, {})->heights),
                   small(mesh, integrate_normal_map(mesh, normals, {})->heights));
}

TEST(Relief, IsTheSameOnAMeshOfMixedWinding) { expect_same_relief({3, 4, 9, 20}); }

TEST(Relief, IsTheSameOnAMeshThatComesInsideOut) {
  std::vector<std::size_t> all(slab.mesh(2).triangles.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  expect_same_relief(all);
}

TEST(Relief, OfAMapIsRefusedOnAMeshWithoutTextureCoordinates) {
  const triangle_mesh mesh = slab.mesh(1);
  const auto heights = height_map_relief(mesh, slab.height_map(16, 16), slab_range());
  triangle_mesh bare = mesh;
  bare.uvs.clear();
  const auto refused = bake(bare, with_relief(*heights));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, error_code::bad_mesh);
  EXPECT_NE(refused.error().message.find("no texture coordinates"), std::string::npos) << refused.error().message;
}

TEST(Relief, IsKeptWhenTheMeshIsSimplified) {
  const triangle_mesh mesh = slab.mesh(12);
  bake_settings options = with_relief(*height_map_relief(mesh, slab.height_map(map_side, 16), slab_range()));
  options.triangles = 100;
  const auto model = bake(mesh, options);
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_LE(model->mesh.triangles.size(), 100U);
  EXPECT_LT(miss(*model, 0.014), 0.05) << "edges are rounded by the simplification";
}

void expect_refused(const result<textured_model>& r, error_code code, const std::string& says) {
  ASSERT_FALSE(r);
  EXPECT_EQ(r.error().code, code);
  EXPECT_NE(r.error().message.find(says), std::string::npos) << r.error().message;
}

TEST(Relief, RefusesHeightsThatCannotBeMeant) {
  const triangle_mesh mesh = slab.mesh(1);
  const map_image map = slab.height_map(64, 16);
  expect_refused(bake(mesh, with_relief(*height_map_relief(mesh, map, {-0.1, 0.2}))), error_code::bad_texture,
                 "more than 5 % of the mesh's diagonal");
  expect_refused(bake(mesh, with_relief({[](const relief_point& p) { return std::sqrt(p.position.x); }, 0.0})),
                 error_code::bad_texture, "not finite");
  std::string said;
  bake_settings coarse = with_relief(*height_map_relief(mesh, slab.height_map(map_side, 16), slab_range()));
  coarse.texture_size = 32;
  coarse.remark = [&](std::string_view sentence) { said += sentence; };
  ASSERT_TRUE(bake(mesh, coarse));
  EXPECT_NE(said.find("too coarse for a relief"), std::string::npos) << said;
}

template <class Result>
void expect_fault(const Result& r, error_code code, const std::string& says) {
  ASSERT_FALSE(r) << says;
  EXPECT_EQ(r.error().code, code) << r.error().message;
  EXPECT_NE(r.error().message.find(says), std::string::npos) << r.error().message;
}

TEST(Maps, NameWhatIsWrongWithThem) {
  const triangle_mesh mesh = slab.mesh(1);
  triangle_mesh bare = mesh;
  bare.uvs.clear();
  const map_image heights = slab.height_map(16, 8);
  const map_image normals = slab.normal_map(16, 8);
  expect_fault(height_map_relief(bare, heights, {}), error_code::bad_mesh, "no texture coordinates");
  expect_fault(integrate_normal_map(bare, normals, {}), error_code::bad_mesh, "no texture coordinates");
  expect_fault(height_map_relief(mesh, normals, {}), error_code::bad_texture, "has colours");
  expect_fault(integrate_normal_map(mesh, heights, {}), error_code::bad_texture, "is grey");
  map_image holes = slab.height_map(16, 0);
  holes.samples[17] = std::numeric_limits<float>::quiet_NaN();
  expect_fault(height_map_relief(mesh, holes, {}), error_code::bad_texture, "column 1, row 1");
  map_image object_space = normals;
  for (std::size_t i = 2; i < object_space.samples.size(); i += 3) object_space.samples[i] = i % 2 == 0 ? 0.1F : 0.9F;
  expect_fault(integrate_normal_map(mesh, object_space, {}), error_code::bad_texture, "no tangent-space map");
  triangle_mesh open = mesh;
  open.triangles.pop_back();
  open.uvs.pop_back();
  expect_fault(integrate_normal_map(open, normals, {}), error_code::bad_mesh, "not closed");
}

}  // namespace
}  // namespace asperity::bake
