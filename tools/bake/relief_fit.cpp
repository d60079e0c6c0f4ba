#include "bake/relief_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "bake/geometry.hpp"
#include "bake/parallel.hpp"
#include "bake/simplify.hpp"
#include "bake/stage_monitor.hpp"

namespace asperity::bake {
namespace {

constexpr int most_steps = 6;
constexpr int samples_per_edge = 6;
constexpr double longest_move = 0.2;  // of the shortest edge at the vertex: a step cannot turn a triangle over

// Offsets of the relief at the sample points of one triangle, NaN where it is out of reach.
using triangle_offsets = std::array<double, samples_per_edge*(samples_per_edge + 1) / 2>;

// Calls visit(number, b) for the sample points of a triangle, b their barycentric coordinates.
template <class Visit>
void for_each_sample(const Visit& visit) {
  std::size_t number = 0;
  for (int i = 0; i < samples_per_edge; ++i)
    for (int j = 0; i + j < samples_per_edge; ++j) {
      const double b1 = (i + 1.0 / 3.0) / samples_per_edge;
      const double b2 = (j + 1.0 / 3.0) / samples_per_edge;
      visit(number++, std::array<double, 3>{1.0 - b1 - b2, b1, b2});
    }
}

// Mean offset of the relief around each vertex, weighted by the vertex's hat function.
std::vector<double> mean_offsets(const triangle_mesh& coarse, const std::vector<vec3>& normals,
                                 const triangle_bvh& full, double range_m, unsigned threads, stage_monitor& report) {
  std::vector<triangle_offsets> offsets(coarse.triangles.size());
  const auto look = [&](std::size_t i) {
    const index_triangle& t = coarse.triangles[i];
    const auto c = corners(coarse.positions, t);
    for_each_sample([&](std::size_t number, const std::array<double, 3>& b) {
      const vec3 p = b[0] * c[0] + b[1] * c[1] + b[2] * c[2];
      const vec3 n = normalised(b[0] * normals[t[0]] + b[1] * normals[t[1]] + b[2] * normals[t[2]]);
      const auto crossing = full.nearest_front_crossing(p, n, range_m);
      offsets[i][number] = crossing ? crossing->offset_m : std::numeric_limits<double>::quiet_NaN();
    });
  };
  if (!parallel_tasks(offsets.size(), threads, report, report.done(), report.done(), look)) return {};

  std::vector<double> sum(coarse.positions.size(), 0.0);
  std::vector<double> weight(coarse.positions.size(), 0.0);
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const index_triangle& t = coarse.triangles[i];
    const double area = glm::length(area_normal(corners(coarse.positions, t)));
    for_each_sample([&](std::size_t number, const std::array<double, 3>& b) {
      if (std::isnan(offsets[i][number])) return;
      for (std::size_t k = 0; k < 3; ++k) {
        sum[t[k]] += area * b[k] * offsets[i][number];
        weight[t[k]] += area * b[k];
      }
    });
  }
  for (std::size_t v = 0; v < sum.size(); ++v) sum[v] = weight[v] > 0.0 ? sum[v] / weight[v] : 0.0;
  return sum;
}

}  // namespace

void fit_to_relief(triangle_mesh& coarse, const triangle_bvh& full, double range_m, unsigned threads,
                   stage_monitor* monitor) {
  stage_monitor no_one;
  stage_monitor& report = monitor != nullptr ? *monitor : no_one;
  for (int step = 0; step < most_steps; ++step) {
    const std::vector<vec3> normals = vertex_normals(coarse.positions, coarse.triangles);
    const std::vector<double> offsets = mean_offsets(coarse, normals, full, range_m, threads, report);
    if (report.cancelled()) return;
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
