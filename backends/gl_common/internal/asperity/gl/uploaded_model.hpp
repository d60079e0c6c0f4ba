// A textured model on the device, shared by every contact and backend of a context.
#pragma once

#include <memory>

#include "asperity/gl/names.hpp"
#include "asperity/model/textured_model.hpp"

namespace asperity::gl {

/// A corner of a coarse triangle as a vertex stage reads it.
struct uploaded_corner {
  float position[3];  ///< body frame, m
  float texel[2];     ///< texel position in the haptic texture; texel centres have integer coordinates
};

struct uploaded_model {
  model_ptr model;
  /// GL_RGBA32F: surface position, body frame, m; alpha 1, or 0 where the texel is not a finite position (then it is
  /// 0).
  owned_name texture;
  owned_name corners;  ///< array of uploaded_corner, three per coarse triangle in the mesh's order

  /// Memory on the device, bytes.
  [[nodiscard]] std::size_t device_bytes() const noexcept { return texture.bytes() + corners.bytes(); }
};

using uploaded_ptr = std::shared_ptr<const uploaded_model>;

/// The model on the context's device. Uploads it the first time; as long as anyone holds the result, everybody gets the
/// same one. @pre the context is current in this thread   @return limit_exceeded | unsupported
[[nodiscard]] result<uploaded_ptr> upload(const context_ptr& context, const model_ptr& model);

}  // namespace asperity::gl
