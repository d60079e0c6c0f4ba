#include "egl_library.hpp"

#include <algorithm>
#include <cstring>
#include <dlfcn.h>
#include <map>
#include <mutex>

namespace asperity::gl {
namespace {

bool lists(const char* extensions, const char* name) {
  if (extensions == nullptr) return false;
  const std::size_t length = std::strlen(name);
  for (const char* at = std::strstr(extensions, name); at != nullptr; at = std::strstr(at + length, name)) {
    const bool starts = at == extensions || at[-1] == ' ';
    if (starts && (at[length] == ' ' || at[length] == '\0')) return true;
  }
  return false;
}

constexpr const char* install =
    "install the driver of the graphics card, or for one in software Mesa (Debian: libegl1, libegl-mesa0, "
    "libgl1-mesa-dri)";

result<egl_library> load_now(const std::string& name) {
  void* const library = dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    const char* const why = dlerror();
    return error{error_code::unsupported,
                 "OpenGL: loading EGL failed: " + std::string(why != nullptr ? why : name) + "; " + install};
  }
  egl_library egl;
  std::string missing;
  const auto find = [&](auto& to, const char* entry) {
    to = reinterpret_cast<std::remove_reference_t<decltype(to)>>(dlsym(library, entry));
    if (to == nullptr) missing = entry;
  };
  find(egl.GetProcAddress, "eglGetProcAddress");
  find(egl.QueryString, "eglQueryString");
  find(egl.Initialize, "eglInitialize");
  find(egl.BindAPI, "eglBindAPI");
  find(egl.QueryAPI, "eglQueryAPI");
  find(egl.ChooseConfig, "eglChooseConfig");
  find(egl.CreateContext, "eglCreateContext");
  find(egl.DestroyContext, "eglDestroyContext");
  find(egl.MakeCurrent, "eglMakeCurrent");
  find(egl.GetCurrentContext, "eglGetCurrentContext");
  find(egl.GetCurrentDisplay, "eglGetCurrentDisplay");
  find(egl.GetCurrentSurface, "eglGetCurrentSurface");
  find(egl.GetError, "eglGetError");
  if (!missing.empty()) {
    dlclose(library);
    return error{error_code::unsupported, "OpenGL: loading EGL failed: " + name + " has no " + missing +
                                              ", so it is not an EGL library; " + install};
  }
  const char* const extensions = egl.QueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  const auto extension = [&](auto& to, bool there, const char* entry) {
    if (there) to = reinterpret_cast<std::remove_reference_t<decltype(to)>>(egl.GetProcAddress(entry));
  };
  extension(egl.GetPlatformDisplay, lists(extensions, "EGL_EXT_platform_base"), "eglGetPlatformDisplayEXT");
  const bool devices = lists(extensions, "EGL_EXT_device_base") ||
                       (lists(extensions, "EGL_EXT_device_enumeration") && lists(extensions, "EGL_EXT_device_query"));
  extension(egl.QueryDevices, devices && lists(extensions, "EGL_EXT_platform_device"), "eglQueryDevicesEXT");
  extension(egl.QueryDeviceString, devices, "eglQueryDeviceStringEXT");
  return egl;
}

std::vector<display_source> device_sources(const egl_library& egl) {
  std::vector<display_source> out;
  EGLint count = 0;
  if (egl.QueryDevices == nullptr || egl.QueryDevices(0, nullptr, &count) != EGL_TRUE || count <= 0) return out;
  std::vector<EGLDeviceEXT> devices(static_cast<std::size_t>(count));
  if (egl.QueryDevices(count, devices.data(), &count) != EGL_TRUE) return out;
  devices.resize(static_cast<std::size_t>(count));
  for (const EGLDeviceEXT device : devices) {
    display_source source{EGL_PLATFORM_DEVICE_EXT, device, "EGL device " + std::to_string(out.size()), false};
    if (egl.QueryDeviceString != nullptr) {
      const char* const extensions = egl.QueryDeviceString(device, EGL_EXTENSIONS);
      source.software = lists(extensions, "EGL_MESA_device_software");
      if (lists(extensions, "EGL_EXT_device_drm")) {
        const char* const file = egl.QueryDeviceString(device, EGL_DRM_DEVICE_FILE_EXT);
        if (file != nullptr) source.name = file;
      }
    }
    if (source.software) source.name = "software device";
    out.push_back(source);
  }
  std::stable_partition(out.begin(), out.end(), [](const display_source& s) { return !s.software; });
  return out;
}

}  // namespace

result<const egl_library*> egl_library::load(const std::string& name) {
  // Never destroyed: a context may be closed after the destructors of static objects have run.
  static auto& mutex = *new std::mutex;
  static auto& loaded = *new std::map<std::string, egl_library>;
  const std::lock_guard lock(mutex);
  if (const auto found = loaded.find(name); found != loaded.end()) return &found->second;
  const result<egl_library> egl = load_now(name);
  if (!egl) return egl.error();
  return &loaded.emplace(name, *egl).first->second;
}

result<std::vector<display_source>> find_sources(const egl_library& egl) {
  std::vector<display_source> sources = device_sources(egl);
  static_cast<void>(egl.GetError());
  if (sources.empty() && egl.GetPlatformDisplay != nullptr) {
    const char* const extensions = egl.QueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    if (lists(extensions, "EGL_MESA_platform_surfaceless")) {
      sources.push_back({EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, "Mesa's default device", false});
    }
  }
  if (sources.empty()) {
    return error{error_code::unsupported,
                 std::string("OpenGL: finding a vendor failed: EGL is there, but no driver is registered with it that "
                             "works without a window system; ") +
                     install};
  }
  return sources;
}

result<EGLDisplay> open_display(const egl_library& egl, const display_source& source) {
  const auto failed = [&](const char* call) {
    return error{error_code::unsupported, "OpenGL: starting the driver of " + source.name + " failed: " + call +
                                              " said " + last_error(egl) + "; " + install};
  };
  const EGLDisplay display = egl.GetPlatformDisplay(source.platform, source.native, nullptr);
  if (display == EGL_NO_DISPLAY) return failed("eglGetPlatformDisplay");
  EGLint major = 0, minor = 0;
  if (egl.Initialize(display, &major, &minor) != EGL_TRUE) return failed("eglInitialize");
  return display;
}

std::string last_error(const egl_library& egl) {
  const EGLint e = egl.GetError();
  switch (e) {
    case EGL_SUCCESS:
      return "nothing";
    case EGL_NOT_INITIALIZED:
      return "EGL_NOT_INITIALIZED";
    case EGL_BAD_ACCESS:
      return "EGL_BAD_ACCESS";
    case EGL_BAD_ALLOC:
      return "EGL_BAD_ALLOC";
    case EGL_BAD_ATTRIBUTE:
      return "EGL_BAD_ATTRIBUTE";
    case EGL_BAD_CONFIG:
      return "EGL_BAD_CONFIG";
    case EGL_BAD_CONTEXT:
      return "EGL_BAD_CONTEXT";
    case EGL_BAD_DISPLAY:
      return "EGL_BAD_DISPLAY";
    case EGL_BAD_MATCH:
      return "EGL_BAD_MATCH";
    case EGL_BAD_PARAMETER:
      return "EGL_BAD_PARAMETER";
    case EGL_CONTEXT_LOST:
      return "EGL_CONTEXT_LOST";
    default:
      return "error " + std::to_string(e);
  }
}

}  // namespace asperity::gl
