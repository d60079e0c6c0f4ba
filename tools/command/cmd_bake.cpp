// asperity bake: from a full-resolution mesh to a textured model.
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "asperity/bake/bake.hpp"
#include "asperity/bake/repair.hpp"
#include "asperity/io/mesh_file.hpp"
#include "asperity/io/textured_model_file.hpp"
#include "cli.hpp"
#include "interrupt.hpp"
#include "model_drawing.hpp"
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
  std::string picture;
  std::string name;
  std::size_t triangles = 600;
  std::uint32_t texture = 1024;
  unsigned threads = 0;
  std::optional<double> scale;  // metres per unit, by --scale
  std::optional<std::string> units;
  std::optional<std::size_t> pieces;
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

struct length_unit {
  const char* name;
  double metres;
};
constexpr std::array<length_unit, 4> length_units{{{"m", 1.0}, {"cm", 1e-2}, {"mm", 1e-3}, {"in", 0.0254}}};

double metres_per_unit(const bake_command& options) {
  if (options.scale) return *options.scale;
  for (const length_unit& u : length_units)
    if (options.units == u.name) return u.metres;
  return 1.0;
}

// Mesh formats other than glTF do not say what their numbers mean. Where they would make a body that nobody holds in
// his hand, the unit is asked for.
result<void> check_size(const bake_command& options, const triangle_mesh& mesh) {
  if (options.scale || options.units || mesh.positions.empty()) return {};
  if (extension_error(options.full, {".gltf", ".glb"}).empty()) return {};
  vec3 low = mesh.positions.front();
  vec3 high = low;
  for (const vec3& p : mesh.positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const double diagonal = glm::length(high - low);
  // Without any size, or with none that is a number, the mesh has another fault, which the bake names.
  if (!std::isfinite(diagonal) || diagonal == 0.0 || is_sensible_size(diagonal)) return {};
  std::string choices;
  for (const length_unit& u : length_units) {
    if (is_sensible_size(diagonal * u.metres))
      choices += (choices.empty() ? "" : ", or ") + std::string("--units ") + u.name + " (" +
                 length_text(diagonal * u.metres) + ")";
  }
  return error{error_code::invalid_argument,
               options.full + ": its diagonal would be " + length_text(diagonal) +
                   " if its unit is the metre, outside " + sensible_sizes() +
                   "; say the unit: " + (choices.empty() ? "" : choices + ", or ") +
                   "--units m if it is that large or small, or --scale with metres per unit"};
}

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
    if (!input.empty() && !options.picture.empty() && fs::equivalent(input, options.picture, ignored)) {
      return error{error_code::invalid_argument,
                   "--picture " + options.picture + " would replace the mesh that is being baked: give another name"};
    }
  }
  if (!options.picture.empty() &&
      fs::weakly_canonical(options.picture, ignored) == fs::weakly_canonical(options.out, ignored)) {
    return error{error_code::invalid_argument, "--picture and -o name the same file: give two names"};
  }
  return check_writable(options.out);
}

answer report(const bake_command& options, const textured_model& model, const bake::hole_report& holes,
              const relief_job& relief, const stage_clock& clock, std::vector<std::string> notes) {
  for (std::string& warning : warnings(model)) notes.push_back(std::move(warning));
  answer out;
  out.document = {{"file", options.out}, {"source", options.full}, {"scale", metres_per_unit(options)}};
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

  std::optional<output_file> drawing;
  if (!options.picture.empty()) {
    result<output_file> opened = output_file::create(options.picture);
    if (!opened) return opened.error();
    drawing.emplace(std::move(*opened));
  }
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
  if (const result<void> ok = check_size(options, *full); !ok) return ok.error();
  scale_mesh(*full, metres_per_unit(options));
  std::vector<std::string> remarks;
  bake::hole_report holes;
  if (options.close_holes) {
    const result<bake::hole_report> closed = bake::close_holes(*full);
    if (!closed) return closed.error();
    holes = *closed;
    if (holes.triangles_turned > 0) {
      remarks.push_back("before its holes were closed, " + std::to_string(holes.triangles_turned) +
                        " triangles that were wound against their neighbours have been turned");
    }
  }

  bake::bake_options settings;
  settings.name = options.name.empty() ? fs::path(options.full).stem().string() : options.name;
  settings.triangles = options.triangles;
  settings.texture_size = options.texture;
  settings.pieces = options.pieces;
  settings.threads = options.threads;
  settings.progress = enter;
  if (!options.relief->kind().empty() && !enter("relief", 0.0))
    return error{error_code::cancelled, "interrupted: nothing was written"};
  result<relief_job> relief = make_relief(*options.relief, *full, options.full);
  if (!relief) return relief.error();
  settings.relief = relief->relief;
  remarks.insert(remarks.end(), relief->notes.begin(), relief->notes.end());
  settings.remark = [&](std::string_view sentence) { remarks.emplace_back(sentence); };
  if (!options.coarse.empty()) {
    result<triangle_mesh> coarse = io::load_mesh(options.coarse);
    if (!coarse) return coarse.error();
    scale_mesh(*coarse, metres_per_unit(options));
    settings.coarse = std::move(coarse).value();
  }
  // A mesh that the picture does not need is not kept twice.
  const result<textured_model> model =
      drawing && !settings.relief ? bake::bake(*full, settings) : bake::bake(std::move(*full), settings);
  if (!model) return model.error();

  json picture;
  if (drawing) {
    picture::picture_options page;
    if (!settings.relief) {  // with one, the mesh is not what the textured surface should be
      page.original = &*full;
      page.original_name = fs::path(options.full).filename().string();
    }
    page.threads = options.threads;
    page.progress = enter;
    result<json> drawn = write_picture(*model, page, *drawing);
    if (!drawn) return drawn.error();
    picture = {{"file", options.picture}};
    picture.update(*drawn);
  }
  if (!enter("write", 0.0)) return error{error_code::cancelled, "interrupted: nothing was written"};
  if (const result<void> saved = io::save_textured_model(*model, options.out); !saved) return saved.error();
  if (drawing) {
    if (const result<void> kept = drawing->commit(); !kept) return kept.error();
  }
  clock.leave();
  answer out = report(options, *model, holes, *relief, clock, std::move(remarks));
  if (drawing) {
    out.document["picture"] = std::move(picture);
    out.text += row("picture", options.picture);
  }
  return out;
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
  auto* scale = sub.add_option("--scale", o->scale, "Metres per unit of the meshes (0.001 for millimetres)")
                    ->check(positive_number_error, "NUMBER > 0");
  sub.add_option("--units", o->units, "Unit of the meshes: m, cm, mm or in")
      ->check(CLI::IsMember({"m", "cm", "mm", "in"}))
      ->excludes(scale);
  sub.add_option("--pieces", o->pieces, "Convex pieces to aim for; by default as many as the usual tolerances make")
      ->check(CLI::Range(1, 1000000));
  add_relief_options(sub, o->relief);
  sub.add_flag("--close-holes", o->close_holes, "Close the holes of the full mesh first, and report them");
  sub.add_option("--picture", o->picture, "Draw the model and its distance to the full mesh here (.png)")
      ->check([](const std::string& text) { return extension_error(text, {".png"}); }, "FILE.png");
  sub.add_option("--name", o->name, "Name kept in the model; by default the mesh's file name without extension");
  sub.add_option("--threads", o->threads, "Threads to use; 0 takes all. The result does not depend on it")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
}

}  // namespace asperity::command
