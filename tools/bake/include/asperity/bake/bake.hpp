// From a full-resolution mesh to a textured model. Component asperity::bake.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "asperity/bake/relief.hpp"
#include "asperity/bake/texel_filter.hpp"
#include "asperity/core/status.hpp"
#include "asperity/model/textured_model.hpp"
#include "asperity/model/triangle_mesh.hpp"

namespace asperity::bake {

struct bake_settings {
  std::string name;             ///< name of the model, kept in the file
  std::size_t triangles = 600;  ///< coarse triangles to aim for; ignored where `coarse` is given
  /// Where `triangles` are too few for a sound coarse mesh near the original, as one with many handles needs, more are taken
  /// and a remark tells how many; otherwise the bake is refused, and the refusal names a count that is enough.
  bool more_triangles = false;
  std::optional<triangle_mesh> coarse;  ///< a coarse mesh to use instead of simplifying
  /// The coarse mesh's own texture coordinates become the atlas instead of a new one. Without `coarse` the mesh has to
  /// be its own coarse mesh: of no more than `triangles`.
  bool keep_uvs = false;
  std::uint32_t texture_size = 1024;          ///< texels per side
  texel_filter texels = texel_filter::point;  ///< what a texel keeps of the surface under it
  bake::relief relief;                        ///< heights to add to the mesh; none by default
  /// Convex pieces to aim for, by smaller pieces or looser tolerances than usual; what that costs is in the report.
  std::optional<std::size_t> pieces;
  unsigned threads = 0;  ///< 0: as many as the machine has; the result does not depend on it
  /// Called with every stage and its share done, 0 to 1; returning false cancels the bake.
  std::function<bool(std::string_view stage, double done)> progress;
  /// Called with one sentence for each thing that was done differently from what was asked: a mesh turned the right way
  /// out, a coarse mesh of more triangles.
  std::function<void(std::string_view sentence)> remark;
};

/// The textured model of a full-resolution mesh, in seven stages: check the mesh, simplify it (or take the coarse mesh
/// given), compare the two, lay an atlas on the coarse mesh, project its texels onto the original, split the coarse
/// mesh into convex pieces, and measure how far the textured surface and the original are apart. The mesh has to be
/// closed, 2-manifold and in metres; several components and cavities are allowed. Positions and texture coordinates of
/// the model are exact in float32. The same input gives the same bits.
/// Texture coordinates that are kept have to be fit for an atlas: within the unit square, each triangle with a place of
/// its own, and room for lookups between charts. They may mirror and stretch; the report then states the texels' sizes.
/// A relief is added on the way: every texel goes on, in its own direction, until it is that height above the triangle
/// of the mesh that it has met. The errors in the report are then against the mesh with its relief.
/// @return bad_mesh | bad_texture (relief) | invalid_argument | limit_exceeded | cancelled, with the fault, its place
///         and the mend
[[nodiscard]] result<textured_model> bake(triangle_mesh full, const bake_settings& settings);

}  // namespace asperity::bake
