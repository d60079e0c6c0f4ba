// A program of a consumer of asperity::plugin: it looks for drivers where the installation keeps them.
#include <cstdio>

#include <asperity/plugin/child_driver.hpp>
#include <asperity/plugin/driver_search.hpp>
#include <asperity/plugin/plugin_driver.hpp>

int main() {
  for (const auto& file : asperity::plugin::find_driver_files(asperity::plugin::search_path())) {
    std::printf("%s\n", file.file.c_str());
  }
  const auto nothing = asperity::plugin::child_driver::load("nothing.so");
  if (nothing) return 1;
  std::printf("%s\n", nothing.error().message.c_str());
  const auto here = asperity::plugin::plugin_driver::load("nothing.so");
  if (here) return 1;
  return nothing.error().code == asperity::error_code::io_failed ? 0 : 1;
}
