#include "asperity/gl/names.hpp"

#include <utility>

#include "asperity/gl/functions.hpp"

namespace asperity::gl {
namespace {

error device_full(const functions& gl, const std::string& what, std::size_t bytes) {
  return {error_code::limit_exceeded, "OpenGL: " + what + " of " + std::to_string(bytes) +
                                          " bytes could not be made on the device: " + take_errors(gl) +
                                          "; use smaller textures or fewer contacts"};
}

std::size_t texel_bytes(GLenum format) {
  switch (format) {
    case GL_RGBA32F:
      return 16;
    case GL_RGBA16:
    case GL_RGBA16F:
      return 8;
    case GL_DEPTH_COMPONENT16:
      return 2;
    default:
      return 4;
  }
}

}  // namespace

void owned_name::reset() noexcept {
  if (context_ == nullptr) return;
  context_->give_memory_back(bytes_);
  const current_scope here(context_);
  if (here.state() == status::ok && name_ != 0) {
    const functions& gl = context_->gl();
    switch (kind_) {
      case name_kind::buffer:
        gl.DeleteBuffers(1, &name_);
        break;
      case name_kind::texture:
        gl.DeleteTextures(1, &name_);
        break;
      case name_kind::program:
        gl.DeleteProgram(name_);
        break;
      case name_kind::framebuffer:
        gl.DeleteFramebuffers(1, &name_);
        break;
      case name_kind::vertex_array:
        gl.DeleteVertexArrays(1, &name_);
        break;
      case name_kind::query:
        gl.DeleteQueries(1, &name_);
        break;
    }
  }
  name_ = 0;
}

owned_name make_name(const context_ptr& context, name_kind kind) {
  const functions& gl = context->gl();
  GLuint name = 0;
  switch (kind) {
    case name_kind::buffer:
      gl.GenBuffers(1, &name);
      break;
    case name_kind::texture:
      gl.GenTextures(1, &name);
      break;
    case name_kind::program:
      name = gl.CreateProgram();
      break;
    case name_kind::framebuffer:
      gl.GenFramebuffers(1, &name);
      break;
    case name_kind::vertex_array:
      gl.GenVertexArrays(1, &name);
      break;
    case name_kind::query:
      gl.GenQueries(1, &name);
      break;
  }
  return {context, kind, name};
}

result<owned_name> make_buffer(const context_ptr& context, std::size_t bytes, const void* data,
                               const std::string& what) {
  const functions& gl = context->gl();
  GLint64 largest = 0;
  gl.GetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &largest);
  if (bytes > static_cast<std::size_t>(largest)) {
    return error{error_code::limit_exceeded, "OpenGL: " + what + " take " + std::to_string(bytes) +
                                                 " bytes; a buffer of this device has at most " +
                                                 std::to_string(largest)};
  }
  if (const result<void> r = context->take_memory(bytes, what); !r) return r.error();
  static_cast<void>(take_errors(gl));
  GLuint name = 0;
  gl.GenBuffers(1, &name);
  owned_name out(context, name_kind::buffer, name, bytes);
  gl.BindBuffer(GL_SHADER_STORAGE_BUFFER, name);
  gl.BufferData(GL_SHADER_STORAGE_BUFFER, static_cast<GLsizeiptr>(bytes), data,
                data != nullptr ? GL_STATIC_DRAW : GL_DYNAMIC_COPY);
  gl.BindBuffer(GL_SHADER_STORAGE_BUFFER, 0);
  if (gl.GetError() != GL_NO_ERROR) return device_full(gl, what, bytes);
  return out;
}

result<owned_name> make_texture(const context_ptr& context, GLenum internal_format, std::uint32_t width,
                                std::uint32_t height, const std::string& what) {
  const functions& gl = context->gl();
  GLint largest = 0;
  gl.GetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  if (width == 0 || height == 0 || width > static_cast<GLuint>(largest) || height > static_cast<GLuint>(largest)) {
    return error{error_code::unsupported, "OpenGL: " + what + " is " + std::to_string(width) + " x " +
                                              std::to_string(height) + "; this device takes 1 to " +
                                              std::to_string(largest) + " texels per side"};
  }
  const std::size_t bytes = texel_bytes(internal_format) * width * height;
  if (const result<void> r = context->take_memory(bytes, what); !r) return r.error();
  static_cast<void>(take_errors(gl));
  GLuint name = 0;
  gl.GenTextures(1, &name);
  owned_name out(context, name_kind::texture, name, bytes);
  gl.BindTexture(GL_TEXTURE_2D, name);
  gl.TexStorage2D(GL_TEXTURE_2D, 1, internal_format, static_cast<GLsizei>(width), static_cast<GLsizei>(height));
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  gl.BindTexture(GL_TEXTURE_2D, 0);
  if (gl.GetError() != GL_NO_ERROR) return device_full(gl, what, bytes);
  return out;
}

}  // namespace asperity::gl
