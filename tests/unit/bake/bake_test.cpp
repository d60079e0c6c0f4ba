#include "asperity/bake/bake.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <numbers>
#include <string>
#include <vector>

#include "asperity/model/validate.hpp"
#include "bake/geometry.hpp"
#include "bake/halfedges.hpp"
#include "bake/triangle_bvh.hpp"
#include "shapes.hpp"

namespace asperity::bake {
namespace {

const shapes::wavy_torus wavy;

const triangle_mesh& full_torus() {
  static const triangle_mesh mesh = wavy.mesh(160, 72);
  return mesh;
}

bake_settings small_options(unsigned threads = 2) {
  bake_settings options;
  options.name = "wavy torus";
  options.triangles = 300;
  options.texture_size = 256;
  options.threads = threads;
  return options;
}

const textured_model& baked_torus() {
  static const textured_model model = *bake(full_torus(), small_options());
  return model;
}

TEST(Bake, MakesAModelThatPassesTheModelCheck) {
  const textured_model& model = baked_torus();
  const auto r = validate(model);
  EXPECT_TRUE(r.has_value()) << r.error().message;
  EXPECT_EQ(model.name, "wavy torus");
  EXPECT_EQ(model.mesh.triangles.size(), 300u);
  EXPECT_EQ(model.report.full_triangles, 23040u);
  EXPECT_GT(model.report.texels, 256u * 256u / 3u);
  EXPECT_GT(model.pieces.size(), 1u);
  EXPECT_NEAR(model.box.high.x, 0.07, 0.002);
  // Volume of a torus: 2 pi^2 R r^2; chords and the fit to the relief nearly cancel.
  const double volume = 2.0 * std::pow(std::numbers::pi, 2) * wavy.major_m * wavy.minor_m * wavy.minor_m;
  EXPECT_NEAR(model.mass.volume_m3 / volume, 1.0, 0.02);
  EXPECT_LT(glm::length(model.mass.centre_of_mass), 2e-4);
}

TEST(Bake, TextureSamplesLieOnTheFormula) {
  const textured_model& model = baked_torus();
  shapes::dice roll(1);
  double squares = 0.0;
  double worst = 0.0;
  constexpr int samples = 20000;
  for (int i = 0; i < samples; ++i) {
    const auto& t = model.mesh.triangles[roll.below(model.mesh.triangles.size())];
    const auto b = roll.barycentric();
    const double offset =
        std::abs(wavy.radial_offset(model.texture.sample(b[0] * t.uv[0] + b[1] * t.uv[1] + b[2] * t.uv[2])));
    squares += offset * offset;
    worst = std::max(worst, offset);
  }
  // Chords across a wave of curvature a (2 pi / 11 mm)^2: facets of 2 mm cost a sixth of the amplitude a in the middle,
  // and texels of 1 mm, both ways, a tenth; where the relief is steep the texels are farther apart.
  EXPECT_LT(worst, 0.5 * wavy.amplitude_m);
  EXPECT_LT(std::sqrt(squares / samples), 0.15 * wavy.amplitude_m);
}

TEST(Bake, ReportsWhatItMeasured) {
  const bake_report& report = baked_torus().report;
  const double diagonal = baked_torus().box.diagonal();
  EXPECT_GT(report.rms_error_m, 0.0);
  EXPECT_LT(report.rms_error_m, 5e-4 * diagonal);
  EXPECT_LT(report.max_error_m, 4e-3 * diagonal);
  EXPECT_GT(report.peak_to_valley_m, 2.0 * wavy.amplitude_m);
  EXPECT_GE(report.max_displacement_m, 0.5 * report.peak_to_valley_m);
  EXPECT_EQ(report.fallback_texels, 0u);
}

TEST(Bake, ReportsItsQuality) {
  const bake_report& report = baked_torus().report;
  const double diagonal = baked_torus().box.diagonal();
  ASSERT_TRUE(report.quality);
  const bake_quality& q = *report.quality;
  for (const length_spread& s : {q.to_original, q.to_textured, q.texel_spacing}) {
    EXPECT_GT(s.median_m, 0.0);
    EXPECT_LT(s.median_m, s.p99_m);
    EXPECT_LE(s.p99_m, s.max_m);
  }
  EXPECT_DOUBLE_EQ(std::max(q.to_original.max_m, q.to_textured.max_m), report.max_error_m);
  EXPECT_DOUBLE_EQ(std::hypot(q.to_original_rms_m, q.to_textured_rms_m) / std::sqrt(2.0), report.rms_error_m);
  EXPECT_LT(q.crack_max_m, 2e-3 * diagonal);
  EXPECT_NEAR(q.texel_spacing.median_m, q.texel_m, 0.1 * q.texel_m);
  EXPECT_NEAR(q.atlas_utilisation, static_cast<double>(report.texels) / (256.0 * 256.0), 0.02);
  EXPECT_LT(q.surface_to_hull_max_m, 1e-3 * diagonal);
  EXPECT_LT(q.bridged_air_max_m, 4.2e-3 * diagonal);
}

// Texel by texel, from the texture coordinates alone: inside a triangle and two texels around it all are positions.
TEST(Bake, LeavesNoHoleInAChartOrItsGutter) {
  const textured_model& model = baked_torus();
  const double side = model.texture.width;
  std::size_t looked_at = 0;
  for (const coarse_triangle& t : model.mesh.triangles) {
    const std::array<vec3, 3> c{vec3(side * t.uv[0], 0.0), vec3(side * t.uv[1], 0.0), vec3(side * t.uv[2], 0.0)};
    const bounds box = bounds_of(c);
    for (int j = static_cast<int>(box.low.y) - 2; j <= static_cast<int>(box.high.y) + 2; ++j)
      for (int i = static_cast<int>(box.low.x) - 2; i <= static_cast<int>(box.high.x) + 2; ++i) {
        if (i < 0 || j < 0 || i >= static_cast<int>(side) || j >= static_cast<int>(side)) continue;
        const vec3 centre{i + 0.5, j + 0.5, 0.0};
        if (glm::length(centre - closest_on_triangle(centre, c)) > 1.999) continue;
        const vec3 texel = model.texture.at(static_cast<std::size_t>(i), static_cast<std::size_t>(j));
        EXPECT_TRUE(std::isfinite(texel.x) && std::isfinite(texel.y) && std::isfinite(texel.z)) << i << ", " << j;
        ++looked_at;
      }
  }
  EXPECT_GT(looked_at, model.report.texels);
}

TEST(Bake, TheTextureIsWholeAcrossTheEdgesOfItsCharts) {
  const coarse_mesh& mesh = baked_torus().mesh;
  std::vector<index_triangle> triangles;
  for (const coarse_triangle& t : mesh.triangles) triangles.push_back(t.vertex);
  const connectivity net = connect(triangles, mesh.positions.size());
  double worst = 0.0;
  for (std::uint32_t h = 0; h < net.mate.size(); ++h) {
    const std::uint32_t m = net.mate[h];
    for (int i = 0; i <= 20; ++i) {
      const double s = i / 20.0;
      const auto& a = mesh.triangles[h / 3].uv;
      const auto& b = mesh.triangles[m / 3].uv;
      const vec3 here = baked_torus().texture.sample((1.0 - s) * a[h % 3] + s * a[next_halfedge(h) % 3]);
      const vec3 there = baked_torus().texture.sample((1.0 - s) * b[next_halfedge(m) % 3] + s * b[m % 3]);
      worst = std::max(worst, glm::length(here - there));
    }
  }
  EXPECT_LT(worst, 0.003 * baked_torus().box.diagonal());
}

TEST(Bake, GivesTheSameBitsOnAnyNumberOfThreads) {
  const auto one = bake(full_torus(), small_options(1));
  const auto four = bake(full_torus(), small_options(4));
  ASSERT_TRUE(one && four);
  EXPECT_EQ(one->mesh.positions, four->mesh.positions);
  ASSERT_EQ(one->texture.texels.size(), four->texture.texels.size());
  EXPECT_EQ(std::memcmp(one->texture.texels.data(), four->texture.texels.data(),
                        one->texture.texels.size() * sizeof(glm::vec3)),
            0);
  EXPECT_EQ(one->pieces.size(), four->pieces.size());
  EXPECT_EQ(one->report.rms_error_m, four->report.rms_error_m);
  EXPECT_EQ(one->report.max_error_m, four->report.max_error_m);
  EXPECT_EQ(one->report.peak_to_valley_m, four->report.peak_to_valley_m);
  EXPECT_EQ(one->report.quality->to_textured, four->report.quality->to_textured);
  EXPECT_EQ(one->report.quality->crack_max_m, four->report.quality->crack_max_m);
}

TEST(Bake, KeepsWhatAFileKeeps) {
  EXPECT_FALSE(baked_torus().mesh.positions.empty() || baked_torus().mesh.triangles.empty());
  for (const vec3& p : baked_torus().mesh.positions) EXPECT_EQ(p, to_float32(p));
  for (const coarse_triangle& t : baked_torus().mesh.triangles)
    for (const vec2& uv : t.uv) {
      EXPECT_EQ(uv.x, to_float32(uv.x));
      EXPECT_EQ(uv.y, to_float32(uv.y));
    }
}

// A box with ridges along y on its top that fade out towards the rim, and its coarse partner of 12 triangles.
const vec3 block_size{0.04, 0.04, 0.02};
double ridge(const vec3& p) {
  const double edge = std::min(0.02 - std::abs(p.x), 0.02 - std::abs(p.y));
  return 0.0005 * std::cos(2.0 * std::numbers::pi * p.x / 0.004) * smoothstep(edge / 0.004);
}
triangle_mesh ridged_block() {
  return shapes::box(block_size, {160, 80, 4}, [](vec3 p) {
    if (p.z > 0.0099) p.z += ridge(p);
    return p;
  });
}

TEST(Bake, AGivenCoarseBoxKeepsTheRidgesInTheTexture) {
  bake_settings options = small_options();
  options.texture_size = 512;
  options.coarse = shapes::box(block_size, {1, 1, 1});
  const auto model = bake(ridged_block(), options);
  ASSERT_TRUE(model.has_value()) << model.error().message;
  EXPECT_TRUE(validate(*model).has_value());
  EXPECT_EQ(model->mesh.triangles.size(), 12u);
  ASSERT_EQ(model->pieces.size(), 1u);
  EXPECT_NEAR(model->report.peak_to_valley_m, 0.001, 0.0001);
  EXPECT_LT(model->report.rms_error_m, 1e-4 * model->box.diagonal());
  // The depth lookup is orthographic: over a point of the top the texture must hold that very point's height.
  shapes::dice roll(2);
  double worst_height = 0.0;
  double worst_slide = 0.0;
  for (const coarse_triangle& t : model->mesh.triangles) {
    const std::array<vec3, 3> c{model->mesh.positions[t.vertex[0]], model->mesh.positions[t.vertex[1]],
                                model->mesh.positions[t.vertex[2]]};
    if (unit_normal(c).z < 0.5) continue;
    for (int i = 0; i < 2000; ++i) {
      const auto b = roll.barycentric();
      const vec3 p = b[0] * c[0] + b[1] * c[1] + b[2] * c[2];
      const vec3 q = model->texture.sample(b[0] * t.uv[0] + b[1] * t.uv[1] + b[2] * t.uv[2]);
      worst_height = std::max(worst_height, std::abs(q.z - p.z - ridge(p)));
      worst_slide = std::max(worst_slide, std::hypot(q.x - p.x, q.y - p.y));
    }
  }
  // Facets and texels of a quarter of a millimetre each cut 2 % off a ridge of 4 mm; the fade-out adds a little.
  EXPECT_LT(worst_height, 0.06 * 0.0005);
  EXPECT_LT(worst_slide, 1e-4);
}

TEST(Bake, RefusesACoarseMeshOfOtherUnits) {
  bake_settings options = small_options();
  options.coarse = shapes::scaled(shapes::box(block_size, {1, 1, 1}), 1000.0);
  const auto r = bake(ridged_block(), options);
  ASSERT_FALSE(r.has_value());
  EXPECT_EQ(r.error().code, error_code::bad_mesh);
  EXPECT_NE(r.error().message.find("times larger"), std::string::npos) << r.error().message;
}

TEST(Bake, RefusesABadCoarseMeshByName) {
  bake_settings options = small_options();
  options.coarse = shapes::box(block_size, {1, 1, 1});
  options.coarse->triangles.pop_back();
  const auto r = bake(ridged_block(), options);
  ASSERT_FALSE(r.has_value());
  EXPECT_EQ(r.error().message.rfind("the coarse mesh is not closed", 0), 0u) << r.error().message;
}

TEST(Bake, RemarksOnWhatItDidDifferently) {
  std::vector<std::string> remarks;
  bake_settings options = small_options();
  options.texture_size = 64;
  options.remark = [&](std::string_view sentence) { remarks.emplace_back(sentence); };
  const triangle_mesh box = shapes::box(block_size, {2, 2, 2});
  ASSERT_TRUE(bake(box, options).has_value());
  EXPECT_TRUE(remarks.empty());
  options.coarse = shapes::reversed(shapes::box(block_size, {1, 1, 1}));
  const auto model = bake(shapes::reversed(box), options);
  ASSERT_TRUE(model.has_value()) << model.error().message;
  EXPECT_GT(model->mass.volume_m3, 0.0);
  EXPECT_EQ(remarks, (std::vector<std::string>{"the mesh was inside-out and has been turned",
                                               "the coarse mesh was inside-out and has been turned"}));
}

TEST(Bake, RemarksOnPiecesThatItCouldNotMake) {
  std::vector<std::string> remarks;
  bake_settings options = small_options();
  options.texture_size = 64;
  options.pieces = 7;
  options.remark = [&](std::string_view sentence) { remarks.emplace_back(sentence); };
  ASSERT_TRUE(bake(shapes::box(block_size, {2, 2, 2}), options).has_value());
  EXPECT_EQ(remarks, std::vector<std::string>{"made 1 convex pieces, not the 7 asked for"});
}

TEST(Bake, RefusesOptionsOutOfRange) {
  bake_settings few = small_options();
  few.triangles = 3;
  EXPECT_EQ(bake(full_torus(), few).error().code, error_code::invalid_argument);
  bake_settings none = small_options();
  none.pieces = 0;
  EXPECT_EQ(bake(full_torus(), none).error().code, error_code::invalid_argument);
  bake_settings tiny = small_options();
  tiny.texture_size = 1;
  EXPECT_EQ(bake(full_torus(), tiny).error().code, error_code::invalid_argument);
  bake_settings huge = small_options();
  huge.texture_size = 1U << 20;
  EXPECT_EQ(bake(full_torus(), huge).error().code, error_code::invalid_argument);
}

TEST(Bake, TellsOfItsStagesAndStopsAtAnyOfThem) {
  std::vector<std::string> stages;
  bake_settings options = small_options();
  const triangle_mesh mesh = wavy.mesh(60, 30);
  options.progress = [&](std::string_view stage, double done) {
    EXPECT_GE(done, 0.0);
    EXPECT_LE(done, 1.0);
    if (stages.empty() || stages.back() != stage) stages.emplace_back(stage);
    return true;
  };
  ASSERT_TRUE(bake(mesh, options).has_value());
  EXPECT_EQ(stages,
            (std::vector<std::string>{"check", "simplify", "compare", "atlas", "project", "pieces", "measure"}));
  for (const std::string& last : stages) {
    options.progress = [&](std::string_view stage, double) { return stage != last; };
    const auto r = bake(mesh, options);
    ASSERT_FALSE(r.has_value()) << last;
    EXPECT_EQ(r.error().code, error_code::cancelled) << last;
  }
}

}  // namespace
}  // namespace asperity::bake
