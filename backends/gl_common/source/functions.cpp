#include "asperity/gl/functions.hpp"

#include <cstring>

namespace asperity::gl {

std::string functions::load(any_function (*proc_address)(const char*)) {
  std::string missing;
  const auto find = [&](const char* name) {
    const any_function f = proc_address(name);
    if (f == nullptr) missing += std::string(missing.empty() ? "" : ", ") + name;
    return f;
  };
#define ASPERITY_GL_LOAD(name, NAME) name = reinterpret_cast<PFNGL##NAME##PROC>(find("gl" #name));
  ASPERITY_GL_FUNCTIONS(ASPERITY_GL_LOAD)
#undef ASPERITY_GL_LOAD
  if (!missing.empty()) return missing;

  GLint major = 0, minor = 0;
  GetIntegerv(GL_MAJOR_VERSION, &major);
  GetIntegerv(GL_MINOR_VERSION, &minor);
  const auto* const words = reinterpret_cast<const char*>(GetString(GL_VERSION));
  const bool es = words != nullptr && std::strncmp(words, "OpenGL ES", 9) == 0;
  const int version = 10 * major + minor;
  // An entry point counts only with its version or extension: EGL has an address for any name, known or not.
  const auto optional = [&](auto& to, bool in_core, const char* core_name, const char* extension,
                            const char* extension_name) {
    const char* const name = in_core ? core_name : (has_extension(*this, extension) ? extension_name : nullptr);
    if (name != nullptr) to = reinterpret_cast<std::remove_reference_t<decltype(to)>>(proc_address(name));
  };
  optional(BufferStorage, !es && version >= 44, "glBufferStorage",
           es ? "GL_EXT_buffer_storage" : "GL_ARB_buffer_storage", es ? "glBufferStorageEXT" : "glBufferStorage");
  optional(ClipControl, !es && version >= 45, "glClipControl", es ? "GL_EXT_clip_control" : "GL_ARB_clip_control",
           es ? "glClipControlEXT" : "glClipControl");
  optional(GetGraphicsResetStatus, version >= (es ? 32 : 45), "glGetGraphicsResetStatus", "GL_KHR_robustness",
           es ? "glGetGraphicsResetStatusKHR" : "glGetGraphicsResetStatus");
  if (!es) {
    GetQueryObjectui64v = reinterpret_cast<PFNGLGETQUERYOBJECTUI64VPROC>(proc_address("glGetQueryObjectui64v"));
    QueryCounter = reinterpret_cast<PFNGLQUERYCOUNTERPROC>(proc_address("glQueryCounter"));
  }
  return missing;
}

std::string take_errors(const functions& gl) {
  const auto name = [](GLenum e) -> std::string {
    switch (e) {
      case GL_INVALID_ENUM:
        return "GL_INVALID_ENUM";
      case GL_INVALID_VALUE:
        return "GL_INVALID_VALUE";
      case GL_INVALID_OPERATION:
        return "GL_INVALID_OPERATION";
      case GL_INVALID_FRAMEBUFFER_OPERATION:
        return "GL_INVALID_FRAMEBUFFER_OPERATION";
      case GL_OUT_OF_MEMORY:
        return "GL_OUT_OF_MEMORY";
      case GL_CONTEXT_LOST:
        return "GL_CONTEXT_LOST";
      default:
        return "error " + std::to_string(e);
    }
  };
  std::string all;
  // A lost context may report an error for ever.
  for (int i = 0; i < 16; ++i) {
    const GLenum e = gl.GetError();
    if (e == GL_NO_ERROR) break;
    all += (all.empty() ? "" : ", ") + name(e);
  }
  return all;
}

bool has_extension(const functions& gl, const char* name) {
  GLint count = 0;
  gl.GetIntegerv(GL_NUM_EXTENSIONS, &count);
  for (GLint i = 0; i < count; ++i) {
    const auto* const has = reinterpret_cast<const char*>(gl.GetStringi(GL_EXTENSIONS, static_cast<GLuint>(i)));
    if (has != nullptr && std::strcmp(has, name) == 0) return true;
  }
  return false;
}

}  // namespace asperity::gl
