#include "cli.hpp"

#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>
#include <string_view>

#include "interrupt.hpp"
#include "text.hpp"

namespace asperity::command {
namespace {

// False where stdout did not take everything, for example a full disk behind a redirection.
bool print(std::string_view text) {
  return std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
}

void complain(std::string_view message) {
  const std::string line = "asperity: " + printable(message) + '\n';
  std::fwrite(line.data(), 1, line.size(), stderr);
}

std::string serialise(const json& document) {
  // File names need not be UTF-8; JSON must be.
  return document.dump(2, ' ', false, json::error_handler_t::replace) + '\n';
}

int fail(std::string_view code, std::string_view message, bool as_json, int exit_status) {
  complain(message);
  if (as_json) {
    print(serialise({{"schema", "asperity.error/1"}, {"error", {{"code", code}, {"message", printable(message)}}}}));
  }
  return exit_status;
}

}  // namespace

command_line::command_line() : app_("Haptic rendering of contact between textured objects", "asperity") {
  app_.require_subcommand(1);
  app_.get_formatter()->column_width(32);
  add_common_switches(app_);
}

void command_line::add_common_switches(CLI::App& to) {
  to.set_version_flag("--version", "asperity " ASPERITY_VERSION, "Print the version and exit");
  to.add_flag("--json", common_.json, "Print one JSON document on stdout and nothing else there");
  to.add_flag("--quiet", common_.quiet, "Print no report and no progress");
}

CLI::App& command_line::add(const std::string& name, const std::string& purpose, action run) {
  CLI::App* sub = app_.add_subcommand(name, purpose);
  add_common_switches(*sub);
  sub->parse_complete_callback([this, name, run = std::move(run)] {
    chosen_ = name;
    action_ = run;
  });
  return *sub;
}

int command_line::run(int argc, const char* const* argv) {
  // Parsing may stop before it reaches --json, and the error has to be a document all the same.
  const bool json_wanted =
      std::any_of(argv, argv + argc, [](const char* word) { return std::string_view(word) == "--json"; });
  try {
    app_.parse(argc, argv);
  } catch (const CLI::Success& help_or_version) {
    return app_.exit(help_or_version) == 0 && std::fflush(stdout) == 0 ? exit_ok : exit_failed;
  } catch (const CLI::ParseError& e) {
    const auto chosen = app_.get_subcommands();
    // CLI11 would only say that a subcommand is missing, without the word that should have been one.
    const auto word =
        std::find_if(argv + std::min(1, argc), argv + argc, [](const char* a) { return *a != '-' && *a != '\0'; });
    if (chosen.empty() && word != argv + argc) {
      return fail("usage", "there is no subcommand '" + std::string(*word) + "'; see asperity --help", json_wanted,
                  exit_usage);
    }
    const std::string page = chosen.empty() ? "asperity --help" : "asperity " + chosen.front()->get_name() + " --help";
    return fail("usage", std::string(e.what()) + "; see " + page, json_wanted, exit_usage);
  }

  try {
    const result<answer> done = action_(common_);
    if (!done) {
      const bool cancelled = done.error().code == error_code::cancelled && interrupted();
      return fail(to_string(done.error().code), done.error().message, common_.json,
                  cancelled ? exit_interrupted : exit_failed);
    }
    std::string out;
    if (common_.json) {
      json document = {{"schema", "asperity." + chosen_ + "/1"}};
      document.update(done->document);
      out = serialise(document);
    } else if (!common_.quiet) {
      // Each part has escaped the names in it already; what one has forgotten can break a line and nothing else.
      out = printable(done->text, '\n');
    }
    if (!print(out)) {
      complain("stdout could not be written: free space or redirect it elsewhere");
      return exit_failed;
    }
    if (!done->complaint.empty()) complain(done->complaint);
    return done->exit_status;
  } catch (const std::bad_alloc&) {
    return fail("limit_exceeded", "out of memory: use smaller models or free memory", common_.json, exit_failed);
  }
}

}  // namespace asperity::command
