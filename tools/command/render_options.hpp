// Options that choose and tune the three policies; the same for query, run and bench.
#pragma once

#include <string>

#include "chosen_renderer.hpp"
#include "cli.hpp"

namespace asperity::command {

/// --contacts, --backend, --gradient, --grid and --allow-scale-mismatch.
void add_render_options(CLI::App& sub, render_options& options);

/// What the options come to, for documents and captions.
[[nodiscard]] std::string gradient_name(const render_options& options);
[[nodiscard]] json grid_json(const render_options& options);

}  // namespace asperity::command
