// A program of a consumer of asperity::hid: it lists what is plugged in, which may be nothing.
#include <cstdio>

#include <asperity/hid/hid.hpp>

int main() {
  const auto devices = asperity::hid::system_finder().list();
  if (!devices) return std::puts(devices.error().message.c_str()), 1;
  for (const auto& d : *devices) std::printf("%s at %s\n", d.product.c_str(), d.path.c_str());
  const auto nothing = asperity::hid::open_hid("/dev/null");
  if (nothing) return std::puts("/dev/null was taken for a HID device"), 1;
  std::printf("%zu devices; %s\n", devices->size(), nothing.error().message.c_str());
  return nothing.error().code == asperity::error_code::unsupported ? 0 : 1;
}
