// A textured model on the device, shared by every contact and backend of a context.
#pragma once

#include <memory>
#include <vector>

#include "asperity/gl/names.hpp"
#include "asperity/model/scene.hpp"
#include "asperity/model/textured_model.hpp"

namespace asperity::gl {

struct uploaded_model {
  model_ptr model;
  /// GL_RGBA32F: surface position, body frame, m; alpha 1, or 0 where the texel is not a finite position (then it is
  /// 0).
  owned_name texture;

  /// Memory on the device, bytes.
  [[nodiscard]] std::size_t device_bytes() const noexcept { return texture.bytes(); }
};

using uploaded_ptr = std::shared_ptr<const uploaded_model>;

/// The model on the context's device. Uploads it the first time, and returns the same one as long as anyone holds it.
/// @pre the context is current in this thread   @return limit_exceeded | unsupported
[[nodiscard]] result<uploaded_ptr> upload(const context_ptr& context, const model_ptr& model);

/// A scene's models on the device.
struct uploaded_scene {
  uploaded_ptr probe;
  std::vector<uploaded_ptr> fixed;
};

/// All models of a scene, each as upload() has it.
[[nodiscard]] result<uploaded_scene> upload(const context_ptr& context, const scene& bodies);

}  // namespace asperity::gl
