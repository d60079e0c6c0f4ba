// asperity-conformance DRIVER.so: tries a driver and prints a report that can be published.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>
#include <unistd.h>

#include "asperity/core/printable.hpp"
#include "asperity/version.hpp"
#include "document.hpp"
#include "kit.hpp"
#include "own_process.hpp"

namespace {

namespace kit = asperity::conformance;

void print(const kit::report& r, bool as_json) {
  // A driver's names and reasons are its vendor's text: none of it reaches the terminal's controls.
  const std::string text = as_json ? kit::to_json(r) : asperity::printable(kit::to_text(r), '\n');
  std::fwrite(text.data(), 1, text.size(), stdout);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Tries a device driver (driver_abi.h) and prints a report. Exit status: 0 it conforms, 1 it does not, 2 usage.",
      "asperity-conformance");
  kit::kit_options options;
  std::string device;
  bool as_json = false;
  int patience_s = 60;
  app.add_option("driver", options.driver, "The driver's shared object")->required();
  app.add_option("--device", device, "Identity of the device to try; the first listed otherwise");
  app.add_option("--date", options.date, "Date to print in the report, as you write it");
  app.add_option("--ticks", options.ticks, "Ticks of the session")
      ->capture_default_str()
      ->check(CLI::Range(200, 1'000'000));
  app.add_option("--patience", patience_s, "Seconds after which a call that did not return is given up")
      ->capture_default_str()
      ->check(CLI::Range(1, 3600));
  app.add_flag("--json", as_json, "Print one JSON document, schema asperity.conformance/1");
  app.add_flag("--hand-held", options.hand_held,
               "A person holds the device: up to the peak limits may be put out. Without it, a device that is not "
               "simulated is never given a command other than zero");
  app.set_version_flag("--version", std::string("asperity-conformance " ASPERITY_VERSION_STRING));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);
    std::fprintf(stderr, "%s\nRun with --help for more information.\n", asperity::printable(e.what()).c_str());
    return 2;
  }
  if (!device.empty()) options.device = device;

  const kit::process_end end = kit::in_own_process(
      [&](kit::progress& shared) {
        // What a driver prints goes to stderr: stdout is the report's.
        const int out = ::dup(STDOUT_FILENO);
        ::dup2(STDERR_FILENO, STDOUT_FILENO);
        const kit::report r = kit::examine(options, shared);
        std::fflush(stdout);
        ::dup2(out, STDOUT_FILENO);
        print(r, as_json);
        return r.found.failed() ? 1 : 0;
      },
      patience_s);
  if (end.broken.empty()) return end.exit_status;

  kit::report r{.file = options.driver.string(), .date = options.date, .hand_held = options.hand_held};
  r.found.begin("the whole");
  r.found.look("process.survives", false, [&] { return end.broken; });
  r.found.skip_rest("the process did not come to its end");
  print(r, as_json);
  return 1;
}
