// Files made to break a loader. Each must end in an error or in a valid model, quickly, whatever its bytes.
#include <functional>
#include <gtest/gtest.h>
#include <string>

#include "asperity/io/mesh_file.hpp"
#include "asperity/io/textured_model_file.hpp"
#include "asperity/model/validate.hpp"
#include "glb_editor.hpp"
#include "scratch_folder.hpp"
#include "some_quality.hpp"
#include "support/small_models.hpp"

namespace asperity {
namespace {

using nlohmann::json;
using test_support::glb_editor;
using test_support::scratch_folder;

class HostileGlb : public ::testing::Test {
 protected:
  HostileGlb() {
    textured_model model = test_support::make_flat_box({1, 1, 1}, 24);
    model.report.quality = test_support::some_quality();
    const auto saved = io::save_textured_model(model, folder_.file("good.glb"));
    EXPECT_TRUE(saved) << saved.error().message;
    good_ = test_support::read_all(folder_.file("good.glb"));
  }

  /// Loads bytes as a model and as a mesh; a model that loads must be a valid one.
  result<textured_model> load(const std::string& bytes) {
    const auto file = folder_.file("hostile.glb", bytes);
    (void)io::load_mesh(file);
    auto model = io::load_textured_model(file);
    EXPECT_TRUE(!model || validate(*model));
    return model;
  }

  void expect_refused(const std::string& bytes, const std::string& says) {
    SCOPED_TRACE(says);
    const auto model = load(bytes);
    ASSERT_FALSE(model);
    EXPECT_NE(model.error().message.find(says), std::string::npos) << model.error().message;
    EXPECT_EQ(model.error().message.find('\n'), std::string::npos) << model.error().message;
  }

  void expect_edit_refused(const std::string& says, const std::function<void(glb_editor&)>& edit) {
    glb_editor glb(good_);
    edit(glb);
    expect_refused(glb.bytes(), says);
  }

  scratch_folder folder_;
  std::string good_;
};

void put_word(std::string& bytes, std::size_t offset, std::uint32_t value) {
  std::memcpy(bytes.data() + offset, &value, 4);
}

TEST_F(HostileGlb, TheModelThatTheOthersAreMadeFromLoads) {
  EXPECT_TRUE(load(good_));
  EXPECT_TRUE(load(glb_editor(good_).bytes()));
}

TEST_F(HostileGlb, EveryPrefixIsRefused) {
  const auto file = folder_.file("prefix.glb", good_);
  for (std::size_t n = good_.size(); n-- > 0;) {
    std::filesystem::resize_file(file, n);
    ASSERT_FALSE(io::load_textured_model(file)) << n << " bytes";
    ASSERT_FALSE(io::load_mesh(file)) << n << " bytes";
  }
}

TEST_F(HostileGlb, EveryPrefixWithACorrectedLengthIsRefused) {
  const auto file = folder_.file("prefix.glb", good_);
  std::fstream header(file, std::ios::binary | std::ios::in | std::ios::out);
  for (std::size_t n = good_.size() - 1; n >= 12; --n) {
    std::filesystem::resize_file(file, n);
    const auto length = static_cast<std::uint32_t>(n);
    header.seekp(8).write(reinterpret_cast<const char*>(&length), 4).flush();
    ASSERT_FALSE(io::load_textured_model(file)) << n << " bytes";
    ASSERT_FALSE(io::load_mesh(file)) << n << " bytes";
  }
}

TEST_F(HostileGlb, Container) {
  const std::size_t json_length = good_.find("BIN") - 4 - 20;
  std::string bytes = good_;
  put_word(bytes, 8, static_cast<std::uint32_t>(bytes.size() + 8));
  expect_refused(bytes, "byte 8 announces");
  bytes = good_;
  put_word(bytes, 12, 0xfffffffcU);
  expect_refused(bytes, "byte 12 begins no JSON chunk");
  bytes = good_;
  put_word(bytes, 20 + json_length, static_cast<std::uint32_t>(bytes.size() - 28 - json_length + 8));
  expect_refused(bytes, "begins no BIN chunk");
  bytes = good_ + std::string("\0\0\0\0BIN\0", 8);
  put_word(bytes, 8, static_cast<std::uint32_t>(bytes.size()));
  expect_refused(bytes, "where nothing belongs");
  bytes = good_;
  put_word(bytes, 4, 1);
  expect_refused(bytes, "version 1");
  expect_refused("glTF", "fewer than the header");
}

TEST_F(HostileGlb, JsonThatExhaustsAParser) {
  const glb_editor glb(good_);
  const std::string text = glb.json.dump();
  const auto with_extras = [&](const std::string& extras) {
    return glb.bytes("{\"extras\":" + extras + "," + text.substr(1));
  };
  EXPECT_TRUE(load(with_extras(std::string(30, '[') + std::string(30, ']'))));
  expect_refused(with_extras(std::string(100000, '[') + std::string(100000, ']')), "deeper than 32 levels");
  std::string many = "[0";
  for (int i = 0; i < 300000; ++i) many += ",0";
  expect_refused(with_extras(many + "]"), "more than 200000 JSON items");
  expect_refused(with_extras("\"" + std::string(17 << 20, 'x') + "\""), "bytes of JSON");
  expect_refused(with_extras("1e999"), "does not parse");
  expect_refused(with_extras("\"\xff\xfe\""), "does not parse");
  expect_refused(glb.bytes("{\"asset\":{}," + text.substr(1)), "the name 'asset' twice in one object");
  expect_refused(glb.bytes("[]"), "does not parse as an object");
  expect_refused(glb.bytes(text.substr(0, text.size() / 2)), "does not parse");
}

TEST_F(HostileGlb, Buffers) {
  using e = glb_editor&;
  expect_edit_refused("buffers[0].uri names data outside", [](e g) { g.json["buffers"][0]["uri"] = "/etc/passwd"; });
  expect_edit_refused("buffers[0].uri names data outside",
                      [](e g) { g.json["buffers"][0]["uri"] = "data:;base64,AAAA"; });
  expect_edit_refused("buffers[1] has no uri", [](e g) { g.json["buffers"].push_back({{"byteLength", 4}}); });
  expect_edit_refused("byteLength is 0", [](e g) { g.json["buffers"][0]["byteLength"] = 0; });
  expect_edit_refused("byteLength is 18446744073709551615",
                      [](e g) { g.json["buffers"][0]["byteLength"] = 18446744073709551615U; });
  expect_edit_refused("bufferViews[0] lies outside",
                      [](e g) { g.json["bufferViews"][0]["byteOffset"] = 18446744073709551608U; });  // wraps round
  expect_edit_refused("bufferViews[3] lies outside",                                                 // the image's
                      [](e g) { g.json["bufferViews"][3]["byteOffset"] = 0xffffff0000U; });
  expect_edit_refused("bufferViews[1] lies outside", [](e g) { g.json["bufferViews"][1]["byteLength"] = 1U << 30; });
  expect_edit_refused("byteStride", [](e g) { g.json["bufferViews"][0]["byteStride"] = 7; });
  // Three floats every eight bytes: each would begin within the one before.
  expect_edit_refused("accessors[0] (count 24)", [](e g) { g.json["bufferViews"][0]["byteStride"] = 8; });
  expect_edit_refused("accessors[0] (count 1152921504606846976)",
                      [](e g) { g.json["accessors"][0]["count"] = 1ULL << 60; });
  expect_edit_refused("accessors[0] (count 25)", [](e g) { g.json["accessors"][0]["count"] = 25; });
  expect_edit_refused("accessors[0].count is not a whole number", [](e g) { g.json["accessors"][0]["count"] = -24; });
  expect_edit_refused("accessors[2]", [](e g) { g.json["accessors"][2]["componentType"] = 5130; });
}

TEST_F(HostileGlb, ImagesAreNeverLookedAt) {
  glb_editor glb(good_);
  glb.json["images"] = {
      {{"uri", "/dev/zero"}}, {{"bufferView", 99}, {"mimeType", 3}}, {{"uri", "http://example.org/x.png"}}};
  glb.json["materials"] = 7;
  EXPECT_TRUE(load(glb.bytes()));
}

TEST_F(HostileGlb, Geometry) {
  using e = glb_editor&;
  expect_edit_refused("entry 4 names vertex 24 of 24", [](e g) { g.put(2, 4, std::uint32_t{24}); });
  expect_edit_refused("coordinate that is not finite at vertex 1", [](e g) { g.put(0, 5, NAN); });
  expect_edit_refused("texture coordinate that is not finite", [](e g) { g.put(1, 0, INFINITY); });
  expect_edit_refused("outside [0, 1]", [](e g) { g.put(1, 0, 1.5F); });
  expect_edit_refused("merges positions that differ", [](e g) { g.put(0, 0, 0.25F); });
  expect_edit_refused("meshes[0] is not a single list of triangles",
                      [](e g) { g.json["meshes"][0]["primitives"].push_back(g.json["meshes"][0]["primitives"][0]); });
  expect_edit_refused("more than one mesh", [](e g) { g.json["meshes"].push_back(g.json["meshes"][0]); });
  expect_edit_refused("POSITION is 9, but there are only 3",
                      [](e g) { g.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 9; });
}

TEST_F(HostileGlb, Extension) {
  using e = glb_editor&;
  expect_edit_refused("is not a JSON object", [](e g) { g.haptic() = 3; });
  expect_edit_refused("version is missing", [](e g) { g.haptic().erase("version"); });
  expect_edit_refused("units is not m", [](e g) { g.haptic()["units"] = "mm"; });
  expect_edit_refused("meshVertices", [](e g) { g.haptic()["meshVertices"]["count"] = 1U << 31; });
  expect_edit_refused("merges positions that differ or names vertex 8 of 8",
                      [](e g) { g.put(4, 0, std::uint32_t{8}); });
  expect_edit_refused("is 24 x 4294967295 texels", [](e g) { g.haptic()["texture"]["height"] = 4294967295U; });
  expect_edit_refused("holds 6912 bytes, not the 6624 of 24 x 23 texels",
                      [](e g) { g.haptic()["texture"]["height"] = 23; });
  expect_edit_refused("bufferView is 99", [](e g) { g.haptic()["texture"]["bufferView"] = 99; });
  expect_edit_refused("is not a position", [](e g) { g.put(5, 3 * (24 * 4 + 4), NAN); });
  expect_edit_refused("texels of another kind", [](e g) { g.haptic()["texture"]["componentType"] = 5131; });
  for (const std::size_t column : {0U, 1U, 2U}) {
    for (const std::uint32_t count : {0xffffffffU, 10'000U}) {
      expect_edit_refused("row 0 takes more than the arrays hold", [&](e g) { g.put(6, column, count); });
    }
  }
  expect_edit_refused("leaves part of the arrays to no piece", [](e g) { g.put(6, 1, std::uint32_t{11}); });
  expect_edit_refused("four numbers for each piece", [](e g) { g.haptic()["pieces"]["count"] = 2; });
  expect_edit_refused("vertices entry 0 names vertex 8 of 8", [](e g) { g.put(7, 0, std::uint32_t{8}); });
  expect_edit_refused("hull face that names vertex 9 of 8", [](e g) { g.put(8, 0, std::uint32_t{9}); });
  expect_edit_refused("covers coarse triangle 12 of 12", [](e g) { g.put(9, 0, std::uint32_t{12}); });
  expect_edit_refused("rms_error_m is not a finite number", [](e g) { g.haptic()["report"]["rms_error_m"] = "small"; });
  const auto quality = [](e g) -> nlohmann::json& { return g.haptic()["report"]["quality"]; };
  expect_edit_refused("report.quality is not a JSON object", [&](e g) { quality(g) = 1; });
  expect_edit_refused("quality.lost_share is missing", [&](e g) { quality(g).erase("lost_share"); });
  expect_edit_refused("quality.to_original.p99_m is not a finite number",
                      [&](e g) { quality(g)["to_original"]["p99_m"] = "1"; });
  expect_edit_refused("quality.lost_part_low is not three finite numbers", [&](e g) {
    quality(g)["lost_part_low"] = {1, 2};
  });
  expect_edit_refused("quality.lost_part_high is not three finite numbers",
                      [&](e g) { quality(g)["lost_part_high"][2] = "high"; });
}

}  // namespace
}  // namespace asperity
