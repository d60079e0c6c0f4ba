// asperity bake: the options that add a relief to the mesh, and what is reported of it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "asperity/bake/relief.hpp"
#include "asperity/model/triangle_mesh.hpp"
#include "cli.hpp"

namespace asperity::command {

struct relief_options {
  std::string height_map;
  std::array<double, 2> height_range_m{0.0, 0.0};
  double height_scale_m = 1.0;
  std::string normal_map;
  std::string normal_y = "up";
  double normal_scale = 1.0;
  bool from_material = false;
  std::string procedural;
  double pitch_m = 0.002;
  double height_m = 0.0002;
  double diameter_m = 0.0;  ///< 0: 0.6 of the pitch
  std::array<double, 3> direction{1.0, 0.0, 0.0};
  double rms_m = 1e-5;
  double spectral_slope = 2.0;
  std::array<double, 2> wavelengths_m{0.0005, 0.01};
  std::uint64_t seed = 1;
  bool has_range = false;
  bool has_scale = false;

  /// What is to be added, in a word; empty where nothing is.
  [[nodiscard]] std::string kind() const;
  /// Images that are read, so that none of them is the file that is written.
  [[nodiscard]] std::vector<std::string> inputs() const { return {height_map, normal_map}; }
};

/// A relief, and what the report says of it.
struct relief_job {
  bake::relief relief;
  json document;     ///< for the key "relief"
  std::string text;  ///< rows
  std::vector<std::string> notes;
};

/// Adds the options to the subcommand; what they set stays valid as long as it.
void add_relief_options(CLI::App& sub, const std::shared_ptr<relief_options>& options);

/// The relief that the options ask for over the mesh, metres; none where they ask for none.
/// @param file the mesh's own file, for its material
[[nodiscard]] result<relief_job> make_relief(const relief_options& options, const triangle_mesh& mesh,
                                             const std::string& file);

}  // namespace asperity::command
