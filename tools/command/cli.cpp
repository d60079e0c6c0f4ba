#include "cli.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <exception>
#include <new>
#include <poll.h>
#include <string_view>
#include <unistd.h>

#include "asperity/version.hpp"
#include "interrupt.hpp"
#include "text.hpp"

namespace asperity::command {
namespace {

// Writes everything, however often signals come. @return false where the stream takes no more
bool write_all(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t n = ::write(descriptor, text.data(), text.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return false;
    text.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

// Not to wait for a stream that nobody reads, or a terminal that is held.
bool has_room(int descriptor) {
  constexpr int patience_ms = 500;
  pollfd room{.fd = descriptor, .events = POLLOUT, .revents = 0};
  return poll(&room, 1, patience_ms) > 0 && (room.revents & POLLOUT) != 0;
}

std::string serialise(const json& document) {
  // File names need not be UTF-8; JSON must be.
  return document.dump(2, ' ', false, json::error_handler_t::replace) + '\n';
}

std::string error_document(std::string_view code, std::string_view message) {
  return serialise({{"schema", "asperity.error/1"}, {"error", {{"code", code}, {"message", printable(message)}}}});
}

int fail(std::string_view code, std::string_view message, bool as_json, int exit_status) {
  complain(message);
  if (as_json) write_all(STDOUT_FILENO, error_document(code, message));
  return exit_status;
}

const char* why_stdout_failed() {
  return errno == EPIPE ? "stdout could not be written: nobody reads it any more"
                        : "stdout could not be written: free space or redirect it elsewhere";
}

}  // namespace

int exit_interrupted() noexcept { return 128 + stop_signal(); }

void complain(std::string_view message) { write_all(STDERR_FILENO, "asperity: " + printable(message) + '\n'); }

void report_error(std::string_view code, std::string_view message, bool as_json) {
  if (has_room(STDERR_FILENO)) complain(message);
  if (as_json && has_room(STDOUT_FILENO)) write_all(STDOUT_FILENO, error_document(code, message));
}

command_line::command_line() : app_("Haptic rendering of contact between textured objects", "asperity") {
  app_.require_subcommand(1);
  app_.get_formatter()->column_width(32);
  add_common_switches(app_);
}

void command_line::add_common_switches(CLI::App& to) {
  to.set_version_flag("--version", "asperity " ASPERITY_VERSION_STRING, "Print the version and exit");
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
      // What was cancelled deep inside does not know by whom.
      const bool says_so = done.error().message.starts_with("interrupted");
      return fail(to_string(done.error().code), (cancelled && !says_so ? "interrupted: " : "") + done.error().message,
                  common_.json, cancelled ? exit_interrupted() : exit_failed);
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
    if (!write_all(STDOUT_FILENO, out)) {
      complain(why_stdout_failed());
      return exit_failed;
    }
    if (!done->complaint.empty()) complain(done->complaint);
    return done->exit_status;
  } catch (const std::bad_alloc&) {
    return fail("limit_exceeded", "out of memory: use smaller models or free memory", common_.json, exit_failed);
  } catch (const std::exception& e) {
    // Caught so that everything on the way is destroyed: a device is disarmed by the end of its session.
    return fail("internal", std::string("a fault in asperity, please report it: ") + e.what(), common_.json,
                exit_failed);
  }
}

}  // namespace asperity::command
