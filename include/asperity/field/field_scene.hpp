// The bodies of a scene as the field formulation sees them: a depth field to be measured in, samples to measure with.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "asperity/core/memory.hpp"
#include "asperity/core/status.hpp"
#include "asperity/field/body_field.hpp"
#include "asperity/field/make_body_field.hpp"
#include "asperity/field/sample_tree.hpp"
#include "asperity/field/surface_samples.hpp"
#include "asperity/model/scene.hpp"
#include "asperity/model/surface_index.hpp"

namespace asperity {

/// One body. Immutable once made.
struct field_body {
  body_field field;
  sample_tree samples;

  [[nodiscard]] std::size_t heap_bytes() const noexcept { return asperity::heap_bytes(field, samples); }
};

/// Shared and never changed, like the model it was made of.
using field_body_ptr = std::shared_ptr<const field_body>;

/// Settings of make_field_body().
struct field_body_settings {
  field_settings field{};
  double sample_pitch_m = 0.0;  ///< distance between samples; 0: 0.3 % of the body's diagonal

  friend bool operator==(const field_body_settings&, const field_body_settings&) = default;
};

/// Makes a body's field and lays out its samples. Allocates; for fractions of a second, not for a tick.
/// @return invalid_argument (a setting out of range) | bad_mesh | bad_texture
[[nodiscard]] inline result<field_body> make_field_body(const textured_model& model,
                                                        const field_body_settings& settings = {}) {
  if (!(std::isfinite(settings.sample_pitch_m) && settings.sample_pitch_m >= 0.0)) {
    return error{error_code::invalid_argument,
                 "field settings: sample_pitch_m must be a finite length, or 0 for automatic"};
  }
  result<body_field> field = make_body_field(model, settings.field);
  if (!field) return field.error();
  constexpr double of_the_diagonal = 0.003;
  const double pitch_m =
      settings.sample_pitch_m > 0.0 ? settings.sample_pitch_m : of_the_diagonal * model.box.diagonal();
  const detail::surface_index index(model);
  std::vector<field_sample> samples = detail::surface_samples(model, index, pitch_m).make();
  if (samples.empty()) {
    return error{error_code::bad_texture, "the model " + model.name + " has no texel that holds a surface point"};
  }
  return field_body{std::move(field).value(), sample_tree(std::move(samples))};
}

/// One per body, in the order of the scene.
struct field_scene {
  field_body_ptr probe;
  std::vector<field_body_ptr> fixed;

  [[nodiscard]] std::size_t heap_bytes() const noexcept {
    std::size_t bytes = asperity::heap_bytes(fixed) + sizeof(field_body) + probe->heap_bytes();
    for (auto b = fixed.begin(); b != fixed.end(); ++b) {
      const bool counted = *b == probe || std::find(fixed.begin(), b, *b) != b;
      if (!counted) bytes += sizeof(field_body) + (*b)->heap_bytes();
    }
    return bytes;
  }
};

/// Makes the field and the samples of every body of a scene; a model that appears several times is made once.
/// @return invalid_argument | bad_mesh | bad_texture
[[nodiscard]] inline result<field_scene> make_field_scene(const scene& bodies,
                                                          const field_body_settings& settings = {}) {
  if (!bodies.probe) return error{error_code::invalid_argument, "the scene has no probe: give it a textured model"};
  const auto make = [&](const model_ptr& model) -> result<field_body_ptr> {
    if (!model) return error{error_code::invalid_argument, "the scene has a fixed body without a model"};
    result<field_body> made = make_field_body(*model, settings);
    if (!made) return made.error();
    return field_body_ptr(std::make_shared<const field_body>(std::move(made).value()));
  };
  field_scene out;
  result<field_body_ptr> probe = make(bodies.probe);
  if (!probe) return probe.error();
  out.probe = std::move(probe).value();
  for (std::size_t b = 0; b < bodies.fixed.size(); ++b) {
    const auto same =
        std::find(bodies.fixed.begin(), bodies.fixed.begin() + static_cast<std::ptrdiff_t>(b), bodies.fixed[b]);
    const auto at = static_cast<std::size_t>(same - bodies.fixed.begin());
    if (bodies.fixed[b] == bodies.probe) {
      out.fixed.push_back(out.probe);
    } else if (at < b) {
      out.fixed.push_back(out.fixed[at]);
    } else {
      result<field_body_ptr> made = make(bodies.fixed[b]);
      if (!made) return made.error();
      out.fixed.push_back(std::move(made).value());
    }
  }
  return out;
}

}  // namespace asperity
