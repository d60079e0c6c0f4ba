// Renderers: a pose in, a wrench out.
#include "asperity/c/renderer.h"

#include <cmath>
#include <functional>
#include <memory>

#include "approach.hpp"
#include "asperity/least_motion/least_motion_renderer.hpp"
#include "asperity/planes/plane_renderer.hpp"
#include "asperity/window/window_renderer.hpp"
#include "c/handles.hpp"
#include "c/made_renderer.hpp"

// NOLINTBEGIN(readability-identifier-naming): names of the C header
struct asperity_renderer : asperity::c::handle_mark<0x52617370U> {
  asperity_renderer(asperity::any_renderer made, std::size_t bodies) : feel(std::move(made)), T_wb(bodies) {}
  asperity::any_renderer feel;
  std::vector<asperity::pose> T_wb;
  asperity::tick last{};
};
// NOLINTEND(readability-identifier-naming)

namespace {

using namespace asperity;
using namespace asperity::c;

template <class Renderer>
result<any_renderer> erased(result<Renderer> made) {
  if (!made) return made.error();
  return any_renderer(std::move(made).value());
}

}  // namespace

namespace asperity::c {

result<any_renderer> make_any_renderer(scene bodies, const renderer_wish& wish) {
  const result<void> ok = range_check()
                              .within("stiffness_n_per_m", wish.stiffness_n_per_m, 0.0, largest_stiffness)
                              .within("period_s", wish.period_s, 1e-5, 1.0)
                              .within("reach_m", wish.reach_m, 0.0, 1.0)
                              .within("softness_m", wish.softness_m, 0.0, 1.0)
                              .within("sharpness", wish.sharpness, 0.0, 1e6)
                              .within("grid", wish.grid, 0.0, 4096.0)
                              .holds(wish.threads == 1 || wish.formulation == ASPERITY_FORMULATION_PLANES,
                                     "threads share a tick of support planes: give formulation planes, or threads 1")
                              .done();
  if (!ok) return ok.error();
  const auto stiffness = [&](double usual) { return or_usual(wish.stiffness_n_per_m, usual); };
  switch (wish.formulation) {
    case ASPERITY_FORMULATION_LEAST_MOTION: {
      least_motion_renderer_settings s;
      s.force.stiffness_n_per_m = stiffness(s.force.stiffness_n_per_m);
      s.force.period_s = wish.period_s;
      s.force.softness_m = wish.softness_m;
      s.force.sharpness = wish.sharpness;
      return erased(make_least_motion_renderer(std::move(bodies), s));
    }
    case ASPERITY_FORMULATION_PLANES: {
      plane_renderer_settings s;
      s.springs.stiffness_n_per_m = stiffness(s.springs.stiffness_n_per_m);
      s.reach_m = wish.reach_m;
      s.threads = wish.threads;
      return erased(make_plane_renderer(std::move(bodies), s));
    }
    case ASPERITY_FORMULATION_WINDOW: {
      window_renderer_settings s;
      s.force.stiffness_n_per_m = stiffness(s.force.stiffness_n_per_m);
      if (wish.grid != 0) s.depth.grid = wish.grid;
      return erased(make_window_renderer(std::move(bodies), s));
    }
    default:
      return error{error_code::invalid_argument, "formulation is none of ASPERITY_FORMULATION_...: give 0 to 3"};
  }
}

result<pose> find_start(any_renderer& feel, const quat& rotation, std::span<const pose> T_wb) {
  const command::step_function step = [&](const scene_pose& at, tick& out) { return feel.step(at, out); };
  return command::find_touch(feel.scene(), step, rotation, T_wb);
}

}  // namespace asperity::c

std::int32_t asperity_renderer_make(const asperity_model* probe, const asperity_model* const* fixed,
                                    std::uint32_t fixed_count, const asperity_renderer_settings* settings,
                                    asperity_renderer** out, asperity_error* why) {
  return guarded(why, [&] {
    if (out == nullptr) return refuse_argument(why, "out is NULL: give a place for the handle");
    *out = nullptr;
    asperity_renderer_settings s{};
    if (const std::int32_t taken = take(settings, s); taken != ASPERITY_STATUS_OK) return refuse_struct(why, taken);
    result<scene> bodies = scene_of(probe, fixed, fixed_count);
    if (!bodies) return refuse(why, bodies.error());
    const renderer_wish wish{
        .formulation = s.formulation == ASPERITY_FORMULATION_USUAL ? ASPERITY_FORMULATION_LEAST_MOTION : s.formulation,
        .stiffness_n_per_m = s.stiffness_n_per_m,
        .period_s = or_usual(s.period_s, 1e-3),
        .reach_m = s.reach_m,
        .softness_m = s.softness_m,
        .sharpness = s.sharpness,
        .grid = s.grid,
        .threads = s.threads == 0 ? 1 : s.threads};
    result<any_renderer> made = make_any_renderer(std::move(*bodies), wish);
    if (!made) return refuse(why, made.error());
    *out = std::make_unique<asperity_renderer>(std::move(*made), fixed_count).release();
    return ASPERITY_STATUS_OK;
  });
}

std::int32_t asperity_renderer_free(asperity_renderer* renderer) {
  if (renderer == nullptr) return ASPERITY_STATUS_OK;
  if (checked(renderer) == nullptr) return ASPERITY_ERROR_INVALID_ARGUMENT;
  delete renderer;
  return ASPERITY_STATUS_OK;
}

std::int32_t asperity_renderer_place_body(asperity_renderer* renderer, std::uint32_t body, const double* T_wb) {
  if (checked(renderer) == nullptr || T_wb == nullptr || body >= renderer->T_wb.size())
    return ASPERITY_ERROR_INVALID_ARGUMENT;
  const pose there = pose_of(T_wb);
  if (!is_valid(there)) return ASPERITY_STATUS_INVALID_POSE;
  renderer->T_wb[body] = there;
  return ASPERITY_STATUS_OK;
}

std::int32_t asperity_renderer_step(asperity_renderer* renderer, const double* T_wa, asperity_touch* out) {
  if (checked(renderer) == nullptr || T_wa == nullptr || !has_size(out)) return ASPERITY_ERROR_INVALID_ARGUMENT;
  tick& found = renderer->last;
  const status s = renderer->feel.step({pose_of(T_wa), renderer->T_wb}, found);
  asperity_touch full{};
  full.flags = static_cast<std::uint32_t>(found.flags);
  put(found.force.on_probe_w, full.on_probe);
  put(found.centre_of_mass_w, full.centre_of_mass_m);
  full.deepest_m = depth_of(found).deepest_m;
  full.contacts = static_cast<std::uint32_t>(found.contacts.size());
  full.dropped_contacts = static_cast<std::uint32_t>(found.dropped_contacts);
  give(out, full);
  return answer(s);
}

std::int32_t asperity_renderer_body_wrench(asperity_renderer* renderer, std::uint32_t body, double* out) {
  if (checked(renderer) == nullptr || out == nullptr || body >= renderer->T_wb.size())
    return ASPERITY_ERROR_INVALID_ARGUMENT;
  const bool told = body < renderer->last.on_body.size();
  put(told ? renderer->last.on_body[body] : wrench{}, out);
  return told ? ASPERITY_STATUS_OK : ASPERITY_STATUS_NOT_READY;
}

std::int32_t asperity_renderer_contact(asperity_renderer* renderer, std::uint32_t number, asperity_contact* out) {
  if (checked(renderer) == nullptr || !has_size(out)) return ASPERITY_ERROR_INVALID_ARGUMENT;
  asperity_contact full{};
  const tick& last = renderer->last;
  const bool told = number < last.contacts.size() && number < last.depths.size();
  if (told) {
    full.body = last.contacts[number].body;
    full.depth_m = last.depths[number].depth_m;
    put(last.depths[number].witness_w, full.point_m);
    put(last.contacts[number].window.n_ab_w, full.n_ab);
  }
  give(out, full);
  return told ? ASPERITY_STATUS_OK : ASPERITY_STATUS_NOT_READY;
}

std::int32_t asperity_renderer_find_touch(asperity_renderer* renderer, const double* rotation, double* out,
                                          asperity_error* why) {
  return guarded(why, [&] {
    if (checked(renderer) == nullptr) return refuse_argument(why, "renderer is no renderer");
    if (rotation == nullptr || out == nullptr) return refuse_argument(why, "rotation or pose is NULL");
    const pose held{quat_from_xyzw({rotation[0], rotation[1], rotation[2], rotation[3]}), vec3(0.0)};
    if (!is_valid(held)) return refuse_argument(why, "rotation is no quaternion x y z w of unit length");
    renderer->last = {};
    const result<pose> touching = find_start(renderer->feel, held.rotation, renderer->T_wb);
    if (!touching) return refuse(why, touching.error());
    put(*touching, out);
    return ASPERITY_STATUS_OK;
  });
}
