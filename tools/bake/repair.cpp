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

// The open halfedges of every hole, in the order in which the triangles around it run along its border.
std::vector<std::vector<std::uint32_t>> find_holes(const connectivity& around) {
  std::vector<std::vector<std::uint32_t>> holes;
  std::vector<bool> seen(around.mate.size(), false);
  for (std::uint32_t start = 0; start < around.mate.size(); ++start) {
    if (around.mate[start] != no_halfedge || seen[start]) continue;
    auto& hole = holes.emplace_back();
    for (std::uint32_t h = start; !seen[h]; h = next_along_border(h, around.mate)) {
      seen[h] = true;
      hole.push_back(h);
    }
  }
  return holes;
}

// Triangulation of a hole that folds back onto itself or onto the triangles around as rarely as it can, and of those
// the one of least area: best(i, k) over the corners between i and k, by increasing distance. Area alone is not enough:
// where a rim is ragged, the least of it may lie back to back with the surface.
class smallest_fill {
 public:
  smallest_fill(const triangle_mesh& mesh, const std::vector<std::uint32_t>& hole)
      : positions_(mesh.positions), n_(hole.size()), best_(n_ * n_) {
    for (const std::uint32_t h : hole) {
      polygon_.push_back(origin_of(mesh.triangles, h));
      rim_.push_back(unit_normal(corners(mesh.positions, mesh.triangles[h / 3])));
    }
    for (std::size_t gap = 2; gap < n_; ++gap) {
      for (std::size_t i = 0; i + gap < n_; ++i) find_best_split(i, i + gap);
    }
  }

  [[nodiscard]] double area() const { return best_[n_ - 1].area; }

  void append_to(std::vector<index_triangle>& out) const {
    std::vector<std::pair<std::size_t, std::size_t>> open{{0, n_ - 1}};
    while (!open.empty()) {
      const auto [i, k] = open.back();
      open.pop_back();
      if (k - i < 2) continue;
      const std::size_t j = best_[i * n_ + k].split;
      // The hole's border runs against the new triangles: its neighbours already run along it this way.
      out.push_back({polygon_[k], polygon_[j], polygon_[i]});
      open.emplace_back(i, j);
      open.emplace_back(j, k);
    }
  }

 private:
  static constexpr double folded_cosine = -0.866;  // two triangles that leave less than 30 degrees between them

  // The fill between corner i and corner k, and of it the triangle at the edge from i to k.
  struct fill {
    int folds = 0;
    double area = 0.0;
    std::size_t split = 0;
    vec3 normal{0.0};
  };

  [[nodiscard]] const vec3& normal_across(std::size_t i, std::size_t k) const {
    return k - i == 1 ? rim_[i] : best_[i * n_ + k].normal;
  }

  void find_best_split(std::size_t i, std::size_t k) {
    fill best{std::numeric_limits<int>::max(), 0.0, 0, vec3(0.0)};
    for (std::size_t j = i + 1; j < k; ++j) {
      const vec3 across = area_normal(corners(positions_, {polygon_[k], polygon_[j], polygon_[i]}));
      const fill& before = best_[i * n_ + j];
      const fill& after = best_[j * n_ + k];
      fill here{before.folds + after.folds, before.area + after.area + 0.5 * glm::length(across), j,
                normalised(across)};
      const auto fold = [&](const vec3& beside) { return glm::dot(here.normal, beside) < folded_cosine ? 1 : 0; };
      here.folds += fold(normal_across(i, j)) + fold(normal_across(j, k));
      if (k - i == n_ - 1) here.folds += fold(rim_[n_ - 1]);
      if (std::pair(here.folds, here.area) < std::pair(best.folds, best.area)) best = here;
    }
    best_[i * n_ + k] = best;
  }

  const std::vector<vec3>& positions_;
  std::size_t n_;
  std::vector<std::uint32_t> polygon_;
  std::vector<vec3> rim_;  // normal of the triangle at the edge from each corner to the next
  std::vector<fill> best_;
};

double widest_distance(const triangle_mesh& mesh, const std::vector<std::uint32_t>& hole) {
  const auto at = [&](std::uint32_t h) { return mesh.positions[origin_of(mesh.triangles, h)]; };
  double widest = 0.0;
  for (const std::uint32_t a : hole) {
    for (const std::uint32_t b : hole) widest = std::max(widest, glm::length(at(a) - at(b)));
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

  const auto holes = find_holes(around);
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
    const smallest_fill fill(mesh, hole);
    fill.append_to(mesh.triangles);
    report.area_added_m2 += fill.area();
    report.largest_m = std::max(report.largest_m, widest_distance(mesh, hole));
  }
  report.triangles_added = mesh.triangles.size() - before;
  if (report.holes != 0) mesh.uvs.clear();
  return report;
}

}  // namespace asperity::bake
