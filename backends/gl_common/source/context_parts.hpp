// EGL's side of a context, and opening one on a given device.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "asperity/gl/context.hpp"
#include "asperity/gl/functions.hpp"
#include "asperity/gl/names.hpp"
#include "egl_library.hpp"

namespace asperity::gl {

struct uploaded_model;

struct context_parts {
  const egl_library* egl = nullptr;
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext handle = EGL_NO_CONTEXT;
  functions gl;
  context_facts facts;
  std::vector<std::weak_ptr<const uploaded_model>> models;  ///< what upload() knows
  std::vector<std::pair<std::string, std::weak_ptr<const owned_name>>>
      programs;  ///< what share_program() knows, by text
};

/// Newest first: core 4.5 to 4.3, then ES 3.2 and 3.1, as far as `wanted` allows.
/// @return unsupported with the step that failed
[[nodiscard]] result<context_ptr> open_on(const egl_library& egl, const display_source& source, dialect wanted);

}  // namespace asperity::gl
