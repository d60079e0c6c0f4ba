#include "asperity/bake/repair.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "bake/check.hpp"
#include "bake/halfedges.hpp"
#include "bake/repair_steps.hpp"
#include "bake/winding.hpp"

namespace asperity::bake {

void repair_report::add(repair_kind kind, const vec3& at, double change_m, std::size_t count) noexcept {
  repair_action& action = actions[static_cast<std::size_t>(kind)];
  if (action.count == 0) action.first = at;
  action.count += count;
  action.largest_m = std::max(action.largest_m, change_m);
}

std::size_t repair_report::total() const noexcept {
  std::size_t sum = 0;
  for (const repair_action& action : actions) sum += action.count;
  return sum;
}

const char* to_string(repair_kind kind) noexcept {
  constexpr std::array<const char*, repair_kinds> names{
      "weld",   "degenerate",  "t_junction", "duplicate",         "inner_wall",      "split_edge", "split_vertex",
      "turned", "loose_piece", "hole",       "turned_inside_out", "inner_component", "crossing"};
  return names[static_cast<std::size_t>(kind)];
}

const char* in_words(repair_kind kind, std::size_t count) noexcept {
  constexpr std::array<std::array<const char*, 2>, repair_kinds> words{
      {{"vertex welded", "vertices welded"},
       {"triangle without area dropped", "triangles without area dropped"},
       {"vertex set into an edge that it lies on", "vertices set into edges that they lie on"},
       {"duplicate face dropped", "duplicate faces dropped"},
       {"triangle of a fin or an inner wall dropped", "triangles of fins or inner walls dropped"},
       {"edge of more than two triangles parted", "edges of more than two triangles parted"},
       {"vertex parted where surfaces touched", "vertices parted where surfaces touched"},
       {"triangle turned that wound against its neighbours", "triangles turned that wound against their neighbours"},
       {"triangle of a loose piece dropped", "triangles of loose pieces dropped"},
       {"hole closed", "holes closed"},
       {"component turned that was inside-out", "components turned that were inside-out"},
       {"component dropped that nothing can touch", "components dropped that nothing can touch"},
       {"crossing of two triangles resolved", "crossings of two triangles resolved"}}};
  return words[static_cast<std::size_t>(kind)][count == 1 ? 0 : 1];
}

void drop_triangles(triangle_mesh& mesh, const std::vector<bool>& gone) {
  const bool has_uvs = mesh.uvs.size() == mesh.triangles.size();
  std::size_t kept = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (gone[t]) continue;
    mesh.triangles[kept] = mesh.triangles[t];
    if (has_uvs) mesh.uvs[kept] = mesh.uvs[t];
    ++kept;
  }
  mesh.triangles.resize(kept);
  if (has_uvs) mesh.uvs.resize(kept);
}

void split_at_edge(triangle_mesh& mesh, std::uint32_t t, std::uint32_t k, std::uint32_t v, double s) {
  index_triangle second = mesh.triangles[t];
  second[k] = v;
  const std::uint32_t next = (k + 1) % 3;
  if (mesh.uvs.size() == mesh.triangles.size()) {
    auto uv = mesh.uvs[t];
    const vec2 at = (1.0 - s) * uv[k] + s * uv[next];
    mesh.uvs[t][next] = at;
    uv[k] = at;
    mesh.uvs.push_back(uv);
  }
  mesh.triangles[t][next] = v;
  mesh.triangles.push_back(second);
}

double area_of(const triangle_mesh& mesh) {
  double sum = 0.0;
  for (const index_triangle& t : mesh.triangles) sum += 0.5 * glm::length(area_normal(corners(mesh.positions, t)));
  return sum;
}

double volume_of(const triangle_mesh& mesh) {
  double six = 0.0;
  const vec3 apex = mesh.positions.front();
  for (const index_triangle& t : mesh.triangles) {
    const auto c = corners(mesh.positions, t);
    six += glm::dot(c[0] - apex, glm::cross(c[1] - apex, c[2] - apex));
  }
  return six / 6.0;
}

double reach_of(const triangle_mesh& mesh) {
  const bounds box = bounds_of(mesh.positions);
  const vec3 far = glm::max(glm::abs(box.low), glm::abs(box.high));
  return std::max({far.x, far.y, far.z});
}

namespace {

constexpr double least_weld_in_diagonals = 1e-6;
constexpr double least_volume = 1e-9;  // of the cube of the diagonal: less bounds no solid

/// What no repair can read, and what check refuses for its size, is left to check.
bool is_readable(const triangle_mesh& mesh) {
  if (mesh.triangles.size() < 4 || mesh.triangles.size() > most_triangles) return false;
  if (mesh.positions.size() > 3 * most_triangles) return false;
  for (const index_triangle& t : mesh.triangles)
    for (const std::uint32_t v : t)
      if (v >= mesh.positions.size() || !is_finite(mesh.positions[v])) return false;
  return true;
}

struct faults {
  bool flat = false;  // a triangle without area
  connectivity net;

  [[nodiscard]] bool none() const { return !flat && net.closed_manifold(); }
  /// Winding alone is what check mends.
  [[nodiscard]] bool winding_only() const {
    return !flat && net.open_edges.count + net.non_manifold_edges.count + net.non_manifold_vertices.count == 0;
  }
};

faults faults_of(const triangle_mesh& mesh) {
  faults out;
  const double reach = reach_of(mesh);
  for (const index_triangle& t : mesh.triangles) out.flat = out.flat || has_no_area(corners(mesh.positions, t), reach);
  out.net = connect(mesh.triangles, mesh.positions.size());
  return out;
}

std::string percent(double share) {
  std::ostringstream out;
  out.precision(3);
  out << 100.0 * share << " %";
  return out.str();
}

error not_mended(const std::string& what) {
  return {error_code::bad_mesh, "the mesh " + what + "; mend it in a mesh editor"};
}

std::string what_is_left(const faults& left) {
  const auto counted = [](std::size_t n, const char* one, const char* many) {
    return std::to_string(n) + (n == 1 ? one : many);
  };
  if (left.net.non_manifold_edges.count > 0)
    return counted(left.net.non_manifold_edges.count, " edge", " edges") + " with more than two triangles";
  if (left.net.open_edges.count > 0) return counted(left.net.open_edges.count, " open edge", " open edges");
  if (left.net.misoriented_edges.count > 0) return "only one side, as a Klein bottle has,";
  if (left.net.non_manifold_vertices.count > 0)
    return counted(left.net.non_manifold_vertices.count, " vertex", " vertices") + " where surfaces touch in a point";
  return "triangles without area";
}

result<void> make_closed_manifold(triangle_mesh& mesh, const repair_settings& settings, repair_report& report) {
  constexpr int most_rounds = 4;
  const double tolerance_m =
      std::max(settings.weld_in_diagonals, least_weld_in_diagonals) * bounds_of(mesh.positions).diagonal();
  for (int round = 0; round < most_rounds; ++round) {
    drop_degenerate(mesh, report);
    if (round == 0) {
      weld_borders(mesh, tolerance_m, report);
      drop_degenerate(mesh, report);
      split_t_junctions(mesh, tolerance_m, report);
    }
    drop_duplicates(mesh, report);
    drop_inner_walls(mesh, report);
    part_sheets(mesh, report);
    const std::vector<index_triangle> before = mesh.triangles;
    if (const auto turned = make_winding_consistent(mesh); turned && *turned > 0) {
      const auto [first, was] = std::ranges::mismatch(mesh.triangles, before);
      report.add(repair_kind::turned, mesh.positions[first->front()], 0.0, *turned);
    }
    drop_loose_pieces(mesh, report);
    if (mesh.triangles.size() < 4) return not_mended("has no part that bounds a volume");
    if (settings.close_holes) close_all_holes(mesh, settings, report);
    if (faults_of(mesh).none()) return {};
  }
  return not_mended("cannot be repaired, it still has " + what_is_left(faults_of(mesh)));
}

}  // namespace

result<repair_report> repair(triangle_mesh& given, const repair_settings& settings) {
  repair_report report;
  report.triangles_before = report.triangles_after = given.triangles.size();
  if (!is_readable(given)) return report;
  triangle_mesh mesh = given;
  if (mesh.uvs.size() != mesh.triangles.size()) mesh.uvs.clear();
  drop_unused_vertices(mesh);
  if (!(bounds_of(mesh.positions).diagonal() > 0.0)) return report;
  if (const faults found = faults_of(mesh); !found.winding_only()) {
    if (const result<void> ok = make_closed_manifold(mesh, settings, report); !ok) return ok.error();
    drop_unused_vertices(mesh);
  } else if (!found.net.closed_manifold()) {
    return report;  // check turns triangles that wind against their neighbours
  }
  report.made_up_share = report.area_added_m2 / area_of(mesh);
  if (report.made_up_share > settings.largest_made_up_share) {
    const repair_action& holes = report[repair_kind::hole];
    return not_mended("is too open to be closed: " + std::to_string(holes.count) +
                      (holes.count == 1 ? " hole" : " holes") + " would make up " + percent(report.made_up_share) +
                      " of its surface, more than " + percent(settings.largest_made_up_share));
  }
  // One may make work for the other: a component that was turned, or cut apart, may lie in another now.
  constexpr int most_rounds = 4;
  for (int round = 0; round < most_rounds; ++round) {
    const std::size_t before = report.total();
    order_components(mesh, settings, report);
    if (settings.uncross) uncross(mesh, settings, report);
    if (report.total() == before) break;
  }
  if (report.total() == 0) return report;
  if (!(std::abs(volume_of(mesh)) > least_volume * std::pow(bounds_of(mesh.positions).diagonal(), 3)))
    return not_mended("bounds no volume");
  report.triangles_after = mesh.triangles.size();
  given = std::move(mesh);
  return report;
}

}  // namespace asperity::bake
