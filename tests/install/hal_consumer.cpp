// A consumer of the transports: opens what is not there, and is told so.
#include <cstdio>

#include <asperity/can/socketcan.hpp>
#include <asperity/serial/serial_port.hpp>

int main() {
  const auto bus = asperity::can::open_socketcan("no-such-can");
  const auto line = asperity::serial::open_serial("/dev/no-such-line");
  if (bus || line) return 1;
  std::printf("%s\n%s\n", bus.error().message.c_str(), line.error().message.c_str());
  return asperity::can::list_interfaces("/no-such-folder").empty() ? 0 : 1;
}
