// asperity bake: from a full-resolution mesh to a textured model.
#include <chrono>
#include <filesystem>
#include <utility>
#include <vector>

#include "asperity/bake/bake.hpp"
#include "asperity/bake/repair.hpp"
#include "asperity/io/mesh_file.hpp"
#include "asperity/io/textured_model_file.hpp"
#include "cli.hpp"
#include "interrupt.hpp"
#include "model_report.hpp"
#include "options.hpp"
#include "output_file.hpp"
#include "progress.hpp"
#include "relief_options.hpp"
#include "text.hpp"

namespace asperity::command {
namespace {

namespace fs = std::filesystem;

struct bake_command {
  std::string full;
  std::string coarse;
  std::string out;
  std::string name;
  std::size_t triangles = 600;
  std::uint32_t texture = 1024;
  unsigned threads = 0;
  double scale = 1.0;
  bool close_holes = false;
  std::shared_ptr<relief_options> relief = std::make_shared<relief_options>();
};

// Wall time of each stage, told apart by the names that the work reports.
class stage_clock {
 public:
  void enter(std::string_view stage) {
    if (!stages_.empty() && stages_.back().first == stage) return;
    leave();
    stages_.emplace_back(std::string(stage), 0.0);
    since_ = std::chrono::steady_clock::now();
  }
  void leave() {
    if (stages_.empty() || stages_.back().second != 0.0) return;
    stages_.back().second = std::chrono::duration<double>(std::chrono::steady_clock::now() - since_).count();
  }
  [[nodiscard]] const std::vector<std::pair<std::string, double>>& stages() const { return stages_; }

 private:
  std::vector<std::pair<std::string, double>> stages_;
  std::chrono::steady_clock::time_point since_;
};

void scale_mesh(triangle_mesh& mesh, double factor) {
  if (factor == 1.0) return;
  for (vec3& p : mesh.positions) p *= factor;
}

result<void> check_paths(const bake_command& options) {
  std::error_code ignored;
  std::vector<std::string> inputs = options.relief->inputs();
  inputs.insert(inputs.end(), {options.full, options.coarse});
  for (const std::string& input : inputs) {
    if (!input.empty() && fs::equivalent(input, options.out, ignored)) {
      return error{error_code::invalid_argument,
                   "-o " + options.out + " would replace a file that is being baked: give another name"};
    }
  }
  return check_writable(options.out);
}

answer report(const bake_command& options, const textured_model& model, const bake::hole_report& holes,
              const relief_job& relief, const stage_clock& clock, std::vector<std::string> notes) {
  for (std::string& warning : warnings(model)) notes.push_back(std::move(warning));
  answer out;
  out.document = {{"file", options.out}, {"source", options.full}, {"scale", options.scale}};
  out.document.update(describe(model));
  out.document["repair"] = {{"holes_closed", holes.holes},
                            {"triangles_added", holes.triangles_added},
                            {"area_added", holes.area_added_m2},
                            {"largest_hole", holes.largest_m}};
  if (relief.relief) out.document["relief"] = relief.document;
  json stages = json::array();
  std::string times;
  double total = 0.0;
  for (const auto& [stage, seconds] : clock.stages()) {
    stages.push_back({{"stage", stage}, {"seconds", seconds}});
    times += (times.empty() ? "" : ", ") + stage + ' ' + time_text(seconds);
    total += seconds;
  }
  out.document["stages"] = std::move(stages);
  out.document["seconds"] = total;
  out.document["warnings"] = notes;
  out.document["units"] = "SI";
  out.text = options.full + " -> " + options.out + '\n' + describe_text(model);
  out.text += relief.text;
  if (holes.holes > 0) {
    out.text +=
        row("holes closed", std::to_string(holes.holes) + ", the largest " + length_text(holes.largest_m) + " across");
  }
  out.text += row("time", time_text(total) + "  (" + times + ')') + warnings_text(notes);
  return out;
}

result<answer> run_bake(const bake_command& options, const common_options& common) {
  if (const result<void> ok = check_paths(options); !ok) return ok.error();

  progress_line progress(common.quiet);
  stage_clock clock;
  const auto enter = [&](std::string_view stage, double done) {
    clock.enter(stage);
    progress.show(stage, done);
    return !interrupted();
  };

  enter("read", 0.0);
  result<triangle_mesh> full = io::load_mesh(options.full);
  if (!full) return full.error();
  scale_mesh(*full, options.scale);
  bake::hole_report holes;
  if (options.close_holes) {
    const result<bake::hole_report> closed = bake::close_holes(*full);
    if (!closed) return closed.error();
    holes = *closed;
  }

  bake::bake_options settings;
  settings.name = options.name.empty() ? fs::path(options.full).stem().string() : options.name;
  settings.triangles = options.triangles;
  settings.texture_size = options.texture;
  settings.threads = options.threads;
  settings.progress = enter;
  if (!options.relief->kind().empty() && !enter("relief", 0.0))
    return error{error_code::cancelled, "interrupted: nothing was written"};
  result<relief_job> relief = make_relief(*options.relief, *full, options.full);
  if (!relief) return relief.error();
  settings.relief = relief->relief;
  std::vector<std::string> remarks = relief->notes;
  settings.remark = [&](std::string_view sentence) { remarks.emplace_back(sentence); };
  if (!options.coarse.empty()) {
    result<triangle_mesh> coarse = io::load_mesh(options.coarse);
    if (!coarse) return coarse.error();
    scale_mesh(*coarse, options.scale);
    settings.coarse = std::move(coarse).value();
  }
  const result<textured_model> model = bake::bake(*full, settings);
  if (!model) return model.error();

  if (!enter("write", 0.0)) return error{error_code::cancelled, "interrupted: nothing was written"};
  if (const result<void> saved = io::save_textured_model(*model, options.out); !saved) return saved.error();
  clock.leave();
  return report(options, *model, holes, *relief, clock, std::move(remarks));
}

}  // namespace

void add_bake(command_line& line) {
  const auto o = std::make_shared<bake_command>();
  CLI::App& sub = line.add("bake", "Turn a full-resolution mesh into a textured model",
                           [o](const common_options& common) { return run_bake(*o, common); });
  sub.add_option("full", o->full, "Full-resolution mesh (.ply, .obj, .stl, .gltf, .glb), closed, in metres")
      ->required();
  sub.add_option("-o,--output", o->out, "Textured model to write (.glb)")
      ->required()
      ->check([](const std::string& text) { return extension_error(text, {".glb"}); }, "FILE.glb");
  auto* triangles = sub.add_option("--triangles", o->triangles, "Triangles of the coarse mesh to aim for")
                        ->check(CLI::Range(4, 1000000))
                        ->capture_default_str();
  sub.add_option("--coarse", o->coarse, "Use this mesh as the coarse mesh instead of simplifying")->excludes(triangles);
  sub.add_option("--texture", o->texture, "Texels per side of the haptic texture")
      ->check(CLI::Range(16, 8192))
      ->capture_default_str();
  sub.add_option("--scale", o->scale, "Metres per unit of the meshes (0.001 for millimetres)")
      ->check(positive_number_error, "NUMBER > 0")
      ->capture_default_str();
  add_relief_options(sub, o->relief);
  sub.add_flag("--close-holes", o->close_holes, "Close the holes of the full mesh first, and report them");
  sub.add_option("--name", o->name, "Name kept in the model; by default the mesh's file name without extension");
  sub.add_option("--threads", o->threads, "Threads to use; 0 takes all. The result does not depend on it")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
}

}  // namespace asperity::command
