#include "render_choice.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "asperity/depth/settings.hpp"
#include "render_kinds.hpp"

namespace asperity::command {
namespace {

/// A value of --backend.
struct backend_choice {
  const char* name;
  renderer_maker* shared;  ///< with --contacts shared; null: the backend has none, and implies --contacts paper
  renderer_maker* paper;   ///< with --contacts paper; both null: not part of this build
  bool on_grid;            ///< the paper's depth is sampled: --gradient and --grid mean something
};

constexpr std::array backends{
    backend_choice{"cpu", make_shared_on_cpu, make_paper_on_cpu, true},
    backend_choice{"exact", nullptr, make_paper_with_exact, false},
    backend_choice{"cpu-simd", nullptr, nullptr, true},
    backend_choice{"gl-occlusion", nullptr, nullptr, true},
    backend_choice{"gl-compute", nullptr, nullptr, true},
};

/// @pre the name is one of them: the command line lets no other through
const backend_choice& backend_of(const render_options& options) {
  return *std::find_if(backends.begin(), backends.end(), [&](const auto& b) { return options.backend == b.name; });
}

bool is_built(const backend_choice& b) { return b.paper != nullptr; }

}  // namespace

std::vector<std::string> backend_names() {
  std::vector<std::string> names;
  for (const backend_choice& b : backends) names.emplace_back(b.name);
  return names;
}

std::string formulation_name(const render_options& options) {
  return options.contacts.value_or(backend_of(options).shared != nullptr ? "shared" : "paper");
}

std::string gradient_name(const render_options& options) {
  const bool sampled = formulation_name(options) == "paper" && backend_of(options).on_grid;
  return sampled ? options.gradient.value_or("soft") : "exact";
}

std::optional<std::uint32_t> grid_of(const render_options& options) {
  if (formulation_name(options) != "paper" || !backend_of(options).on_grid) return std::nullopt;
  return options.grid.value_or(depth_settings{}.grid);
}

result<void> check(const render_options& options) {
  const backend_choice& backend = backend_of(options);
  if (!is_built(backend)) {
    return error{error_code::unsupported,
                 "the depth backend " + options.backend + " is not part of this build: use --backend cpu"};
  }
  const auto contradiction = [](std::string what) { return error{error_code::invalid_argument, std::move(what)}; };
  if (backend.shared == nullptr && options.contacts == "shared") {
    return contradiction("--backend " + options.backend +
                         " looks into the windows of the paper's contacts: leave out --contacts shared");
  }
  if (!options.gradient && !options.grid) return {};
  const std::string option = options.gradient ? "--gradient" : "--grid";
  if (formulation_name(options) == "shared") {
    return contradiction(option + " belongs to the paper's contacts: add --contacts paper");
  }
  if (!backend.on_grid) {
    return contradiction(option + " belongs to depths on a grid: leave it out with --backend " + options.backend);
  }
  return {};
}

result<chosen_renderer> make_chosen_renderer(scene bodies, const render_options& options) {
  if (const result<void> ok = check(options); !ok) return ok.error();
  const backend_choice& backend = backend_of(options);
  return (formulation_name(options) == "shared" ? backend.shared : backend.paper)(std::move(bodies), options);
}

}  // namespace asperity::command
