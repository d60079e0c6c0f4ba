// The straight sharp edges of a coarse mesh, merged from collinear pieces.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "asperity/cells/coarse_regions.hpp"
#include "asperity/cells/relief_tap.hpp"
#include "asperity/cells/surface_cells.hpp"

namespace asperity::detail {

/// Fine surface at a fraction f of edge k of triangle t, from its first corner on. Both charts have a say.
[[nodiscard]] inline vec3 fine_edge_point(const textured_model& model, const surface_index& index, std::uint32_t t,
                                          std::size_t k, double f) noexcept {
  const coarse_triangle& tri = model.mesh.triangles[t];
  const vec3 p = model.texture.sample((1.0 - f) * tri.uv[k] + f * tri.uv[(k + 1) % 3]);
  const std::uint32_t across = index.neighbour[t][k];
  if (across == coarse_regions::none) return p;
  const coarse_triangle& other = model.mesh.triangles[across];
  std::size_t m = 0;  // the neighbour's corner at the far end of this edge
  while (other.vertex[m] != tri.vertex[(k + 1) % 3]) ++m;
  return 0.5 * (p + model.texture.sample((1.0 - f) * other.uv[(m + 1) % 3] + f * other.uv[m]));
}

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

/// Gives every sharp edge its relief: how far the fine surface is from it, a feature pitch apart.
inline void lay_edge_relief(surface_cells& body, const textured_model& model, const surface_index& index,
                            const coarse_regions& regions) {
  struct piece {
    std::uint32_t triangle;
    std::uint32_t edge;
  };
  std::vector<piece> pieces;
  std::vector<bounds> boxes;
  for (std::uint32_t t = 0; t < model.mesh.triangles.size(); ++t) {
    const auto c = corners(model.mesh, t);
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (regions.kind[t][k] != edge_kind::convex) continue;
      pieces.push_back({t, k});
      boxes.push_back({glm::min(c[k], c[(k + 1) % 3]), glm::max(c[k], c[(k + 1) % 3])});
    }
  }
  const aabb_tree tree(boxes);
  for (sharp_edge& e : body.edges) {
    const auto spans =
        static_cast<std::uint32_t>(std::clamp(std::ceil(e.length_m / body.settings.feature_pitch_m), 1.0, 4096.0));
    e.first_relief = static_cast<std::uint32_t>(body.edge_relief.size());
    e.relief = spans + 1;
    for (std::uint32_t i = 0; i <= spans; ++i) {
      const vec3 at = e.from_b + (e.length_m * i / spans) * e.along_b;
      // A merged edge leaves its pieces by a little where they turn by a little.
      const double slack = 0.02 * e.length_m;
      double nearest = 1e30;
      vec3 relief(0.0);
      tree.query({at - slack, at + slack}, [&](std::uint32_t n) {
        const auto c = corners(model.mesh, pieces[n].triangle);
        const vec3 a = c[pieces[n].edge], d = c[(pieces[n].edge + 1) % 3] - a;
        const double l2 = glm::dot(d, d);
        const double f = l2 > 0.0 ? std::clamp(glm::dot(at - a, d) / l2, 0.0, 1.0) : 0.0;
        const vec3 coarse = a + f * d;
        const double distance = glm::length(at - coarse);
        if (distance >= nearest) return;
        const vec3 fine = fine_edge_point(model, index, pieces[n].triangle, pieces[n].edge, f);
        if (!is_finite(fine)) return;
        nearest = distance;
        relief = fine - coarse;
      });
      body.edge_relief.emplace_back(relief);
      body.largest_edge_relief_m = std::max(body.largest_edge_relief_m, glm::length(relief));
    }
  }
}

/// Relief of a sharp edge at a place along it, and its slope along the edge: a spline that ends level, so that it goes
/// on evenly where the edge reaches past its end.
[[nodiscard]] inline vec3 read_edge_relief(const surface_cells& body, const sharp_edge& e, double at_m,
                                           vec3& slope) noexcept {
  slope = vec3(0.0);
  if (e.relief < 2) return vec3(0.0);
  const double spans = e.relief - 1.0, place = std::clamp(at_m / e.length_m, 0.0, 1.0) * spans;
  const auto cell = static_cast<std::int64_t>(std::min(place, spans - 1.0));
  const spline_weights w(place - static_cast<double>(cell));
  vec3 value(0.0);
  for (std::int64_t i = -1; i <= 2; ++i) {
    const auto last = static_cast<std::int64_t>(e.relief) - 1;
    std::int64_t n = std::abs(cell + i);  // mirrored at both ends
    if (n > last) n = 2 * last - n;
    const vec3 node(body.edge_relief[e.first_relief + static_cast<std::size_t>(n)]);
    value += w.value[i + 1] * node;
    slope += w.slope[i + 1] * node;
  }
  slope *= at_m >= 0.0 && at_m <= e.length_m ? spans / e.length_m : 0.0;
  return value;
}

}  // namespace asperity::detail
