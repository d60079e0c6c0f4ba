// Does a surface pass through itself?
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "asperity/model/triangle_mesh.hpp"
#include "bake/stage_monitor.hpp"
#include "bake/triangle_bvh.hpp"

namespace asperity::bake {

struct self_crossings {
  std::size_t pairs = 0;  ///< of triangles
  vec3 first{0.0};        ///< middle of the first triangle of the first pair, m
};

/// Pairs of triangles of which an edge of one goes through the inside of the other. Neighbours along an edge do not
/// count, nor does what merely touches or lies in one plane. The count does not depend on the number of threads.
/// @return nothing where the bake was cancelled
[[nodiscard]] std::optional<self_crossings> find_self_crossings(const triangle_mesh& mesh, const triangle_bvh& tree,
                                                                unsigned threads, stage_monitor& monitor);

/// More than these are not listed.
inline constexpr std::size_t most_listed_crossings = 1'000'000;

/// The pairs themselves, the lower number first, sorted; no more than `most`. @return nothing where it was cancelled
using crossing_pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
[[nodiscard]] std::optional<crossing_pairs> list_self_crossings(const triangle_mesh& mesh, const triangle_bvh& tree,
                                                                unsigned threads, std::size_t most,
                                                                stage_monitor& monitor);

/// Of these the pairs of which at least one is triangle `from` or a later one.
[[nodiscard]] std::optional<crossing_pairs> list_crossings_from(const triangle_mesh& mesh, const triangle_bvh& tree,
                                                                std::size_t from, unsigned threads, std::size_t most,
                                                                stage_monitor& monitor);

/// The sentence with which a report tells of them. @pre found.pairs > 0
[[nodiscard]] std::string crossing_remark(const self_crossings& found);

}  // namespace asperity::bake
