// Materials of a surface from an image of an existing asset. Component asperity::bake.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "asperity/core/status.hpp"
#include "asperity/model/map_image.hpp"
#include "asperity/model/textured_model.hpp"
#include "asperity/model/triangle_mesh.hpp"

namespace asperity::bake {

/// A colour of a map of materials, and what it stands for.
struct material_colour {
  std::array<std::uint8_t, 3> rgb{};  ///< red, green, blue
  material is{};
};

struct material_map_settings {
  map_wrap wrap_u = map_wrap::repeat;
  map_wrap wrap_v = map_wrap::repeat;
  unsigned threads = 0;  ///< 0: as many as the machine has; the result does not depend on it
  /// Asked several times a second, on the calling thread; false cancels.
  std::function<bool()> keep_going = {};
};

/// What lay_materials() found.
struct laid_materials {
  material surface;  ///< the first colour's
  material_map map;
  /// Part of the texels whose pixel is further from its colour than a tenth of the range, in some channel.
  double far_share = 0.0;
};

/// Lays an image of materials on a baked model, by the texture coordinates of the mesh that it was baked from: each
/// texel is of the listed colour that its pixel is nearest to, the first of equals. Pixels are not mixed.
/// @param full what the model was baked from, with texture coordinates; its own frame, metres
/// @param colours 2 to most_materials, all different
/// @return bad_mesh (no texture coordinates) | bad_texture (no image) | invalid_argument (the colours, or a material)
///         | cancelled
[[nodiscard]] result<laid_materials> lay_materials(const textured_model& model, const triangle_mesh& full,
                                                   const map_image& image, std::span<const material_colour> colours,
                                                   const material_map_settings& settings = {});

}  // namespace asperity::bake
