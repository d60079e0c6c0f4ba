#include "asperity/gl/mapped_buffer.hpp"

#include <cstring>
#include <utility>

namespace asperity::gl {

result<mapped_buffer> mapped_buffer::make(const context_ptr& context, std::size_t bytes, direction way,
                                          const std::string& what) {
  const functions& gl = context->gl();
  if (const result<void> r = context->take_memory(bytes, what); !r) return r.error();
  static_cast<void>(take_errors(gl));
  GLuint name = 0;
  gl.GenBuffers(1, &name);
  mapped_buffer out;
  out.name_ = owned_name(context, name_kind::buffer, name, bytes);
  const auto size = static_cast<GLsizeiptr>(bytes);
  gl.BindBuffer(GL_SHADER_STORAGE_BUFFER, name);
  if (gl.BufferStorage != nullptr) {
    const GLbitfield flags = (way == direction::to_device ? GL_MAP_WRITE_BIT : GL_MAP_READ_BIT) |
                             GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
    gl.BufferStorage(GL_SHADER_STORAGE_BUFFER, size, nullptr, flags);
    out.memory_ = gl.MapBufferRange(GL_SHADER_STORAGE_BUFFER, 0, size, flags);
  } else {
    gl.BufferData(GL_SHADER_STORAGE_BUFFER, size, nullptr,
                  way == direction::to_device ? GL_STREAM_DRAW : GL_STREAM_READ);
    out.copy_ = std::make_unique<std::byte[]>(bytes);
    out.memory_ = out.copy_.get();
  }
  gl.BindBuffer(GL_SHADER_STORAGE_BUFFER, 0);
  const std::string errors = take_errors(gl);
  if (!errors.empty() || out.memory_ == nullptr) {
    return error{error_code::limit_exceeded, "OpenGL: " + what + " of " + std::to_string(bytes) +
                                                 " bytes could not be mapped: " + errors + "; use fewer contacts"};
  }
  return out;
}

void mapped_buffer::send(std::size_t bytes) noexcept {
  if (copy_ == nullptr || bytes == 0) return;
  const functions& gl = name_.owner()->gl();
  gl.BindBuffer(GL_SHADER_STORAGE_BUFFER, name_.get());
  gl.BufferSubData(GL_SHADER_STORAGE_BUFFER, 0, static_cast<GLsizeiptr>(bytes), copy_.get());
  gl.BindBuffer(GL_SHADER_STORAGE_BUFFER, 0);
}

status mapped_buffer::receive(std::size_t bytes) noexcept {
  if (copy_ == nullptr || bytes == 0) return status::ok;
  const functions& gl = name_.owner()->gl();
  gl.BindBuffer(GL_SHADER_STORAGE_BUFFER, name_.get());
  const void* const there =
      gl.MapBufferRange(GL_SHADER_STORAGE_BUFFER, 0, static_cast<GLsizeiptr>(bytes), GL_MAP_READ_BIT);
  if (there != nullptr) std::memcpy(copy_.get(), there, bytes);
  const bool intact = there != nullptr && gl.UnmapBuffer(GL_SHADER_STORAGE_BUFFER) == GL_TRUE;
  gl.BindBuffer(GL_SHADER_STORAGE_BUFFER, 0);
  return intact ? status::ok : status::backend_failed;
}

status wait_for_device(const functions& gl, std::uint64_t timeout_ns) noexcept {
  // With the barrier before the fence, what shaders wrote is in mapped memory once the fence has passed.
  gl.MemoryBarrier(gl.BufferStorage != nullptr ? GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT
                                               : GL_BUFFER_UPDATE_BARRIER_BIT);
  const GLsync fence = gl.FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
  if (fence == nullptr) return status::backend_failed;
  const GLenum said = gl.ClientWaitSync(fence, GL_SYNC_FLUSH_COMMANDS_BIT, timeout_ns);
  gl.DeleteSync(fence);
  return said == GL_ALREADY_SIGNALED || said == GL_CONDITION_SATISFIED ? status::ok : status::backend_failed;
}

}  // namespace asperity::gl
