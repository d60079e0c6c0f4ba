// Runs load_probe on one file under limits.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace asperity::hostile {

/// What a probe did.
struct probe_outcome {
  int signal = 0;              ///< that ended it; 0 where it ended by itself
  std::size_t peak_bytes = 0;  ///< resident memory beyond what the process began with
  double cpu_s = 0.0;
  std::string said;  ///< "loaded" or the error
};

/// Limits of a probe: what hangs or grows is ended by the system.
struct probe_limits {
  std::size_t address_space_bytes = 0;  ///< 0: none. Not set under a sanitizer, which reserves terabytes
  unsigned cpu_s = 10;
  unsigned wall_s = 60;
};

/// @param how the first argument of load_probe
[[nodiscard]] probe_outcome run_probe(const char* how, const std::filesystem::path& file, const probe_limits& limits);

}  // namespace asperity::hostile
