// Options that choose and tune the three policies; the same for query and run.
#pragma once

#include <string>
#include <vector>

#include "cli.hpp"
#include "render_choice.hpp"

namespace asperity::command {

/// --contacts, --backend, --gradient, --grid, --lookup, --gpu, --fallback and --allow-scale-mismatch.
/// @param formulations values of --contacts
void add_render_options(CLI::App& sub, render_options& options, const std::vector<std::string>& formulations);

/// grid_of() for documents.
[[nodiscard]] json grid_json(const render_options& options);
/// lookup_name() for documents.
[[nodiscard]] json lookup_json(const render_options& options);

}  // namespace asperity::command
