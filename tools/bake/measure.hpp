// Last stage of the bake: how far the textured surface and the original are apart.
#pragma once

#include "asperity/core/status.hpp"
#include "asperity/model/textured_model.hpp"
#include "asperity/model/triangle_mesh.hpp"
#include "bake/stage_monitor.hpp"
#include "bake/triangle_bvh.hpp"

namespace asperity::bake {

/// Distances in metres.
struct surface_error {
  double to_original_rms_m = 0.0;  ///< from the textured surface to the original
  double to_original_max_m = 0.0;
  double to_textured_rms_m = 0.0;  ///< from the original to the textured surface
  double to_textured_max_m = 0.0;
  double crack_max_m = 0.0;  ///< largest gap between the two sides of a coarse edge

  [[nodiscard]] double rms_m() const noexcept;
  [[nodiscard]] double max_m() const noexcept;
};

/// Measures the two surfaces as they are used. The textured surface is sampled through haptic_texture::sample about
/// once per texel, coarse edges and corners included, and triangulated between the samples; the original is sampled at
/// its vertices. Each sample is taken to the closest point of the other surface and weighted with the area that it
/// stands for.
/// @return cancelled
[[nodiscard]] result<surface_error> measure(const triangle_mesh& full, const triangle_bvh& full_tree,
                                            const coarse_mesh& coarse, const haptic_texture& texture, unsigned threads,
                                            stage_monitor& monitor);

}  // namespace asperity::bake
