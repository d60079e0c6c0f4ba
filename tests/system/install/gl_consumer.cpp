// A program of a consumer of asperity::gl_compute: it runs with and without OpenGL, and says which of both it is.
#include <cstdio>

#include <asperity/gl/compute_depth.hpp>
#include <asperity/gl/device.hpp>

int main() {
  const auto nothing = asperity::gl::compute_depth::make(nullptr, {});
  if (nothing || nothing.error().code != asperity::error_code::invalid_argument) return 1;
  const auto devices = asperity::gl::list_devices();
  if (!devices) {
    std::printf("no OpenGL: %s\n", devices.error().message.c_str());
    return devices.error().code == asperity::error_code::unsupported ? 0 : 1;
  }
  for (const auto& d : *devices) std::printf("%zu %s %s\n", d.index, d.name.c_str(), d.problem.c_str());
  return devices->empty() ? 1 : 0;
}
