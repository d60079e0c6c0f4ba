// Opens a context and says in one line what came of it: `ok RENDERER` or `failed CODE MESSAGE`.
// gl_probe [automatic|core|es] [EGL-LIBRARY]
#include <cstdio>
#include <string>

#include "asperity/gl/device.hpp"

int main(int argc, char** argv) {
  using namespace asperity;
  gl::context_settings options;
  const std::string dialect = argc > 1 ? argv[1] : "automatic";
  options.dialect = dialect == "core" ? gl::dialect::core : dialect == "es" ? gl::dialect::es : gl::dialect::automatic;
  if (argc > 2) options.egl_library = argv[2];
  const auto opened = gl::open_context(options);
  if (!opened) {
    std::printf("failed %s %s\n", to_string(opened.error().code), opened.error().message.c_str());
    // The list of devices has the same reason to give.
    const auto devices = gl::list_devices(options);
    if (devices && devices->empty()) return 3;
    if (devices && devices->front().problem.empty()) return 4;
    return 0;
  }
  const gl::context_facts& facts = (*opened)->facts();
  std::printf("ok %s %d.%d %s\n", facts.dialect == gl::dialect::core ? "core" : "es", facts.major, facts.minor,
              facts.renderer.c_str());
  return 0;
}
