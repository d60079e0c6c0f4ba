// asperity inspect: what is in a textured model.
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "asperity/io/mesh_file.hpp"
#include "asperity/io/textured_model_file.hpp"
#include "cli.hpp"
#include "file_names.hpp"
#include "interrupt.hpp"
#include "mesh_placing.hpp"
#include "mesh_units.hpp"
#include "model_drawing.hpp"
#include "model_report.hpp"
#include "options.hpp"
#include "output_file.hpp"
#include "progress.hpp"
#include "text.hpp"

namespace asperity::command {
namespace {

namespace fs = std::filesystem;

struct inspect_command {
  std::string file;
  std::string picture;
  std::string original;
  std::string original_up = "z";
  std::shared_ptr<mesh_units> units = std::make_shared<mesh_units>();
  std::string up = "auto";
  double turn_deg = 0.0;
};

result<output_file> open_picture(const inspect_command& options) {
  std::vector<named_file> inputs = mesh_files(options.original, "--original");
  inputs.push_back({"inspect", options.file});
  const named_file picture{"--picture", options.picture};
  if (const result<void> ok = check_outputs(inputs, {&picture, 1}); !ok) return ok.error();
  return output_file::create(options.picture);
}

result<json> draw(const inspect_command& options, const common_options& common, const textured_model& model,
                  output_file& to) {
  progress_line progress(common.quiet);
  picture::picture_options settings;
  settings.up = options.up == "x"   ? picture::up_axis::x
                : options.up == "y" ? picture::up_axis::y
                : options.up == "z" ? picture::up_axis::z
                                    : picture::up_axis::automatic;
  settings.turn_deg = options.turn_deg;
  settings.progress = [&](std::string_view stage, double done) {
    progress.show(stage, done);
    return !interrupted();
  };
  std::optional<triangle_mesh> original;
  if (!options.original.empty()) {
    result<triangle_mesh> loaded = io::load_mesh(options.original, not_interrupted);
    if (!loaded) return loaded.error();
    original = std::move(*loaded);
    if (const result<void> ok = bring_to_metres(*options.units, options.original, *original); !ok) return ok.error();
    turn_up(options.original_up, *original);
    settings.original = &*original;
    settings.original_name = fs::path(options.original).filename().string();
  }
  return write_picture(model, settings, to);
}

result<answer> inspect(const inspect_command& options, const common_options& common) {
  std::optional<output_file> drawing;
  if (!options.picture.empty()) {
    result<output_file> opened = open_picture(options);
    if (!opened) return opened.error();
    drawing.emplace(std::move(*opened));
  }
  const result<textured_model> model = io::load_textured_model(options.file, not_interrupted);
  if (!model) return model.error();
  const std::vector<std::string> notes = warnings(*model);

  answer out;
  out.document = {{"file", options.file}};
  out.document.update(describe(*model));
  out.document["warnings"] = notes;
  out.text = printable(options.file) + '\n' + describe_text(*model) + warnings_text(notes);
  if (drawing) {
    const result<json> shown = draw(options, common, *model, *drawing);
    if (!shown) return shown.error();
    if (const result<void> kept = drawing->commit(); !kept) return kept.error();
    out.document["picture"] = {{"file", options.picture}};
    out.document["picture"].update(*shown);
    out.text += row("picture", options.picture);
  }
  out.document["units"] = "SI";
  return out;
}

}  // namespace

void add_inspect(command_line& line) {
  const auto o = std::make_shared<inspect_command>();
  CLI::App& sub = line.add("inspect", "Show what is in a textured model",
                           [o](const common_options& common) { return inspect(*o, common); });
  sub.add_option("model", o->file, "Textured model (.glb)")->required();
  auto* drawn =
      sub.add_option("--picture", o->picture, "Draw coarse mesh, textured surface, error and texture here (.png)")
          ->check([](const std::string& text) { return extension_error(text, {".png"}); }, "FILE.png");
  auto* original =
      sub.add_option("--original", o->original, "With --picture: show the distance to this mesh")->needs(drawn);
  const unit_option_pair unit = add_unit_options(sub, o->units, "the original");
  unit.units->needs(original);
  unit.scale->needs(original);
  add_original_up(sub, o->original_up, original);
  sub.add_option("--up", o->up,
                 "With --picture: axis of the body that points up, x, y or z; auto takes z, and lays down what is tall")
      ->check(CLI::IsMember({"auto", "x", "y", "z"}))
      ->needs(drawn)
      ->capture_default_str();
  sub.add_option("--turn", o->turn_deg, "With --picture: turn the model about that axis, degrees")
      ->check(CLI::Range(-360.0, 360.0))
      ->needs(drawn)
      ->capture_default_str();
}

}  // namespace asperity::command
