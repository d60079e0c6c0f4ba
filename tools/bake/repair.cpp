#include "asperity/bake/repair.hpp"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "bake/geometry.hpp"
#include "bake/halfedges.hpp"
#include "bake/winding.hpp"

namespace asperity::bake {
namespace {

// The open halfedge that follows h around its hole: turn about h's end point until an edge without a mate comes.
std::uint32_t next_along_border(std::uint32_t h, const std::vector<std::uint32_t>& mate) {
  std::uint32_t g = next_halfedge(h);
  while (mate[g] != no_halfedge) g = next_halfedge(mate[g]);
  return g;
}

// Vertices of every hole, in the order in which the triangles around it run along its border.
std::vector<std::vector<std::uint32_t>> find_holes(const std::vector<index_triangle>& triangles,
                                                   const connectivity& around) {
  std::vector<std::vector<std::uint32_t>> holes;
  std::vector<bool> seen(around.mate.size(), false);
  for (std::uint32_t start = 0; start < around.mate.size(); ++start) {
    if (around.mate[start] != no_halfedge || seen[start]) continue;
    auto& hole = holes.emplace_back();
    for (std::uint32_t h = start; !seen[h]; h = next_along_border(h, around.mate)) {
      seen[h] = true;
      hole.push_back(origin_of(triangles, h));
    }
  }
  return holes;
}

// Least-area triangulation of a closed polygon: best(i, k) over the corners between i and k, by increasing distance.
class least_area_triangulation {
 public:
  least_area_triangulation(const std::vector<vec3>& positions, const std::vector<std::uint32_t>& polygon)
      : positions_(positions), polygon_(polygon), n_(polygon.size()), area_(n_ * n_, 0.0), split_(n_ * n_, 0) {
    for (std::size_t gap = 2; gap < n_; ++gap) {
      for (std::size_t i = 0; i + gap < n_; ++i) find_best_split(i, i + gap);
    }
  }

  [[nodiscard]] double area() const { return area_[n_ - 1]; }

  void append_to(std::vector<index_triangle>& out) const {
    std::vector<std::pair<std::size_t, std::size_t>> open{{0, n_ - 1}};
    while (!open.empty()) {
      const auto [i, k] = open.back();
      open.pop_back();
      if (k - i < 2) continue;
      const std::size_t j = split_[i * n_ + k];
      // The hole's border runs against the new triangles: its neighbours already run along it this way.
      out.push_back({polygon_[k], polygon_[j], polygon_[i]});
      open.emplace_back(i, j);
      open.emplace_back(j, k);
    }
  }

 private:
  void find_best_split(std::size_t i, std::size_t k) {
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t j = i + 1; j < k; ++j) {
      const double a = area_[i * n_ + j] + area_[j * n_ + k] + triangle_area(i, j, k);
      if (a < best) {
        best = a;
        split_[i * n_ + k] = j;
      }
    }
    area_[i * n_ + k] = best;
  }

  [[nodiscard]] double triangle_area(std::size_t i, std::size_t j, std::size_t k) const {
    return 0.5 * glm::length(area_normal(corners(positions_, {polygon_[i], polygon_[j], polygon_[k]})));
  }

  const std::vector<vec3>& positions_;
  const std::vector<std::uint32_t>& polygon_;
  std::size_t n_;
  std::vector<double> area_;
  std::vector<std::size_t> split_;
};

double widest_distance(const std::vector<vec3>& positions, const std::vector<std::uint32_t>& polygon) {
  double widest = 0.0;
  for (const std::uint32_t a : polygon) {
    for (const std::uint32_t b : polygon) widest = std::max(widest, glm::length(positions[a] - positions[b]));
  }
  return widest;
}

}  // namespace

result<hole_report> close_holes(triangle_mesh& mesh) {
  for (const index_triangle& t : mesh.triangles) {
    if (std::ranges::max(t) >= mesh.positions.size()) {
      return error{error_code::bad_mesh, "cannot close holes: a triangle names a vertex that the mesh does not have"};
    }
  }
  connectivity around = connect(mesh.triangles, mesh.positions.size());
  if (around.non_manifold_edges.count != 0) {
    return error{error_code::bad_mesh, "cannot close holes: " + std::to_string(around.non_manifold_edges.count) +
                                           (around.non_manifold_edges.count == 1 ? " edge has" : " edges have") +
                                           " more than two triangles; remove duplicate or inner faces first"};
  }
  hole_report report;
  triangle_mesh wound{{}, mesh.triangles, mesh.uvs};
  if (around.misoriented_edges.count != 0) {
    const auto turned = make_winding_consistent(wound);
    if (!turned) {
      return error{error_code::bad_mesh,
                   "cannot close holes: the surface has only one side, as a Moebius band has; cut it or remove faces"};
    }
    report.triangles_turned = *turned;
    around = connect(wound.triangles, mesh.positions.size());
  }

  const auto holes = find_holes(wound.triangles, around);
  for (const auto& hole : holes) {
    if (hole.size() > largest_hole_edges) {
      return error{error_code::bad_mesh, "cannot close holes: one has " + std::to_string(hole.size()) +
                                             " edges, more than " + std::to_string(largest_hole_edges) +
                                             "; close it in a mesh editor, where its shape can be chosen"};
    }
  }
  mesh.triangles = std::move(wound.triangles);
  mesh.uvs = std::move(wound.uvs);
  report.holes = holes.size();
  const std::size_t before = mesh.triangles.size();
  for (const auto& hole : holes) {
    const least_area_triangulation fill(mesh.positions, hole);
    fill.append_to(mesh.triangles);
    report.area_added_m2 += fill.area();
    report.largest_m = std::max(report.largest_m, widest_distance(mesh.positions, hole));
  }
  report.triangles_added = mesh.triangles.size() - before;
  if (report.holes != 0) mesh.uvs.clear();
  return report;
}

}  // namespace asperity::bake
