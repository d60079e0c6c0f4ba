// The straight sharp edges of a coarse mesh, merged from collinear pieces.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "asperity/cells/coarse_regions.hpp"
#include "asperity/cells/surface_cells.hpp"

namespace asperity::detail {

/// Chains of sharp convex edges, cut wherever they turn.
///
/// An edge that is cut in two by a vertex in its middle, as triangulations do, must stay one: contact of edge with edge
/// fades at an edge's ends. Where a chain goes on with a slight turn (the rim of a hole) an edge may reach a little
/// past its end, so that the next one has taken over before it has faded.
[[nodiscard]] inline std::vector<sharp_edge> find_sharp_edges(const coarse_mesh& mesh, const surface_index& index,
                                                              const coarse_regions& regions, double reach_m) {
  struct half {
    std::uint32_t from, to, triangle, across;
    bool used;
  };
  std::vector<half> pieces;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t across = index.neighbour[t][k];
      if (regions.kind[t][k] != edge_kind::convex || across == coarse_regions::none || across < t) continue;
      const auto& v = mesh.triangles[t].vertex;
      const vec3 d = mesh.positions[v[(k + 1) % 3]] - mesh.positions[v[k]];
      if (glm::dot(d, d) > 0.0) pieces.push_back({v[k], v[(k + 1) % 3], t, across, false});
    }
  }
  std::vector<std::vector<std::uint32_t>> at(mesh.positions.size());  // pieces that meet in a vertex
  for (std::uint32_t i = 0; i < pieces.size(); ++i) {
    at[pieces[i].from].push_back(i);
    at[pieces[i].to].push_back(i);
  }
  const auto direction = [&](const half& p) { return glm::normalize(mesh.positions[p.to] - mesh.positions[p.from]); };
  constexpr double straight = 0.9998;  // 1.1 degrees
  const double goes_on = std::cos(0.7);
  // The piece that continues from `vertex` in `heading`, and how well.
  const auto next = [&](std::uint32_t vertex, const vec3& heading, std::uint32_t except, double& cosine) {
    std::uint32_t best = coarse_regions::none;
    for (const std::uint32_t i : at[vertex]) {
      if (i == except) continue;
      const vec3 d = pieces[i].from == vertex ? direction(pieces[i]) : -direction(pieces[i]);
      const double c = glm::dot(d, heading);
      if (c > cosine) {
        cosine = c;
        best = i;
      }
    }
    return best;
  };
  std::vector<sharp_edge> out;
  for (std::uint32_t i = 0; i < pieces.size(); ++i) {
    if (pieces[i].used) continue;
    pieces[i].used = true;
    const vec3 along = direction(pieces[i]);
    std::array<std::uint32_t, 2> end{pieces[i].from, pieces[i].to};
    sharp_edge edge;
    for (std::size_t side = 0; side < 2; ++side) {
      const vec3 heading = side == 0 ? -along : along;
      for (std::uint32_t last = i;;) {
        double cosine = goes_on;
        const std::uint32_t n = next(end[side], heading, last, cosine);
        if (n == coarse_regions::none) break;
        const bool same_faces =
            glm::dot(index.normal[pieces[n].triangle], index.normal[pieces[i].triangle]) > straight ||
            glm::dot(index.normal[pieces[n].triangle], index.normal[pieces[i].across]) > straight;
        if (cosine < straight || !same_faces || pieces[n].used) {
          edge.extension_m[side] = reach_m;
          break;
        }
        pieces[n].used = true;
        end[side] = pieces[n].from == end[side] ? pieces[n].to : pieces[n].from;
        last = n;
      }
    }
    edge.from_b = mesh.positions[end[0]];
    const vec3 whole = mesh.positions[end[1]] - edge.from_b;
    edge.length_m = glm::length(whole);
    if (!(edge.length_m > 0.0)) continue;  // a closed chain has no straight edge
    edge.along_b = whole / edge.length_m;
    edge.face_b[0] = glm::normalize(glm::cross(index.normal[pieces[i].triangle], edge.along_b));
    edge.face_b[1] = glm::normalize(glm::cross(edge.along_b, index.normal[pieces[i].across]));
    out.push_back(edge);
  }
  return out;
}

}  // namespace asperity::detail
