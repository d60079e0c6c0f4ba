#include <array>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <unistd.h>

#include "asperity/io/textured_model_file.hpp"
#include "attacks.hpp"
#include "support/small_models.hpp"

namespace asperity::hostile {

using nlohmann::json;

void write(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

namespace {

// A model as the writer leaves it in a file.
std::string written(const textured_model& model, const std::string& name) {
  const auto file = std::filesystem::temp_directory_path() / (name + "_" + std::to_string(::getpid()) + ".glb");
  if (const auto saved = io::save_textured_model(model, file); !saved) {
    throw std::runtime_error(saved.error().message);
  }
  std::ifstream in(file, std::ios::binary);
  std::string out{std::istreambuf_iterator<char>(in), {}};
  std::filesystem::remove(file);
  return out;
}

}  // namespace

const std::string& good_model() {
  static const std::string bytes = written(
      test_support::make_textured_box({0.01, 0.01, 0.01}, 24, test_support::ridges(1e-4, 4e-3)), "asperity_hostile");
  return bytes;
}

const std::string& good_mapped_model() {
  static const std::string bytes = [] {
    textured_model model = test_support::make_flat_box({0.01, 0.01, 0.01}, 24);
    model.surface = preset_material("ice").value();
    model.surface_map.others = {preset_material("rubber").value(), preset_material("wood").value()};
    for (std::size_t i = 0; i < model.texture.texels.size(); ++i) {
      model.surface_map.texels.push_back(static_cast<std::uint8_t>(i / 7 % 3));
    }
    return written(model, "asperity_hostile_map");
  }();
  return bytes;
}

std::string tetrahedron_bytes() {
  constexpr std::array<float, 12> positions{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  constexpr std::array<std::uint32_t, 12> indices{0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};
  std::string out(96, '\0');
  std::memcpy(out.data(), positions.data(), 48);
  std::memcpy(out.data() + 48, indices.data(), 48);
  return out;
}

json tetrahedron() {
  return {{"asset", {{"version", "2.0"}}},
          {"buffers", {{{"byteLength", 96}}}},
          {"bufferViews",
           {{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", 48}},
            {{"buffer", 0}, {"byteOffset", 48}, {"byteLength", 48}}}},
          {"accessors",
           {{{"bufferView", 0}, {"componentType", 5126}, {"count", 4}, {"type", "VEC3"}},
            {{"bufferView", 1}, {"componentType", 5125}, {"count", 12}, {"type", "SCALAR"}}}},
          {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}}}}},
          {"nodes", {{{"mesh", 0}}}},
          {"scenes", {{{"nodes", {0}}}}},
          {"scene", 0}};
}

std::string glb(const std::string& json_text, const std::string& bin) {
  test_support::glb_editor editor(good_model());
  editor.bin = bin;
  editor.bin.resize((bin.size() + 3) / 4 * 4);
  return editor.bytes(json_text);
}

std::string glb(const json& document, const std::string& bin) { return glb(document.dump(), bin); }

}  // namespace asperity::hostile
