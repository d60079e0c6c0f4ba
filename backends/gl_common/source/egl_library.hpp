// EGL, loaded at run time: the library, its devices, and the displays that contexts are opened on.
#pragma once

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <string>
#include <vector>

#include "asperity/core/status.hpp"

namespace asperity::gl {

/// EGL's entry points. Loaded once per library name and kept for the life of the process: drivers leave handlers behind
/// that run when a thread or the process ends.
struct egl_library {
  PFNEGLGETPROCADDRESSPROC GetProcAddress = nullptr;
  PFNEGLQUERYSTRINGPROC QueryString = nullptr;
  PFNEGLINITIALIZEPROC Initialize = nullptr;
  PFNEGLBINDAPIPROC BindAPI = nullptr;
  PFNEGLQUERYAPIPROC QueryAPI = nullptr;
  PFNEGLCHOOSECONFIGPROC ChooseConfig = nullptr;
  PFNEGLCREATECONTEXTPROC CreateContext = nullptr;
  PFNEGLDESTROYCONTEXTPROC DestroyContext = nullptr;
  PFNEGLMAKECURRENTPROC MakeCurrent = nullptr;
  PFNEGLGETCURRENTCONTEXTPROC GetCurrentContext = nullptr;
  PFNEGLGETCURRENTDISPLAYPROC GetCurrentDisplay = nullptr;
  PFNEGLGETCURRENTSURFACEPROC GetCurrentSurface = nullptr;
  PFNEGLGETERRORPROC GetError = nullptr;
  // Null where this EGL has no such extension.
  PFNEGLGETPLATFORMDISPLAYEXTPROC GetPlatformDisplay = nullptr;
  PFNEGLQUERYDEVICESEXTPROC QueryDevices = nullptr;
  PFNEGLQUERYDEVICESTRINGEXTPROC QueryDeviceString = nullptr;

  /// @return unsupported where it cannot be loaded
  [[nodiscard]] static result<const egl_library*> load(const std::string& name);
};

/// Something that a display can be made of: a device, or Mesa's choice of one.
struct display_source {
  EGLenum platform = 0;
  void* native = nullptr;
  std::string name;
  bool software = false;
};

/// Real devices first, then software, and Mesa's platform without a window system where there is no list of devices.
/// @return unsupported where no vendor's driver is registered
[[nodiscard]] result<std::vector<display_source>> find_sources(const egl_library& egl);

/// An initialised display. It is never terminated: that would take it from everyone else in the process.
/// @return unsupported where the driver behind it does not start
[[nodiscard]] result<EGLDisplay> open_display(const egl_library& egl, const display_source& source);

/// EGL's last error in words. Reads it away.
[[nodiscard]] std::string last_error(const egl_library& egl);

}  // namespace asperity::gl
