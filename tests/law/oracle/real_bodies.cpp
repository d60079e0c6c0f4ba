#include "law/oracle/real_bodies.hpp"

#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "asperity/bake/repair.hpp"
#include "asperity/io/mesh_file.hpp"
#include "asperity/io/textured_model_file.hpp"
#include "support/real_meshes.hpp"

namespace asperity::oracle {
namespace {

const std::filesystem::path baked = std::filesystem::path(ASPERITY_TEST_MODELS_DIR) / "real";

std::string stem(const real_mesh& mesh) { return std::filesystem::path(mesh.file).stem().string(); }

}  // namespace

std::string why_without_real_meshes() {
  for (const real_mesh& mesh : real_meshes) {
    if (std::string why = test_support::why_without(mesh.file); !why.empty()) return why;
  }
  return "";
}

std::string bake_report_of(const real_mesh& mesh) {
  const std::filesystem::path file = baked / (stem(mesh) + ".json");
  std::ifstream in(file);
  std::ostringstream text;
  if (!(text << in.rdbuf()))
    throw std::runtime_error("there is no " + file.string() + "; ctest -R real_models makes it");
  return text.str();
}

const original_and_bake& load_real_body(const std::string& name) {
  static std::map<std::string, original_and_bake> read;
  if (const auto known = read.find(name); known != read.end()) return known->second;
  for (const real_mesh& mesh : real_meshes) {
    if (stem(mesh) != name) continue;
    auto full = io::load_mesh(test_support::real_mesh_folder() / mesh.file);
    if (!full) throw std::runtime_error(full.error().message);
    const double scale = nlohmann::json::parse(bake_report_of(mesh)).at("scale");
    for (vec3& p : full->positions) p *= scale;
    // The library's own repair: what lies over a hole is its word, everywhere else it is the scan's.
    if (mesh.holes > 0) {
      if (const auto closed = bake::repair(*full); !closed) throw std::runtime_error(closed.error().message);
    }
    auto model = io::load_textured_model(baked / (name + ".glb"));
    if (!model) throw std::runtime_error(model.error().message);
    return read[name] = {name, std::move(full).value(),
                         std::make_shared<const textured_model>(std::move(model).value())};
  }
  throw std::runtime_error("no real mesh is named " + name);
}

}  // namespace asperity::oracle
