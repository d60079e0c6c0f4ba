// Changes the scene of a session that runs: bodies are added, removed, placed and exchanged outside of its ticks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "asperity/core/export.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/core/status.hpp"
#include "asperity/field/field_scene.hpp"
#include "asperity/model/scene.hpp"
#include "asperity/planes/plane_renderer.hpp"
#include "asperity/planes/plane_scene.hpp"

namespace asperity {

/// Fixed sizes of a scene that changes. All memory of its renderer is taken for them.
struct scene_limits {
  std::size_t bodies = 64;  ///< most fixed bodies at one time: the slots
  std::size_t balls =
      65'536;  ///< of the samples of one fixed body (sample_tree::balls()), about an eighth of the samples
};

/// Edits a scene and hands versions of it to a session.
///
///     auto editor = scene_editor::make(probe);                     // result<scene_editor>
///     const auto table = editor->add(table_model, T_wb);           // result<body_handle>
///     auto renderer = make_plane_renderer(*editor);                // its first version
///     real_session<plane_renderer, R> session(std::move(*renderer), {{}, probe->mass.centre_of_mass}, ...);
///     ...
///     const auto cup = editor->add(cup_model, T_wc);               // prepared here, seen by nobody
///     const auto version = editor->commit(session.scenes());       // all changes since the last commit, at once
///     session.scene_in_use().version >= *version                   // true once the hand feels it
///
/// A change costs the editor's thread what it takes to make a body's depth field, where its model does not keep one and
/// no other body of the scene has the same model, and some microseconds for each slot. The session's ticks allocate and
/// free nothing; a version that was replaced comes back and is freed by the next commit().
/// From one thread. What fails changes nothing and says why.
class ASPERITY_API scene_editor {
 public:
  /// An empty scene.
  /// @return invalid_argument | bad_mesh | bad_texture
  [[nodiscard]] static result<scene_editor> make(model_ptr probe, const scene_limits& limits = {},
                                                 const field_body_settings& fields = {});

  /// Puts a body into a free slot.
  /// @return its handle; limit_exceeded (no slot is free, or it has too many samples) | invalid_argument (no model, or no
  ///         pose) | bad_mesh | bad_texture
  [[nodiscard]] result<body_handle> add(const model_ptr& model, const pose& T_wb);
  /// The same with a field that was made before, as by another thread: make_field_body().
  [[nodiscard]] result<body_handle> add(const model_ptr& model, field_body_ptr made, const pose& T_wb);
  /// Takes a body away. Its handle names nobody any more. @return invalid_argument (no such body)
  [[nodiscard]] result<void> remove(const body_handle& body);
  /// Puts a body elsewhere at once. A body that real_session::move_bodies() tells of goes where that tells it to.
  /// @return invalid_argument (no such body, no pose)
  [[nodiscard]] result<void> place(const body_handle& body, const pose& T_wb);
  /// Gives a body another model, at the same pose and with the same handle.
  /// @return as add() and remove()
  [[nodiscard]] result<void> exchange(const body_handle& body, const model_ptr& model);
  [[nodiscard]] result<void> exchange(const body_handle& body, const model_ptr& model, field_body_ptr made);

  /// Hands all changes since the last commit to a session, as one version.
  /// @param to session.scenes(), or anything else with its functions, as scene_hand_over
  /// @return the version; busy where the session has not taken the last one yet: the changes are kept for the next
  ///         commit
  template <class HandOver>
  [[nodiscard]] result<std::uint64_t> commit(HandOver& to) {
    if (to.pending()) return busy();
    to.collect();
    if (!changed_) return version_;
    changed_ = !to.offer(prepare());
    return version_;
  }

  /// Whether the scene, changes that were not committed included, has a body.
  [[nodiscard]] bool has(const body_handle& body) const noexcept;
  /// The body that is in a slot, as of support_plane::body; nothing where it is free.
  [[nodiscard]] std::optional<body_handle> in_slot(std::uint32_t slot) const noexcept;
  [[nodiscard]] std::size_t bodies() const noexcept;
  [[nodiscard]] const scene_limits& limits() const noexcept { return limits_; }
  /// Of the version that was handed over last; 0: none.
  [[nodiscard]] std::uint64_t version() const noexcept { return version_; }
  /// For control_settings::surfaces: one per slot, so that the materials of bodies that come are felt.
  [[nodiscard]] surface_pairs surfaces() const;

  /// The scene as it is now, as a version of its own, for whoever hands it over otherwise than by commit().
  [[nodiscard]] std::shared_ptr<const plane_scene> prepare();

 private:
  struct slot {
    model_ptr model;  // null: free
    field_body_ptr field;
    pose T_wb{};
    std::uint32_t generation = 0;  // of the last body that was here
    std::uint64_t since = 0;
    body_facts facts{};
    std::shared_ptr<const material_places> materials;  // null without a map
  };

  scene_editor(model_ptr probe, field_body_ptr made, const scene_limits& limits, const field_body_settings& fields);

  // What a model needs to be a body: its field and what is looked up of it.
  [[nodiscard]] result<slot> fit(const model_ptr& model, field_body_ptr made) const;
  [[nodiscard]] result<void> check(const body_handle& body) const;
  [[nodiscard]] static error busy();
  void change(slot& s) noexcept {
    s.since = version_ + 1;
    changed_ = true;
  }

  model_ptr probe_;
  field_body_ptr probe_field_;
  body_facts probe_facts_;
  std::shared_ptr<const material_places> probe_materials_;
  scene_limits limits_;
  field_body_settings fields_;
  std::vector<slot> slots_;
  std::uint64_t version_ = 0;
  bool changed_ = true;
};

/// The plane renderer of a scene that changes, with the scene as it is now. All memory that its ticks need is taken
/// here, for as many bodies as the editor's limits allow. Gaps are told up to settings.reach_m, whatever bodies come;
/// automatic: for a loop of 1 kHz, and at most a tenth of the probe's diagonal and of those bodies' that are there.
/// @param settings its bodies are the editor's, and not looked at
/// @return invalid_argument (a setting out of range)
[[nodiscard]] ASPERITY_API result<plane_renderer> make_plane_renderer(scene_editor& editor,
                                                                      const plane_renderer_settings& settings = {});

}  // namespace asperity
