// Solids for presses: balls, slabs, plates, rods, cones, pencils, and the hollow ones that a probe goes into. Each is
// made from its name, as the mesh of its plain shape and as a fine mesh of the same surface, and baked by the library.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "asperity/core/status.hpp"
#include "asperity/model/textured_model.hpp"
#include "asperity/model/triangle_mesh.hpp"

namespace asperity::test_support {

/// How a solid is meshed.
enum class fineness : std::uint8_t {
  plain,  ///< as few triangles as the shape needs; a ball has 1280
  fine,   ///< edges of about 1 mm, more for large bodies; every vertex lies on the plain shape's surface (a ball's on
          ///< the sphere)
};

/// A solid in its body frame, metres: closed, 2-manifold, one component, outward oriented. By its name:
///   ball_R         of radius R mm about the origin
///   slab           60 x 60 x 20 mm about the origin
///   plate_T        60 x 60 x T mm about the origin
///   rod_N          60 mm long along z about the origin, an N-gon whose corners lie on a circle of 4 mm diameter
///   cone_A_N       tip at the origin, axis +z, half angle A degrees at the corners of its N-gon; 20 mm high, or less
///                  where its base would be wider than 20 mm in radius
///   pyramid_A      the same with four sides
///   pencil         a hexagonal prism, 8 mm across its corners, with a round cone of half angle 20 degrees cut on it;
///                  tip at the origin, axis +z, 70 mm long
///   cup            outer radius 20 mm, 40 mm high, wall and bottom 2 mm thick; open at +z, its outer bottom at z = 0
///   groove         60 x 60 x 30 mm, z from -20 to 10 mm, with a groove along y, 90 degrees, 30 mm wide, 15 mm deep
///   corner         a cube of 50 mm about the origin without its octant of +x, +y, +z
/// @return invalid_argument where the name is none of these
[[nodiscard]] result<triangle_mesh> make_press_solid(std::string_view name, fineness how);

/// Whether make_press_solid() knows the name.
[[nodiscard]] bool is_press_solid(std::string_view name);

/// How a solid becomes a model.
enum class press_bake : std::uint8_t {
  own_coarse,  ///< the plain mesh is its own coarse mesh, so that the texture has next to nothing to say
  simplified,  ///< the library simplifies the fine mesh to 600 triangles
};

/// A solid with what the library makes of it.
struct press_solid {
  triangle_mesh full;  ///< what the model was baked from
  model_ptr model;
};

/// Bakes a solid, in about a second: with a texture of 512 texels a side, or of 256 where the texture has nothing to
/// say.
/// @param kept folder for the models; one that is newer than the running program is read and not baked again. Empty:
///             nothing is kept
[[nodiscard]] result<press_solid> bake_press_solid(std::string_view name, press_bake how,
                                                   const std::filesystem::path& kept);

/// Volume that a closed mesh encloses, m^3; negative where it is oriented inwards.
[[nodiscard]] double volume_m3(const triangle_mesh& mesh);
/// Edges that are not shared by exactly two triangles in opposite directions.
[[nodiscard]] std::size_t open_edges(const triangle_mesh& mesh);

}  // namespace asperity::test_support
