// What Khronos' validator asks of a file, asked of what we write: `./dev interop` runs the validator itself, where
// there is a network. The rules are those of the glTF 2.0 specification.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "asperity/io/textured_model_file.hpp"
#include "glb_editor.hpp"
#include "scratch_folder.hpp"
#include "support/small_models.hpp"

namespace asperity {
namespace {

using nlohmann::json;
using test_support::glb_editor;
using test_support::make_textured_box;
using test_support::ridges;
using test_support::scratch_folder;

constexpr int float_component = 5126, uint_component = 5125;
constexpr int array_buffer = 34962, element_array_buffer = 34963;

std::string written(const std::string& name) {
  textured_model model = make_textured_box({0.02, 0.03, 0.01}, 64, ridges(1e-3, 5e-3));
  model.name = name;
  const scratch_folder folder;
  const auto saved = io::save_textured_model(model, folder.file("m.glb"));
  EXPECT_TRUE(saved) << saved.error().message;
  return test_support::read_all(folder.file("m.glb"));
}

std::uint32_t word_at(const std::string& bytes, std::size_t at) {
  std::uint32_t out = 0;
  std::memcpy(&out, bytes.data() + at, sizeof out);
  return out;
}

class GltfRules : public ::testing::Test {
 protected:
  std::string file = written("box \xc3\xa9");
  glb_editor glb{file};
  const json& views = glb.json["bufferViews"];
  const json& accessors = glb.json["accessors"];
  const json& primitive = glb.json["meshes"][0]["primitives"][0];

  [[nodiscard]] std::size_t offset(std::size_t view) const { return views[view].value("byteOffset", std::size_t{0}); }
  template <class T>
  [[nodiscard]] std::vector<T> numbers(const json& accessor, std::size_t components) const {
    std::vector<T> out(accessor["count"].get<std::size_t>() * components);
    std::memcpy(out.data(), glb.bin.data() + offset(accessor["bufferView"]) + accessor.value("byteOffset", 0U),
                out.size() * sizeof(T));
    return out;
  }
};

TEST_F(GltfRules, ChunksAreAlignedAndPaddedAndTheLengthsAddUp) {
  EXPECT_EQ(file.substr(0, 4), "glTF");
  EXPECT_EQ(word_at(file, 4), 2U);
  EXPECT_EQ(word_at(file, 8), file.size());
  const std::uint32_t json_bytes = word_at(file, 12);
  EXPECT_EQ(file.substr(16, 4), "JSON");
  EXPECT_EQ(json_bytes % 4, 0U);
  const std::uint32_t bin_bytes = word_at(file, 20 + json_bytes);
  EXPECT_EQ(file.substr(24 + json_bytes, 4), std::string("BIN\0", 4));
  EXPECT_EQ(bin_bytes % 4, 0U);
  EXPECT_EQ(28 + json_bytes + bin_bytes, file.size());
  ASSERT_EQ(glb.json["buffers"].size(), 1U);
  const json& buffer = glb.json["buffers"][0];
  EXPECT_FALSE(buffer.contains("uri"));
  EXPECT_LE(buffer["byteLength"], bin_bytes);
  EXPECT_LT(bin_bytes - buffer["byteLength"].get<std::uint32_t>(), 4U);
}

TEST_F(GltfRules, ViewsLieInTheBufferApartAndAreAllUsed) {
  std::set<std::size_t> used{glb.json["images"][0]["bufferView"]};
  for (const json& a : accessors) used.insert(a["bufferView"].get<std::size_t>());
  const json& haptic = glb.haptic();
  used.insert({haptic["meshVertices"]["bufferView"].get<std::size_t>(), haptic["texture"]["bufferView"]});
  for (const char* part : {"table", "vertices", "hull", "triangles"})
    used.insert(haptic["pieces"][part].get<std::size_t>());
  EXPECT_EQ(used.size(), views.size());
  std::size_t end = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    EXPECT_EQ(views[v]["buffer"], 0);
    EXPECT_GE(offset(v), end) << "view " << v << " overlaps its neighbour";
    EXPECT_EQ(offset(v) % 4, 0U) << "view " << v;
    EXPECT_GE(views[v]["byteLength"], 1);
    end = offset(v) + views[v]["byteLength"].get<std::size_t>();
  }
  EXPECT_LE(end, glb.json["buffers"][0]["byteLength"]);
}

TEST_F(GltfRules, AccessorsFitTheirViewsAndTheirUse) {
  const std::map<std::string, std::size_t> components{{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}};
  for (const json& a : accessors) {
    const json& view = views[a["bufferView"].get<std::size_t>()];
    EXPECT_EQ(a["count"].get<std::size_t>() * components.at(a["type"]) * 4, view["byteLength"]);
    EXPECT_FALSE(view.contains("byteStride"));
  }
  const json& position = accessors[primitive["attributes"]["POSITION"].get<std::size_t>()];
  const json& uv = accessors[primitive["attributes"]["TEXCOORD_0"].get<std::size_t>()];
  const json& index = accessors[primitive["indices"].get<std::size_t>()];
  EXPECT_EQ(position["type"], "VEC3");
  EXPECT_EQ(uv["type"], "VEC2");
  EXPECT_EQ(index["type"], "SCALAR");
  for (const json* a : {&position, &uv}) {
    EXPECT_EQ((*a)["componentType"], float_component);
    EXPECT_EQ(views[(*a)["bufferView"].get<std::size_t>()]["target"], array_buffer);
  }
  EXPECT_EQ(index["componentType"], uint_component);
  EXPECT_EQ(views[index["bufferView"].get<std::size_t>()]["target"], element_array_buffer);
  EXPECT_EQ(position["count"], uv["count"]);
  EXPECT_EQ(index["count"].get<std::size_t>() % 3, 0U);
}

TEST_F(GltfRules, NumbersAreFiniteAndBoundsAreTheirs) {
  const json& position = accessors[primitive["attributes"]["POSITION"].get<std::size_t>()];
  const auto p = numbers<float>(position, 3);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    float low = std::numeric_limits<float>::infinity(), high = -low;
    for (std::size_t i = axis; i < p.size(); i += 3) {
      ASSERT_TRUE(std::isfinite(p[i]));
      low = std::min(low, p[i]);
      high = std::max(high, p[i]);
    }
    // Written and read back as text, they have to be the float itself.
    EXPECT_EQ(position["min"][axis].get<double>(), double{low});
    EXPECT_EQ(position["max"][axis].get<double>(), double{high});
  }
  for (const float x : numbers<float>(accessors[primitive["attributes"]["TEXCOORD_0"].get<std::size_t>()], 2)) {
    EXPECT_TRUE(x >= 0.0F && x <= 1.0F) << x;
  }
  const auto indices = numbers<std::uint32_t>(accessors[primitive["indices"].get<std::size_t>()], 1);
  std::vector<bool> seen(position["count"].get<std::size_t>(), false);
  for (std::size_t i = 0; i < indices.size(); ++i) {
    ASSERT_LT(indices[i], seen.size());
    seen[indices[i]] = true;
    EXPECT_NE(indices[i], indices[i - i % 3 + (i + 1) % 3]) << "a triangle without area";
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), false), 0) << "vertices that no triangle uses";
}

TEST_F(GltfRules, TheDocumentRefersToAllThatItHolds) {
  EXPECT_EQ(glb.json["asset"]["version"], "2.0");
  EXPECT_EQ(glb.json["extensionsUsed"], json::array({"ASPERITY_mesh_haptic_texture"}));
  EXPECT_FALSE(glb.json.contains("extensionsRequired"));
  EXPECT_EQ(glb.json["scene"], 0);
  EXPECT_EQ(glb.json["scenes"][0]["nodes"], json::array({0}));
  EXPECT_EQ(glb.json["nodes"][0]["mesh"], 0);
  EXPECT_EQ(glb.json["meshes"].size(), 1U);
  EXPECT_EQ(primitive.value("mode", 4), 4);
  EXPECT_EQ(primitive["material"], 0);
  EXPECT_EQ(glb.json["materials"].size(), 1U);
  EXPECT_EQ(glb.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"], 0);
  EXPECT_EQ(glb.json["textures"][0]["source"], 0);
  EXPECT_EQ(glb.json["images"].size(), 1U);
  // Nothing else, and no list may be empty: what nothing refers to would be remarked on.
  std::set<std::string> keys;
  for (const auto& [key, value] : glb.json.items()) {
    keys.insert(key);
    EXPECT_FALSE(value.is_array() && value.empty()) << key;
  }
  EXPECT_EQ(keys, (std::set<std::string>{"accessors", "asset", "bufferViews", "buffers", "extensionsUsed", "images",
                                         "materials", "meshes", "nodes", "scene", "scenes", "textures"}));
}

TEST_F(GltfRules, TheImageIsAPngAndSaysSo) {
  const json& image = glb.json["images"][0];
  EXPECT_EQ(image["mimeType"], "image/png");
  EXPECT_FALSE(image.contains("uri"));
  const std::size_t view = image["bufferView"];
  EXPECT_FALSE(views[view].contains("target"));
  EXPECT_EQ(glb.bin.substr(offset(view), 8), "\x89PNG\r\n\x1a\n");
}

// A name comes from a file's name, which may be any bytes.
TEST(GltfRulesOfNames, AreUtf8WhateverTheModelIsCalled) {
  const std::vector<std::pair<std::string, std::string>> names{
      {"", ""},
      {"a b", "a b"},
      {"\xe6\x9f\x90 \xc3\xa9", "\xe6\x9f\x90 \xc3\xa9"},
      {"line\nand\ttab \"quoted\"", "line\nand\ttab \"quoted\""},
      {"\xff", "\xef\xbf\xbd"},
      {"cut \xc3", "cut \xef\xbf\xbd"},
  };
  for (const auto& [given, kept] : names) {
    const glb_editor glb(written(given));
    EXPECT_EQ(glb.json["meshes"][0].value("name", ""), kept);
    EXPECT_EQ(glb.json["nodes"][0].value("name", ""), kept);
  }
}

}  // namespace
}  // namespace asperity
