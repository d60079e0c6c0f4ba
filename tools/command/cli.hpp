// What every subcommand shares: its place on the command line, its switches and the shape of its answer.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "asperity/core/status.hpp"

namespace asperity::command {

using json = nlohmann::ordered_json;  // a document's keys come out in the order in which its page describes them

/// Exit statuses of the command.
enum : int {
  exit_ok = 0,
  exit_failed = 1,  ///< one line on stderr says what and how to mend it
  exit_usage = 2,   ///< the command line itself is wrong
};

/// Exit status after a signal that asked to stop, by the shell's convention: 128 and its number, 130 for SIGINT.
[[nodiscard]] int exit_interrupted() noexcept;

/// One line on stderr.
void complain(std::string_view message);

/// Error line, and with --json the error document, for a process that ends at once: waits for half a
/// second at the most for somebody who reads.
void report_error(std::string_view code, std::string_view message, bool as_json);

/// Switches that every subcommand has.
struct common_options {
  bool json = false;   ///< one JSON document on stdout instead of text
  bool quiet = false;  ///< no text and no progress; errors and JSON still appear
};

/// What a subcommand found, for a program and for a person.
struct answer {
  json document;     ///< without "schema", which the frame puts in front
  std::string text;  ///< ends with a newline
  int exit_status = exit_ok;
  std::string complaint;  ///< the line for stderr where exit_status is not exit_ok
};

using action = std::function<result<answer>(const common_options&)>;

/// The whole command line: subcommands add themselves, main parses and runs the chosen one.
class command_line {
 public:
  command_line();

  /// Adds a subcommand with the common switches. `run` is called after parsing where this one was chosen.
  CLI::App& add(const std::string& name, const std::string& purpose, action run);

  /// Parses, runs and prints. @return the process's exit status
  int run(int argc, const char* const* argv);

 private:
  void add_common_switches(CLI::App& to);  // before and after the subcommand's name they mean the same

  CLI::App app_;
  common_options common_;
  std::string chosen_;
  action action_;
};

// One function per subcommand, each in its own file.
void add_bake(command_line& line);
void add_inspect(command_line& line);
void add_query(command_line& line);
void add_run(command_line& line);
void add_models(command_line& line);
void add_devices(command_line& line);
void add_experiment(command_line& line);
void add_bench(command_line& line);
void add_view(command_line& line);  // in builds that have the live page

}  // namespace asperity::command
