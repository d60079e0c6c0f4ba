#include "render_options.hpp"

#include <string>
#include <vector>

#include "asperity/window/window_depth_settings.hpp"

namespace asperity::command {

void add_render_options(CLI::App& sub, render_options& options, const std::vector<std::string>& formulations) {
  sub.add_option("--contacts", options.contacts,
                 (formulations.size() > 2 ? "How contacts hold the probe: by support planes; or how many become one "
                                            "force: by the least motion that clears the bodies, or the paper's windows "
                                            "and sum"
                                          : "How many contacts become one force: by the least motion that clears the "
                                            "bodies, or the paper's windows and sum"))
      ->transform(CLI::Transformer(old_contact_names()).description(""))
      ->check(CLI::IsMember(formulations))
      ->default_str(options.usual_contacts);
  sub.add_option("--backend", options.backend,
                 "Depth backend. All but cpu imply --contacts window. exact searches the maximum itself, for work at a "
                 "desk; gl-compute and gl-occlusion calculate on a GPU")
      ->check(CLI::IsMember(backend_names()))
      ->capture_default_str();
  sub.add_option("--gradient", options.gradient,
                 "Gradient of the depth with --contacts window: a soft maximum, or the paper's central differences")
      ->check(CLI::IsMember({"central", "soft"}))
      ->default_str("soft; with gl-occlusion, central");
  sub.add_option("--grid", options.grid, "Samples per side of a contact's window with --contacts window")
      ->check(CLI::Range(std::uint32_t{2}, window_depth_settings::max_grid))
      ->default_str(std::to_string(window_depth_settings{}.grid));
  sub.add_option("--lookup", options.lookup,
                 "Fine point of a sample with --contacts window: the one over it, or the paper's, of the coarse hit")
      ->check(CLI::IsMember({"exact", "paper"}))
      ->default_str("exact; with gl-occlusion, paper");
  sub.add_option("--gpu", options.gpu,
                 "GPU of gl-compute and gl-occlusion, an index or a part of a name; see `asperity devices --gpu`")
      ->type_name("DEVICE");
  sub.add_flag("--fallback", options.fallback,
               "Where the GPU fails, let the CPU answer in the same tick, and count it; an error without it");
  sub.add_flag("--allow-scale-mismatch", options.allow_scale_mismatch,
               "Accept bodies whose sizes differ more than 500 times");
}

json grid_json(const render_options& options) {
  const auto grid = grid_of(options);
  return grid ? json(*grid) : json();
}

json lookup_json(const render_options& options) {
  const auto lookup = lookup_name(options);
  return lookup ? json(*lookup) : json();
}

}  // namespace asperity::command
