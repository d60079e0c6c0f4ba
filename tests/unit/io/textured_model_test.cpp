// A textured model in a file: what comes back is what went in, to the bit.
#include <cstring>
#include <gtest/gtest.h>
#include <string>

#include "asperity/core/float32.hpp"
#include "asperity/field/packed_field.hpp"
#include "asperity/io/mesh_file.hpp"
#include "asperity/io/textured_model_file.hpp"
#include "glb_editor.hpp"
#include "scratch_folder.hpp"
#include "some_quality.hpp"
#include "support/small_models.hpp"

namespace asperity {
namespace {

using test_support::make_textured_box;
using test_support::ridges;
using test_support::scratch_folder;

textured_model sample_model() {
  textured_model model = make_textured_box({0.02, 0.03, 0.01}, 64, ridges(1e-3, 5e-3));
  model.name = "box \"quoted\" \xc3\xa9";
  model.report = {1e-6, 2.5e-5, 0.1, 3.3e-3, 660000, 17, 4096};
  model.report.quality = test_support::some_quality();
  // Two pieces, one of them flat, as a bake of a concave part would leave them.
  convex_piece flat;
  flat.vertices = {model.mesh.positions[0], model.mesh.positions[2], model.mesh.positions[3]};
  flat.hull = {{0, 1, 2}};
  flat.triangles = {10};
  flat.flat = true;
  model.pieces[0].triangles = {11, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0};
  model.pieces.push_back(flat);
  return model;
}

/// Bitwise, because NaN texels are part of the content.
template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

void expect_same(const textured_model& a, const textured_model& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_TRUE(same_bits(a.mesh.positions, b.mesh.positions));
  ASSERT_EQ(a.mesh.triangles.size(), b.mesh.triangles.size());
  for (std::size_t t = 0; t < a.mesh.triangles.size(); ++t) {
    EXPECT_EQ(a.mesh.triangles[t].vertex, b.mesh.triangles[t].vertex);
    EXPECT_EQ(a.mesh.triangles[t].uv, b.mesh.triangles[t].uv);
  }
  EXPECT_EQ(a.texture.width, b.texture.width);
  EXPECT_EQ(a.texture.height, b.texture.height);
  EXPECT_TRUE(same_bits(a.texture.texels, b.texture.texels));
  ASSERT_EQ(a.pieces.size(), b.pieces.size());
  for (std::size_t k = 0; k < a.pieces.size(); ++k) {
    EXPECT_TRUE(same_bits(a.pieces[k].vertices, b.pieces[k].vertices));
    EXPECT_EQ(a.pieces[k].hull, b.pieces[k].hull);
    EXPECT_EQ(a.pieces[k].triangles, b.pieces[k].triangles);
    EXPECT_EQ(a.pieces[k].flat, b.pieces[k].flat);
  }
  EXPECT_EQ(a.mass.volume_m3, b.mass.volume_m3);
  EXPECT_EQ(a.mass.centre_of_mass, b.mass.centre_of_mass);
  EXPECT_EQ(a.mass.inertia_per_mass, b.mass.inertia_per_mass);
  EXPECT_EQ(a.box.low, b.box.low);
  EXPECT_EQ(a.box.high, b.box.high);
  EXPECT_EQ(a.report.rms_error_m, b.report.rms_error_m);
  EXPECT_EQ(a.report.max_error_m, b.report.max_error_m);
  EXPECT_EQ(a.report.peak_to_valley_m, b.report.peak_to_valley_m);
  EXPECT_EQ(a.report.max_displacement_m, b.report.max_displacement_m);
  EXPECT_EQ(a.report.full_triangles, b.report.full_triangles);
  EXPECT_EQ(a.report.fallback_texels, b.report.fallback_texels);
  EXPECT_EQ(a.report.texels, b.report.texels);
  EXPECT_EQ(a.report.quality, b.report.quality);
}

TEST(TexturedModelFile, ComesBackBitForBit) {
  const scratch_folder folder;
  const textured_model model = sample_model();
  ASSERT_TRUE(std::isnan(model.texture.texels[63].x)) << "the sample must hold texels of no face";
  const auto saved = io::save_textured_model(model, folder.file("m.glb"));
  ASSERT_TRUE(saved) << saved.error().message;
  const auto back = io::load_textured_model(folder.file("m.glb"));
  ASSERT_TRUE(back) << back.error().message;
  expect_same(model, *back);
}

TEST(TexturedModelFile, WithoutTheQualityOfItsBakeStillLoads) {
  const scratch_folder folder;
  textured_model model = sample_model();
  model.report.quality.reset();
  ASSERT_TRUE(io::save_textured_model(model, folder.file("old.glb")));
  EXPECT_EQ(test_support::read_all(folder.file("old.glb")).find("quality"), std::string::npos);
  const auto back = io::load_textured_model(folder.file("old.glb"));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_FALSE(back->report.quality);
  expect_same(model, *back);
}

TEST(TexturedModelFile, RoundsToFloat32OnceAndThenNoMore) {
  const scratch_folder folder;
  textured_model model = sample_model();
  for (vec3& p : model.mesh.positions) p *= 1.0 + 1e-10;
  for (convex_piece& piece : model.pieces) {
    for (vec3& p : piece.vertices) p *= 1.0 + 1e-10;
  }
  ASSERT_TRUE(io::save_textured_model(model, folder.file("1.glb")));
  const auto once = io::load_textured_model(folder.file("1.glb"));
  ASSERT_TRUE(once) << once.error().message;
  EXPECT_EQ(once->mesh.positions[7], round_to_float32(model.mesh.positions[7]));
  ASSERT_TRUE(io::save_textured_model(*once, folder.file("2.glb")));
  EXPECT_EQ(test_support::read_all(folder.file("1.glb")), test_support::read_all(folder.file("2.glb")));
}

TEST(TexturedModelFile, IsAnOrdinaryMeshToOthers) {
  const scratch_folder folder;
  ASSERT_TRUE(io::save_textured_model(sample_model(), folder.file("m.glb")));
  const auto mesh = io::load_mesh(folder.file("m.glb"));
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->positions.size(), 8U);  // seams welded again
  EXPECT_EQ(mesh->triangles.size(), 12U);
  EXPECT_EQ(mesh->uvs.size(), 12U);
  const test_support::glb_editor glb(test_support::read_all(folder.file("m.glb")));
  EXPECT_EQ(glb.json["extensionsUsed"], nlohmann::json({"ASPERITY_mesh_haptic_texture"}));
  EXPECT_FALSE(glb.json.contains("extensionsRequired"));
  EXPECT_EQ(glb.json["accessors"][0]["count"], 24);  // six faces of four corners
  EXPECT_EQ(glb.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"], 0)
      << "without a material that uses them, tools drop the texture coordinates";
}

TEST(TexturedModelFile, KeepsVerticesApartThatOnlyShareAPlace) {
  // Two boxes that touch in one corner: one position, two vertices, and the surface stays 2-manifold.
  textured_model model = sample_model();
  const textured_model other = make_textured_box({0.02, 0.03, 0.01}, 64, ridges(1e-3, 5e-3));
  const vec3 shift = model.mesh.positions[7] - model.mesh.positions[0];
  for (const vec3& p : other.mesh.positions) model.mesh.positions.push_back(round_to_float32(p + shift));
  ASSERT_EQ(model.mesh.positions[7], model.mesh.positions[8]);
  convex_piece piece = other.pieces[0];
  piece.vertices.assign(model.mesh.positions.begin() + 8, model.mesh.positions.end());
  piece.triangles.clear();
  for (coarse_triangle t : other.mesh.triangles) {
    for (auto& v : t.vertex) v += 8;
    for (vec2& uv : t.uv) uv.y = 0.5 * uv.y + 0.5;
    piece.triangles.push_back(static_cast<std::uint32_t>(model.mesh.triangles.size()));
    model.mesh.triangles.push_back(t);
  }
  for (std::size_t t = 0; t < 12; ++t) {
    for (vec2& uv : model.mesh.triangles[t].uv) uv.y *= 0.5;
  }
  for (glm::vec3& texel : model.texture.texels) texel = glm::vec3(0.0F);  // values do not matter here
  model.pieces.push_back(piece);
  const scratch_folder folder;
  const auto saved = io::save_textured_model(model, folder.file("m.glb"));
  ASSERT_TRUE(saved) << saved.error().message;
  const auto back = io::load_textured_model(folder.file("m.glb"));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->mesh.positions.size(), 16U);
  EXPECT_TRUE(same_bits(back->mesh.positions, model.mesh.positions));
}

TEST(TexturedModelFile, SaysWhenTheTextureWasLost) {
  const scratch_folder folder;
  ASSERT_TRUE(io::save_textured_model(sample_model(), folder.file("m.glb")));
  test_support::glb_editor glb(test_support::read_all(folder.file("m.glb")));
  glb.json["meshes"][0].erase("extensions");  // as other tools write it
  const auto model = io::load_textured_model(folder.file("lost.glb", glb.bytes()));
  ASSERT_FALSE(model);
  EXPECT_EQ(model.error().code, error_code::bad_texture);
  EXPECT_NE(model.error().message.find("has no haptic texture"), std::string::npos) << model.error().message;
  EXPECT_NE(model.error().message.find("make bake the last step"), std::string::npos) << model.error().message;
}

TEST(TexturedModelFile, ReadsVersionOneOnly) {
  const scratch_folder folder;
  ASSERT_TRUE(io::save_textured_model(sample_model(), folder.file("m.glb")));
  test_support::glb_editor glb(test_support::read_all(folder.file("m.glb")));
  glb.haptic()["version"] = 2;
  const auto model = io::load_textured_model(folder.file("new.glb", glb.bytes()));
  ASSERT_FALSE(model);
  EXPECT_EQ(model.error().code, error_code::unsupported) << model.error().message;
}

TEST(TexturedModelFile, RefusesWhatIsNoGlb) {
  const scratch_folder folder;
  const auto code = [](const std::filesystem::path& file) {
    const auto model = io::load_textured_model(file);
    return model ? std::string("loaded") : std::string(to_string(model.error().code));
  };
  EXPECT_EQ(code(folder.file("absent.glb")), "io_failed");
  EXPECT_EQ(code(folder.path()), "io_failed");
  EXPECT_EQ(code(folder.file("empty.glb", "")), "bad_format");
  EXPECT_EQ(code(folder.file("text.glb", "{\"asset\":{\"version\":\"2.0\"}}")), "bad_format");
}

// A box as a file holds it, with the field of it, coarse to be made at once.
textured_model box_with_field(const scratch_folder& folder) {
  EXPECT_TRUE(
      io::save_textured_model(make_textured_box({0.02, 0.03, 0.01}, 64, ridges(1e-3, 5e-3)), folder.file("bare.glb")));
  textured_model model = io::load_textured_model(folder.file("bare.glb")).value();
  EXPECT_EQ(model.field, nullptr);
  field_body_settings settings;
  settings.field.most_nodes = 20'000;
  settings.sample_pitch_m = 2e-3;
  model.field = std::make_shared<const field_body>(make_field_body(model, settings).value());
  return model;
}

TEST(TexturedModelFile, KeepsTheFieldOfItsModel) {
  const scratch_folder folder;
  textured_model model = box_with_field(folder);
  ASSERT_TRUE(io::save_textured_model(model, folder.file("m.glb")));
  const textured_model back = io::load_textured_model(folder.file("m.glb")).value();
  ASSERT_NE(back.field, nullptr);
  EXPECT_TRUE(pack_field(*back.field) == pack_field(*model.field));
  ASSERT_TRUE(io::save_textured_model(back, folder.file("again.glb")));
  EXPECT_EQ(test_support::read_all(folder.file("again.glb")), test_support::read_all(folder.file("m.glb")));

  // A field of another surface is not written.
  model.texture.texels[10].x += 1e-4F;
  ASSERT_TRUE(io::save_textured_model(model, folder.file("worn.glb")));
  EXPECT_EQ(io::load_textured_model(folder.file("worn.glb")).value().field, nullptr);
}

TEST(TexturedModelFile, TakesNoFieldThatIsNotItsOwn) {
  const scratch_folder folder;
  ASSERT_TRUE(io::save_textured_model(box_with_field(folder), folder.file("m.glb")));
  const test_support::glb_editor good(test_support::read_all(folder.file("m.glb")));
  const auto loaded = [&](const test_support::glb_editor& edited) {
    return io::load_textured_model(folder.file("edited.glb", edited.bytes()));
  };
  const std::size_t texels = test_support::glb_editor(good).haptic()["texture"]["bufferView"];
  const std::size_t packed = test_support::glb_editor(good).haptic()["field"]["bufferView"];

  test_support::glb_editor newer = good;  // its bytes are nobody's business then
  newer.haptic()["field"] = {{"version", packed_field_version + 1}, {"bufferView", texels}};
  ASSERT_TRUE(loaded(newer));
  EXPECT_EQ(loaded(newer).value().field, nullptr);

  test_support::glb_editor worn = good;
  worn.put(texels, 3 * 70, 0.0203F);
  ASSERT_TRUE(loaded(worn)) << loaded(worn).error().message;
  EXPECT_EQ(loaded(worn).value().field, nullptr);

  test_support::glb_editor damaged = good;
  damaged.put(packed, 35, std::numeric_limits<float>::quiet_NaN());  // the first node of its grid
  const auto refused = loaded(damaged);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, error_code::bad_format);
  for (const char* word : {"edited.glb", "field", "a node of its grid", "bake the model again"}) {
    EXPECT_NE(refused.error().message.find(word), std::string::npos) << refused.error().message;
  }
}

}  // namespace
}  // namespace asperity
