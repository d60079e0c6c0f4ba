#include "render_choice.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "asperity/window/window_depth_settings.hpp"
#include "render_kinds.hpp"

namespace asperity::command {
namespace {

/// How a backend takes the depth in a contact's window.
enum class depth_kind : std::uint8_t {
  searched,   ///< not on a grid of samples: --gradient, --grid and --lookup mean nothing
  sampled,    ///< on a grid, both gradients and both lookups
  as_printed  ///< on a grid, by central differences of the paper's lookup alone
};

/// A value of --backend.
struct backend_choice {
  const char* name;
  renderer_maker*
      least_motion;        ///< with --contacts least-motion; null: none, and the backend implies --contacts window
  renderer_maker* planes;  ///< with --contacts planes; null: the backend has none
  renderer_maker* window;  ///< with --contacts window; all null: not part of this build
  depth_kind depth;
  bool on_gpu;
};

#ifdef ASPERITY_HAS_GL
constexpr renderer_maker* gl_compute = make_window_with_gl_compute;
constexpr renderer_maker* gl_occlusion = make_window_with_gl_occlusion;
#else
constexpr renderer_maker* gl_compute = nullptr;
constexpr renderer_maker* gl_occlusion = nullptr;
#endif

constexpr std::array backends{
    backend_choice{"cpu", make_least_motion_on_cpu, make_planes_on_cpu, make_window_on_cpu, depth_kind::sampled, false},
    backend_choice{"exact", nullptr, nullptr, make_window_with_exact, depth_kind::searched, false},
    backend_choice{"cpu-simd", nullptr, nullptr, nullptr, depth_kind::sampled, false},
    backend_choice{"gl-occlusion", nullptr, nullptr, gl_occlusion, depth_kind::as_printed, true},
    backend_choice{"gl-compute", nullptr, nullptr, gl_compute, depth_kind::sampled, true},
};

/// @pre the name is one of them: the command line lets no other through
const backend_choice& backend_of(const render_options& options) {
  return *std::find_if(backends.begin(), backends.end(), [&](const auto& b) { return options.backend == b.name; });
}

bool is_built(const backend_choice& b) { return b.window != nullptr; }

error contradiction(std::string what) { return {error_code::invalid_argument, std::move(what)}; }

bool on_grid(const render_options& options) {
  return formulation_name(options) == "window" && backend_of(options).depth != depth_kind::searched;
}

/// The first of the options given that belong to depths on a grid, or nothing.
const char* given_for_grid(const render_options& options) {
  return options.gradient ? "--gradient" : options.grid ? "--grid" : options.lookup ? "--lookup" : nullptr;
}

result<void> check_gpu(const backend_choice& backend, const render_options& options) {
  if (backend.on_gpu) return {};
  if (options.gpu) return contradiction("--gpu chooses among GPUs: add --backend gl-compute or gl-occlusion");
  if (options.fallback) {
    return contradiction("--fallback is for a GPU that fails: add --backend gl-compute or gl-occlusion");
  }
  return {};
}

result<void> check_as_printed(const render_options& options) {
  if (options.gradient == "soft") {
    return contradiction(
        "--gradient soft needs the depth of every sample, and a query tells the largest alone: leave it "
        "out with --backend " +
        options.backend);
  }
  if (options.lookup == "exact") {
    return contradiction("--lookup exact is not how --backend " + options.backend +
                         " draws: leave it out, or use --backend gl-compute");
  }
  return {};
}

}  // namespace

std::vector<std::string> backend_names() {
  std::vector<std::string> names;
  for (const backend_choice& b : backends) names.emplace_back(b.name);
  return names;
}

std::vector<std::pair<std::string, std::string>> old_contact_names() {
  return {{"field", "planes"}, {"shared", "least-motion"}, {"paper", "window"}};
}

std::string formulation_name(const render_options& options) {
  return options.contacts.value_or(backend_of(options).least_motion != nullptr ? options.usual_contacts : "window");
}

std::string gradient_name(const render_options& options) {
  if (!on_grid(options)) return "exact";
  return options.gradient.value_or(backend_of(options).depth == depth_kind::as_printed ? "central" : "soft");
}

std::optional<std::uint32_t> grid_of(const render_options& options) {
  if (!on_grid(options)) return std::nullopt;
  return options.grid.value_or(window_depth_settings{}.grid);
}

std::optional<std::string> lookup_name(const render_options& options) {
  if (!on_grid(options)) return std::nullopt;
  return options.lookup.value_or(backend_of(options).depth == depth_kind::as_printed ? "paper" : "exact");
}

window_depth_settings grid_settings(const render_options& options) {
  window_depth_settings settings;
  settings.gradient =
      gradient_name(options) == "central" ? gradient_scheme::central_difference : gradient_scheme::soft_max;
  settings.parallax = lookup_name(options) == "paper" ? parallax_mode::paper_lookup : parallax_mode::exact;
  if (options.grid) settings.grid = *options.grid;
  settings.difference_step_m = options.difference_step_m;
  return settings;
}

result<void> check(const render_options& options) {
  const backend_choice& backend = backend_of(options);
  if (!is_built(backend)) {
    return error{error_code::unsupported,
                 "the depth backend " + options.backend + " is not part of this build: use --backend cpu" +
                     (backend.on_gpu ? ", or configure with -DASPERITY_BUILD_GL=ON and OpenGL's headers (Debian: "
                                       "libegl-dev, libgl-dev)"
                                     : "")};
  }
  const bool without_windows = options.contacts && options.contacts != "window";
  if (backend.least_motion == nullptr && without_windows) {
    return contradiction("--backend " + options.backend + " looks into the windows of contacts: leave out --contacts " +
                         *options.contacts);
  }
  if (const result<void> ok = check_gpu(backend, options); !ok) return ok;
  if (options.threads > 1 && formulation_name(options) != "planes") {
    return contradiction("--threads share a tick of support planes: leave it out, or use --contacts planes");
  }
  if (const char* const given = given_for_grid(options); given != nullptr && !on_grid(options)) {
    return contradiction(given +
                         (formulation_name(options) != "window"
                              ? std::string(" belongs to contacts with windows: add --contacts window")
                              : " belongs to depths on a grid: leave it out with --backend " + options.backend));
  }
  return backend.depth == depth_kind::as_printed ? check_as_printed(options) : result<void>();
}

result<any_renderer> make_chosen_renderer(scene bodies, const render_options& options) {
  if (const result<void> ok = check(options); !ok) return ok.error();
  const backend_choice& backend = backend_of(options);
  const std::string formulation = formulation_name(options);
  renderer_maker* const make = formulation == "least-motion"
                                   ? backend.least_motion
                                   : (formulation == "planes" ? backend.planes : backend.window);
  return make(std::move(bodies), options);
}

}  // namespace asperity::command
