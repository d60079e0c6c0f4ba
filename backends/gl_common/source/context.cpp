#include "asperity/gl/context.hpp"

#include <array>
#include <charconv>
#include <cstring>
#include <utility>

#include "context_parts.hpp"

namespace asperity::gl {
namespace {

struct version {
  gl::dialect dialect;
  int major, minor;
};
constexpr std::array<version, 5> versions{
    {{dialect::core, 4, 5}, {dialect::core, 4, 4}, {dialect::core, 4, 3}, {dialect::es, 3, 2}, {dialect::es, 3, 1}}};

/// Gives a thread's context back when the thread ends: EGL would leave it current in a thread that is no more.
struct thread_guard {
  std::weak_ptr<context> held;
  ~thread_guard() {
    if (const context_ptr c = held.lock()) c->release();
  }
};
thread_local thread_guard guard;

/// @param why  EGL's error where the result is EGL_NO_CONTEXT
EGLContext create(const egl_library& egl, EGLDisplay display, const version& v, bool robust, std::string& why) {
  std::array<EGLint, 12> attributes{EGL_CONTEXT_MAJOR_VERSION, v.major, EGL_CONTEXT_MINOR_VERSION, v.minor};
  std::size_t n = 4;
  if (v.dialect == dialect::core) {
    attributes[n++] = EGL_CONTEXT_OPENGL_PROFILE_MASK;
    attributes[n++] = EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT;
  }
  if (robust) {
    attributes[n++] = EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY;
    attributes[n++] = EGL_LOSE_CONTEXT_ON_RESET;
  }
  attributes[n] = EGL_NONE;
  // The API is a state of the thread, which is not ours to change.
  const EGLenum before = egl.QueryAPI();
  egl.BindAPI(v.dialect == dialect::core ? EGL_OPENGL_API : EGL_OPENGL_ES_API);
  const EGLContext handle = egl.CreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes.data());
  if (handle == EGL_NO_CONTEXT) why = last_error(egl);
  if (before != EGL_NONE) egl.BindAPI(before);
  return handle;
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Entry points and facts. @pre current
result<void> describe(context_parts& parts, const display_source& source) {
  const auto proc_address = reinterpret_cast<functions::any_function (*)(const char*)>(parts.egl->GetProcAddress);
  if (const std::string missing = parts.gl.load(proc_address); !missing.empty()) {
    return error{error_code::unsupported,
                 "OpenGL: the driver of " + source.name + " has no " + missing + "; install a newer driver"};
  }
  const auto text = [&](GLenum name) {
    const auto* const words = reinterpret_cast<const char*>(parts.gl.GetString(name));
    return std::string(words == nullptr ? "" : words);
  };
  context_facts& f = parts.facts;
  f.renderer = text(GL_RENDERER);
  f.version = text(GL_VERSION);
  parts.gl.GetIntegerv(GL_MAJOR_VERSION, &f.major);
  parts.gl.GetIntegerv(GL_MINOR_VERSION, &f.minor);
  f.software = source.software;
  for (const char* name : {"llvmpipe", "softpipe", "swrast", "SwiftShader"}) {
    f.software = f.software || contains(f.renderer, name);
  }
  f.double_precision = f.dialect == dialect::core;
  f.persistent_mapping = parts.gl.BufferStorage != nullptr;
  f.robust = f.robust && parts.gl.GetGraphicsResetStatus != nullptr;
  const std::string errors = take_errors(parts.gl);
  if (errors.empty()) return {};
  return error{error_code::unsupported, "OpenGL: a new context of " + f.renderer + " reports " + errors};
}

std::string words(const version& v) {
  return (v.dialect == dialect::core ? "core " : "ES ") + std::to_string(v.major) + "." + std::to_string(v.minor);
}

}  // namespace

result<context_ptr> open_on(const egl_library& egl, const display_source& source, dialect wanted) {
  const result<EGLDisplay> display = open_display(egl, source);
  if (!display) return display.error();
  std::string refused;
  for (const version& v : versions) {
    if (wanted != dialect::automatic && wanted != v.dialect) continue;
    auto parts = std::make_unique<context_parts>();
    parts->egl = &egl;
    parts->display = *display;
    parts->facts.dialect = v.dialect;
    parts->facts.robust = true;
    std::string why;
    parts->handle = create(egl, *display, v, true, why);
    if (parts->handle == EGL_NO_CONTEXT) {
      parts->facts.robust = false;
      parts->handle = create(egl, *display, v, false, why);
    }
    if (parts->handle == EGL_NO_CONTEXT) {
      refused += (refused.empty() ? "" : ", ") + words(v) + " with " + why;
      continue;
    }
    context_parts& inside = *parts;
    const auto opened = std::make_shared<context>(std::move(parts));
    const current_scope here(opened);
    if (here.state() != status::ok) {
      return error{error_code::unsupported, "OpenGL: making a context of " + source.name +
                                                " current failed: " + last_error(egl) +
                                                "; the driver needs EGL_KHR_surfaceless_context: install a newer one"};
    }
    if (const result<void> r = describe(inside, source); !r) return r.error();
    return opened;
  }
  return error{error_code::unsupported, "OpenGL: the driver of " + source.name + " is too old: it refuses " + refused +
                                            "; install one with OpenGL 4.3 or OpenGL ES 3.1"};
}

result<context_ptr> open_context(const context_settings& settings) {
  const result<const egl_library*> egl = egl_library::load(settings.egl_library);
  if (!egl) return egl.error();
  const auto sources = find_sources(**egl);
  if (!sources) return sources.error();

  std::size_t wanted = sources->size();
  const char* const end = settings.device.data() + settings.device.size();
  const auto number = std::from_chars(settings.device.data(), end, wanted);
  const bool by_index = !settings.device.empty() && number.ec == std::errc() && number.ptr == end;
  const bool by_name = !settings.device.empty() && !by_index;
  std::optional<error> first_error;
  std::string seen;
  for (std::size_t i = 0; i < sources->size(); ++i) {
    const display_source& source = (*sources)[i];
    if (by_index && i != wanted) continue;
    result<context_ptr> opened = open_on(**egl, source, settings.dialect);
    if (!opened) {
      if (!first_error) first_error = opened.error();
      continue;
    }
    const std::string& renderer = (*opened)->facts().renderer;
    if (by_name && !contains(renderer, settings.device) && !contains(source.name, settings.device)) {
      seen += (seen.empty() ? "" : ", ") + renderer;
      continue;
    }
    (*opened)->limit_memory(settings.memory_limit_bytes);
    return opened;
  }
  if (first_error && seen.empty()) return *first_error;
  return error{error_code::invalid_argument,
               "OpenGL: there is no device \"" + settings.device + "\"; " +
                   (by_index ? "give an index below " + std::to_string(sources->size()) : "these are there: " + seen)};
}

context::context(std::unique_ptr<context_parts> parts) noexcept : parts_(std::move(parts)) {}

context::~context() {
  release();
  parts_->egl->DestroyContext(parts_->display, parts_->handle);
}

const context_facts& context::facts() const noexcept { return parts_->facts; }
const functions& context::gl() const noexcept { return parts_->gl; }
bool context::is_current() const noexcept { return parts_->egl->GetCurrentContext() == parts_->handle; }

status context::make_current() noexcept {
  if (lost_) return status::backend_failed;
  if (is_current()) return status::ok;
  if (parts_->egl->MakeCurrent(parts_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, parts_->handle) != EGL_TRUE) {
    return status::backend_failed;
  }
  guard.held = weak_from_this();
  return status::ok;
}

void context::release() noexcept {
  if (!is_current()) return;
  parts_->egl->MakeCurrent(parts_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

status context::check() noexcept {
  if (!lost_ && parts_->facts.robust && parts_->gl.GetGraphicsResetStatus() != GL_NO_ERROR) lost_ = true;
  return lost_ ? status::backend_failed : status::ok;
}

result<void> context::take_memory(std::size_t bytes, const std::string& what) {
  const std::size_t before = device_bytes_.fetch_add(bytes);
  if (memory_limit_bytes_ == 0 || before + bytes <= memory_limit_bytes_) return {};
  device_bytes_ -= bytes;
  return error{error_code::limit_exceeded,
               "OpenGL: " + what + " needs " + std::to_string(bytes) + " bytes of device memory; " +
                   std::to_string(before) + " of at most " + std::to_string(memory_limit_bytes_) +
                   " are taken: raise the limit, or use smaller textures or fewer contacts"};
}

current_scope::current_scope(context_ptr c) noexcept : context_(std::move(c)), state_(status::ok) {
  const egl_library& egl = *context_->parts().egl;
  before_ = egl.GetCurrentContext();
  display_ = egl.GetCurrentDisplay();
  draw_ = egl.GetCurrentSurface(EGL_DRAW);
  read_ = egl.GetCurrentSurface(EGL_READ);
  state_ = context_->make_current();
}

current_scope::~current_scope() {
  const context_parts& parts = context_->parts();
  if (!context_->is_current() || before_ == parts.handle) return;
  if (before_ == EGL_NO_CONTEXT) {
    context_->release();
  } else {
    parts.egl->MakeCurrent(display_, draw_, read_, before_);
  }
}

}  // namespace asperity::gl
