#include "render_options.hpp"

namespace asperity::command {

void add_render_options(CLI::App& sub, render_options& options) {
  sub.add_option("--backend", options.backend, "Depth backend")
      ->check(CLI::IsMember({"cpu", "cpu-simd", "gl-occlusion", "gl-compute"}))
      ->capture_default_str();
  sub.add_option("--gradient", options.gradient,
                 "Gradient of the depth: the paper's central differences or a soft maximum")
      ->check(CLI::IsMember({"central", "soft"}))
      ->capture_default_str();
  sub.add_option("--grid", options.grid, "Samples per side of a contact's window")
      ->check(CLI::Range(std::uint32_t{2}, depth_settings::max_grid))
      ->capture_default_str();
  sub.add_flag("--allow-scale-mismatch", options.allow_scale_mismatch,
               "Accept bodies whose sizes differ more than 500 times");
}

result<renderer_settings> chosen_settings(const render_options& options) {
  if (options.backend != "cpu") {
    return error{error_code::unsupported,
                 "the depth backend " + options.backend + " is not part of this build: use --backend cpu"};
  }
  renderer_settings settings;
  settings.depth.gradient =
      options.gradient == "central" ? gradient_scheme::central_difference : gradient_scheme::soft_max;
  settings.depth.grid = options.grid;
  return settings;
}

}  // namespace asperity::command
