// The material of a surface in a textured model and in a file of its own: what comes back, what is refused, and that
// files without one are as they were.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "asperity/io/surface_file.hpp"
#include "asperity/io/textured_model_file.hpp"
#include "glb_editor.hpp"
#include "scratch_folder.hpp"
#include "support/fresh_seed.hpp"
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

constexpr const char* rigid_bodies = "KHR_physics_rigid_bodies";
constexpr const char* haptic_material = "ASPERITY_haptic_material";

void write(const std::filesystem::path& file, std::string_view bytes) {
  std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

textured_model small_box(std::optional<material> surface = std::nullopt) {
  textured_model model = test_support::make_flat_box({0.01, 0.01, 0.01}, 24);
  model.surface = std::move(surface);
  return model;
}

const material felt{"felt \xc3\xa9", 1234.5, 3.25, 0.7, 0.3, friction_combine::multiply};

/// The document of a model with a material.
struct felt_box : changed_model {
  felt_box() : changed_model(small_box(felt)) {}
  json& physics_material() { return glb.json["extensions"][rigid_bodies]["physicsMaterials"][0]; }
  json& collider() { return glb.json["nodes"][0]["extensions"][rigid_bodies]["collider"]; }
};

TEST(Surface, ComesBackToTheBit) {
  drawn d(test_support::fresh_seed("Surface.ComesBackToTheBit", "20 materials"));
  const scratch_folder folder;
  for (int i = 0; i < 20; ++i) {
    const material m = test_support::drawn_material(i % 2 == 0 ? "material " + std::to_string(i) : "", d);
    ASSERT_TRUE(io::save_textured_model(small_box(m), folder.file("m.glb")));
    const result<textured_model> read = io::load_textured_model(folder.file("m.glb"));
    ASSERT_TRUE(read && read->surface) << (read ? "" : read.error().message);
    expect_same(*read->surface, m);
  }
}

TEST(Surface, OfAModelWithoutOneIsNotWrittenNorRead) {
  const scratch_folder folder;
  ASSERT_TRUE(io::save_textured_model(small_box(), folder.file("m.glb")));
  const glb_editor glb(test_support::read_all(folder.file("m.glb")));
  EXPECT_EQ(glb.json["extensionsUsed"], json::array({"ASPERITY_mesh_haptic_texture"}));
  EXPECT_FALSE(glb.json.contains("extensions"));
  EXPECT_FALSE(glb.json["nodes"][0].contains("extensions"));
  EXPECT_FALSE(io::load_textured_model(folder.file("m.glb"))->surface.has_value());
}

TEST(Surface, IsAPhysicsMaterialThatTheColliderOfTheNodeNames) {
  felt_box box;
  EXPECT_EQ(box.glb.json["extensionsUsed"],
            json::array({"ASPERITY_mesh_haptic_texture", rigid_bodies, haptic_material}));
  EXPECT_FALSE(box.glb.json.contains("extensionsRequired"));
  EXPECT_EQ(box.collider(), json::parse(R"({"geometry": {"node": 0}, "physicsMaterial": 0})"));
  EXPECT_EQ(box.physics_material(), json::parse(R"({"name": "felt é", "staticFriction": 0.7, "dynamicFriction": 0.3,
                            "frictionCombine": "multiply", "extensions": {"ASPERITY_haptic_material":
                            {"version": 1, "stiffness_n_per_m": 1234.5, "dissipation_s_per_m": 3.25}}})"));
}

// A program that knows KHR_physics_rigid_bodies alone wrote these.
TEST(Surface, OfOthersHasFrictionAndOurUsualLaw) {
  felt_box box;
  box.physics_material() = json::parse(R"({"staticFriction": 0.8, "dynamicFriction": 0.7, "restitution": 0.1})");
  expect_same(*box.load()->surface, {"", 4e5, 5.0, 0.8, 0.7, friction_combine::average});
  box.physics_material() = json::object();  // all as the extension's schema has it
  expect_same(*box.load()->surface, {"", 4e5, 5.0, 0.6, 0.6, friction_combine::average});
  box.physics_material() = json::parse(R"({"staticFriction": 0.2})");
  expect_same(*box.load()->surface, {"", 4e5, 5.0, 0.2, 0.2, friction_combine::average});
  // A collider without a material, or none: nobody said.
  box.collider().erase("physicsMaterial");
  EXPECT_FALSE(box.load()->surface.has_value());
  box.glb.json["nodes"][0].erase("extensions");
  EXPECT_FALSE(box.load()->surface.has_value());
}

TEST(Surface, OutOfRangeIsRefusedByName) {
  const auto with = [](const char* key, const json& value, const char* why) {
    felt_box box;
    box.physics_material()[key] = value;
    box.expect_refused(why);
  };
  with("staticFriction", -0.1, "the static friction must be from 0 to 10");
  with("staticFriction", 0.1, "the dynamic friction must be from 0 to the static one");
  with("staticFriction", "much", "staticFriction is not a finite number");
  with("dynamicFriction", nullptr, "dynamicFriction is not a finite number");
  with("frictionCombine", "geometric", "frictionCombine is 'geometric', not average, minimum, maximum or multiply");
  with("frictionCombine", 3, "frictionCombine is not a string");
  with("name", 3, "name is not a string");
  with("extensions", 3, "extensions is not a JSON object");
  const auto with_ours = [](const char* key, const json& value, const char* why) {
    felt_box box;
    box.physics_material()["extensions"][haptic_material][key] = value;
    box.expect_refused(why);
  };
  with_ours("stiffness_n_per_m", 0, "the stiffness must be from 100 to 1e7 N/m");
  with_ours("stiffness_n_per_m", 1e300, "the stiffness must be from 100 to 1e7 N/m");
  with_ours("stiffness_n_per_m", json::array(), "stiffness_n_per_m is not a finite number");
  with_ours("dissipation_s_per_m", -1, "the dissipation must be from 0 to 100 s/m");
  with_ours("version", 2, "version is 2, and this build reads version 1");
  with_ours("version", -1, "version is not a whole number from 0");
  for (const char* key : {"version", "stiffness_n_per_m", "dissipation_s_per_m"}) {
    felt_box box;
    box.physics_material()["extensions"][haptic_material].erase(key);
    box.expect_refused(std::string(key) + " is missing");
  }
}

TEST(Surface, MaterialsThatNodesNameAndThatAreNotThereAreRefused) {
  felt_box box;
  box.collider()["physicsMaterial"] = 1;
  box.expect_refused("has no material 1, which a node names");
  box.collider()["physicsMaterial"] = -1;
  box.expect_refused("physicsMaterial is not a whole number from 0");
  box.collider()["physicsMaterial"] = 0;
  box.glb.json.erase("extensions");
  box.expect_refused("extensions is missing");
  felt_box two;
  two.glb.json["nodes"].push_back(two.glb.json["nodes"][0]);
  two.glb.json["nodes"][1]["extensions"][rigid_bodies]["collider"]["physicsMaterial"] = 1;
  two.glb.json["extensions"][rigid_bodies]["physicsMaterials"].push_back(json::object());
  two.expect_refused("nodes place the mesh with more than one physics material");
  two.glb.json["nodes"][1]["extensions"][rigid_bodies]["collider"]["physicsMaterial"] = 0;
  EXPECT_TRUE(two.load());
}

TEST(Surface, OutOfRangeIsNotWritten) {
  const scratch_folder folder;
  material bad = felt;
  bad.stiffness_n_per_m = std::nan("");
  const result<void> saved = io::save_textured_model(small_box(bad), folder.file("m.glb"));
  ASSERT_FALSE(saved);
  EXPECT_NE(saved.error().message.find("stiffness"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder.file("m.glb")));
}

TEST(Surface, OfAFileOfItsOwn) {
  felt_box box;
  const scratch_folder folder;
  const auto file = folder.file("felt.json");
  write(file, box.physics_material().dump());
  const result<material> read = io::load_material(file);
  ASSERT_TRUE(read) << read.error().message;
  expect_same(*read, felt);
  for (const auto& [bytes, why] : std::initializer_list<std::pair<std::string, std::string>>{
           {"", "empty"},
           {"[]", "does not parse as an object"},
           {"{\"staticFriction\": 1e999}", "too large"},
           {"{\"staticFriction\": 0.5, \"staticFriction\": 0.6}", "twice"},
           {std::string(100'000, ' '), "bytes"},
           {std::string(1000, '['), "deeper"},
           {"{\"staticFriction\": -1}", "static friction must be from 0 to 10"},
           {"steel", "does not parse"}}) {
    write(file, bytes);
    const result<material> refused = io::load_material(file);
    ASSERT_FALSE(refused) << bytes.substr(0, 40);
    EXPECT_NE(refused.error().message.find(why), std::string::npos) << refused.error().message;
  }
  EXPECT_FALSE(io::load_material(folder.file("absent.json")));
}

}  // namespace
}  // namespace asperity
