// Bodies whose originals are known: the benchmark models, and scans where there are any. With what the field
// formulation makes of them.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "asperity/field/field_body.hpp"
#include "asperity/field/field_scene.hpp"
#include "asperity/model/textured_model.hpp"
#include "asperity/model/triangle_mesh.hpp"

namespace asperity::truth {

/// A baked model, the mesh that it was baked from in the model's frame, and its field.
struct truth_body {
  std::string name;
  triangle_mesh full;
  model_ptr model;
  field_body_ptr field;

  [[nodiscard]] double diagonal_m() const { return model->box.diagonal(); }
  [[nodiscard]] double sample_pitch_m() const { return 0.003 * diagonal_m(); }
};

inline constexpr std::array<const char*, 6> benchmark_names{"block", "gear", "torus", "hammer", "file", "cad_part"};
inline constexpr std::array<const char*, 3> scan_names{"igea", "rocker-arm", "stanford-bunny"};

/// A benchmark model or a scan, each read once per program.
/// @throws std::runtime_error where it cannot be read
[[nodiscard]] const truth_body& get_body(const std::string& name);

/// Why the tests of scans have to be skipped; empty where all scans are there.
[[nodiscard]] std::string why_without_scans();

/// make_field_body(), compiled as far optimised as for a user. @throws std::runtime_error where it is refused
[[nodiscard]] field_body_ptr built_field_body(const textured_model& model, const field_body_settings& settings = {});

/// Two of them in a scene.
struct truth_pair {
  scene bodies;
  std::shared_ptr<const field_scene> fields;
};
[[nodiscard]] truth_pair pair_of(const truth_body& probe, const truth_body& fixed);

/// A body whose relief is moved aside by one texel along the columns of its texture: a bug that a test has to notice.
[[nodiscard]] textured_model with_shifted_relief(const textured_model& model);
/// A body of which only every `kept`th sample is left: likewise.
[[nodiscard]] field_body_ptr with_fewer_samples(const field_body& body, std::size_t kept);

}  // namespace asperity::truth
