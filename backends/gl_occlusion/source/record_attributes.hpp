// Records that a vertex shader reads, one per instance: an attribute per four floats.
#pragma once

#include <cstddef>

#include "asperity/gl/functions.hpp"
#include "asperity/gl/names.hpp"

namespace asperity::gl {

inline constexpr std::size_t attribute_bytes = 4 * sizeof(float);

/// How many attributes a record fills.
template <class Record>
requires(sizeof(Record) % attribute_bytes ==
         0) inline constexpr GLuint attributes_of = static_cast<GLuint>(sizeof(Record) / attribute_bytes);

/// A vertex array that takes a record for each instance.
template <class Record>
[[nodiscard]] owned_name make_record_vertices(const context_ptr& context) {
  const functions& gl = context->gl();
  owned_name out = make_name(context, name_kind::vertex_array);
  gl.BindVertexArray(out.get());
  for (GLuint i = 0; i < attributes_of<Record>; ++i) {
    gl.EnableVertexAttribArray(i);
    gl.VertexAttribDivisor(i, 1);
  }
  gl.BindVertexArray(0);
  return out;
}

/// The next draw reads records from this byte of the bound buffer on.
template <class Record>
void read_records_from(const functions& gl, std::size_t first_byte) noexcept {
  for (GLuint i = 0; i < attributes_of<Record>; ++i) {
    // OpenGL takes the offset in a buffer where it once took an address.
    // NOLINTNEXTLINE(performance-no-int-to-ptr)
    const auto* const offset = reinterpret_cast<const void*>(first_byte + i * attribute_bytes);
    gl.VertexAttribPointer(i, 4, GL_FLOAT, GL_FALSE, static_cast<GLsizei>(sizeof(Record)), offset);
  }
}

}  // namespace asperity::gl
