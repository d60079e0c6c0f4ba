#include "render_options.hpp"

#include "asperity/depth/settings.hpp"

namespace asperity::command {

void add_render_options(CLI::App& sub, render_options& options) {
  sub.add_option("--contacts", options.contacts,
                 "How many contacts become one force: as one potential, or the paper's clusters and sum")
      ->check(CLI::IsMember({"shared", "paper"}))
      ->capture_default_str();
  sub.add_option("--backend", options.backend, "Depth backend")
      ->check(CLI::IsMember({"cpu", "cpu-simd", "gl-occlusion", "gl-compute"}))
      ->capture_default_str();
  sub.add_option("--gradient", options.gradient,
                 "Gradient of the depth with --contacts paper: a soft maximum, or the paper's central differences")
      ->check(CLI::IsMember({"central", "soft"}))
      ->default_str("soft");
  sub.add_option("--grid", options.grid, "Samples per side of a contact's window with --contacts paper")
      ->check(CLI::Range(std::uint32_t{2}, depth_settings::max_grid))
      ->default_str(std::to_string(depth_settings{}.grid));
  sub.add_flag("--allow-scale-mismatch", options.allow_scale_mismatch,
               "Accept bodies whose sizes differ more than 500 times");
}

std::string gradient_name(const render_options& options) {
  return options.contacts == "shared" ? "exact" : options.gradient.value_or("soft");
}

json grid_json(const render_options& options) {
  return options.contacts == "shared" ? json() : json(options.grid.value_or(depth_settings{}.grid));
}

}  // namespace asperity::command
