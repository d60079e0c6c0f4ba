// The choice of contacts and depth backend, and the renderer that comes of it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "asperity/control/control_settings.hpp"
#include "asperity/core/status.hpp"
#include "asperity/model/scene.hpp"
#include "asperity/render/any_renderer.hpp"
#include "asperity/window/window_depth_settings.hpp"

namespace asperity::command {

/// What the options of the command line choose; render_options.hpp has their help.
struct render_options {
  std::optional<std::string> contacts;  ///< what the backend implies where it is not given
  /// What the backend cpu implies: a pose alone has no loop that planes could use.
  std::string usual_contacts = "least-motion";
  std::string backend = "cpu";
  std::optional<std::string> gradient;  ///< of windows on grids only
  std::optional<std::uint32_t> grid;    ///< of windows on grids only
  std::optional<std::string> lookup;    ///< of windows on grids only
  std::optional<std::string> gpu;       ///< index of a GPU or part of its name; of backends on a GPU only
  bool fallback = false;                ///< of backends on a GPU only
  bool allow_scale_mismatch = false;
  /// Of the loops that render and use contacts, where there are any: planes are reported as far as these need, and the
  /// least motion is as soft as these can follow.
  loop_periods periods{};
  unsigned threads = 1;                       ///< that share a tick; of planes only
  void (*set_up_helper)(unsigned) = nullptr;  ///< called once in each of them but the caller's
  double motion_scale = 1.0;                  ///< workspace_map::scale: hands are faster in a world that is made larger
  /// Of the least motion, N/m. For experiments: the command line has no option for it.
  std::optional<double> contact_stiffness_n_per_m;
  /// Of windows on grids with central differences, m; 0: the backend's choice. For experiments: the
  /// command line has no option for it.
  double difference_step_m = 0.0;
};

/// Every value of --backend, those that are not part of this build too.
[[nodiscard]] std::vector<std::string> backend_names();

/// The names that --contacts had before, each with its name of today. They are still accepted.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> old_contact_names();

/// What the options come to, for documents and captions.
[[nodiscard]] std::string formulation_name(const render_options& options);
[[nodiscard]] std::string gradient_name(const render_options& options);
/// Samples per side of a contact's window; nothing where depths are not sampled.
[[nodiscard]] std::optional<std::uint32_t> grid_of(const render_options& options);
/// Which fine point stands for a sample; nothing where depths are not sampled.
[[nodiscard]] std::optional<std::string> lookup_name(const render_options& options);

/// The same for a depth backend on a grid. @pre grid_of() has a value
[[nodiscard]] window_depth_settings grid_settings(const render_options& options);

/// Says what does not go together; asked before models are loaded, which takes longer.
/// @return unsupported (a backend that is not part of this build) | invalid_argument
[[nodiscard]] result<void> check(const render_options& options);

/// The renderer that the options ask for.
/// @return what check() says, or the renderer's maker
[[nodiscard]] result<any_renderer> make_chosen_renderer(scene bodies, const render_options& options);

}  // namespace asperity::command
