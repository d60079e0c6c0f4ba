// Faces that are there more than once.
#include <algorithm>
#include <tuple>

#include "bake/edge_table.hpp"
#include "bake/repair_steps.hpp"

namespace asperity::bake {
namespace {

/// Does the triangle wind as its sorted vertices do?
bool winds_up(const index_triangle& t) noexcept { return (t[0] < t[1]) + (t[1] < t[2]) + (t[2] < t[0]) == 2; }

/// Doubled faces that join in common edges, and whether all of their rim hangs on surface that is closed without them.
class doubled_regions {
 public:
  doubled_regions(const std::vector<index_triangle>& faces, const std::vector<bool>& doubled) : sets_(faces.size()) {
    const std::vector<edge_use> edges = edges_of(faces);
    const auto inner = [&](std::span<const edge_use> uses) {
      return uses.size() == 2 && doubled[uses[0].halfedge / 3] && doubled[uses[1].halfedge / 3];
    };
    for_each_edge(edges, [&](std::span<const edge_use> uses) {
      if (inner(uses)) sets_.join(uses[0].halfedge / 3, uses[1].halfedge / 3);
    });
    hangs_.assign(faces.size(), false);
    odd_.assign(faces.size(), false);
    for_each_edge(edges, [&](std::span<const edge_use> uses) {
      if (inner(uses)) return;
      for (const edge_use& e : uses) {
        const std::uint32_t region = sets_.find(e.halfedge / 3);
        if (uses.size() % 2 == 0) odd_[region] = true;
        if (uses.size() > 2) hangs_[region] = true;
      }
    });
  }
  /// A wall or a fin: without both its sides, what is left is closed along its rim.
  [[nodiscard]] bool is_wall(std::uint32_t face) noexcept {
    const std::uint32_t region = sets_.find(face);
    return hangs_[region] && !odd_[region];
  }

 private:
  disjoint_sets sets_;
  std::vector<bool> hangs_, odd_;
};

}  // namespace

// Copies that face the same way: one stays. Faces that are there both ways: one side stays, so that a mesh whose every
// face is doubled keeps one surface; of an inner wall or a fin neither does.
void drop_duplicates(triangle_mesh& mesh, repair_report& report) {
  std::vector<std::pair<index_triangle, std::uint32_t>> sorted;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    index_triangle v = mesh.triangles[t];
    std::ranges::sort(v);
    sorted.emplace_back(v, t);
  }
  std::ranges::sort(sorted);
  std::vector<bool> gone(mesh.triangles.size(), false);
  std::vector<index_triangle> faces;
  std::vector<bool> doubled;
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0, j = 0; i < sorted.size(); i = j) {
    bool both = false;
    const std::uint32_t first = sorted[i].second;
    for (j = i; j < sorted.size() && sorted[j].first == sorted[i].first; ++j) {
      if (j == i) continue;
      both = both || winds_up(mesh.triangles[sorted[j].second]) != winds_up(mesh.triangles[first]);
      gone[sorted[j].second] = true;
    }
    faces.push_back(mesh.triangles[first]);
    doubled.push_back(both);
    kept.push_back(first);
  }
  if (faces.size() == mesh.triangles.size()) return;
  doubled_regions regions(faces, doubled);
  for (std::uint32_t f = 0; f < faces.size(); ++f)
    if (doubled[f] && regions.is_wall(f)) gone[kept[f]] = true;
  for (std::size_t t = 0; t < gone.size(); ++t)
    if (gone[t]) report.add(repair_kind::duplicate, mesh.positions[mesh.triangles[t][0]], 0.0);
  drop_triangles(mesh, gone);
}

}  // namespace asperity::bake
