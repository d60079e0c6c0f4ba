// Textured models that are damaged, hostile or in other units. Every command that reads a model refuses them alike.
#include <cmath>
#include <limits>

#include "command_process.hpp"
#include "unit/io/glb_editor.hpp"

namespace fault {
namespace {

using asperity::test_support::glb_editor;

class bad_model : public command_test {
 protected:
  bad_model() { std::filesystem::copy_file(small_models() / "block.glb", path("whole.glb")); }

  // Writes these bytes and expects inspect, query and run to refuse them. @return the message
  std::string expect_refused(const std::string& bytes, const std::string& code) const {
    write("model.glb", bytes);
    const std::string good = path("whole.glb");
    expect_failure({"query", "--probe", path("model.glb"), "--fixed", good, "--probe-pose", "0 0 0 0 0 0 1"}, 1, code);
    expect_failure({"run", "--probe", good, "--fixed", path("model.glb"), "--record", path("session.csv")}, 1, code);
    const std::string message = expect_failure({"inspect", path("model.glb")}, 1, code);
    EXPECT_NE(message.find("model.glb"), std::string::npos) << message;
    return message;
  }
};

TEST_F(bad_model, not_there) {
  EXPECT_NE(expect_failure({"inspect", path("absent.glb")}, 1, "io_failed").find("absent.glb"), std::string::npos);
}

TEST_F(bad_model, not_a_model_at_all) {
  expect_refused("", "bad_format");
  expect_refused("ply\nformat ascii 1.0\n", "bad_format");
}

TEST_F(bad_model, truncated) {
  const std::string whole = read("whole.glb");
  for (const std::size_t kept :
       {std::size_t{4}, std::size_t{11}, std::size_t{19}, std::size_t{200}, whole.size() / 2, whole.size() - 1}) {
    expect_refused(whole.substr(0, kept), "bad_format");
  }
}

TEST_F(bad_model, corrupt) {
  const std::string whole = read("whole.glb");
  std::string magic = whole;
  magic[0] = 'x';
  expect_refused(magic, "bad_format");

  std::string syntax = whole;
  syntax[whole.find("\"accessors\"")] = '!';
  expect_refused(syntax, "bad_format");

  std::string longer = whole + std::string(16, '\0');
  expect_refused(longer, "bad_format");
}

TEST_F(bad_model, every_flipped_byte_of_the_header_ends_in_an_answer) {
  // Whatever a single wrong byte does, the process ends by itself: with a report, or with one line.
  std::filesystem::copy_file(small_models() / "block_bare.glb", path("bare.glb"));
  const std::string whole = read("bare.glb");
  for (std::size_t at = 0; at < 400; at += 7) {
    std::string flipped = whole;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x15);
    write("model.glb", flipped);
    const outcome ended = run({"inspect", path("model.glb")});
    EXPECT_TRUE(ended.exit_status == 0 || ended.exit_status == 1) << "byte " << at << ": " << ended.exit_status;
  }
}

TEST_F(bad_model, haptic_texture_lost_on_a_rewrite) {
  // What a modelling program leaves of a file whose extension it does not know.
  glb_editor file(read("whole.glb"));
  file.json["meshes"][0].erase("extensions");
  file.json.erase("extensionsUsed");
  const std::string message = expect_refused(file.bytes(), "bad_texture");
  EXPECT_NE(message.find("bake"), std::string::npos) << message;
}

TEST_F(bad_model, texture_of_nan) {
  for (const float value : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    glb_editor file(read("whole.glb"));
    const auto view = file.haptic()["texture"]["bufferView"].get<std::size_t>();
    for (std::size_t i = 0; i < std::size_t{128} * 128 * 3; ++i) file.put(view, i, value);
    expect_refused(file.bytes(), "bad_texture");
  }
}

TEST_F(bad_model, one_nan_in_a_texel_that_is_used) {
  glb_editor file(read("whole.glb"));
  const auto number = [&](std::size_t accessor, std::size_t index, auto value) {
    const auto view = file.json["accessors"][accessor]["bufferView"].get<std::size_t>();
    const auto offset = file.json["bufferViews"][view].value("byteOffset", std::size_t{0});
    std::memcpy(&value, file.bin.data() + offset + index * sizeof value, sizeof value);
    return value;
  };
  // The texel under the middle of the first triangle.
  const json& primitive = file.json["meshes"][0]["primitives"][0];
  const auto indices = primitive["indices"].get<std::size_t>();
  const auto texcoord = primitive["attributes"]["TEXCOORD_0"].get<std::size_t>();
  float u = 0.0F, v = 0.0F;
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const std::size_t vertex = number(indices, corner, std::uint32_t{});
    u += number(texcoord, 2 * vertex, 0.0F) / 3.0F;
    v += number(texcoord, 2 * vertex + 1, 0.0F) / 3.0F;
  }
  const std::size_t texel = static_cast<std::size_t>(v * 128.0F) * 128 + static_cast<std::size_t>(u * 128.0F);
  file.put(file.haptic()["texture"]["bufferView"].get<std::size_t>(), 3 * texel,
           std::numeric_limits<float>::quiet_NaN());
  expect_refused(file.bytes(), "bad_texture");
}

TEST_F(bad_model, nan_position) {
  glb_editor file(read("whole.glb"));
  file.put(file.json["accessors"][0]["bufferView"].get<std::size_t>(), 1, std::numeric_limits<float>::quiet_NaN());
  write("model.glb", file.bytes());
  const outcome refused = run({"inspect", path("model.glb")});
  EXPECT_EQ(refused.exit_status, 1) << refused.out;
}

TEST_F(bad_model, units_mixed_up) {
  const auto block = [](const char* name) { return (small_models() / name).string(); };
  ASSERT_EQ(run({"bake", block("block.ply"), "--coarse", block("block_coarse.ply"), "--texture", "64", "--scale",
                 "1000", "-o", path("huge.glb")})
                .exit_status,
            0);
  const arguments too_large{"query",           "--probe",      path("huge.glb"), "--fixed",
                            path("whole.glb"), "--probe-pose", "0 0 30 0 0 0 1"};
  const std::string message = expect_failure(too_large, 1, "invalid_argument");
  EXPECT_NE(message.find("1000 times larger"), std::string::npos) << message;
  EXPECT_NE(message.find("--scale 0.001"), std::string::npos) << message;
  EXPECT_NE(
      expect_failure({"run", "--probe", path("whole.glb"), "--fixed", path("huge.glb"), "--record", path("s.csv")}, 1,
                     "invalid_argument")
          .find("1000 times smaller"),
      std::string::npos);

  arguments meant = too_large;
  meant.emplace_back("--allow-scale-mismatch");
  static_cast<void>(expect_document(meant, "asperity.query/1"));
}

}  // namespace
}  // namespace fault
