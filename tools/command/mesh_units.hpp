// In what unit a mesh file's numbers are: the options --units and --scale.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "asperity/model/triangle_mesh.hpp"
#include "cli.hpp"

namespace asperity::command {

struct mesh_units {
  std::optional<double> scale;       ///< metres per unit, by --scale
  std::optional<std::string> units;  ///< by --units

  /// 1 where nothing was said.
  [[nodiscard]] double metres_per_unit() const;
};

/// The two options of one subcommand.
struct unit_option_pair {
  CLI::Option* units;
  CLI::Option* scale;
};

/// Adds the options to the subcommand; what they set stays valid as long as it.
/// @param whose "the meshes", in their help
unit_option_pair add_unit_options(CLI::App& sub, const std::shared_ptr<mesh_units>& units, const std::string& whose);

/// Brings a mesh that was read from the file to metres. Formats other than glTF do not say what their numbers mean:
/// where they would make a body that nobody holds in his hand, and no unit was said, the unit is asked for.
/// @return invalid_argument
[[nodiscard]] result<void> bring_to_metres(const mesh_units& units, const std::string& file, triangle_mesh& mesh);

/// The same for a mesh that goes with another one, which has been asked about.
void scale_to_metres(const mesh_units& units, triangle_mesh& mesh);

}  // namespace asperity::command
