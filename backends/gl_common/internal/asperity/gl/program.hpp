// Programs made from GLSL that was built into the library.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "asperity/gl/functions.hpp"
#include "asperity/gl/names.hpp"

namespace asperity::gl {

/// A .glsl file as the build embedded it: see asperity_embed_shaders() in shaders.cmake.
struct shader_source {
  std::string_view file;  ///< its name, for messages
  std::string_view text;
};

/// One stage of a program: the files one after the other. The version line and the precision that the dialect wants
/// come first, then `definitions` (whole lines of `#define`).
struct shader_stage {
  GLenum stage = 0;  ///< GL_COMPUTE_SHADER, GL_VERTEX_SHADER or GL_FRAGMENT_SHADER
  std::string definitions;
  std::vector<shader_source> files;
};

/// Compiles and links. @pre the context is current in this thread
/// @return unsupported, with the driver's first lines and the files that its line numbers are about
[[nodiscard]] result<owned_name> make_program(const context_ptr& context, std::span<const shader_stage> stages,
                                              const std::string& what);

/// One program per context and text, shared as long as anyone holds it, because compiling takes far longer than a tick.
using program_ptr = std::shared_ptr<const owned_name>;
[[nodiscard]] result<program_ptr> share_program(const context_ptr& context, std::span<const shader_stage> stages,
                                                const std::string& what);

}  // namespace asperity::gl
