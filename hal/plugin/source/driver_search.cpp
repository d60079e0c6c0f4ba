#include "asperity/plugin/driver_search.hpp"

#include <algorithm>
#include <cstdlib>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "asperity/plugin/driver_file.hpp"

namespace asperity::plugin {

std::vector<std::filesystem::path> search_path() {
  std::vector<std::filesystem::path> folders;
  if (const char* variable = ::secure_getenv("ASPERITY_DRIVER_PATH")) {
    std::string_view rest(variable);
    while (!rest.empty()) {
      const std::size_t colon = std::min(rest.find(':'), rest.size());
      // A relative folder would load whatever lies where the program happens to be started.
      if (const std::filesystem::path folder(rest.substr(0, colon)); folder.is_absolute()) folders.push_back(folder);
      rest.remove_prefix(std::min(colon + 1, rest.size()));
    }
  }
  folders.emplace_back(ASPERITY_DRIVER_FOLDER);
  return folders;
}

std::vector<found_file> find_driver_files(std::span<const std::filesystem::path> folders) {
  std::vector<found_file> out;
  for (const std::filesystem::path& folder : folders) {
    std::vector<std::filesystem::path> files;
    std::error_code failed;
    for (std::filesystem::directory_iterator it(folder, failed), end; !failed && it != end; it.increment(failed)) {
      if (it->path().extension() == ".so") files.push_back(it->path());
    }
    std::sort(files.begin(), files.end());
    for (const std::filesystem::path& file : files) {
      found_file found{.name = file.stem().string(), .file = file};
      const auto same =
          std::find_if(out.begin(), out.end(), [&](const found_file& other) { return other.name == found.name; });
      if (same != out.end()) {
        found.refused = error{error_code::invalid_argument, file.string() + ": a driver named " + found.name +
                                                                " was already found: " + same->file.string()};
      } else if (const result<driver_file> opened = driver_file::open(file); !opened) {
        found.refused = opened.error();
      }
      out.push_back(std::move(found));
    }
  }
  return out;
}

}  // namespace asperity::plugin
