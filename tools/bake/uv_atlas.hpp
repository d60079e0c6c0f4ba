// Third stage of the bake where the coarse mesh's own texture coordinates are kept.
#pragma once

#include <cstdint>
#include <string>

#include "asperity/core/status.hpp"
#include "asperity/model/triangle_mesh.hpp"
#include "bake/atlas.hpp"

namespace asperity::bake {

/// Can the texture coordinates be an atlas, as far as each triangle alone can tell? There, finite, in the unit square
/// with half a texel to its border, and no triangle without area.
/// @return bad_mesh, with the triangle and the mend
[[nodiscard]] result<void> check_uvs(const triangle_mesh& coarse, std::uint32_t texture_size);

/// The atlas that the mesh's own texture coordinates are. Charts are the triangles that are joined by edges whose
/// texture coordinates agree; they may be mirrored and stretched, but every place of the image belongs to one triangle
/// at most, and between parts that are no neighbours on the surface there is room for two gutters.
/// @pre closed 2-manifold without degenerate triangles; indices in range
/// @return bad_mesh, with two triangles and the mend | invalid_argument (too few texels) | limit_exceeded (needles)
[[nodiscard]] result<atlas> atlas_from_uvs(const triangle_mesh& coarse, std::uint32_t texture_size);

/// The sentence that says that texels are of very different sizes; empty where they are not.
[[nodiscard]] std::string distortion_remark(const atlas& charts);

}  // namespace asperity::bake
