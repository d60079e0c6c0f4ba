// Stands in for libEGL.so.1 and passes everything on to the real one, until the driver has been asked often enough
// whether the context is still there: from then on it says that it is lost, and lets nobody take it. Found by the
// dynamic linker through LD_LIBRARY_PATH, so that the command under test needs to know nothing about it.
//
// LOSING_EGL_REAL   path of the real library
// LOSING_EGL_AFTER  answers before the loss
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <vector>

namespace {

constexpr unsigned lost_by_others = 0x8254;  // GL_INNOCENT_CONTEXT_RESET

template <class Function>
Function* real(const char* name) {
  static void* const library = dlopen(std::getenv("LOSING_EGL_REAL"), RTLD_NOW | RTLD_LOCAL);
  return library == nullptr ? nullptr : reinterpret_cast<Function*>(dlsym(library, name));
}

std::atomic<long> answers_left{[] {
  const char* const after = std::getenv("LOSING_EGL_AFTER");
  return after == nullptr ? 0L : std::atol(after);
}()};

unsigned graphics_reset_status() { return answers_left-- > 0 ? 0U : lost_by_others; }

}  // namespace

// NOLINTBEGIN(readability-identifier-naming): the names are EGL's.
extern "C" {

#define PASS_ON(Result, name, parameters, arguments)                          \
  __attribute__((visibility("default"))) Result EGLAPIENTRY name parameters { \
    static auto* const there = real<Result EGLAPIENTRY parameters>(#name);    \
    return there arguments;                                                   \
  }

PASS_ON(const char*, eglQueryString, (EGLDisplay d, EGLint name), (d, name))
PASS_ON(EGLBoolean, eglInitialize, (EGLDisplay d, EGLint* major, EGLint* minor), (d, major, minor))
PASS_ON(EGLBoolean, eglBindAPI, (EGLenum api), (api))
PASS_ON(EGLenum, eglQueryAPI, (), ())
PASS_ON(EGLBoolean, eglChooseConfig, (EGLDisplay d, const EGLint* list, EGLConfig* all, EGLint size, EGLint* count),
        (d, list, all, size, count))
PASS_ON(EGLBoolean, eglDestroyContext, (EGLDisplay d, EGLContext c), (d, c))
PASS_ON(EGLContext, eglGetCurrentContext, (), ())
PASS_ON(EGLDisplay, eglGetCurrentDisplay, (), ())
PASS_ON(EGLSurface, eglGetCurrentSurface, (EGLint which), (which))
PASS_ON(EGLint, eglGetError, (), ())

/// Every driver can lose a context here, those too that never tell: they are not asked for it.
__attribute__((visibility("default"))) EGLContext EGLAPIENTRY eglCreateContext(EGLDisplay d, EGLConfig settings,
                                                                               EGLContext share,
                                                                               const EGLint* attributes) {
  static auto* const there =
      real<EGLContext EGLAPIENTRY(EGLDisplay, EGLConfig, EGLContext, const EGLint*)>("eglCreateContext");
  std::vector<EGLint> asked;
  for (; attributes != nullptr && *attributes != EGL_NONE; attributes += 2) {
    if (*attributes != EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY)
      asked.insert(asked.end(), attributes, attributes + 2);
  }
  asked.push_back(EGL_NONE);
  return there(d, settings, share, asked.data());
}

__attribute__((visibility("default"))) EGLBoolean EGLAPIENTRY eglMakeCurrent(EGLDisplay d, EGLSurface draw,
                                                                             EGLSurface read, EGLContext c) {
  static auto* const there =
      real<EGLBoolean EGLAPIENTRY(EGLDisplay, EGLSurface, EGLSurface, EGLContext)>("eglMakeCurrent");
  if (c != EGL_NO_CONTEXT && answers_left < 0) return EGL_FALSE;
  return there(d, draw, read, c);
}

using any_function = __eglMustCastToProperFunctionPointerType;
__attribute__((visibility("default"))) any_function EGLAPIENTRY eglGetProcAddress(const char* name) {
  static auto* const there = real<any_function EGLAPIENTRY(const char*)>("eglGetProcAddress");
  for (const char* const mine : {"glGetGraphicsResetStatus", "glGetGraphicsResetStatusKHR"}) {
    if (std::strcmp(name, mine) == 0) return reinterpret_cast<any_function>(graphics_reset_status);
  }
  return there(name);
}
}
// NOLINTEND(readability-identifier-naming)
