// Which way the triangles of a soup should face: out of what they enclose, as far as that can be told.
#pragma once

#include <cstddef>
#include <optional>

#include "asperity/model/triangle_mesh.hpp"
#include "bake/stage_monitor.hpp"
#include "bake/triangle_bvh.hpp"

namespace asperity::bake {

/// Drops triangles without area, and triangles given twice with the same facing. @return how many
/// @pre indices in range, coordinates finite
std::size_t drop_useless_triangles(triangle_mesh& mesh);

/// Does nothing lie on the ray?
[[nodiscard]] bool escapes(const triangle_bvh& tree, const vec3& from, const vec3& direction) noexcept;

/// Turns triangles against their neighbours where that joins a surface with two sides; then every closed connected part
/// with the volume positive, and every open one so that its front can be seen from outside rather than its back. Parts
/// that are seen from both sides, or from none, stay. @return how many triangles were turned; nothing where cancelled
/// @source Takayama et al. 2014 (facing by rays that escape)
[[nodiscard]] std::optional<std::size_t> face_outwards(triangle_mesh& mesh, unsigned threads, stage_monitor& monitor);

}  // namespace asperity::bake
