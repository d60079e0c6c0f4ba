#include "bake/lost_area.hpp"

#include <algorithm>

#include "bake/geometry.hpp"

namespace asperity::bake {
namespace {

// What a triangle of the original has lost.
struct losing_triangle {
  std::uint32_t triangle;
  double area = 0.0;
  vec3 moment{0.0};  // area times place
  std::uint32_t part = no_halfedge;
};

}  // namespace

std::vector<char> find_lost(const fine_points& original, const std::vector<double>& distance,
                            const triangle_bvh& textured, double reach_m, unsigned threads, stage_monitor& monitor) {
  const std::vector<vec3>& points = original.mesh.positions;
  const std::vector<vec3> normals = vertex_normals(points, original.mesh.triangles);
  std::vector<char> lost(points.size(), 0);
  const auto visit = [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      lost[i] = distance[i] > reach_m || !textured.has_facing(points[i], normals[i], reach_m) ? 1 : 0;
  };
  if (!parallel_blocks(points.size(), threads, monitor, 0.9, 1.0, visit)) return {};
  return lost;
}

lost_area measure_lost(const triangle_mesh& full, const fine_points& original, const std::vector<char>& lost) {
  lost_area out;
  if (std::find(lost.begin(), lost.end(), char{1}) == lost.end()) return out;
  double whole = 0.0;
  double sum = 0.0;
  std::vector<losing_triangle> losing;  // in the order of the original's triangles
  std::vector<std::uint32_t> number(full.triangles.size(), no_halfedge);
  for (std::size_t i = 0; i < original.mesh.triangles.size(); ++i) {
    const index_triangle& t = original.mesh.triangles[i];
    const double third = glm::length(area_normal(corners(original.mesh.positions, t))) / 6.0;
    whole += 3.0 * third;
    for (const std::uint32_t v : t) {
      if (!lost[v]) continue;
      sum += third;
      const std::uint32_t source = original.source[i];
      if (number[source] == no_halfedge) {
        number[source] = static_cast<std::uint32_t>(losing.size());
        losing.push_back({source});
      }
      losing[number[source]].area += third;
      losing[number[source]].moment += third * original.mesh.positions[v];
    }
  }
  if (!(sum > 0.0)) return out;
  out.share = sum / whole;

  // Flood over edges between triangles that have lost something.
  const std::vector<std::uint32_t> across = connect(full.triangles, full.positions.size()).mate;
  const auto is_open = [&](const losing_triangle& t) { return t.area > 0.0 && t.part == no_halfedge; };
  std::vector<double> area;
  std::vector<vec3> centre;
  std::vector<std::uint32_t> open;
  for (std::uint32_t seed = 0; seed < losing.size(); ++seed) {
    if (!is_open(losing[seed])) continue;
    const auto part = static_cast<std::uint32_t>(area.size());
    area.push_back(0.0);
    centre.emplace_back(0.0);
    losing[seed].part = part;
    open.push_back(seed);
    while (!open.empty()) {
      const losing_triangle t = losing[open.back()];
      open.pop_back();
      area[part] += t.area;
      centre[part] += t.moment;
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t mate = across[3 * t.triangle + k];
        const std::uint32_t beside = mate == no_halfedge ? no_halfedge : number[mate / 3];
        if (beside == no_halfedge || !is_open(losing[beside])) continue;
        losing[beside].part = part;
        open.push_back(beside);
      }
    }
  }
  const auto largest = static_cast<std::uint32_t>(std::max_element(area.begin(), area.end()) - area.begin());
  out.part_share = area[largest] / whole;
  out.part_centre = centre[largest] / area[largest];
  std::vector<vec3> points;
  for (std::size_t i = 0; i < original.mesh.triangles.size(); ++i) {
    const std::uint32_t source = number[original.source[i]];
    if (source == no_halfedge || losing[source].part != largest) continue;
    for (const std::uint32_t v : original.mesh.triangles[i])
      if (lost[v]) points.push_back(original.mesh.positions[v]);
  }
  const bounds box = bounds_of(points);
  out.part_low = box.low;
  out.part_high = box.high;
  return out;
}

}  // namespace asperity::bake
