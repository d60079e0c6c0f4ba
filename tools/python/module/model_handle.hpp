// A textured model and a mesh as Python holds them.
#pragma once

#include <memory>
#include <utility>

#include "asperity/model/textured_model.hpp"
#include "asperity/model/triangle_mesh.hpp"

namespace asperity::python {

/// Shares the model with renderers and views.
struct model_handle {
  model_ptr inside;

  [[nodiscard]] static model_handle of(textured_model model) {
    return {std::make_shared<const textured_model>(std::move(model))};
  }
};

/// Shares the mesh with bakes that are under way and with views.
struct mesh_handle {
  std::shared_ptr<const triangle_mesh> inside;

  [[nodiscard]] static mesh_handle of(triangle_mesh mesh) {
    return {std::make_shared<const triangle_mesh>(std::move(mesh))};
  }
};

}  // namespace asperity::python
