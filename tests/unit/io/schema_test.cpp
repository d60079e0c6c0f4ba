// What the writer puts into the extension against the published schema. Knows the keywords that the schema uses and no
// others; one that it does not know fails the test.
#include <filesystem>
#include <gtest/gtest.h>
#include <set>
#include <string>

#include "asperity/io/textured_model_file.hpp"
#include "glb_editor.hpp"
#include "scratch_folder.hpp"
#include "some_quality.hpp"
#include "support/small_models.hpp"

namespace asperity {
namespace {

using nlohmann::json;

bool has_type(const json& value, const std::string& type) {
  if (type == "object") return value.is_object();
  if (type == "integer") return value.is_number_integer();
  if (type == "number") return value.is_number();
  if (type == "string") return value.is_string();
  if (type == "array") return value.is_array();
  ADD_FAILURE() << "the schema has a type that this test does not know: " << type;
  return false;
}

/// Empty where the value keeps the schema; the place of the first breach otherwise.
std::string breach(const json& value, const json& schema, const json& root, const std::string& place) {
  static const std::set<std::string> annotations{"$schema", "$id", "$defs", "title", "description"};
  for (const auto& [key, rule] : schema.items()) {
    bool good = true;
    if (key == "$ref") {
      const auto inner = breach(value, root[json::json_pointer(rule.get<std::string>().substr(1))], root, place);
      if (!inner.empty()) return inner;
    } else if (key == "type") {
      good = has_type(value, rule);
    } else if (key == "const") {
      good = value == rule;
    } else if (key == "minimum") {
      good = value >= rule;
    } else if (key == "maximum") {
      good = value <= rule;
    } else if (key == "minItems") {
      good = value.size() >= rule;
    } else if (key == "maxItems") {
      good = value.size() <= rule;
    } else if (key == "items") {
      for (std::size_t i = 0; i < value.size(); ++i) {
        const auto inner = breach(value[i], rule, root, place + "/" + std::to_string(i));
        if (!inner.empty()) return inner;
      }
    } else if (key == "required") {
      for (const std::string name : rule) good = good && value.contains(name);
    } else if (key == "properties") {
      for (const auto& [name, inner_schema] : rule.items()) {
        if (!value.contains(name)) continue;
        const auto inner = breach(value[name], inner_schema, root, place + "/" + name);
        if (!inner.empty()) return inner;
      }
    } else if (key == "additionalProperties") {
      for (const auto& [name, ignored] : value.items())
        good = good && (rule == json(true) || schema["properties"].contains(name));
    } else if (annotations.count(key) == 0) {
      ADD_FAILURE() << "the schema has a keyword that this test does not know: " << key;
    }
    if (!good) return place + " breaks " + key;
  }
  return {};
}

class Schema : public ::testing::Test {
 protected:
  Schema() {
    schema_ = json::parse(test_support::read_all(std::filesystem::path(ASPERITY_SOURCE_DIR) /
                                                 "docs/reference/ASPERITY_mesh_haptic_texture.schema.json"));
    const test_support::scratch_folder folder;
    textured_model model = test_support::make_flat_box({1, 1, 1}, 24);
    model.report.quality = test_support::some_quality();
    EXPECT_TRUE(io::save_textured_model(model, folder.file("m.glb")));
    extension_ = test_support::glb_editor(test_support::read_all(folder.file("m.glb"))).haptic();
  }
  json schema_;
  json extension_;
};

TEST_F(Schema, TheWriterKeepsIt) { EXPECT_EQ(breach(extension_, schema_, schema_, ""), ""); }

TEST_F(Schema, EveryKeyOfTheWriterIsDescribedAndRequired) {
  const json flat = extension_.flatten();
  EXPECT_GE(flat.size(), 20U);
  for (const auto& item : flat.items()) {
    json damaged = extension_;
    const json::json_pointer place(item.key());
    json& parent = damaged[place.parent_pointer()];
    if (parent.is_array())
      parent.erase(parent.begin());
    else
      parent.erase(place.back());
    EXPECT_NE(breach(damaged, schema_, schema_, ""), "") << item.key() << " can be left out";
    damaged = extension_;
    damaged[place] = json::array();
    EXPECT_NE(breach(damaged, schema_, schema_, ""), "") << item.key() << " can be anything";
  }
}

// The extension of a material, which a model need not have.
TEST(SchemaOfAMaterial, TheWriterKeepsItAndEveryKeyIsRequired) {
  const json schema = json::parse(test_support::read_all(std::filesystem::path(ASPERITY_SOURCE_DIR) /
                                                         "docs/reference/ASPERITY_haptic_material.schema.json"));
  const test_support::scratch_folder folder;
  textured_model model = test_support::make_flat_box({1, 1, 1}, 24);
  model.surface = preset_material("rubber").value();
  ASSERT_TRUE(io::save_textured_model(model, folder.file("m.glb")));
  const json document = test_support::glb_editor(test_support::read_all(folder.file("m.glb"))).json;
  const json written = document["extensions"]["KHR_physics_rigid_bodies"]["physicsMaterials"][0]["extensions"]
                               ["ASPERITY_haptic_material"];
  EXPECT_EQ(breach(written, schema, schema, ""), "");
  EXPECT_EQ(written.size(), 3U);
  for (const auto& [key, value] : written.items()) {
    json damaged = written;
    damaged.erase(key);
    EXPECT_NE(breach(damaged, schema, schema, ""), "") << key << " can be left out";
    damaged[key] = 1e9;
    EXPECT_NE(breach(damaged, schema, schema, ""), "") << key << " can be anything";
  }
}

// The map of materials, which a model need not have.
TEST(SchemaOfAMap, TheWriterKeepsItAndEveryKeyIsRequired) {
  const json schema = json::parse(test_support::read_all(std::filesystem::path(ASPERITY_SOURCE_DIR) /
                                                         "docs/reference/ASPERITY_mesh_haptic_texture.schema.json"));
  const test_support::scratch_folder folder;
  textured_model model = test_support::make_flat_box({1, 1, 1}, 24);
  model.surface = preset_material("rubber").value();
  model.surface_map = {.others = {preset_material("ice").value()}, .texels = std::vector<std::uint8_t>(24 * 24, 1)};
  ASSERT_TRUE(io::save_textured_model(model, folder.file("m.glb")));
  const json written = test_support::glb_editor(test_support::read_all(folder.file("m.glb"))).haptic();
  EXPECT_EQ(breach(written, schema, schema, ""), "");
  EXPECT_EQ(written["materials"].size(), 3U);
  for (const auto& [key, value] : written["materials"].items()) {
    json damaged = written;
    damaged["materials"].erase(key);
    EXPECT_NE(breach(damaged, schema, schema, ""), "") << key << " can be left out";
    damaged["materials"][key] = json::object();
    EXPECT_NE(breach(damaged, schema, schema, ""), "") << key << " can be anything";
  }
}

TEST_F(Schema, AReportWithoutQualityIsAnOlderOne) {
  extension_["report"].erase("quality");
  EXPECT_EQ(breach(extension_, schema_, schema_, ""), "");
}

}  // namespace
}  // namespace asperity
