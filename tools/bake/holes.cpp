// Holes closed, and open pieces that no hole can be told of dropped.
#include <algorithm>
#include <utility>
#include <vector>

#include "bake/halfedges.hpp"
#include "bake/hole_fill.hpp"
#include "bake/repair_steps.hpp"
#include "bake/smooth_fill.hpp"

namespace asperity::bake {
namespace {

constexpr double most_filling_steps = 2e10;     // some minutes at the worst
constexpr double largest_piece_share = 0.1;     // of the whole area: a larger piece is not dropped
constexpr double largest_piece_filling = 0.25;  // of a piece with its holes closed

}  // namespace

// An open piece is loose where closing its holes would make up much of it. Its filling is judged by the least area that
// its borders can have: that of their vector areas.
void drop_loose_pieces(triangle_mesh& mesh, repair_report& report) {
  const connectivity net = connect(mesh.triangles, mesh.positions.size());
  if (net.open_edges.count == 0) return;
  struct piece {
    double area = 0.0, filling = 0.0;
    std::size_t triangles = 0;
    std::uint32_t first = no_halfedge;
    bounds box;
  };
  std::vector<piece> pieces(net.components);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto c = corners(mesh.positions, mesh.triangles[t]);
    piece& p = pieces[net.component[t]];
    if (p.triangles++ == 0) {
      p.first = t;
      p.box = {c[0], c[0]};
    }
    p.area += 0.5 * glm::length(area_normal(c));
    for (const vec3& at : c) {
      p.box.low = glm::min(p.box.low, at);
      p.box.high = glm::max(p.box.high, at);
    }
  }
  double whole = 0.0;
  for (const piece& p : pieces) whole += p.area;
  for (const auto& hole : find_holes(net)) {
    const vec3 apex = mesh.positions[origin_of(mesh.triangles, hole.front())];
    vec3 twice{0.0};
    for (const std::uint32_t h : hole)
      twice += glm::cross(mesh.positions[origin_of(mesh.triangles, h)] - apex,
                          mesh.positions[origin_of(mesh.triangles, next_halfedge(h))] - apex);
    pieces[net.component[hole.front() / 3]].filling += 0.5 * glm::length(twice);
  }
  std::vector<bool> loose(pieces.size(), false);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const piece& p = pieces[i];
    loose[i] = p.area < largest_piece_share * whole && p.filling > largest_piece_filling * (p.area + p.filling);
    if (loose[i])
      report.add(repair_kind::loose_piece, mesh.positions[mesh.triangles[p.first][0]], p.box.diagonal(), p.triangles);
  }
  std::vector<bool> gone(mesh.triangles.size(), false);
  for (std::size_t t = 0; t < gone.size(); ++t) gone[t] = loose[net.component[t]];
  drop_triangles(mesh, gone);
}

void close_all_holes(triangle_mesh& mesh, const repair_settings& settings, repair_report& report) {
  const connectivity net = connect(mesh.triangles, mesh.positions.size());
  double budget = most_filling_steps;
  const std::size_t before = mesh.triangles.size();
  std::vector<closed_hole> holes;
  for (auto& border : find_simple_holes(mesh, net)) {
    report.add(repair_kind::hole, mesh.positions[origin_of(mesh.triangles, border.front())],
               widest_distance(mesh, border));
    const std::size_t first = mesh.triangles.size();
    const double area = fill_hole(mesh, border, budget);
    holes.push_back({std::move(border), mesh.triangles.size() - first, area});
  }
  if (holes.empty()) return;
  mesh.uvs.clear();
  if (settings.smooth_holes)
    smooth_patches(mesh, net, holes, {report.area_added_m2, settings.largest_made_up_share, settings.threads});
  for (const closed_hole& hole : holes) {
    report.area_added_m2 += hole.area_m2;
    report.smooth_holes += hole.smooth ? 1U : 0U;
  }
  report.triangles_added += mesh.triangles.size() - before;
}

}  // namespace asperity::bake
