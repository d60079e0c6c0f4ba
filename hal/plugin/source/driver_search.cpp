#include "asperity/plugin/driver_search.hpp"

#include <algorithm>
#include <cstdlib>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

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

found_drivers load_drivers(std::span<const std::filesystem::path> folders, const log_sink& log) {
  found_drivers out;
  for (const std::filesystem::path& folder : folders) {
    std::vector<std::filesystem::path> files;
    std::error_code failed;
    for (std::filesystem::directory_iterator it(folder, failed), end; !failed && it != end; it.increment(failed)) {
      if (it->path().extension() == ".so") files.push_back(it->path());
    }
    std::sort(files.begin(), files.end());
    for (const std::filesystem::path& file : files) {
      result<std::unique_ptr<plugin_driver>> driver = plugin_driver::load(file, log);
      if (!driver) {
        out.refused.push_back({file, driver.error()});
        continue;
      }
      const auto same = std::find_if(out.drivers.begin(), out.drivers.end(),
                                     [&](const auto& other) { return other->name() == (*driver)->name(); });
      if (same != out.drivers.end()) {
        out.refused.push_back(
            {file,
             {error_code::invalid_argument, file.string() + ": a driver named " + std::string((*driver)->name()) +
                                                " was already loaded from " + (*same)->module().where()}});
        continue;
      }
      out.drivers.push_back(std::move(driver).value());
    }
  }
  return out;
}

}  // namespace asperity::plugin
