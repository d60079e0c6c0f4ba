#include "asperity/field/field_scene.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "asperity/field/field_body.hpp"
#include "asperity/field/packed_field.hpp"
#include "field/make_body_field.hpp"
#include "field/model_digest.hpp"
#include "field/surface_samples.hpp"
#include "field/thin_plain.hpp"
#include "field/threads.hpp"
#include "model/surface_index.hpp"

namespace asperity {

result<field_body> make_field_body(const textured_model& model, const field_body_settings& settings) {
  if (!(std::isfinite(settings.sample_pitch_m) && settings.sample_pitch_m >= 0.0)) {
    return error{error_code::invalid_argument,
                 "field settings: sample_pitch_m must be a finite length, or 0 for automatic"};
  }
  constexpr double of_the_diagonal = 0.003;
  const double pitch_m =
      settings.sample_pitch_m > 0.0 ? settings.sample_pitch_m : of_the_diagonal * model.box.diagonal();
  if (const result<void> ok = check_field_model(model, settings.field); !ok) return ok.error();
  const unsigned threads = detail::resolve_threads(settings.field.threads);
  std::optional<result<body_field>> field;
  sample_tree samples, plain;
  detail::for_each_task(2, threads, [&](std::size_t task) {
    if (task == 0) {
      field = make_body_field(model, settings.field);
    } else {
      const detail::surface_index index(model);
      const placed_samples all = detail::surface_samples(model, index, pitch_m).make();
      // With a map, a plain face may be of several materials, and each sample tells of what it is.
      detail::thinned_samples apart = model.surface_map.empty() ? detail::plain_thinning(all, pitch_m).apart(threads)
                                                                : detail::thinned_samples{all, {}};
      samples = sample_tree(std::move(apart.told), threads);
      plain = sample_tree(std::move(apart.plain), threads);
    }
  });
  if (!*field) return field->error();
  if (samples.samples().empty()) {
    return error{error_code::bad_texture, "the model " + model.name + " has no texel that holds a surface point"};
  }
  return field_body{std::move(*field).value(), std::move(samples), std::move(plain), without_threads(settings),
                    detail::model_digest(model)};
}

std::size_t memory_bytes(const field_body& body) noexcept { return sizeof body + body.heap_bytes(); }

std::size_t field_scene::heap_bytes() const noexcept {
  std::size_t bytes = asperity::heap_bytes(fixed) + memory_bytes(*probe);
  for (auto b = fixed.begin(); b != fixed.end(); ++b) {
    const bool counted = *b == probe || std::find(fixed.begin(), b, *b) != b;
    if (*b && !counted) bytes += memory_bytes(**b);
  }
  return bytes - kept_by_models_bytes;
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
  // Models that appear several times are made once.
  std::vector<model_ptr> models{bodies.probe};
  for (const model_ptr& model : bodies.fixed) {
    if (!model) return error{error_code::invalid_argument, "the scene has a fixed body without a model"};
    if (std::find(models.begin(), models.end(), model) == models.end()) models.push_back(model);
  }
  // Each gets more threads than its share, because one that is done leaves the machine to the others.
  const unsigned threads = detail::resolve_threads(settings.field.threads);
  const auto at_once = static_cast<unsigned>(std::min<std::size_t>(threads, models.size()));
  field_body_settings of_each = settings;
  of_each.field.threads = threads > 1 ? std::min(threads, (2 * threads + at_once - 1) / at_once) : 1;
  std::vector<field_body_ptr> made(models.size());
  std::vector<std::optional<error>> failed(models.size());
  detail::for_each_task(models.size(), threads, [&](std::size_t i) {
    if (const field_body_ptr& kept = models[i]->field; kept && is_made_of(*kept, *models[i], settings)) {
      made[i] = kept;
      return;
    }
    result<field_body> body = make_field_body(*models[i], of_each);
    if (body) {
      made[i] = std::make_shared<const field_body>(std::move(body).value());
    } else {
      failed[i] = body.error();
    }
  });
  for (const std::optional<error>& e : failed) {
    if (e) return *e;
  }
  field_scene out;
  for (std::size_t i = 0; i < made.size(); ++i) {
    if (made[i] == models[i]->field) out.kept_by_models_bytes += memory_bytes(*made[i]);
  }
  out.probe = made[0];
  for (const model_ptr& model : bodies.fixed) {
    out.fixed.push_back(
        made[static_cast<std::size_t>(std::find(models.begin(), models.end(), model) - models.begin())]);
  }
  return out;
}

}  // namespace asperity
