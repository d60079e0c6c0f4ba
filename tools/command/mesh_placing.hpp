// How large a mesh is to be and which way up: the options --fit and --up.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "asperity/model/triangle_mesh.hpp"
#include "cli.hpp"
#include "mesh_units.hpp"

namespace asperity::command {

struct mesh_placing {
  std::optional<double> fit_m;  ///< what the diagonal of the full mesh is to measure, by --fit
  std::string up = "z";         ///< axis of the file that becomes the model's z, by --up
};

/// Adds the options to the subcommand; what they set stays valid as long as it.
void add_placing_options(CLI::App& sub, const std::shared_ptr<mesh_placing>& placing, const unit_option_pair& units);

/// With --fit, says the scale that gives the mesh that diagonal, so that its unit is not asked for.
/// @return bad_mesh where no scale does
[[nodiscard]] result<void> fit_scale(const mesh_placing& placing, const std::string& file, const triangle_mesh& mesh,
                                     mesh_units& units);

/// Turns the mesh about the origin so that the axis `up`, x, y, z, -x, -y or -z, becomes z; a rotation by quarter turns,
/// exact.
void turn_up(const std::string& up, triangle_mesh& mesh);

/// Adds --original-up: what --up was when the original was baked. @return the option
CLI::Option* add_original_up(CLI::App& sub, std::string& up, CLI::Option* original);

}  // namespace asperity::command
