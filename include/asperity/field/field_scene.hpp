// The bodies of a scene as planes and least motion see them: a depth field to be measured in, samples to measure with.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "asperity/core/export.hpp"
#include "asperity/core/status.hpp"
#include "asperity/model/scene.hpp"

namespace asperity {

/// How finely a depth field is made. Lengths in metres, 0 for automatic. A pitch is raised where it would go beyond the
/// limits.
struct field_settings {
  double pitch_m = 0.0;                   ///< of the smooth part; automatic: extent / 96, at most a third of thin parts
  double relief_pitch_m = 0.0;            ///< of the relief; automatic: a texel, at most a third of the pitch above
  double margin_m = 0.0;                  ///< of the grid around the body; automatic: 4 % of its diagonal
  std::size_t most_nodes = 4'000'000;     ///< of the smooth part; 4 bytes each
  std::size_t relief_bytes = 40'000'000;  ///< about how much memory the relief may take
  unsigned threads = 0;                   ///< that make it, the same to the bit; 0: as many as the machine has

  friend bool operator==(const field_settings&, const field_settings&) = default;
};

/// Settings of make_field_body().
struct field_body_settings {
  field_settings field{};
  /// Distance between samples on faces, m, a quarter of it on sharp edges; 0: 0.3 % of the body's diagonal.
  double sample_pitch_m = 0.0;

  friend bool operator==(const field_body_settings&, const field_body_settings&) = default;
};

/// The settings on which a field depends.
[[nodiscard]] inline field_body_settings without_threads(field_body_settings settings) noexcept {
  settings.field.threads = 0;
  return settings;
}

struct body_field;

/// One per body, in the order of the scene.
struct field_scene {
  field_body_ptr probe;
  std::vector<field_body_ptr> fixed;
  std::size_t kept_by_models_bytes = 0;  ///< of these, which memory_bytes() of the models counts

  /// Without what the models keep.
  [[nodiscard]] ASPERITY_API std::size_t heap_bytes() const noexcept;
};

/// Says what a scene lacks to be rendered with these fields: every body has one.
/// @param made of the bodies, or nullptr
[[nodiscard]] ASPERITY_API result<void> check_field_scene(const scene& bodies, const field_scene* made);

/// The field and the samples of every body of a scene: those that its model keeps, where they were made of it with these
/// settings, and otherwise made now, once for a model that appears several times. Starts threads, which have ended when
/// it returns.
/// @return invalid_argument | bad_mesh | bad_texture
[[nodiscard]] ASPERITY_API result<field_scene> make_field_scene(const scene& bodies,
                                                                const field_body_settings& settings = {});

}  // namespace asperity
