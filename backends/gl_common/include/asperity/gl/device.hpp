// The devices that an OpenGL context can be opened on. Component asperity::gl.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "asperity/core/status.hpp"
#include "asperity/gl/context.hpp"

namespace asperity::gl {

struct device {
  std::size_t index = 0;  ///< what context_settings::device can name
  std::string name;       ///< the renderer's name, or EGL's where no context could be opened
  bool software = false;  ///< drawn by the processor
  std::string version;    ///< of the OpenGL that a context here speaks; empty where none could be opened
  std::string problem;    ///< why no context could be opened; empty where one could
};

/// Opens a context on every device in turn and closes it again: takes tens of milliseconds per device. Only `dialect`
/// and `egl_library` of the settings count.
/// @return unsupported where EGL cannot be loaded or knows no device, with what to do about it
[[nodiscard]] result<std::vector<device>> list_devices(const context_settings& settings = {});

}  // namespace asperity::gl
