// asperity experiment: the paper's experiments, each with figures and verdicts.
#include <algorithm>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "asperity/version.hpp"
#include "cli.hpp"
#include "experiment.hpp"
#include "file_names.hpp"
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
  std::vector<std::string> names;
  std::string folder;
  std::string models;
  bool brief = false;
  bool no_gpu = false;
};

std::string full_name(const experiment::published& one, const experiment::statement& s) {
  return std::string(one.what->name) + '/' + s.name;
}

// What a person wants to know first: does it hold, and if not, where.
void report(const experiment::published& one, answer& out, std::vector<std::string>& failed) {
  std::size_t held = 0;
  for (const experiment::statement& s : one.found.statements) held += s.holds() ? 1U : 0U;
  out.text += std::string(one.what->name) + ": " + one.what->title + ", " + std::to_string(held) + " of " +
              std::to_string(one.found.statements.size()) + " statements hold\n";
  for (const experiment::statement& s : one.found.statements) {
    out.text +=
        row(s.name, brief(s.value) + " (" + bound_text(s) + ")" + (s.holds() ? "" : "  FAILS") + "  " + s.claim);
    if (!s.holds()) failed.push_back(full_name(one, s));
  }
  for (const std::string& note : one.found.notes) out.text += "  note: " + printable(note) + "\n";
  out.document["experiments"].push_back(to_json(one));
}

std::string complaint_of(const std::vector<std::string>& failed) {
  constexpr std::size_t named = 3;
  std::string out =
      failed.size() == 1 ? "a statement does not hold: " : std::to_string(failed.size()) + " statements do not hold: ";
  for (std::size_t i = 0; i < std::min(named, failed.size()); ++i) out += (i == 0 ? "" : ", ") + failed[i];
  if (failed.size() > named) out += " and " + std::to_string(failed.size() - named) + " more";
  return out + "; see the lines that end in FAILS, or verdict.json";
}

// Those that were asked for, each once, in their own order.
std::vector<const experiment::experiment*> chosen(const std::vector<std::string>& names) {
  const auto is_named = [&](std::string_view name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  std::vector<const experiment::experiment*> out;
  for (const experiment::experiment& e : all_experiments()) {
    if (is_named("all") || is_named(e.name)) out.push_back(&e);
  }
  return out;
}

std::string missing(std::span<const experiment::experiment* const> not_done, const error& why) {
  std::string names;
  for (const experiment::experiment* e : not_done) names += (names.empty() ? "" : ", ") + std::string(e->name);
  return "Missing: " + names + ". The run ended before: " + why.message + ".";
}

// The page may be a link, and a model is hours of work.
result<void> check_page(const fs::path& page, const fs::path& models) {
  std::error_code ended;
  std::vector<named_file> inputs;
  for (fs::directory_iterator it(models, ended), end; !ended && it != end; it.increment(ended)) {
    inputs.push_back({"--models", it->path()});
  }
  const named_file output{"-o", page};
  return check_outputs(inputs, {&output, 1});
}

result<answer> run_experiments(const experiment_command& options, const common_options& common) {
  const fs::path out_folder(options.folder);
  const fs::path models_folder = options.models.empty() ? out_folder / "models" : fs::path(options.models);
  for (const fs::path& folder : {out_folder, models_folder}) {
    if (const result<void> made = make_folder(folder); !made) return made.error();
  }
  if (const result<void> apart = check_page(out_folder / "index.html", models_folder); !apart) return apart.error();
  if (const result<void> ready = check_writable(out_folder / "index.html"); !ready) return ready.error();

  progress_line progress(common.quiet);
  experiment::workbench bench({.models = models_folder,
                               .brief = options.brief,
                               .gpu = !options.no_gpu,
                               .variants = {},
                               .make_renderer = {},
                               .progress = [&](std::string_view what, double done) { progress.show(what, done); },
                               .cancelled = [] { return interrupted(); }});
  experiment::page_facts facts{ASPERITY_VERSION_STRING, experiment::machine_text(), options.brief, {}};
  const std::vector<const experiment::experiment*> wanted = chosen(options.names);
  const bool with_page = wanted.size() > 1;
  answer out;
  out.document = {{"output", options.folder},
                  {"page", with_page ? json((out_folder / "index.html").string()) : json()},
                  {"brief", options.brief},
                  {"machine", facts.machine},
                  {"experiments", json::array()}};
  std::vector<experiment::published> done;
  std::vector<std::string> failed;
  std::optional<error> ended;
  for (const experiment::experiment* e : wanted) {
    result<experiment::findings> found = e->run(bench);
    if (!found) {
      ended = found.error();
      break;
    }
    done.push_back({e, std::move(found).value()});
    if (const result<void> written = write_findings(done.back(), out_folder); !written) {
      done.pop_back();
      ended = written.error();
      break;
    }
    report(done.back(), out, failed);
  }
  // The page shows what is there: an older one would belong to other files.
  if (ended) facts.missing = missing(std::span(wanted).subspan(done.size()), *ended);
  if (with_page) {
    const result<void> written = write_page(done, facts, out_folder);
    if (!written && !ended) return written.error();
    out.text += row("page", (out_folder / "index.html").string());
  }
  if (ended) return *ended;
  if (!failed.empty()) {
    out.exit_status = exit_failed;
    out.complaint = complaint_of(failed);
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
  sub.add_option("experiment", o->names, "Which ones, or all")->required()->check(CLI::IsMember(names));
  sub.add_option("-o,--output", o->folder, "Folder to write into; made where it does not exist")->required();
  sub.add_option("--models", o->models,
                 "Folder of baked models; what is missing there is baked and kept. By default a folder of the output");
  sub.add_flag("--brief", o->brief, "A share of each, for tests: fewer renderers and shorter motions");
  sub.add_flag("--no-gpu", o->no_gpu, "Leave out the depth backends on a GPU");
}

}  // namespace asperity::command
