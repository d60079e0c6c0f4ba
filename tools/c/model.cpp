// Models and materials.
#include "asperity/c/model.h"

#include <filesystem>
#include <memory>

#include "asperity/io/textured_model_file.hpp"
#include "c/handles.hpp"

namespace {

using namespace asperity;
using namespace asperity::c;

result<material> material_from(const asperity_material& m) {
  if (m.combine > ASPERITY_COMBINE_MULTIPLY)
    return error{error_code::invalid_argument, "combine is none of ASPERITY_COMBINE_...: give 0 to 3"};
  material out;
  out.stiffness_n_per_m = or_usual(m.stiffness_n_per_m, out.stiffness_n_per_m);
  out.dissipation_s_per_m = m.dissipation_s_per_m;
  out.static_friction = m.static_friction;
  out.dynamic_friction = m.dynamic_friction;
  out.combine = static_cast<friction_combine>(m.combine);
  if (const result<void> ok = check(out); !ok) return ok.error();
  return out;
}

asperity_model_facts facts_of(const textured_model& model) noexcept {
  asperity_model_facts out{};
  const bool told = model.surface.has_value() || !model.surface_map.empty();
  out.materials = told ? static_cast<std::uint32_t>(material_count(model)) : 0;
  out.full_triangles = model.report.full_triangles;
  out.coarse_triangles = static_cast<std::uint32_t>(model.mesh.triangles.size());
  out.pieces = static_cast<std::uint32_t>(model.pieces.size());
  out.texture_width = model.texture.width;
  out.texture_height = model.texture.height;
  put(model.box.low, out.low_m);
  put(model.box.high, out.high_m);
  out.volume_m3 = model.mass.volume_m3;
  put(model.mass.centre_of_mass, out.centre_of_mass_m);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      out.inertia_per_mass_m2[3 * row + column] = model.mass.inertia_per_mass[column][row];
  }
  return out;
}

}  // namespace

namespace asperity::c {

result<scene> scene_of(const asperity_model* probe, const asperity_model* const* fixed, std::uint32_t count) {
  const auto bad = [](std::string what) { return error{error_code::invalid_argument, std::move(what)}; };
  if (checked(probe) == nullptr) return bad("probe is no model: give a handle of asperity_model_load()");
  if (fixed == nullptr || count == 0 || count > most_fixed)
    return bad("the scene has " + std::to_string(count) + " fixed bodies: give the probe 1 to " +
               std::to_string(most_fixed) + " to touch");
  scene out{probe->inside, {}};
  for (std::uint32_t i = 0; i < count; ++i) {
    if (checked(fixed[i]) == nullptr) return bad("fixed body " + std::to_string(i) + " is no model");
    out.fixed.push_back(fixed[i]->inside);
  }
  constexpr double largest_ratio = 500.0;
  for (std::size_t i = 0; i < out.fixed.size(); ++i) {
    const double a_m = out.probe->box.diagonal(), b_m = out.fixed[i]->box.diagonal();
    if (a_m <= largest_ratio * b_m && b_m <= largest_ratio * a_m) continue;
    return bad("the diagonals of the probe (" + std::to_string(a_m) + " m) and of fixed body " + std::to_string(i) +
               " (" + std::to_string(b_m) +
               " m) differ more than 500 times: is one of them in other units? Bake it again with --scale");
  }
  return out;
}

result<void> check(const touch_wish& wish) {
  return range_check()
      .within("stiffness_n_per_m", wish.stiffness_n_per_m, 0.0, largest_stiffness)
      .within("dissipation_s_per_m", wish.dissipation_s_per_m, 0.0, 1000.0)
      .within("static_friction", wish.static_friction, 0.0, largest_friction)
      .within("dynamic_friction", wish.dynamic_friction, 0.0, largest_friction)
      .holds(wish.dynamic_friction <= wish.static_friction,
             "dynamic_friction is above static_friction: give at most that")
      .done();
}

void apply(const touch_wish& wish, surface_pairs& to) {
  const auto change = [&](surface_pair& pair) {
    pair.stiffness_n_per_m = or_usual(wish.stiffness_n_per_m, pair.stiffness_n_per_m);
    pair.dissipation_s_per_m = or_usual(wish.dissipation_s_per_m, pair.dissipation_s_per_m);
    if (wish.static_friction == 0.0) return;
    pair.static_friction = wish.static_friction;
    pair.dynamic_friction = wish.dynamic_friction;
  };
  for (std::optional<surface_pair>& pair : to) {
    if (pair) change(*pair);
  }
  for (mapped_pair& m : to.mapped) change(m.pair);
}

}  // namespace asperity::c

std::int32_t asperity_model_load(const char* file, asperity_model** out, asperity_error* why) {
  return guarded(why, [&] {
    if (out == nullptr) return refuse_argument(why, "out is NULL: give a place for the handle");
    *out = nullptr;
    if (file == nullptr) return refuse_argument(why, "file is NULL: give the path of a .glb");
    result<textured_model> loaded = io::load_textured_model(std::filesystem::path(file));
    if (!loaded) return refuse(why, loaded.error());
    *out = std::make_unique<asperity_model>(std::make_shared<const textured_model>(std::move(*loaded))).release();
    return ASPERITY_STATUS_OK;
  });
}

std::int32_t asperity_model_free(asperity_model* model) {
  if (model == nullptr) return ASPERITY_STATUS_OK;
  if (checked(model) == nullptr) return ASPERITY_ERROR_INVALID_ARGUMENT;
  delete model;
  return ASPERITY_STATUS_OK;
}

std::int32_t asperity_model_get_facts(const asperity_model* model, asperity_model_facts* out) {
  if (checked(model) == nullptr || !has_size(out)) return ASPERITY_ERROR_INVALID_ARGUMENT;
  give(out, facts_of(*model->inside));
  return ASPERITY_STATUS_OK;
}

const char* asperity_model_name(const asperity_model* model) {
  return checked(model) == nullptr ? nullptr : model->inside->name.c_str();
}

std::int32_t asperity_material_preset(const char* name, asperity_material* out, asperity_error* why) {
  return guarded(why, [&] {
    if (name == nullptr) return refuse_argument(why, "name is NULL: give steel, wood, rubber or ice");
    if (!has_size(out)) return refuse_argument(why, "out is NULL, or its size is not set: give sizeof the struct");
    const result<material> found = preset_material(name);
    if (!found) return refuse(why, found.error());
    asperity_material full{};
    full.combine = static_cast<std::uint32_t>(found->combine);
    full.stiffness_n_per_m = found->stiffness_n_per_m;
    full.dissipation_s_per_m = found->dissipation_s_per_m;
    full.static_friction = found->static_friction;
    full.dynamic_friction = found->dynamic_friction;
    give(out, full);
    return ASPERITY_STATUS_OK;
  });
}

const char* asperity_material_preset_name(std::uint32_t number) {
  const std::span<const material> all = material_presets();
  return number < all.size() ? all[number].name.c_str() : nullptr;
}

std::int32_t asperity_model_with_material(const asperity_model* model, const asperity_material* surface,
                                          asperity_model** out, asperity_error* why) {
  return guarded(why, [&] {
    if (out == nullptr) return refuse_argument(why, "out is NULL: give a place for the handle");
    *out = nullptr;
    if (checked(model) == nullptr) return refuse_argument(why, "model is no model");
    textured_model copy = *model->inside;
    copy.surface.reset();
    copy.surface_map = {};
    if (surface != nullptr) {
      asperity_material given{};
      if (const std::int32_t taken = take(surface, given); taken != ASPERITY_STATUS_OK)
        return refuse_struct(why, taken);
      result<material> wanted = material_from(given);
      if (!wanted) return refuse(why, wanted.error());
      copy.surface = std::move(*wanted);
    }
    *out = std::make_unique<asperity_model>(std::make_shared<const textured_model>(std::move(copy))).release();
    return ASPERITY_STATUS_OK;
  });
}
