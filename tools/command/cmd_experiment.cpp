// asperity experiment: the paper's experiments, each with figures and verdicts.
#include <algorithm>
#include <filesystem>
#include <optional>
#include <system_error>
#include <vector>

#include "cli.hpp"
#include "experiment.hpp"
#include "interrupt.hpp"
#include "output_file.hpp"
#include "progress.hpp"
#include "publish.hpp"
#include "text.hpp"

namespace asperity::command {
namespace {

namespace fs = std::filesystem;
using experiment::all_experiments;

struct experiment_command {
  std::string name;
  std::string folder;
  std::string models;
  bool brief = false;
  bool no_gpu = false;
};

result<void> prepare(const fs::path& folder) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) {
    return error{error_code::io_failed, "cannot make the folder " + folder.string() + ": " + failed.message() +
                                            "; give a folder, or a name in an existing, writable one"};
  }
  return check_writable(folder / "index.html");
}

// What a person wants to know first: does it hold, and if not, where.
void tell(const experiment::published& one, answer& out) {
  std::size_t held = 0;
  for (const experiment::statement& s : one.found.statements) held += s.holds() ? 1U : 0U;
  out.text += std::string(one.what->name) + ": " + one.what->title + ", " + std::to_string(held) + " of " +
              std::to_string(one.found.statements.size()) + " statements hold\n";
  json statements = json::array();
  for (const experiment::statement& s : one.found.statements) {
    out.text +=
        row(s.name, brief(s.value) + " (" + bound_text(s) + ")" + (s.holds() ? "" : "  FAILS") + "  " + s.claim);
    statements.push_back({{"name", s.name}, {"value", s.value}, {"pass", s.holds()}});
  }
  for (const std::string& note : one.found.notes) out.text += "  note: " + note + "\n";
  out.document["experiments"].push_back({{"name", one.what->name},
                                         {"pass", held == one.found.statements.size()},
                                         {"statements", std::move(statements)},
                                         {"notes", one.found.notes}});
}

result<answer> run_experiments(const experiment_command& options, const common_options& common) {
  const fs::path out_folder(options.folder);
  const fs::path models_folder = options.models.empty() ? out_folder / "models" : fs::path(options.models);
  if (const result<void> ready = prepare(out_folder); !ready) return ready.error();
  if (const result<void> ready = prepare(models_folder); !ready) return ready.error();

  progress_line progress(common.quiet);
  experiment::workbench bench({.models = models_folder,
                               .brief = options.brief,
                               .gpu = !options.no_gpu,
                               .make_renderer = {},
                               .progress = [&](std::string_view what, double done) { progress.show(what, done); },
                               .cancelled = [] { return interrupted(); }});
  answer out;
  out.document = {{"output", options.folder}, {"brief", options.brief}, {"experiments", json::array()}};
  std::vector<experiment::published> done;
  bool all_hold = true;
  for (const experiment::experiment& e : all_experiments()) {
    if (options.name != "all" && options.name != e.name) continue;
    result<experiment::findings> found = e.run(bench);
    if (!found) return found.error();
    done.push_back({&e, std::move(found).value()});
    if (const result<void> written = write_findings(done.back(), out_folder); !written) return written.error();
    tell(done.back(), out);
    for (const experiment::statement& s : done.back().found.statements) all_hold = all_hold && s.holds();
  }
  if (options.name == "all") {
    if (const result<void> written = write_page(done, out_folder); !written) return written.error();
    out.text += row("page", (out_folder / "index.html").string());
  }
  if (!all_hold) {
    out.exit_status = exit_failed;
    out.complaint = "a statement does not hold: see the lines that end in FAILS, or verdict.json";
  }
  return out;
}

}  // namespace

void add_experiment(command_line& line) {
  const auto o = std::make_shared<experiment_command>();
  CLI::App& sub = line.add("experiment", "Repeat the paper's experiments: tables, pictures and a verdict",
                           [o](const common_options& common) { return run_experiments(*o, common); });
  std::vector<std::string> names{"all"};
  for (const experiment::experiment& e : all_experiments()) names.emplace_back(e.name);
  sub.add_option("experiment", o->name, "Which one, or all")->required()->check(CLI::IsMember(names));
  sub.add_option("-o,--output", o->folder, "Folder to write into; made where it does not exist")->required();
  sub.add_option("--models", o->models,
                 "Folder of baked models; what is missing there is baked and kept. By default a folder of the output");
  sub.add_flag("--brief", o->brief, "A share of each, for tests: fewer renderers and shorter motions");
  sub.add_flag("--no-gpu", o->no_gpu, "Leave out the depth backends on a GPU");
}

}  // namespace asperity::command
