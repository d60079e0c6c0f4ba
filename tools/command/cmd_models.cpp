// asperity models: the paper's six benchmark models as files.
#include <algorithm>
#include <filesystem>
#include <vector>

#include "asperity/io/mesh_file.hpp"
#include "benchmark_models.hpp"
#include "cli.hpp"
#include "interrupt.hpp"
#include "output_file.hpp"
#include "progress.hpp"
#include "text.hpp"

namespace asperity::command {
namespace {

namespace fs = std::filesystem;

struct models_command {
  std::string folder;
  std::vector<std::string> only;
};

struct written_mesh {
  std::string name;
  fs::path file;
  std::size_t vertices;
  std::size_t triangles;
};

result<std::vector<written_mesh>> write_model(models::benchmark which, const fs::path& folder) {
  std::vector<written_mesh> written;
  const auto write = [&](const triangle_mesh& mesh, const std::string& name) -> result<void> {
    const fs::path file = folder / (name + ".ply");
    if (const result<void> saved = io::save_ply(mesh, file); !saved) return saved;
    written.push_back({name, file, mesh.positions.size(), mesh.triangles.size()});
    return {};
  };
  const std::string name(models::to_string(which));
  if (const result<void> saved = write(models::make_full(which), name); !saved) return saved.error();
  if (const auto coarse = models::make_coarse(which)) {
    if (const result<void> saved = write(*coarse, name + "_coarse"); !saved) return saved.error();
  }
  return written;
}

result<answer> write_models(const models_command& options, const common_options& common) {
  const fs::path folder(options.folder);
  if (const result<void> made = make_folder(folder); !made) return made.error();
  if (const result<void> ready = check_writable(folder / "block.ply"); !ready) return ready.error();

  progress_line progress(common.quiet);
  answer out;
  json meshes = json::array();
  std::size_t done = 0;
  for (const models::benchmark which : models::all_benchmarks) {
    const std::string name(models::to_string(which));
    if (!options.only.empty() && std::find(options.only.begin(), options.only.end(), name) == options.only.end())
      continue;
    if (interrupted()) return error{error_code::cancelled, "interrupted: the meshes written so far are whole"};
    const std::size_t all = options.only.empty() ? models::all_benchmarks.size() : options.only.size();
    progress.show(name, static_cast<double>(done++) / static_cast<double>(all));

    const auto written = write_model(which, folder);
    if (!written) return written.error();
    for (const written_mesh& mesh : *written) {
      meshes.push_back({{"name", mesh.name},
                        {"file", mesh.file.string()},
                        {"vertices", mesh.vertices},
                        {"triangles", mesh.triangles}});
      out.text += row(mesh.name, std::to_string(mesh.triangles) + " triangles, " + mesh.file.string());
    }
  }
  out.document = {{"meshes", std::move(meshes)}, {"units", "SI"}};
  return out;
}

}  // namespace

void add_models(command_line& line) {
  const auto o = std::make_shared<models_command>();
  CLI::App& sub = line.add("models", "Write the paper's six benchmark models as full-resolution meshes",
                           [o](const common_options& common) { return write_models(*o, common); });
  sub.add_option("-o,--output", o->folder, "Folder to write into; made where it does not exist")->required();
  std::vector<std::string> names;
  for (const models::benchmark which : models::all_benchmarks) names.emplace_back(models::to_string(which));
  sub.add_option("--only", o->only, "Write only this model; may be given several times")
      ->check(CLI::IsMember(names))
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

}  // namespace asperity::command
