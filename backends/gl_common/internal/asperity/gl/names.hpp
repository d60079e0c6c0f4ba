// Ownership of OpenGL objects.
#pragma once

#include <GL/glcorearb.h>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "asperity/core/status.hpp"
#include "asperity/gl/context.hpp"

namespace asperity::gl {

enum class name_kind : std::uint8_t { buffer, texture, program, framebuffer, vertex_array, query };

/// One OpenGL object and the device memory that was counted for it. It keeps its context alive, and deletes itself in
/// whatever thread it is destroyed, unless another thread has the context: then the object goes with the context.
class owned_name {
 public:
  owned_name() = default;
  owned_name(context_ptr context, name_kind kind, GLuint name, std::size_t bytes = 0) noexcept
      : context_(std::move(context)), kind_(kind), name_(name), bytes_(bytes) {}
  ~owned_name() { reset(); }
  owned_name(owned_name&& other) noexcept { swap(other); }
  owned_name& operator=(owned_name&& other) noexcept {
    owned_name old(std::move(other));
    swap(old);
    return *this;
  }

  [[nodiscard]] GLuint get() const noexcept { return name_; }
  [[nodiscard]] std::size_t bytes() const noexcept { return bytes_; }
  [[nodiscard]] const context_ptr& owner() const noexcept { return context_; }

 private:
  void reset() noexcept;
  void swap(owned_name& other) noexcept {
    std::swap(context_, other.context_);
    std::swap(kind_, other.kind_);
    std::swap(name_, other.name_);
    std::swap(bytes_, other.bytes_);
  }

  context_ptr context_;
  name_kind kind_ = name_kind::buffer;
  GLuint name_ = 0;
  std::size_t bytes_ = 0;
};

// All of these: @pre the context is current in this thread.
// @return limit_exceeded (the context's limit, or the device's memory) | unsupported (the driver's size limits)

/// A vertex array, framebuffer or query: something without memory of its own.
[[nodiscard]] owned_name make_name(const context_ptr& context, name_kind kind);

/// A buffer of the device's own, for shaders. @param data `bytes` to fill it with, or nullptr: undefined
[[nodiscard]] result<owned_name> make_buffer(const context_ptr& context, std::size_t bytes, const void* data,
                                             const std::string& what);

/// A texture without mip levels, read with texelFetch: nearest, clamped.
/// @param internal_format  GL_RGBA32F, GL_RGBA16, GL_R32F, GL_DEPTH_COMPONENT16, GL_DEPTH_COMPONENT24 or
/// GL_DEPTH_COMPONENT32F
[[nodiscard]] result<owned_name> make_texture(const context_ptr& context, GLenum internal_format, std::uint32_t width,
                                              std::uint32_t height, const std::string& what);

}  // namespace asperity::gl
