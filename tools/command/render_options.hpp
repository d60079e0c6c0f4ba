// Options that choose and tune the three policies; the same for query and run.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "asperity/core/status.hpp"
#include "asperity/depth/settings.hpp"
#include "asperity/model/scene.hpp"
#include "chosen_renderer.hpp"
#include "cli.hpp"

namespace asperity::command {

struct render_options {
  std::optional<std::string> contacts;  ///< what the backend implies where it is not given
  std::string backend = "cpu";
  std::optional<std::string> gradient;  ///< of the paper's contacts on grids only
  std::optional<std::uint32_t> grid;    ///< of the paper's contacts on grids only
  std::optional<std::string> lookup;    ///< of the paper's contacts on grids only
  std::optional<std::string> gpu;       ///< index of a GPU or part of its name; of backends on a GPU only
  bool fallback = false;                ///< of backends on a GPU only
  bool allow_scale_mismatch = false;
};

/// --contacts, --backend, --gradient, --grid, --lookup, --gpu, --fallback and --allow-scale-mismatch.
void add_render_options(CLI::App& sub, render_options& options);

/// What the options come to, for documents and captions.
[[nodiscard]] std::string formulation_name(const render_options& options);
[[nodiscard]] std::string gradient_name(const render_options& options);
[[nodiscard]] json grid_json(const render_options& options);
[[nodiscard]] json lookup_json(const render_options& options);

/// What the options come to for a depth backend on grids.
[[nodiscard]] depth_settings grid_settings(const render_options& options);

/// Says what does not go together; asked before models are loaded, which takes longer.
/// @return unsupported (a backend that is not part of this build) | invalid_argument
[[nodiscard]] result<void> check(const render_options& options);

/// The renderer that the options ask for.
/// @return what check() says, or the renderer's maker
[[nodiscard]] result<chosen_renderer> make_chosen_renderer(scene bodies, const render_options& options);

}  // namespace asperity::command
