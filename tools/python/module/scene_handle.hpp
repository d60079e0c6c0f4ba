// A scene that changes, as Python holds it.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "asperity/planes/scene_editor.hpp"

namespace asperity::python {

/// What a session or a renderer has of a scene: the changes that it was given, as one version.
struct scene_seen {
  std::uint64_t changes = 0;
  std::uint64_t version = 0;
};

/// The library's editor and its bodies' models, shared by all that was made of the scene. The GIL is not held while
/// it is locked.
struct scene_handle {
  struct body {
    body_handle handle;
    model_ptr model;
    field_body_ptr field;
    pose T_wb;
  };

  explicit scene_handle(model_ptr moves, scene_editor edits) : probe(std::move(moves)), editor(std::move(edits)) {}

  model_ptr probe;
  std::mutex busy;  ///< of all below
  scene_editor editor;
  std::vector<body> bodies;   ///< those that are there, by slot
  std::uint64_t changes = 1;  ///< that were made; a session has seen so many of them

  /// The bodies that are there, without the free slots. @pre locked
  [[nodiscard]] scene now() const {
    scene out{probe, {}};
    for (const body& b : bodies) out.fixed.push_back(b.model);
    return out;
  }
  [[nodiscard]] std::vector<pose> poses_now() const {
    std::vector<pose> out;
    for (const body& b : bodies) out.push_back(b.T_wb);
    return out;
  }
};

}  // namespace asperity::python
