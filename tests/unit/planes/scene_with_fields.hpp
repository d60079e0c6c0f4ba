// A scene and the depth fields of its bodies.
#pragma once

#include <memory>
#include <utility>

#include "asperity/field/field_scene.hpp"
#include "asperity/model/scene.hpp"

namespace asperity::test_support {

struct scene_with_fields {
  scene of;
  std::shared_ptr<const field_scene> fields;
};

/// @pre its bodies have fields: closed, textured, no wall too thin
[[nodiscard]] inline scene_with_fields with_fields(scene of) {
  auto fields = std::make_shared<const field_scene>(make_field_scene(of).value());
  return {std::move(of), std::move(fields)};
}

}  // namespace asperity::test_support
