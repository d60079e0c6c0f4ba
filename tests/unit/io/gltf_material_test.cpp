// The normal texture of an asset's material: found, read, and never looked for outside the asset's folder.
#include <filesystem>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>

#include "asperity/io/material_file.hpp"
#include "glb_editor.hpp"
#include "scratch_folder.hpp"
#include "support/png_image.hpp"

namespace asperity {
namespace {

using nlohmann::json;
using test_support::png_image;
using test_support::scratch_folder;

const std::string pixels = png_image{2, 1, 8, 2, std::string("\x80\x80\xff\x90\x70\xf0", 6), {}}.bytes();

/// One triangle with a material; the image as given.
json asset(const json& image) {
  return {{"asset", {{"version", "2.0"}}},
          {"buffers", {{{"byteLength", 36}, {"uri", "p.bin"}}}},
          {"bufferViews", {{{"buffer", 0}, {"byteLength", 36}}}},
          {"accessors", {{{"bufferView", 0}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}}}},
          {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"material", 0}}}}}}},
          {"materials", {{{"normalTexture", {{"index", 0}, {"scale", 0.5}}}}}},
          {"textures", {{{"source", 0}, {"sampler", 0}}}},
          {"samplers", {{{"wrapS", 33071}}}},
          {"images", {image}},
          {"nodes", {{{"mesh", 0}}}}};
}

class GltfMaterial : public testing::Test {
 protected:
  GltfMaterial() {
    std::filesystem::create_directories(folder.file("in"));
    (void)folder.file("in/p.bin", std::string(36, '\0'));
    (void)folder.file("in/n.png", pixels);
    (void)folder.file("outside.png", pixels);
  }
  result<io::normal_texture> load(const json& document) const {
    return io::load_normal_texture(folder.file("in/a.gltf", document.dump()));
  }
  void expect_error(const json& document, error_code code, const std::string& says) const {
    const auto texture = load(document);
    ASSERT_FALSE(texture) << says;
    EXPECT_EQ(texture.error().code, code) << texture.error().message;
    EXPECT_NE(texture.error().message.find(says), std::string::npos) << texture.error().message;
  }
  scratch_folder folder;
  const json good = asset({{"uri", "n.png"}});
};

TEST_F(GltfMaterial, ReadsTheImageItsScaleAndItsWrapping) {
  const auto texture = load(good);
  ASSERT_TRUE(texture) << texture.error().message;
  EXPECT_EQ(texture->scale, 0.5);
  EXPECT_EQ(texture->wrap_u, map_wrap::clamp);
  EXPECT_EQ(texture->wrap_v, map_wrap::repeat);
  EXPECT_EQ(texture->image.width, 2U);
  EXPECT_EQ(texture->image.at(1, 0, 0), 0x90 / 255.0F);
}

TEST_F(GltfMaterial, ReadsAnImageInsideAGlb) {
  json document = asset({{"bufferView", 1}, {"mimeType", "image/png"}});
  document["buffers"] = {{{"byteLength", 36 + pixels.size()}}};
  document["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 36}, {"byteLength", pixels.size()}});
  test_support::glb_editor editor(std::string("glTF\2\0\0\0\0\0\0\0\2\0\0\0JSON{}\0\0\0\0\0\0\0\0", 30));
  editor.json = document;
  editor.bin = std::string(36, '\0') + pixels;
  editor.bin.resize((editor.bin.size() + 3) / 4 * 4);
  const auto texture = io::load_normal_texture(folder.file("in/a.glb", editor.bytes()));
  ASSERT_TRUE(texture) << texture.error().message;
  EXPECT_EQ(texture->image.channels, 3U);
}

TEST_F(GltfMaterial, NeverLeavesItsFolder) {
  for (const std::string uri : {"../outside.png", "%2e%2e/outside.png", "/etc/passwd", "file:///etc/passwd"})
    expect_error(asset({{"uri", uri}}), error_code::bad_format, "leads out of the document's folder");
  std::filesystem::create_symlink(folder.file("outside.png"), folder.file("in/link.png"));
  expect_error(asset({{"uri", "link.png"}}), error_code::io_failed, "behind a link");
}

TEST_F(GltfMaterial, SaysWhatItCannotUse) {
  expect_error(asset({{"uri", "absent.png"}}), error_code::io_failed, "absent.png: cannot be found");
  json document = good;
  document["materials"][0].erase("normalTexture");
  expect_error(document, error_code::unsupported, "has no normalTexture");
  document = good;
  document["meshes"][0]["primitives"][0].erase("material");
  expect_error(document, error_code::unsupported, "has no material");
  document = good;
  document["materials"].push_back(json::object());
  document["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 0}}}, {"material", 1}});
  expect_error(document, error_code::unsupported, "has several materials");
  document = good;
  document["materials"][0]["normalTexture"]["texCoord"] = 1;
  expect_error(document, error_code::unsupported, "second set of texture coordinates");
  document = good;
  document["materials"][0]["normalTexture"]["extensions"]["KHR_texture_transform"] = json::object();
  expect_error(document, error_code::unsupported, "texture transform");
  document = good;
  document["textures"][0]["source"] = 7;
  expect_error(document, error_code::bad_format, "textures[0].source is 7");
  document = good;
  document["samplers"][0]["wrapS"] = 1;
  expect_error(document, error_code::bad_format, "no wrapping that glTF knows");
  (void)folder.file("in/n.png", pixels.substr(0, 50));
  expect_error(good, error_code::bad_format, "images[0]: cannot be read as PNG: the file ends early");
}

}  // namespace
}  // namespace asperity
