// A program of a consumer of asperity::serial: it opens what is not there, and is told so.
#include <cstdio>

#include <asperity/serial/serial_port.hpp>

int main() {
  const auto line = asperity::serial::open_serial("/dev/no-such-line");
  if (line) return std::puts("a line that is not there was opened"), 1;
  return std::puts(line.error().message.c_str()) < 0 ? 1 : 0;
}
