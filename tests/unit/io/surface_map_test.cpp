// The map of materials in a textured model: what comes back, what is refused, and what others see of it.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <utility>

#include "asperity/io/textured_model_file.hpp"
#include "asperity/model/validate.hpp"
#include "glb_editor.hpp"
#include "scratch_folder.hpp"
#include "support/fresh_seed.hpp"
#include "support/image_writers.hpp"
#include "support/small_models.hpp"
#include "unit/control/drawn.hpp"
#include "unit/io/changed_model.hpp"

namespace asperity {
namespace {

using nlohmann::json;
using test_support::changed_model;
using test_support::drawn;
using test_support::expect_same;
using test_support::glb_editor;
using test_support::scratch_folder;

material numbered(std::size_t i, drawn& d) { return test_support::drawn_material("material " + std::to_string(i), d); }

/// A box of so many materials, thrown at its texels.
textured_model patched_box(std::size_t materials, drawn& d) {
  textured_model model = test_support::make_flat_box({0.01, 0.01, 0.01}, 24);
  model.surface = numbered(0, d);
  for (std::size_t i = 1; i < materials; ++i) model.surface_map.others.push_back(numbered(i, d));
  for (std::size_t i = 0; i < model.texture.texels.size(); ++i) {
    model.surface_map.texels.push_back(static_cast<std::uint8_t>(d.bits() % materials));
  }
  return model;
}

/// The file of a box of three materials, for one change.
struct patched_file : changed_model {
  patched_file() : changed_model(three()) {}
  static textured_model three() {
    drawn d{20261126};
    return patched_box(3, d);
  }
  json& map() { return glb.haptic()["materials"]; }
  json& image() { return glb.json["images"][map()["image"].get<std::size_t>()]; }
  /// Puts other bytes in the place of the image.
  void put_image(const std::string& bytes) {
    const std::size_t at = (glb.bin.size() + 3) / 4 * 4;
    glb.bin.resize(at);
    glb.bin += bytes;
    glb.bin.resize((glb.bin.size() + 3) / 4 * 4);
    json& view = glb.json["bufferViews"][image()["bufferView"].get<std::size_t>()];
    view["byteOffset"] = at;
    view["byteLength"] = bytes.size();
    glb.json["buffers"][0]["byteLength"] = glb.bin.size();
  }
};

TEST(SurfaceMap, ComesBackToTheBitAndTheFileToo) {
  drawn d(test_support::fresh_seed("SurfaceMap.ComesBack", "7 models"));
  const scratch_folder folder;
  for (std::size_t n = 2; n <= most_materials; ++n) {
    const textured_model model = patched_box(n, d);
    ASSERT_TRUE(io::save_textured_model(model, folder.file("m.glb")));
    const result<textured_model> read = io::load_textured_model(folder.file("m.glb"));
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->surface_map.texels, model.surface_map.texels);
    ASSERT_EQ(material_count(*read), n);
    for (std::size_t i = 0; i < n; ++i) expect_same(*material_of(*read, i), *material_of(model, i));
    ASSERT_TRUE(io::save_textured_model(*read, folder.file("again.glb")));
    EXPECT_EQ(test_support::read_all(folder.file("m.glb")), test_support::read_all(folder.file("again.glb")));
  }
}

// A model without a map has none of it in its file; one with it looks to older readers like one of its first material.
TEST(SurfaceMap, IsAddedToTheFileOfTheFirstMaterial) {
  drawn d(7);
  const scratch_folder folder;
  textured_model model = patched_box(2, d);
  ASSERT_TRUE(io::save_textured_model(model, folder.file("map.glb")));
  model.surface_map = {};
  ASSERT_TRUE(io::save_textured_model(model, folder.file("plain.glb")));
  glb_editor with(test_support::read_all(folder.file("map.glb"))),
      plain(test_support::read_all(folder.file("plain.glb")));
  EXPECT_FALSE(plain.haptic().contains("materials"));
  EXPECT_EQ(plain.json["images"].size(), 1U);
  EXPECT_EQ(with.json["nodes"], plain.json["nodes"]);
  EXPECT_EQ(with.json["extensionsUsed"], plain.json["extensionsUsed"]);
  EXPECT_EQ(with.haptic()["materials"], json::parse(R"({"version": 1, "image": 1, "physicsMaterials": [0, 1]})"));
  json& materials = with.json["extensions"]["KHR_physics_rigid_bodies"]["physicsMaterials"];
  EXPECT_EQ(materials.size(), 2U);
  EXPECT_EQ(materials[0], plain.json["extensions"]["KHR_physics_rigid_bodies"]["physicsMaterials"][0]);
}

TEST(SurfaceMap, ThatDoesNotFitIsRefusedWithItsPlace) {
  const auto with = [](const char* key, const json& value, const char* why) {
    patched_file f;
    f.map()[key] = value;
    f.expect_refused(why);
  };
  with("version", 2, "materials.version is 2, and this build reads version 1");
  with("version", "1", "materials.version is not a whole number");
  with("image", 2, "materials.image is 2, but there are only 2");
  with("image", -1, "materials.image is not a whole number");
  with("image", 0, "names material 128 of 3 in column 0, row 0");  // the picture of the relief
  with("physicsMaterials", json::array({0}), "lists 1 materials, not 2 to 8");
  with("physicsMaterials", json::array({0, 1, 2, 0, 1, 2, 0, 1, 2}), "lists 9 materials, not 2 to 8");
  with("physicsMaterials", json::array({0, 1, 3}), "physicsMaterials[2] is not the number of one of 3");
  with("physicsMaterials", json::array({0, 1, -1}), "physicsMaterials[2] is not the number of one of 3");
  with("physicsMaterials", json::array({0, 1, 1e300}), "physicsMaterials[2] is not the number of one of 3");
  with("physicsMaterials", json::array({1, 0, 2}), "physicsMaterials[0] is 1, and the colliders of the mesh name 0");
  with("physicsMaterials", json::array({0, 1}), "names material 2 of 2");
  with("physicsMaterials", "all", "physicsMaterials is not an array");
  for (const char* key : {"version", "image"}) {
    patched_file f;
    f.map().erase(key);
    f.expect_refused(std::string("materials.") + key + " is missing");
  }
  {
    patched_file f;
    f.map().erase("physicsMaterials");
    f.expect_refused("lists 0 materials");
  }
  {
    patched_file f;
    f.glb.haptic()["materials"] = 3;
    f.expect_refused("materials is not a JSON object");
  }
  {
    patched_file f;
    f.glb.json["nodes"][0].erase("extensions");
    f.expect_refused("maps materials, and no collider of the mesh names the first of them");
  }
  {
    patched_file f;
    f.glb.json["extensions"]["KHR_physics_rigid_bodies"]["physicsMaterials"][2]["staticFriction"] = -1;
    f.expect_refused("physicsMaterials[2] is no material: material: the static friction must be from 0 to 10");
  }
}

TEST(SurfaceMap, ImagesThatAreNoneAreRefused) {
  const std::vector<unsigned char> row(1000, 0);
  const auto zeros = [&](std::uint32_t) { return row.data(); };
  const auto with = [](const std::string& bytes, const char* why) {
    patched_file f;
    f.put_image(bytes);
    f.expect_refused(why);
  };
  {
    patched_file f;  // the control: an image of zeros is as good as another
    f.put_image(test_support::grey_png_bytes(24, 24, false, false, zeros));
    const result<textured_model> read = f.load();
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(std::count(read->surface_map.texels.begin(), read->surface_map.texels.end(), 0), 24 * 24);
  }
  with(test_support::grey_png_bytes(24, 23, false, false, zeros), "24 x 24 texels of the haptic texture");
  with(test_support::grey_png_bytes(24, 24, true, false, zeros), "is not a grey image of 8 bits");
  with(test_support::compressed_png_bytes(24, 24, false), "names material");
  with("", "bufferViews[");
  with("no image at all", "images[1]");
  with(test_support::jpeg_bytes(24, 24, 90, false, true), "images[1]");
  with(test_support::flat_png_bytes(16384, 16384, false), "images[1]");  // a bomb
  const std::string whole = test_support::grey_png_bytes(24, 24, false, false, zeros);
  for (const double part : {0.2, 0.5, 0.9}) {
    with(whole.substr(0, static_cast<std::size_t>(part * static_cast<double>(whole.size()))), "images[1]");
  }
  {
    patched_file f;
    f.image()["mimeType"] = "image/jpeg";
    f.expect_refused("images[1].mimeType is not image/png");
  }
  for (const char* key : {"mimeType", "bufferView"}) {
    patched_file f;
    f.image().erase(key);
    f.expect_refused(std::string("images[1].") + key + " is missing");
  }
  patched_file f;
  f.image()["bufferView"] = 1000;
  f.expect_refused("images[1].bufferView is 1000");
}

TEST(SurfaceMap, ThatIsWrongIsNotWritten) {
  drawn d(3);
  const auto expect_refused = [&](const textured_model& model, const char* why) {
    const result<void> ok = validate(model);
    ASSERT_FALSE(ok) << why;
    EXPECT_NE(ok.error().message.find(why), std::string::npos) << ok.error().message;
    const scratch_folder folder;
    EXPECT_FALSE(io::save_textured_model(model, folder.file("m.glb")));
    EXPECT_FALSE(std::filesystem::exists(folder.file("m.glb")));
  };
  textured_model model = patched_box(3, d);
  EXPECT_TRUE(validate(model));
  model.surface_map.texels[30] = 3;
  expect_refused(model, "names material 3 of 3 in column 6, row 1");
  model.surface_map.texels.pop_back();
  expect_refused(model, "has 575 texels and the haptic texture 576");
  model = patched_box(3, d);
  model.surface.reset();
  expect_refused(model, "has no first material");
  model = patched_box(8, d);
  model.surface_map.others.push_back(material{});
  expect_refused(model, "lists 9 materials with the first, more than the 8");
  model = patched_box(3, d);
  model.surface_map.others[1].dissipation_s_per_m = std::numeric_limits<double>::quiet_NaN();
  expect_refused(model, "the dissipation must be from 0 to 100");
  model = patched_box(3, d);
  model.surface_map.others.clear();
  expect_refused(model, "names no material");
}

// Of a box whose charts are of one size, what its texels say is what its faces are; the share is of the area.
TEST(SurfaceMap, SharesAreOfTheArea) {
  textured_model model = test_support::make_flat_box({0.01, 0.02, 0.03}, 240);
  EXPECT_EQ(material_shares(model), std::vector<double>{1.0});
  model.surface = material{};
  model.surface_map.others = {material{}, material{}};
  for (const glm::vec3& p : model.texture.texels) {
    const bool end = p.z > 0.0299F, upper = p.z > 0.0F;
    model.surface_map.texels.push_back(end ? 2 : (upper ? 1 : 0));
  }
  const std::vector<double> share = material_shares(model);
  const double whole = 2.0 * (1.0 * 2.0 + 2.0 * 3.0 + 1.0 * 3.0), end = 2.0 / whole, sides = 18.0 / whole;
  ASSERT_EQ(share.size(), 3U);
  EXPECT_NEAR(share[0], end + 0.5 * sides, 0.01);
  EXPECT_NEAR(share[1], 0.5 * sides, 0.02);
  EXPECT_NEAR(share[2], end, 0.02);
}

}  // namespace
}  // namespace asperity
