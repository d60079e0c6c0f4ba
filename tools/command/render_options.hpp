// Options that choose and tune the three policies; the same for query, run and bench.
#pragma once

#include <cstdint>
#include <string>

#include "asperity/asperity.hpp"
#include "cli.hpp"

namespace asperity::command {

struct render_options {
  std::string backend = "cpu";
  std::string gradient = "soft";
  std::uint32_t grid = depth_settings{}.grid;
  bool allow_scale_mismatch = false;
};

/// --backend, --gradient, --grid and --allow-scale-mismatch.
void add_render_options(CLI::App& sub, render_options& options);

/// The settings that the options ask for.
/// @return unsupported where the backend is known but not part of this build
[[nodiscard]] result<renderer_settings> chosen_settings(const render_options& options);

}  // namespace asperity::command
