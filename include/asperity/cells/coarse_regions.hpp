// Cuts a coarse surface at its sharp edges, and what lies between them into regions of nearly one direction.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "asperity/cells/cell_settings.hpp"
#include "asperity/depth/surface_index.hpp"

namespace asperity::detail {

/// What a coarse edge is to somebody who slides over it.
enum class edge_kind : std::uint8_t {
  smooth,   ///< part of a curved surface
  convex,   ///< a sharp edge that can be felt
  concave,  ///< the bottom of a corner
};

/// A coarse mesh in regions. Edge k of a triangle runs from corner k to corner k + 1.
struct coarse_regions {
  static constexpr std::uint32_t none = surface_index::none;

  std::vector<std::array<edge_kind, 3>> kind;
  std::vector<std::uint32_t> region;                ///< of each triangle; none for a triangle without area
  std::vector<std::vector<std::uint32_t>> members;  ///< triangles of each region
  std::vector<vec3> normal;                         ///< of each region: unit, area-weighted

  coarse_regions(const coarse_mesh& mesh, const surface_index& index, const cell_settings& settings) {
    classify(mesh, index, settings);
    grow(mesh, index, settings);
  }

  /// True where edge k of triangle t leads into another region.
  [[nodiscard]] bool is_border(const surface_index& index, std::uint32_t t, std::size_t k) const noexcept {
    const std::uint32_t across = index.neighbour[t][k];
    return across == none || region[across] != region[t];
  }

 private:
  void classify(const coarse_mesh& mesh, const surface_index& index, const cell_settings& settings) {
    const double cos_sharp = std::cos(settings.sharp_edge_rad);
    kind.resize(mesh.triangles.size());
    for (std::size_t t = 0; t < kind.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t across = index.neighbour[t][k];
        if (across == none) {
          kind[t][k] = edge_kind::convex;
        } else if (index.normal[t] == vec3(0.0) || index.normal[across] == vec3(0.0)) {
          kind[t][k] = edge_kind::concave;  // without area there is no angle; the surface goes on, and none can be felt
        } else if (glm::dot(index.normal[t], index.normal[across]) > cos_sharp) {
          kind[t][k] = edge_kind::smooth;
        } else {
          // The neighbour's third corner, seen from this triangle's plane.
          const auto& v = mesh.triangles[t].vertex;
          vec3 third = mesh.positions[v[k]];
          for (const std::uint32_t w : mesh.triangles[across].vertex) {
            if (w != v[k] && w != v[(k + 1) % 3]) third = mesh.positions[w];
          }
          const bool below = glm::dot(index.normal[t], third - mesh.positions[v[k]]) < 0.0;
          kind[t][k] = below ? edge_kind::convex : edge_kind::concave;
        }
      }
    }
  }

  // Largest triangle first: its direction is the one a region is measured from.
  void grow(const coarse_mesh& mesh, const surface_index& index, const cell_settings& settings) {
    const double cos_cell = std::cos(settings.cell_angle_rad);
    std::vector<double> area(mesh.triangles.size());
    std::vector<std::uint32_t> order(mesh.triangles.size());
    for (std::size_t t = 0; t < area.size(); ++t) {
      order[t] = static_cast<std::uint32_t>(t);
      const double doubled = glm::length(area_normal(corners(mesh, t)));
      area[t] = std::isfinite(doubled) ? 0.5 * doubled : 0.0;  // a NaN has no place in an order
    }
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return area[a] != area[b] ? area[a] > area[b] : a < b; });
    region.assign(mesh.triangles.size(), none);
    for (const std::uint32_t seed : order) {
      if (region[seed] != none || !(area[seed] > 0.0)) continue;
      const auto id = static_cast<std::uint32_t>(members.size());
      std::vector<std::uint32_t> list{seed};
      region[seed] = id;
      vec3 sum = area[seed] * index.normal[seed];
      for (std::size_t i = 0; i < list.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t across = index.neighbour[list[i]][k];
          if (across == none || region[across] != none || kind[list[i]][k] != edge_kind::smooth) continue;
          if (!(area[across] > 0.0) || glm::dot(index.normal[across], index.normal[seed]) < cos_cell) continue;
          region[across] = id;
          list.push_back(across);
          sum += area[across] * index.normal[across];
        }
      }
      members.push_back(std::move(list));
      normal.push_back(glm::normalize(sum));
    }
  }
};

}  // namespace asperity::detail
