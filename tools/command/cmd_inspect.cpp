// asperity inspect: what is in a textured model.
#include "asperity/io/textured_model_file.hpp"
#include "cli.hpp"
#include "model_report.hpp"

namespace asperity::command {
namespace {

result<answer> inspect(const std::string& file) {
  const result<textured_model> model = io::load_textured_model(file);
  if (!model) return model.error();
  const std::vector<std::string> notes = warnings(*model);

  answer out;
  out.document = {{"file", file}};
  out.document.update(describe(*model));
  out.document["warnings"] = notes;
  out.document["units"] = "SI";
  out.text = file + '\n' + describe_text(*model) + warnings_text(notes);
  return out;
}

}  // namespace

void add_inspect(command_line& line) {
  const auto file = std::make_shared<std::string>();
  CLI::App& sub =
      line.add("inspect", "Show what is in a textured model", [file](const common_options&) { return inspect(*file); });
  sub.add_option("model", *file, "Textured model (.glb)")->required();
}

}  // namespace asperity::command
