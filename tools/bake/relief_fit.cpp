#include "bake/relief_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "bake/geometry.hpp"
#include "bake/simplify.hpp"

namespace asperity::bake {
namespace {

constexpr int most_steps = 6;
constexpr int samples_per_edge = 6;
constexpr double longest_move = 0.2;  // of the shortest edge at the vertex: a step cannot turn a triangle over

// Mean offset of the relief around each vertex, weighted by the vertex's hat function.
std::vector<double> mean_offsets(const triangle_mesh& coarse, const std::vector<vec3>& normals,
                                 const triangle_bvh& full, double range_m) {
  std::vector<double> sum(coarse.positions.size(), 0.0);
  std::vector<double> weight(coarse.positions.size(), 0.0);
  for (const index_triangle& t : coarse.triangles) {
    const auto c = corners(coarse.positions, t);
    const double area = glm::length(area_normal(c));
    for (int i = 0; i < samples_per_edge; ++i)
      for (int j = 0; i + j < samples_per_edge; ++j) {
        const double b1 = (i + 1.0 / 3.0) / samples_per_edge;
        const double b2 = (j + 1.0 / 3.0) / samples_per_edge;
        const std::array<double, 3> b{1.0 - b1 - b2, b1, b2};
        const vec3 p = b[0] * c[0] + b[1] * c[1] + b[2] * c[2];
        const vec3 n = normalised(b[0] * normals[t[0]] + b[1] * normals[t[1]] + b[2] * normals[t[2]]);
        const auto crossing = full.nearest_front_crossing(p, n, range_m);
        if (!crossing) continue;
        for (std::size_t k = 0; k < 3; ++k) {
          sum[t[k]] += area * b[k] * crossing->offset_m;
          weight[t[k]] += area * b[k];
        }
      }
  }
  for (std::size_t v = 0; v < sum.size(); ++v) sum[v] = weight[v] > 0.0 ? sum[v] / weight[v] : 0.0;
  return sum;
}

std::vector<double> shortest_edges(const triangle_mesh& mesh) {
  std::vector<double> out(mesh.positions.size(), std::numeric_limits<double>::infinity());
  for (const index_triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k];
      const std::uint32_t b = t[(k + 1) % 3];
      const double length = glm::length(mesh.positions[a] - mesh.positions[b]);
      out[a] = std::min(out[a], length);
      out[b] = std::min(out[b], length);
    }
  return out;
}

}  // namespace

void fit_to_relief(triangle_mesh& coarse, const triangle_bvh& full, double range_m) {
  for (int step = 0; step < most_steps; ++step) {
    const std::vector<vec3> normals = vertex_normals(coarse.positions, coarse.triangles);
    const std::vector<double> offsets = mean_offsets(coarse, normals, full, range_m);
    const std::vector<double> shortest = shortest_edges(coarse);
    triangle_mesh moved = coarse;
    for (std::size_t v = 0; v < moved.positions.size(); ++v) {
      const double most = longest_move * shortest[v];
      moved.positions[v] = to_float32(moved.positions[v] + std::clamp(offsets[v], -most, most) * normals[v]);
    }
    if (!is_unfolded(moved)) return;
    for (const index_triangle& t : coarse.triangles)
      if (!(glm::dot(area_normal(corners(coarse.positions, t)), area_normal(corners(moved.positions, t))) > 0.0))
        return;
    coarse = std::move(moved);
  }
}

}  // namespace asperity::bake
