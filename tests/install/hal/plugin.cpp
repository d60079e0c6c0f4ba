// A program of a consumer of asperity::plugin: it looks for drivers where the installation keeps them.
#include <cstdio>

#include <asperity/plugin/driver_search.hpp>

int main() {
  const auto found = asperity::plugin::load_drivers(asperity::plugin::search_path());
  for (const auto& driver : found.drivers) std::printf("%s\n", driver->module().where().c_str());
  const auto nothing = asperity::plugin::plugin_driver::load("nothing.so");
  if (nothing) return 1;
  std::printf("%s\n", nothing.error().message.c_str());
  return nothing.error().code == asperity::error_code::io_failed ? 0 : 1;
}
