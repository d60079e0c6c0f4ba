// A mesh taken apart.
#pragma once

#include <optional>
#include <vector>

#include "asperity/io/mesh_file.hpp"
#include "mesh_builder.hpp"

namespace asperity::io {

/// By the parts that the file names; in the order of their first triangles, without empty ones.
[[nodiscard]] std::vector<mesh_part> named_parts(const triangle_mesh& mesh, const part_list& named);

/// By surfaces that share no vertex; one within the box of a larger one stays with it, as a cavity has to. Without names.
/// @return nothing where there are more than max_mesh_parts
[[nodiscard]] std::optional<std::vector<mesh_part>> separate_surfaces(const triangle_mesh& mesh);

}  // namespace asperity::io
