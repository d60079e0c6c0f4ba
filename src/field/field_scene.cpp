#include "asperity/field/field_scene.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "asperity/field/field_body.hpp"
#include "field/make_body_field.hpp"
#include "field/surface_samples.hpp"
#include "model/surface_index.hpp"

namespace asperity {

result<field_body> make_field_body(const textured_model& model, const field_body_settings& settings) {
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

std::size_t field_scene::heap_bytes() const noexcept {
  std::size_t bytes = asperity::heap_bytes(fixed) + sizeof(field_body) + probe->heap_bytes();
  for (auto b = fixed.begin(); b != fixed.end(); ++b) {
    const bool counted = *b == probe || std::find(fixed.begin(), b, *b) != b;
    if (!counted) bytes += sizeof(field_body) + (*b)->heap_bytes();
  }
  return bytes;
}

result<void> check_field_scene(const scene& bodies, const field_scene* made) {
  if (const result<void> ok = check_has_fixed_body(bodies); !ok) return ok.error();
  bool all = bodies.probe && made != nullptr && made->probe && made->fixed.size() == bodies.fixed.size();
  for (std::size_t b = 0; all && b < bodies.fixed.size(); ++b) all = bodies.fixed[b] && made->fixed[b];
  if (all) return {};
  return error{error_code::invalid_argument,
               "the fields are not as many as the scene's bodies: make_field_scene() makes one for each"};
}

result<field_scene> make_field_scene(const scene& bodies, const field_body_settings& settings) {
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
