#include "asperity/planes/scene_editor.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "asperity/field/field_body.hpp"
#include "asperity/planes/plane_depth.hpp"
#include "asperity/planes/plane_finder.hpp"
#include "model/material_places.hpp"
#include "planes/body_tree.hpp"
#include "planes/facing.hpp"
#include "planes/known_branches.hpp"
#include "planes/renderer_team.hpp"
#include "planes/surface_reader.hpp"

namespace asperity {
namespace {

error bad(std::string what) { return {error_code::invalid_argument, "scene editor: " + std::move(what)}; }

// The field that a model keeps, or one that is made now.
result<field_body_ptr> field_of(const model_ptr& model, const field_body_settings& settings) {
  result<field_scene> made = make_field_scene({model, {}}, settings);
  if (!made) return made.error();
  return std::move(made->probe);
}

}  // namespace

scene_editor::scene_editor(model_ptr probe, field_body_ptr made, const scene_limits& limits,
                           const field_body_settings& fields)
    : probe_(std::move(probe)),
      probe_field_(std::move(made)),
      probe_facts_(facts_of(*probe_field_, probe_->box.diagonal(), probe_->box.diagonal())),
      probe_materials_(material_places::of(*probe_)),
      limits_(limits),
      fields_(fields),
      slots_(limits.bodies) {}

result<scene_editor> scene_editor::make(model_ptr probe, const scene_limits& limits,
                                        const field_body_settings& fields) {
  if (!probe) return bad("the scene has no probe: give it a textured model");
  constexpr std::size_t most_bodies = 1'000'000, most_balls = 100'000'000;
  if (limits.bodies < 1 || limits.bodies > most_bodies) return bad("scene_limits::bodies must be from 1 to 1000000");
  if (limits.balls < 1 || limits.balls > most_balls) return bad("scene_limits::balls must be from 1 to 100000000");
  if (const result<void> ok = check_materials(*probe); !ok) return ok.error();
  result<field_body_ptr> made = field_of(probe, fields);
  if (!made) return made.error();
  return scene_editor(std::move(probe), std::move(*made), limits, fields);
}

result<scene_editor::slot> scene_editor::fit(const model_ptr& model, field_body_ptr made) const {
  if (!model) return bad("a body has no model: give it a textured model");
  if (const result<void> ok = check_materials(*model); !ok) return ok.error();
  const auto same = std::find_if(slots_.begin(), slots_.end(), [&](const slot& s) { return s.model == model; });
  if (same != slots_.end() && (!made || made == same->field)) {
    slot out;
    out.model = model;
    out.field = same->field;
    out.facts = same->facts;
    out.materials = same->materials;
    return out;
  }
  if (!made) {
    result<field_body_ptr> now = field_of(model, fields_);
    if (!now) return now.error();
    made = std::move(*now);
  }
  if (made->samples.balls() > limits_.balls) {
    return error{error_code::limit_exceeded,
                 "scene editor: the model " + model->name + " has " + std::to_string(made->samples.balls()) +
                     " balls of samples, and the scene has room for " + std::to_string(limits_.balls) +
                     " of a body: raise scene_limits::balls, or field_body_settings::sample_pitch_m"};
  }
  slot out;
  out.model = model;
  out.facts = facts_of(*made, probe_->box.diagonal(), model->box.diagonal());
  out.field = std::move(made);
  out.materials = material_places::of(*model);
  return out;
}

result<void> scene_editor::check(const body_handle& body) const {
  if (has(body)) return {};
  if (body.generation == 0 || body.slot >= slots_.size() || body.generation > slots_[body.slot].generation) {
    return bad("no body of this scene was ever called slot " + std::to_string(body.slot) + ", generation " +
               std::to_string(body.generation) + ": use a handle that add() returned");
  }
  return bad("the body of slot " + std::to_string(body.slot) + ", generation " + std::to_string(body.generation) +
             " was removed: forget its handle");
}

error scene_editor::busy() {
  return {error_code::busy,
          "scene editor: the session has not taken the last change yet: commit again after its next contact tick"};
}

result<body_handle> scene_editor::add(const model_ptr& model, const pose& T_wb) { return add(model, nullptr, T_wb); }

result<body_handle> scene_editor::add(const model_ptr& model, field_body_ptr made, const pose& T_wb) {
  if (!is_valid(T_wb)) return bad("a body was added at a pose that is none: give finite numbers and a unit quaternion");
  const auto free = std::find_if(slots_.begin(), slots_.end(), [](const slot& s) { return !s.model; });
  if (free == slots_.end()) {
    return error{error_code::limit_exceeded, "scene editor: the scene has " + std::to_string(slots_.size()) +
                                                 " bodies, which is all it has room for: remove one, or raise "
                                                 "scene_limits::bodies"};
  }
  result<slot> fitted = fit(model, std::move(made));
  if (!fitted) return fitted.error();
  fitted->T_wb = T_wb;
  fitted->generation = std::max(1U, free->generation + 1U);  // 0, after 2^32 bodies, names nobody
  *free = std::move(*fitted);
  change(*free);
  return body_handle{static_cast<std::uint32_t>(free - slots_.begin()), free->generation};
}

result<void> scene_editor::remove(const body_handle& body) {
  if (const result<void> ok = check(body); !ok) return ok;
  slot free;
  free.generation = body.generation;
  slots_[body.slot] = std::move(free);
  change(slots_[body.slot]);
  return {};
}

result<void> scene_editor::place(const body_handle& body, const pose& T_wb) {
  if (const result<void> ok = check(body); !ok) return ok;
  if (!is_valid(T_wb))
    return bad("a body was placed at a pose that is none: give finite numbers and a unit quaternion");
  slots_[body.slot].T_wb = T_wb;
  change(slots_[body.slot]);
  return {};
}

result<void> scene_editor::exchange(const body_handle& body, const model_ptr& model) {
  return exchange(body, model, nullptr);
}

result<void> scene_editor::exchange(const body_handle& body, const model_ptr& model, field_body_ptr made) {
  if (const result<void> ok = check(body); !ok) return ok;
  result<slot> fitted = fit(model, std::move(made));
  if (!fitted) return fitted.error();
  fitted->T_wb = slots_[body.slot].T_wb;
  fitted->generation = body.generation;
  slots_[body.slot] = std::move(*fitted);
  change(slots_[body.slot]);
  return {};
}

bool scene_editor::has(const body_handle& body) const noexcept {
  return body.generation != 0 && body.slot < slots_.size() && slots_[body.slot].model &&
         slots_[body.slot].generation == body.generation;
}

std::optional<body_handle> scene_editor::in_slot(std::uint32_t s) const noexcept {
  if (s >= slots_.size() || !slots_[s].model) return std::nullopt;
  return body_handle{s, slots_[s].generation};
}

std::size_t scene_editor::bodies() const noexcept {
  return static_cast<std::size_t>(std::count_if(slots_.begin(), slots_.end(), [](const slot& s) { return !!s.model; }));
}

surface_pairs scene_editor::surfaces() const {
  surface_pairs out(slots_.size());
  for (std::size_t b = 0; b < slots_.size(); ++b) {
    if (!slots_[b].model) continue;
    out[b] = combined(probe_->surface, slots_[b].model->surface);
    add_mapped_pairs(*probe_, static_cast<std::uint32_t>(b), *slots_[b].model, out);
  }
  return out;
}

std::shared_ptr<const plane_scene> scene_editor::prepare() {
  auto out = std::make_shared<plane_scene>();
  const std::size_t n = slots_.size();
  out->version = ++version_;
  changed_ = false;
  out->bodies.probe = probe_;
  out->bodies.fixed.resize(n);
  out->T_wb.resize(n);
  out->generation.resize(n);
  out->since.resize(n);
  out->of.resize(n);
  out->materials.resize(n + 1);
  out->materials[0] = probe_materials_;
  out->surfaces = surfaces();
  out->probe = probe_facts_;
  out->most_balls = limits_.balls;
  auto fields = std::make_shared<field_scene>();
  fields->probe = probe_field_;
  fields->fixed.resize(n);
  std::vector<body_tree::sphere> spheres;
  spheres.reserve(n);
  std::vector<double> shallow_m(n);
  for (std::uint32_t b = 0; b < n; ++b) {
    const slot& s = slots_[b];
    out->since[b] = s.since;
    if (!s.model) continue;
    out->bodies.fixed[b] = s.model;
    out->T_wb[b] = s.T_wb;
    out->generation[b] = s.generation;
    out->of[b] = s.facts;
    out->materials[b + 1] = s.materials;
    fields->fixed[b] = s.field;
    shallow_m[b] = facing::shallow_m(s.facts.smallest_m);
    spheres.push_back({b, s.T_wb * s.facts.centre_b, s.facts.radius_m});
  }
  out->fields = std::move(fields);
  out->reader = std::make_shared<const surface_reader>(out->fields, probe_->mass.centre_of_mass, std::move(shallow_m));
  out->tree = std::make_shared<const body_tree>(std::move(spheres));
  return out;
}

result<plane_renderer> make_plane_renderer(scene_editor& editor, const plane_renderer_settings& settings) {
  if (const result<void> ok = check_reach(settings.reach_m); !ok) return ok.error();
  if (const result<void> ok = check(settings.springs); !ok) return ok.error();
  if (const result<void> ok = check_threads(settings.threads); !ok) return ok.error();
  std::shared_ptr<const plane_scene> first = editor.prepare();
  double reach_m = settings.reach_m;
  if (!(reach_m > 0.0)) {
    constexpr double usual_period_s = 1e-3, of_the_diagonal = 0.1;
    double smallest_m = first->probe.smallest_m;
    for (std::size_t b = 0; b < first->of.size(); ++b) {
      if (first->bodies.fixed[b]) smallest_m = std::min(smallest_m, first->of[b].smallest_m);
    }
    reach_m = std::min(reach_for(usual_period_s), of_the_diagonal * smallest_m);
  }
  auto known =
      std::make_shared<known_branches>(*first->fields, first->bodies.probe->mass.centre_of_mass, first->most_balls);
  auto with = shared_work_of(settings);
  plane_depth depth(*first, reach_m, settings.limits.readings(), known, with.team);
  plane_finder finder(*first, reach_m, std::move(known), std::move(with));
  return plane_renderer(std::move(first), std::move(finder), std::move(depth), plane_springs(settings.springs),
                        settings.limits);
}

}  // namespace asperity
