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

/// A folder of the build that a driver may be loaded from, fresh for `name`; removed by the next test of that name.
/// Not below the system's folder for temporary files, which everybody may write to.
inline std::filesystem::path driver_folder(const std::string& name) {
  const std::filesystem::path folder = std::filesystem::path(ASPERITY_TEST_FOLDER) / name;
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  std::filesystem::permissions(folder, std::filesystem::perms(0755));
  return folder;
}

}  // namespace asperity::test_support
