// Last stage of the bake: how far the textured surface and the original are apart.
#pragma once

#include <vector>

#include "asperity/core/status.hpp"
#include "asperity/model/textured_model.hpp"
#include "asperity/model/triangle_mesh.hpp"
#include "bake/lost_area.hpp"
#include "bake/stage_monitor.hpp"
#include "bake/triangle_bvh.hpp"

namespace asperity::bake {

/// Distances in metres.
struct surface_error {
  length_spread to_original;  ///< from the textured surface to the original
  length_spread to_textured;  ///< from the original to the textured surface
  double to_original_rms_m = 0.0;
  double to_textured_rms_m = 0.0;
  double crack_max_m = 0.0;  ///< largest gap between the two sides of a coarse edge
  lost_area lost;

  [[nodiscard]] double rms_m() const noexcept;
  [[nodiscard]] double max_m() const noexcept;
};

/// Original surface farther from the textured surface than so many texels counts as lost.
inline constexpr double lost_reach_texels = 2.0;

/// Measures the two surfaces as they are used. The textured surface is sampled through haptic_texture::sample about
/// once per texel, coarse edges and corners included, and triangulated between the samples; the original is sampled at
/// its vertices, and on its large triangles every few texels. Each sample is taken to the closest point of the other
/// surface and weighted with the area that it stands for.
/// @param texel_m edge of a texel on the coarse surface
/// @return cancelled
[[nodiscard]] result<surface_error> measure(const triangle_mesh& full, const triangle_bvh& full_tree,
                                            const coarse_mesh& coarse, const haptic_texture& texture, double texel_m,
                                            unsigned threads, stage_monitor& monitor);

/// The largest gap between what the two triangles at a coarse edge look up along it, metres.
[[nodiscard]] double largest_crack(const coarse_mesh& coarse, const haptic_texture& texture);

/// Distances between texels that are neighbours in a row or a column and lie in the same chart.
/// @param chart per texel: the chart that it lies in, or no_halfedge
[[nodiscard]] length_spread texel_spacing(const haptic_texture& texture, const std::vector<std::uint32_t>& chart);

/// Percentiles of values, each with its weight. Zeros where there are none.
[[nodiscard]] length_spread spread_of(const std::vector<double>& values_m, const std::vector<double>& weights);

}  // namespace asperity::bake
