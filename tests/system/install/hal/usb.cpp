// A program of a consumer of asperity::usb: it runs with and without USB, and says which of both it is.
#include <cstdio>

#include <asperity/usb/usb.hpp>

int main() {
  const auto devices = asperity::usb::list_usb();
  if (!devices) {
    std::printf("no USB: %s\n", devices.error().message.c_str());
    return devices.error().code == asperity::error_code::unsupported ? 0 : 1;
  }
  for (const auto& d : *devices) std::printf("%s %s\n", d.path.c_str(), d.name.c_str());
  return asperity::usb::open_usb({.path = "nowhere"}) ? 1 : 0;
}
