#include "renderer_source.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "asperity/planes/plane_renderer.hpp"
#include "asperity/window/window_renderer.hpp"
#include "exact/exact_renderer.hpp"
#include "gpu_renderers.hpp"
#include "plane_reach.hpp"

namespace asperity::python {
namespace {

template <class Renderer>
result<any_renderer> erased(result<Renderer> made) {
  if (!made) return made.error();
  return any_renderer(std::move(made).value());
}

error no_choice(const std::string& name, const std::string& given, const std::string& choices) {
  return {error_code::invalid_argument, name + " is '" + given + "': give " + choices};
}

result<void> check(const renderer_wish& wish) {
  const std::string& f = wish.formulation;
  if (f != "least-motion" && f != "planes" && f != "window" && f != "exact")
    return no_choice("formulation", f, "least-motion, planes, window or exact");
  const std::string& b = wish.backend;
  if (b != "cpu" && b != "gl-compute" && b != "gl-occlusion")
    return no_choice("backend", b, "cpu, gl-compute or gl-occlusion");
  if (b != "cpu" && f != "window") {
    return error{error_code::invalid_argument,
                 "backend '" + b + "' looks into the windows of contacts: leave formulation='" + f + "' out"};
  }
  if (b == "cpu" && (!wish.gpu.empty() || wish.fallback)) {
    return error{error_code::invalid_argument,
                 std::string(wish.fallback ? "fallback is for a GPU that fails" : "gpu chooses among GPUs") +
                     ": add backend='gl-compute' or 'gl-occlusion'"};
  }
  if (b == "gl-occlusion" && wish.gradient != "central") {
    return error{error_code::invalid_argument,
                 "gradient='soft' needs the depth of every sample, and a query tells the largest alone: leave it out "
                 "with backend='gl-occlusion'"};
  }
  if (b == "gl-occlusion" && wish.lookup != "paper") {
    return error{error_code::invalid_argument,
                 "lookup='exact' is not how backend='gl-occlusion' draws: leave it out, or use backend='gl-compute'"};
  }
  if (wish.gradient != "soft" && wish.gradient != "central")
    return no_choice("gradient", wish.gradient, "soft or central");
  if (wish.lookup != "exact" && wish.lookup != "paper") return no_choice("lookup", wish.lookup, "exact or paper");
  if (const result<void> ok = check_threads(wish.threads); !ok) return ok;
  if (wish.threads > 1 && f != "planes")
    return error{error_code::invalid_argument,
                 "threads share a step of planes: leave it out, or give formulation='planes'"};
  if (!(wish.period_s > 0.0 && std::isfinite(wish.period_s)))
    return error{error_code::invalid_argument, "period_s has to be above 0: the time between two steps, s"};
  if (!(wish.stiffness_n_per_m >= 0.0 && std::isfinite(wish.stiffness_n_per_m)))
    return error{error_code::invalid_argument, "stiffness_n_per_m has to be above 0, or None for the usual one"};
  return {};
}

double seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

}  // namespace

result<renderer_source> renderer_source::make(scene bodies, renderer_wish wish) {
  if (const result<void> ok = check_has_fixed_body(bodies); !ok) return ok.error();
  if (const result<void> ok = check(wish); !ok) return ok.error();
  renderer_source out(std::move(bodies), std::move(wish));
  if (out.remembers()) return out;
  result<field_scene> fields = make_field_scene(out.bodies_);
  if (!fields) return fields.error();
  out.fields_ = std::make_shared<const field_scene>(std::move(fields).value());
  if (out.wish_.formulation == "least-motion") out.exits_ = exits::make_exit_scene(*out.fields_);
  return out;
}

result<renderer_source> renderer_source::make(std::shared_ptr<scene_handle> edited, renderer_wish wish) {
  if (const result<void> ok = check(wish); !ok) return ok.error();
  renderer_source out({edited->probe, {}}, std::move(wish));
  out.edited_ = std::move(edited);
  return out;
}

double renderer_source::reach_now(double wanted_m) const {
  if (!edited_) return command::plane_reach_m(bodies_, wanted_m);
  const std::lock_guard lock(edited_->busy);
  return command::plane_reach_m(edited_->now(), wanted_m);
}

result<any_renderer> renderer_source::another(scene_seen* seen) const {
  if (wish_.formulation == "least-motion") return least_motion(wish_.period_s);
  if (wish_.formulation == "planes") return planes(usual_reach(), wish_.threads, seen);
  return wish_.formulation == "exact" ? exact() : window();
}

result<any_renderer> renderer_source::another_alone() const {
  return wish_.formulation == "planes" ? planes(usual_reach(), 1, nullptr) : another();
}

double renderer_source::usual_reach() const {
  return wish_.reach_m > 0.0 ? wish_.reach_m : reach_now(reach_for(wish_.period_s));
}

result<any_renderer> renderer_source::another_for(const loop_periods& periods, double motion_scale,
                                                  scene_seen* seen) const {
  if (wish_.formulation == "least-motion") return least_motion(seconds(periods.renewal_ns()));
  if (wish_.formulation == "planes" && !(wish_.reach_m > 0.0)) {
    const double wanted_m = reach_for(seconds(periods.contact_ns), seconds(periods.device_ns));
    return planes(reach_now(std::max(1.0, motion_scale) * wanted_m), wish_.threads, seen);
  }
  return another(seen);
}

result<any_renderer> renderer_source::least_motion(double period_s) const {
  least_motion_renderer_settings settings;
  settings.force.period_s = period_s;
  settings.force.softness_m = wish_.softness_m;
  settings.force.sharpness = wish_.sharpness;
  settings.reach_m = wish_.reach_m;
  if (wish_.stiffness_n_per_m > 0.0) settings.force.stiffness_n_per_m = wish_.stiffness_n_per_m;
  return erased(make_least_motion_renderer(bodies_, fields_, exits_, settings));
}

result<any_renderer> renderer_source::planes(double reach_m, unsigned threads, scene_seen* seen) const {
  plane_renderer_settings settings;
  settings.reach_m = reach_m;
  settings.threads = threads;
  if (wish_.stiffness_n_per_m > 0.0) settings.springs.stiffness_n_per_m = wish_.stiffness_n_per_m;
  if (edited_) {
    const std::lock_guard lock(edited_->busy);
    result<any_renderer> made = erased(make_plane_renderer(edited_->editor, settings));
    if (made && seen != nullptr) *seen = {edited_->changes, edited_->editor.version()};
    return made;
  }
  return erased(make_plane_renderer(bodies_, fields_, settings));
}

result<any_renderer> renderer_source::window() const {
  window_renderer_settings settings;
  settings.depth.gradient =
      wish_.gradient == "central" ? gradient_scheme::central_difference : gradient_scheme::soft_max;
  settings.depth.parallax = wish_.lookup == "paper" ? parallax_mode::paper_lookup : parallax_mode::exact;
  settings.depth.grid = wish_.grid;
  if (wish_.stiffness_n_per_m > 0.0) settings.force.stiffness_n_per_m = wish_.stiffness_n_per_m;
  if (wish_.backend != "cpu") return make_window_on_gpu(bodies_, wish_, settings);
  return erased(make_window_renderer(bodies_, settings));
}

result<any_renderer> renderer_source::exact() const {
  exact_renderer_settings settings;
  if (wish_.stiffness_n_per_m > 0.0) settings.force.stiffness_n_per_m = wish_.stiffness_n_per_m;
  return erased(make_exact_renderer(bodies_, settings));
}

}  // namespace asperity::python
