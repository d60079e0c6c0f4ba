#include "backend_times.hpp"

#include <algorithm>
#include <array>
#include <random>
#include <utility>

#include "approach.hpp"
#include "asperity/gl/compute_depth.hpp"
#include "asperity/gl/uploaded_model.hpp"
#include "asperity/window/window_renderer.hpp"
#include "interrupt.hpp"
#include "wall_seconds.hpp"
#include "window_on_gpu.hpp"

namespace asperity::command {
namespace {

constexpr std::array<std::size_t, 4> sizes{1, 7, 64, 256};
constexpr std::size_t pairs = 4096;

double median(std::vector<double> seconds) {
  const auto middle = seconds.begin() + static_cast<std::ptrdiff_t>((seconds.size() - 1) / 2);
  std::nth_element(seconds.begin(), middle, seconds.end());
  return *middle;
}

error not_answered(const std::string& backend, status s) {
  return {error_code::unsupported, backend + " did not answer (" + to_string(s) + "): the ratios would mean nothing"};
}

/// The contact that is repeated, where the bodies are, and how they move for the pairs.
struct workload {
  contact what;
  std::vector<std::uint32_t> patch_a, patch_b;
  pose T_wa;
  std::vector<pose> T_wb;
  std::vector<pose> T_wa_of_pair;

  [[nodiscard]] contact_limits limits(std::size_t contacts) const {
    return {.contacts = contacts, .triangles = contacts * (patch_a.size() + patch_b.size())};
  }
  [[nodiscard]] contact_set repeated(std::size_t times) const {
    contact_set out(limits(times));
    for (std::size_t i = 0; i < times; ++i) static_cast<void>(out.add(what, patch_a, patch_b));
    return out;
  }
};

result<workload> make_workload(const scene& bodies, std::uint64_t seed) {
  result<window_renderer> feel = make_window_renderer(bodies);
  if (!feel) return feel.error();
  workload out;
  out.T_wb.resize(bodies.fixed.size());
  const step_function step = [&](const scene_pose& at, tick& found) { return feel->step(at, found); };
  const result<pose> touch = find_touch(bodies, step, quat(1.0, 0.0, 0.0, 0.0), out.T_wb);
  if (!touch) return touch.error();
  out.T_wa = *touch;
  out.T_wa.position.z -= std::min(0.0005, 0.005 * bodies.probe->box.diagonal());
  tick found;
  const status s = feel->step({out.T_wa, out.T_wb}, found);
  if ((s != status::ok && s != status::capacity_reached) || found.contacts.empty()) {
    return error{error_code::invalid_argument, "the bodies do not touch: choose other models"};
  }
  const auto shallower = [](const penetration& a, const penetration& b) { return a.depth_m < b.depth_m; };
  const auto deepest = std::max_element(found.depths.begin(), found.depths.end(), shallower) - found.depths.begin();
  out.what = found.contacts[static_cast<std::size_t>(deepest)];
  const auto a = feel->found().patch_a(out.what), b = feel->found().patch_b(out.what);
  out.patch_a.assign(a.begin(), a.end());
  out.patch_b.assign(b.begin(), b.end());

  std::mt19937_64 bits(seed);
  const auto unit = [&] { return 2.0 * static_cast<double>(bits() >> 11) * 0x1.0p-53 - 1.0; };
  const double shift_m = 0.2 * out.what.window.half_size_m;
  for (std::size_t i = 0; i < pairs; ++i) {
    pose T = out.T_wa;
    T.position += vec3(shift_m * unit(), shift_m * unit(), 0.1 * shift_m * unit());
    out.T_wa_of_pair.push_back(T);
  }
  return out;
}

/// A backend under test: its figures so far, and how to ask it.
struct candidate {
  backend_times times;
  any_depth depth;
  std::size_t reference = 0;     ///< index of the CPU backend with the same settings
  std::size_t device_bytes = 0;  ///< beyond the models
};

window_depth_settings settings_of(const backend_bench& options, gradient_scheme gradient) {
  window_depth_settings s;
  s.gradient = gradient;
  s.grid = options.grid;
  // Central differences are the paper's, so with its lookup: both backends on a GPU can do that.
  if (gradient == gradient_scheme::central_difference) s.parallax = parallax_mode::paper_lookup;
  return s;
}

backend_times named(const char* backend, const window_depth_settings& s) {
  return {.backend = backend,
          .gradient = s.gradient == gradient_scheme::soft_max ? "soft" : "central",
          .lookup = s.parallax == parallax_mode::exact ? "exact" : "paper"};
}

/// One at a time, as a loop without a batch interface has to.
status one_by_one(any_depth& depth, const workload& work, contact_set& one, std::span<penetration> out) {
  for (std::size_t i = 0; i < pairs; ++i) {
    const status s = depth.measure({work.T_wa_of_pair[i], work.T_wb}, one, out.subspan(i, 1));
    if (s != status::ok) return s;
  }
  return status::ok;
}

result<std::vector<candidate>> make_candidates(const scene& bodies, const backend_bench& options,
                                               const gl::context_ptr& context, const contact_limits& limits) {
  std::vector<candidate> out;
  const auto add_gpu = [&](const char* name, gpu_depth_maker* make, gradient_scheme gradient,
                           std::size_t reference) -> result<void> {
    const window_depth_settings s = settings_of(options, gradient);
    const std::size_t before = context->device_bytes();
    result<any_depth> made = error{error_code::unsupported, ""};
    backend_times times = named(name, s);
    times.set_up_s = wall_seconds([&] { made = make(context, bodies, s, limits); });
    if (!made) return made.error();
    out.push_back({std::move(times), std::move(made).value(), reference, context->device_bytes() - before});
    return {};
  };
  for (const gradient_scheme gradient : {gradient_scheme::soft_max, gradient_scheme::central_difference}) {
    const window_depth_settings s = settings_of(options, gradient);
    result<cpu_depth> made = make_cpu_depth(bodies, s);
    if (!made) return made.error();
    out.push_back({named("cpu", s), any_depth(std::move(made).value()), out.size()});
  }
  if (options.backend != "gl-occlusion") {
    for (const auto& [gradient, reference] : {std::pair{gradient_scheme::soft_max, std::size_t{0}},
                                              std::pair{gradient_scheme::central_difference, std::size_t{1}}}) {
      if (result<void> ok = add_gpu("gl-compute", make_gl_compute_depth, gradient, reference); !ok) return ok.error();
    }
  }
  if (options.backend != "gl-compute") {
    if (result<void> ok = add_gpu("gl-occlusion", make_gl_occlusion_depth, gradient_scheme::central_difference, 1);
        !ok) {
      return ok.error();
    }
  }
  return out;
}

/// `n` contacts on every backend, each with room for so many; adds to the figures of the sizes before.
result<void> time_ticks(std::vector<candidate>& all, std::size_t n, const workload& work, const backend_bench& options,
                        progress_line& progress) {
  std::vector<penetration> depths(n);
  const contact_set contacts = work.repeated(n);
  status answered = status::ok;
  const auto time = [&](candidate& c) {
    return wall_seconds([&] { answered = c.depth.measure({work.T_wa, work.T_wb}, contacts, depths); });
  };
  for (candidate& c : all) {
    c.times.first_tick_s = time(c);
    if (answered != status::ok) return not_answered(c.times.backend, answered);
    c.times.ticks.push_back({.contacts = n, .device_bytes = c.device_bytes, .seconds = {}});
  }
  for (std::size_t i = 0; i < options.repeats; ++i) {
    progress.show(std::to_string(n) + " contacts", static_cast<double>(i) / static_cast<double>(options.repeats));
    for (candidate& c : all) {
      if (interrupted()) return error{error_code::cancelled, "interrupted: nothing was written"};
      c.times.ticks.back().seconds.push_back(time(c));
      if (answered != status::ok) return not_answered(c.times.backend, answered);
    }
  }
  for (candidate& c : all) {
    contacts_timed& t = c.times.ticks.back();
    t.cpu_ratio = median(t.seconds) / median(all[c.reference].times.ticks.back().seconds);
  }
  return {};
}

/// All sizes. Set-up and first tick are those of the first size: later ones find shaders that are compiled.
result<std::vector<candidate>> time_sizes(const scene& bodies, const backend_bench& options,
                                          const gl::context_ptr& context, const workload& work,
                                          progress_line& progress) {
  std::vector<candidate> all;
  for (const std::size_t n : sizes) {
    result<std::vector<candidate>> now = make_candidates(bodies, options, context, work.limits(n));
    if (!now) return now.error();
    if (result<void> ok = time_ticks(*now, n, work, options, progress); !ok) return ok.error();
    if (all.empty()) {
      all = std::move(now).value();
      continue;
    }
    for (std::size_t i = 0; i < all.size(); ++i) {
      all[i].times.ticks.push_back(std::move((*now)[i].times.ticks.front()));
    }
  }
  return all;
}

/// The backend that has a batch, for as many pairs at a time as the device's buffers hold.
struct batch_backend {
  gl::compute_depth depth;
  std::size_t at_once;
  std::size_t device_bytes;
};

result<batch_backend> make_batch(const scene& bodies, const workload& work, const window_depth_settings& settings,
                                 const gl::context_ptr& context) {
  for (std::size_t at_once = pairs;; at_once /= 2) {
    const contact_limits limits = work.limits(at_once);
    const std::size_t before = context->device_bytes();
    result<gl::compute_depth> made = gl::compute_depth::make(
        context, bodies, settings, {.contacts = limits.contacts, .triangles = limits.triangles});
    if (made) return batch_backend{std::move(made).value(), at_once, context->device_bytes() - before};
    if (made.error().code != error_code::limit_exceeded || at_once == 1) return made.error();
  }
}

/// 4096 pairs with the soft maximum: on the CPU one by one, on the GPU by measure_each().
result<void> time_batch(std::vector<candidate>& all, const scene& bodies, const workload& work,
                        const backend_bench& options, const gl::context_ptr& context, progress_line& progress) {
  if (options.backend == "gl-occlusion") return {};
  result<batch_backend> gpu = make_batch(bodies, work, settings_of(options, gradient_scheme::soft_max), context);
  if (!gpu) return gpu.error();
  const contact_set contacts = work.repeated(gpu->at_once);
  contact_set one = work.repeated(1);
  std::vector<gl::pose_pair> at;
  for (const pose& T : work.T_wa_of_pair) at.push_back({T, work.T_wb[work.what.body]});
  std::vector<penetration> depths(pairs);
  const auto all_pairs = [&] {
    for (std::size_t first = 0; first < pairs; first += gpu->at_once) {
      const status s = gpu->depth.measure_each(std::span(at).subspan(first, gpu->at_once), contacts,
                                               std::span(depths).subspan(first, gpu->at_once));
      if (s != status::ok) return s;
    }
    return status::ok;
  };
  const auto is_soft = [](const char* backend) {
    return [backend](const candidate& c) { return c.times.backend == backend && c.times.gradient == "soft"; };
  };
  candidate& cpu = *std::find_if(all.begin(), all.end(), is_soft("cpu"));
  candidate& compute = *std::find_if(all.begin(), all.end(), is_soft("gl-compute"));
  contacts_timed on_cpu{.contacts = pairs, .calls = pairs, .seconds = {}};
  contacts_timed on_gpu{
      .contacts = pairs, .calls = pairs / gpu->at_once, .device_bytes = gpu->device_bytes, .seconds = {}};
  status answered = all_pairs();  // not counted: the driver may compile for a new size
  for (std::size_t i = 0; i < std::max<std::size_t>(1, options.repeats / 4); ++i) {
    if (interrupted()) return error{error_code::cancelled, "interrupted: nothing was written"};
    progress.show("batch", 4.0 * static_cast<double>(i) / static_cast<double>(options.repeats));
    if (answered != status::ok) return not_answered("the batch", answered);
    on_gpu.seconds.push_back(wall_seconds([&] { answered = all_pairs(); }));
    if (answered != status::ok) return not_answered("the batch", answered);
    on_cpu.seconds.push_back(wall_seconds([&] { answered = one_by_one(cpu.depth, work, one, depths); }));
    if (answered != status::ok) return not_answered("the batch", answered);
  }
  on_gpu.cpu_ratio = median(on_gpu.seconds) / median(on_cpu.seconds);
  cpu.times.batch = std::move(on_cpu);
  compute.times.batch = std::move(on_gpu);
  return {};
}

}  // namespace

result<bench_of_backends> time_backends(const scene& bodies, const backend_bench& options, progress_line& progress) {
  const result<gl::context_ptr> context = gl::open_context({.device = options.gpu.value_or("")});
  if (!context) return context.error();
  const result<workload> work = make_workload(bodies, options.seed);
  if (!work) return work.error();
  // Held from here on, so that the models' memory is no backend's.
  const result<gl::uploaded_scene> models = [&] {
    const gl::current_scope here(*context);
    return gl::upload(*context, bodies);
  }();
  if (!models) return models.error();
  const std::size_t model_bytes = (*context)->device_bytes();
  result<std::vector<candidate>> all = time_sizes(bodies, options, *context, *work, progress);
  if (!all) return all.error();
  if (result<void> ok = time_batch(*all, bodies, *work, options, *context, progress); !ok) return ok.error();

  bench_of_backends out;
  const gl::context_facts& facts = (*context)->facts();
  out.gpu.device = facts.renderer;
  out.gpu.version = facts.version;
  out.gpu.software = facts.software;
  out.gpu.device_bytes = model_bytes;
  out.patch_triangles = work->patch_a.size() + work->patch_b.size();
  for (candidate& c : *all) out.backends.push_back(std::move(c.times));
  if (options.backend == "gl-occlusion") return out;
  // A device of software takes as long for a pose as the processor, or longer.
  result<std::vector<bench_of_planes>> planes =
      time_planes(bodies, *context, facts.software ? 64 : 1024, options.repeats, options.seed, progress);
  if (!planes) return planes.error();
  out.planes = std::move(planes).value();
  return out;
}

}  // namespace asperity::command
