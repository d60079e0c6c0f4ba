// A program of a consumer of asperity::can: it opens what is not there, and is told so.
#include <cstdio>

#include <asperity/can/socketcan.hpp>

int main() {
  const auto bus = asperity::can::open_socketcan("no-such-can");
  if (bus) return std::puts("an interface that is not there was opened"), 1;
  std::printf("%s\n", bus.error().message.c_str());
  return asperity::can::list_interfaces("/no-such-folder").empty() ? 0 : 1;
}
