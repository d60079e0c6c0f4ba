// The drivers of the tests, and how one that is broken is chosen.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace asperity::test_support {

inline const std::filesystem::path sample_driver = ASPERITY_SAMPLE_DRIVER;
inline const std::filesystem::path broken_driver = ASPERITY_BROKEN_DRIVER;
inline const std::filesystem::path simulated_driver = ASPERITY_SIMULATED_DRIVER;

/// While it lives, broken_driver is broken in this way, here and in processes that are started.
class broken_way {
 public:
  explicit broken_way(const std::string& way) { ::setenv("ASPERITY_BROKEN", way.c_str(), 1); }
  broken_way(const broken_way&) = delete;
  broken_way& operator=(const broken_way&) = delete;
  ~broken_way() { ::unsetenv("ASPERITY_BROKEN"); }
};

}  // namespace asperity::test_support
