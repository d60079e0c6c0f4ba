// What the cells of a body can be told.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "asperity/core/status.hpp"
#include "asperity/model/textured_model.hpp"

namespace asperity {

/// Settings of make_surface_cells(). Lengths in metres; 0 means automatic, see resolve().
struct cell_settings {
  double sharp_edge_rad = 25.0 * std::numbers::pi / 180.0;  ///< a coarse edge that turns more than this is an edge to
                                                            ///< be felt; less is a curved surface cut in triangles
  double cell_angle_rad = 10.0 * std::numbers::pi / 180.0;  ///< triangles within this angle share a cell
  double apron_angle_rad =
      45.0 * std::numbers::pi / 180.0;  ///< a cell reaches over its neighbours as far as they turn less than this
  double apron_m = 0.0;                 ///< and as far as this from its own triangles
  double depth_limit_m = 0.0;           ///< deeper samples have faded to nothing; the fade begins halfway
  double taper_m = 0.0;                 ///< over this distance from an edge samples fade in
  double pitch_m = 0.0;                 ///< distance between the nodes of a relief map
  double sample_pitch_m = 0.0;          ///< distance between samples on a face
  double feature_pitch_m = 0.0;         ///< distance between samples along a sharp edge
  double steepest = 3.0;  ///< slope that the relief of a map is limited to: a surface seen from one direction has
                          ///< walls, and a wall has no gradient

  friend bool operator==(const cell_settings&, const cell_settings&) = default;
};

/// The same with the automatic lengths filled in.
/// - apron: 1.5 % of the diagonal. - depth limit: 10 %, and never more than the thickness under a cell.
/// - taper: 0.5 %, and at least one and a half pitches. - pitch: one texel, but half a coarse one, or the spline
///   of the map would overshoot; at least 0.05 %.
/// - sample pitch: 0.3 %, and at least one texel. - feature pitch: 0.3 %.
/// @param texel_m typical distance between texels on the coarse surface
[[nodiscard]] inline cell_settings resolve(cell_settings s, const textured_model& model, double texel_m) noexcept {
  const double diagonal = model.box.diagonal();
  if (s.apron_m <= 0.0) s.apron_m = 0.015 * diagonal;
  if (s.depth_limit_m <= 0.0) s.depth_limit_m = 0.1 * diagonal;
  if (s.pitch_m <= 0.0) s.pitch_m = std::max({0.5 * texel_m, std::min(texel_m, 0.0015 * diagonal), 5e-4 * diagonal});
  if (s.taper_m <= 0.0) s.taper_m = std::max(0.005 * diagonal, 1.5 * s.pitch_m);
  if (s.sample_pitch_m <= 0.0) s.sample_pitch_m = std::max(0.003 * diagonal, texel_m);
  if (s.feature_pitch_m <= 0.0) s.feature_pitch_m = 0.003 * diagonal;
  return s;
}

/// Says which setting is out of range and what would do.
[[nodiscard]] inline result<void> check(const cell_settings& s) {
  const auto bad = [](std::string what) { return error{error_code::invalid_argument, "cell settings: " + what}; };
  const auto length = [](double x) { return std::isfinite(x) && x >= 0.0; };
  const auto angle = [](double x) { return x > 0.0 && x < 0.5 * std::numbers::pi; };
  if (!angle(s.sharp_edge_rad)) return bad("sharp_edge_rad must lie between 0 and pi/2");
  if (!angle(s.cell_angle_rad)) return bad("cell_angle_rad must lie between 0 and pi/2");
  if (!angle(s.apron_angle_rad)) return bad("apron_angle_rad must lie between 0 and pi/2");
  if (!length(s.apron_m)) return bad("apron_m must be a finite length, or 0 for automatic");
  if (!length(s.depth_limit_m)) return bad("depth_limit_m must be a finite length, or 0 for automatic");
  if (!length(s.taper_m)) return bad("taper_m must be a finite length, or 0 for automatic");
  if (!length(s.pitch_m)) return bad("pitch_m must be a finite length, or 0 for automatic");
  if (!length(s.sample_pitch_m)) return bad("sample_pitch_m must be a finite length, or 0 for automatic");
  if (!length(s.feature_pitch_m)) return bad("feature_pitch_m must be a finite length, or 0 for automatic");
  if (!(s.steepest >= 1.0 && s.steepest <= 10.0)) return bad("steepest must lie between 1 and 10");
  return {};
}

}  // namespace asperity
