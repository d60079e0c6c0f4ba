// One bug, one trial: planted in a copy of the sources, built, and looked for by the tests.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "asperity/core/status.hpp"
#include "workshop/mutation/catalogue.hpp"

namespace asperity::mutation {

/// Where bugs are planted: a copy of the sources that nothing else uses, and how its tests are built and run.
/// In both commands {source}, {build} and {test} stand for folders and for a test's name.
struct workshop {
  std::filesystem::path source;
  std::filesystem::path build;
  std::string build_command;
  std::string run_command;                ///< fails where the test fails
  int build_limit_s = 1200;               ///< a build that takes longer is ended
  int run_limit_s = 120;                  ///< a test that runs longer is ended: it hangs
  std::map<std::string, int> run_limits;  ///< of single tests
};

enum class verdict {
  caught,
  survived,
  not_built,  ///< the compiler refused it: nothing is known of the tests
};

[[nodiscard]] const char* to_string(verdict v);

struct outcome {
  verdict answer = verdict::survived;
  std::string test;    ///< that caught it, or for which it was not built
  std::string how;     ///< the first case that failed, or "time-out", or how the program ended
  double seconds = 0;  ///< of building and running
};

/// Plants, builds and runs test after test until one fails; the file is whole again afterwards.
/// @return an error where the bug cannot be planted or a test cannot be run
[[nodiscard]] result<outcome> try_bug(const workshop& where, const bug& what);

/// Builds and runs a test without any bug. @return its seconds, or an error where it fails
[[nodiscard]] result<double> try_sound(const workshop& where, const std::string& test);

[[nodiscard]] result<std::string> read_text(const std::filesystem::path& path);
[[nodiscard]] result<void> write_text(const std::filesystem::path& path, const std::string& text);

}  // namespace asperity::mutation
