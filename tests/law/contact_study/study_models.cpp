#include "law/contact_study/study_models.hpp"

#include <memory>
#include <string>
#include <utility>

#include "asperity/bake/bake.hpp"
#include "asperity/io/mesh_file.hpp"
#include "asperity/io/textured_model_file.hpp"
#include "benchmark_models.hpp"
#include "support/real_meshes.hpp"

namespace asperity::contact_study {
namespace {

namespace fs = std::filesystem;

result<model_ptr> load(const fs::path& file) {
  result<textured_model> loaded = io::load_textured_model(file);
  if (!loaded) return loaded.error();
  return model_ptr(std::make_shared<const textured_model>(std::move(loaded).value()));
}

void scale_to_diagonal(triangle_mesh& mesh, double diagonal_m) {
  vec3 low = mesh.positions.front(), high = low;
  for (const vec3& p : mesh.positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const double scale = diagonal_m / glm::length(high - low);
  for (vec3& p : mesh.positions) p = scale * (p - 0.5 * (low + high));
}

result<triangle_mesh> real_mesh(std::string_view name) {
  const fs::path folder = test_support::real_mesh_folder();
  for (const char* extension : {".ply", ".obj", ".stl"}) {
    const fs::path file = folder / (std::string(name) + extension);
    if (!fs::exists(file)) continue;
    result<triangle_mesh> mesh = io::load_mesh(file);
    if (mesh && !mesh->positions.empty()) scale_to_diagonal(*mesh, 0.16);
    return mesh;
  }
  return error{error_code::io_failed, "there is no mesh " + std::string(name) + " in " + folder.string() +
                                          "; ASPERITY_MODELS names another folder"};
}

}  // namespace

result<model_ptr> study_model(std::string_view name, const fs::path& baked, const fs::path& kept) {
  const std::string file = std::string(name) + ".glb";
  std::error_code ignored;
  for (const fs::path& folder : {baked, kept}) {
    if (fs::exists(folder / file, ignored)) return load(folder / file);
  }
  bake::bake_settings options;
  options.name = name;
  const std::optional<models::benchmark> known = models::parse_benchmark(name);
  if (known) options.triangles = models::coarse_triangle_count(*known);
  result<triangle_mesh> full = known ? models::make_full(*known) : real_mesh(name);
  if (!full) return full.error();
  result<textured_model> made = bake::bake(*full, options);
  if (!made) return made.error();
  fs::create_directories(kept, ignored);
  if (const result<void> saved = io::save_textured_model(*made, kept / file); !saved) return saved.error();
  return model_ptr(std::make_shared<const textured_model>(std::move(made).value()));
}

}  // namespace asperity::contact_study
