#include "bake/check.hpp"

#include <algorithm>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "bake/geometry.hpp"
#include "bake/halfedges.hpp"
#include "bake/winding.hpp"

namespace asperity::bake {
namespace {

std::string text(const vec3& p) {
  std::ostringstream out;
  out.precision(6);
  out << "(" << p.x << ", " << p.y << ", " << p.z << ") m";
  return out.str();
}

std::string counted(std::size_t n, std::string_view one, std::string_view many) {
  return std::to_string(n) + " " + std::string(n == 1 ? one : many);
}

error bad(std::string_view what, const std::string& fault, std::string_view mend) {
  return {error_code::bad_mesh, std::string(what) + " " + fault + "; " + std::string(mend)};
}

std::optional<error> check_numbers(const triangle_mesh& mesh, std::string_view what) {
  if (mesh.positions.empty() || mesh.triangles.empty())
    return bad(what, "is empty", "give a file that contains triangles");
  if (mesh.triangles.size() > most_triangles)
    return error{error_code::limit_exceeded, std::string(what) + " has " + std::to_string(mesh.triangles.size()) +
                                                 " triangles, more than the " + std::to_string(most_triangles) +
                                                 " that a bake takes; decimate it first"};
  if (mesh.positions.size() > 3 * most_triangles)
    return error{error_code::limit_exceeded, std::string(what) + " has " + std::to_string(mesh.positions.size()) +
                                                 " vertices, more than its triangles can use; remove unused vertices"};
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t]) {
      if (v >= mesh.positions.size())
        return bad(what,
                   "has a vertex index out of range: triangle " + std::to_string(t) + " uses vertex " +
                       std::to_string(v) + " of " + std::to_string(mesh.positions.size()),
                   "export it again, the file is damaged");
      if (!is_finite(mesh.positions[v]))
        return bad(what,
                   "has a coordinate that is not a number: vertex " + std::to_string(v) + ", used by triangle " +
                       std::to_string(t),
                   "remove or correct that vertex");
    }
  if (mesh.triangles.size() < 4)
    return bad(what, "has " + counted(mesh.triangles.size(), "triangle", "triangles") + ", too few to enclose a volume",
               "give a closed surface of at least 4 triangles");
  return std::nullopt;
}

// The mesh without unused vertices, and without texture coordinates that are not there for all triangles, in place.
void compact(triangle_mesh& mesh) {
  if (mesh.uvs.size() != mesh.triangles.size()) mesh.uvs = {};
  drop_unused_vertices(mesh);
}

std::optional<error> check_size(const triangle_mesh& mesh, std::string_view what) {
  const bounds box = bounds_of(mesh.positions);
  const double diagonal = box.diagonal();
  std::ostringstream size;
  size << "measures " << diagonal << " m across";
  if (!(diagonal <= largest_diagonal_m))
    return bad(what, size.str() + ", which looks like a mix-up of units",
               "scale it to metres (a file in millimetres: 0.001)");
  if (diagonal < smallest_diagonal_m) return bad(what, size.str() + ", too small to be felt", "scale it to metres");
  const vec3 reach = glm::max(glm::abs(box.low), glm::abs(box.high));
  if (std::max({reach.x, reach.y, reach.z}) > farthest_in_diagonals * diagonal)
    return bad(what, size.str() + " but lies near " + text(box.low) + ", where single precision is too coarse for it",
               "move it to the origin");
  return std::nullopt;
}

std::optional<error> check_areas(const triangle_mesh& mesh, std::string_view what) {
  const double reach = [&] {
    const bounds box = bounds_of(mesh.positions);
    const vec3 far = glm::max(glm::abs(box.low), glm::abs(box.high));
    return std::max({far.x, far.y, far.z});
  }();
  fault_count zero;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (has_no_area(corners(mesh.positions, mesh.triangles[t]), reach)) zero.add(static_cast<std::uint32_t>(t));
  }
  if (zero.count == 0) return std::nullopt;
  const vec3 at = mesh.positions[mesh.triangles[zero.first][0]];
  return bad(what,
             "has " + counted(zero.count, "triangle", "triangles") + " without area, the first is triangle " +
                 std::to_string(zero.first) + " at " + text(at),
             "merge vertices that lie in one place and remove degenerate faces");
}

std::optional<error> check_connectivity(const triangle_mesh& mesh, const connectivity& net, std::string_view what) {
  const auto at_edge = [&](const fault_count& fault) {
    const vec3 a = mesh.positions[origin_of(mesh.triangles, fault.first)];
    const vec3 b = mesh.positions[origin_of(mesh.triangles, next_halfedge(fault.first))];
    return "the first is at " + text(0.5 * (a + b)) + " in triangle " + std::to_string(fault.first / 3);
  };
  if (net.non_manifold_edges.count > 0)
    return bad(what,
               "has " + counted(net.non_manifold_edges.count, "edge", "edges") + " with more than two triangles, " +
                   at_edge(net.non_manifold_edges),
               "remove duplicate or inner faces");
  if (net.open_edges.count > 0)
    return bad(
        what,
        "is not closed: " + counted(net.open_edges.count, "open edge", "open edges") + ", " + at_edge(net.open_edges),
        "close the holes (a bake without --strict does it) and weld vertices that lie in one place");
  if (net.misoriented_edges.count > 0)
    return bad(what,
               "has " + counted(net.misoriented_edges.count, "edge", "edges") +
                   " whose triangles wind in opposite senses, " + at_edge(net.misoriented_edges),
               "it has only one side, as a Klein bottle has; cut it open or remove faces");
  if (net.non_manifold_vertices.count > 0)
    return bad(what,
               "has " + counted(net.non_manifold_vertices.count, "vertex", "vertices") +
                   " where surfaces touch in a point, the first is vertex " +
                   std::to_string(net.non_manifold_vertices.first) + " at " +
                   text(mesh.positions[net.non_manifold_vertices.first]),
               "split such vertices, one for each surface");
  return std::nullopt;
}

struct component_extent {
  double volume_m3 = 0.0;
  bounds box;
  std::uint32_t first_triangle = 0;
};

std::vector<component_extent> measure_components(const triangle_mesh& mesh, const connectivity& net) {
  std::vector<component_extent> out(net.components);
  std::vector<bool> seen(net.components, false);
  const vec3 apex = mesh.positions.front();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto c = corners(mesh.positions, mesh.triangles[t]);
    component_extent& part = out[net.component[t]];
    if (!seen[net.component[t]]) {
      seen[net.component[t]] = true;
      part.box = {c[0], c[0]};
      part.first_triangle = static_cast<std::uint32_t>(t);
    }
    part.volume_m3 += glm::dot(c[0] - apex, glm::cross(c[1] - apex, c[2] - apex)) / 6.0;
    for (const vec3& p : c) {
      part.box.low = glm::min(part.box.low, p);
      part.box.high = glm::max(part.box.high, p);
    }
  }
  return out;
}

bool inside(const bounds& inner, const bounds& outer) noexcept {
  return glm::all(glm::greaterThanEqual(inner.low, outer.low)) && glm::all(glm::lessThanEqual(inner.high, outer.high));
}

// Turns a mesh that is inside-out as a whole; refuses one that is so in part, cavities excepted.
std::optional<error> orient(checked_mesh& out, const connectivity& net, std::string_view what) {
  std::vector<component_extent> parts = measure_components(out.mesh, net);
  double volume = 0.0;
  for (const component_extent& part : parts) volume += part.volume_m3;
  const double size = bounds_of(out.mesh.positions).diagonal();
  if (std::abs(volume) < 1e-12 * size * size * size)
    return bad(what, "encloses no volume", "give a surface that bounds a solid");
  if (volume < 0.0) {
    out.flipped = true;
    for (std::size_t t = 0; t < out.mesh.triangles.size(); ++t) turn(out.mesh, t);
    for (component_extent& part : parts) part.volume_m3 = -part.volume_m3;
  }
  for (const component_extent& part : parts) {
    if (part.volume_m3 > 0.0) continue;
    const bool cavity = std::any_of(parts.begin(), parts.end(), [&](const component_extent& other) {
      return other.volume_m3 > -part.volume_m3 && inside(part.box, other.box);
    });
    if (!cavity)
      return bad(what,
                 "has a component that is inside-out, with triangle " + std::to_string(part.first_triangle) + " at " +
                     text(out.mesh.positions[out.mesh.triangles[part.first_triangle][0]]),
                 "flip the normals of that component");
  }
  return std::nullopt;
}

}  // namespace

result<checked_mesh> check(triangle_mesh mesh, std::string_view what) {
  if (auto fault = check_numbers(mesh, what)) return *fault;
  checked_mesh out;
  out.mesh = std::move(mesh);
  compact(out.mesh);
  if (auto fault = check_size(out.mesh, what)) return *fault;
  if (auto fault = check_areas(out.mesh, what)) return *fault;
  connectivity net = connect(out.mesh.triangles, out.mesh.positions.size());
  if (net.misoriented_edges.count > 0 && net.open_edges.count + net.non_manifold_edges.count == 0) {
    if (const auto turned = make_winding_consistent(out.mesh)) {
      out.turned_triangles = *turned;
      net = connect(out.mesh.triangles, out.mesh.positions.size());
    }
  }
  if (auto fault = check_connectivity(out.mesh, net, what)) return *fault;
  out.components = net.components;
  out.euler = net.euler;
  if (auto fault = orient(out, net, what)) return *fault;
  return out;
}

}  // namespace asperity::bake
