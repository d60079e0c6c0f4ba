#include "law/presses/press_pairs.hpp"

#include <array>
#include <exception>
#include <filesystem>
#include <utility>

#include "asperity/io/mesh_file.hpp"
#include "asperity/io/textured_model_file.hpp"
#include "law/oracle/real_bodies.hpp"
#include "support/real_meshes.hpp"

namespace asperity::presses {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 6> benchmarks{"block", "gear", "hammer", "cad_part", "file", "torus"};
const fs::path baked = ASPERITY_TEST_MODELS_DIR;

const oracle::real_mesh* scan(std::string_view name) {
  for (const oracle::real_mesh& mesh : oracle::real_meshes) {
    if (fs::path(mesh.file).stem().string() == name) return &mesh;
  }
  return nullptr;
}

bool is_benchmark(std::string_view name) {
  for (const std::string_view b : benchmarks) {
    if (b == name) return true;
  }
  return false;
}

/// With the probe's tip, which is the origin of its frame.
bool by_the_tip(const vec3& point_a, const vec3&) { return glm::length(point_a) < 1e-3; }

bool inside_the_cup(const vec3&, const vec3& p) {
  return p.x * p.x + p.y * p.y < 18.5e-3 * 18.5e-3 && p.z > 1.5e-3 && p.z < 38e-3;
}

/// On the groove's slopes, not on its edges.
bool in_the_groove(const vec3&, const vec3& p) {
  return p.x > -14e-3 && p.x < 14e-3 && p.z < 9e-3 && p.z > -6e-3 && p.y > -29.9e-3 && p.y < 29.9e-3;
}

/// On the three walls of the missing octant.
bool in_the_corner(const vec3&, const vec3& p) {
  const double inside = 24e-3, wall = 1e-4;
  return p.x > -wall && p.y > -wall && p.z > -wall && p.x < inside && p.y < inside && p.z < inside;
}

}  // namespace

std::vector<press_pair> press_pairs() {
  return {
      {"ball_2", "slab", {}},
      {"ball_10", "slab", {}},
      {"ball_10", "plate_5", {}},
      {"ball_2", "plate_2", {}},
      {"ball_2", "plate_1", {}},
      {"rod_8", "rod_8", {}},
      {"rod_128", "rod_128", {}},
      {"cone_20_16", "slab", by_the_tip},
      {"cone_20_200", "slab", by_the_tip},
      {"cone_45_24", "slab", by_the_tip},
      {"cone_45_60", "plate_5", by_the_tip},
      {"cone_60_4", "slab", by_the_tip},
      {"pyramid_30", "ball_30", by_the_tip},
      {"pencil", "slab", by_the_tip},
      {"ball_2", "cup", inside_the_cup},
      {"ball_10", "groove", in_the_groove},
      {"ball_10", "corner", in_the_corner},
      {"slab", "corner", {}},
      {"block", "gear", {}},
      {"file", "cad_part", {}},
      {"hammer", "torus", {}},
      {"ball_10", "cad_part", {}},
      {"pencil", "torus", by_the_tip},
      {"ball_10", "igea", {}},
      {"ball_10", "rocker-arm", {}},
      {"igea", "rocker-arm", {}},
      {"ball_30", "stanford-bunny", {}},
      {"pencil", "stanford-bunny", by_the_tip},
  };
}

std::vector<press_pair> benchmark_pairs() {
  std::vector<press_pair> out;
  for (const std::string_view probe : benchmarks) {
    for (const std::string_view fixed : benchmarks) {
      if (probe != fixed) out.push_back({std::string(probe), std::string(fixed), {}});
    }
  }
  return out;
}

std::string why_without_body(std::string_view name) {
  const oracle::real_mesh* const mesh = scan(name);
  return mesh == nullptr ? "" : test_support::why_without(mesh->file);
}

result<const press_body*> press_shelf::get(const std::string& name) {
  if (const auto known = made_.find(name); known != made_.end()) return &known->second;
  press_body body;
  body.name = name;
  if (scan(name) != nullptr) {
    if (std::string why = why_without_body(name); !why.empty()) return error{error_code::io_failed, std::move(why)};
    try {
      const oracle::original_and_bake& read = oracle::load_real_body(name);
      body.full = read.full;
      body.model = read.model;
    } catch (const std::exception& e) {
      return error{error_code::io_failed, e.what()};
    }
  } else if (is_benchmark(name)) {
    auto full = io::load_mesh(baked / (name + ".ply"));
    auto model = io::load_textured_model(baked / (name + ".glb"));
    if (!full || !model) {
      return error{error_code::io_failed,
                   (full ? model.error().message : full.error().message) + "; ctest -R benchmark_models makes it"};
    }
    body.full = std::move(full).value();
    body.model = std::make_shared<const textured_model>(std::move(model).value());
  } else if (!solids_) {
    auto full = test_support::make_press_solid(name, test_support::fineness::fine);
    if (!full) return full.error();
    body.full = std::move(full).value();
  } else {
    auto solid = test_support::bake_press_solid(name, *solids_, baked / "presses");
    if (!solid) return solid.error();
    body.full = std::move(solid->full);
    body.model = std::move(solid->model);
  }
  return &(made_[name] = std::move(body));
}

}  // namespace asperity::presses
