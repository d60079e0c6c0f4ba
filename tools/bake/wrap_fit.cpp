#include "bake/wrap_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "bake/geometry.hpp"
#include "bake/halfedges.hpp"
#include "bake/parallel.hpp"
#include "bake/self_crossing.hpp"
#include "bake/winding_number.hpp"

namespace asperity::bake {
namespace {

constexpr double reach_in_cells = 0.5;
constexpr double least_facing = 0.3;  // cosine between the surfaces
constexpr double least_turn = 0.5;    // cosine that a triangle may turn by
constexpr double least_height_in_cells = 0.02;
constexpr int rounds = 2;
constexpr int most_mends = 8;

// Triangles around each vertex.
class stars {
 public:
  explicit stars(const triangle_mesh& mesh) : first_(mesh.positions.size() + 1, 0), around_(3 * mesh.triangles.size()) {
    for (const index_triangle& t : mesh.triangles)
      for (const std::uint32_t v : t) ++first_[v + 1];
    for (std::size_t v = 1; v < first_.size(); ++v) first_[v] += first_[v - 1];
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
      for (const std::uint32_t v : mesh.triangles[t]) around_[next[v]++] = t;
  }
  [[nodiscard]] std::span<const std::uint32_t> of(std::size_t v) const noexcept {
    return std::span(around_).subspan(first_[v], first_[v + 1] - first_[v]);
  }

 private:
  std::vector<std::uint32_t> first_;
  std::vector<std::uint32_t> around_;
};

bool harmless(const triangle_mesh& mesh, const stars& around, const std::vector<vec3>& facing, std::uint32_t v,
              const vec3& to, double least_height) {
  return std::ranges::all_of(around.of(v), [&](std::uint32_t t) {
    auto c = corners(mesh.positions, mesh.triangles[t]);
    for (std::size_t k = 0; k < 3; ++k)
      if (mesh.triangles[t][k] == v) c[k] = to;
    const vec3 n = area_normal(c);
    const double twice_area = glm::length(n);
    const double longest = std::max({glm::length(c[1] - c[0]), glm::length(c[2] - c[1]), glm::length(c[0] - c[2])});
    return twice_area > least_height * longest && glm::dot(n, facing[t]) > least_turn * twice_area;
  });
}

struct component_shape {
  double volume = 0.0;
  bounds box;
  std::uint32_t first = no_halfedge;  // a triangle of it
};

std::vector<component_shape> shapes_of(const triangle_mesh& mesh, const connectivity& net) {
  std::vector<component_shape> out(net.components);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    component_shape& part = out[net.component[t]];
    const auto c = corners(mesh.positions, mesh.triangles[t]);
    if (part.first == no_halfedge) {
      part.first = t;
      part.box = {c[0], c[0]};
    }
    part.volume += glm::dot(c[0], glm::cross(c[1], c[2])) / 6.0;
    for (const vec3& p : c) {
      part.box.low = glm::min(part.box.low, p);
      part.box.high = glm::max(part.box.high, p);
    }
  }
  return out;
}

void keep_parts(triangle_mesh& mesh, const connectivity& net, const std::vector<char>& keep) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (keep[net.component[t]] != 0) mesh.triangles[kept++] = mesh.triangles[t];
  mesh.triangles.resize(kept);
}

}  // namespace

bool fit_to_original(triangle_mesh& mesh, const triangle_mesh& original, const triangle_bvh& tree, double cell_m,
                     unsigned threads, stage_monitor& monitor) {
  const std::vector<vec3> normals = vertex_normals(mesh.positions, mesh.triangles);
  std::vector<vec3> facing(mesh.triangles.size());
  for (std::size_t t = 0; t < facing.size(); ++t) facing[t] = unit_normal(corners(mesh.positions, mesh.triangles[t]));
  std::vector<vec3> wanted = mesh.positions;
  const auto aim = [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const auto found = tree.closest(mesh.positions[v], reach_in_cells * cell_m);
      if (found.triangle == no_halfedge) continue;
      const vec3 n = unit_normal(corners(original.positions, original.triangles[found.triangle]));
      if (glm::dot(n, normals[v]) > least_facing) wanted[v] = found.point;
    }
  };
  if (!parallel_blocks(mesh.positions.size(), threads, monitor, monitor.done(), monitor.done(), aim)) return false;

  const std::vector<vec3> before = mesh.positions;
  const stars around(mesh);
  for (int round = 0; round < rounds; ++round)
    for (std::uint32_t v = 0; v < wanted.size(); ++v)
      if (mesh.positions[v] != wanted[v] &&
          harmless(mesh, around, facing, v, wanted[v], least_height_in_cells * cell_m))
        mesh.positions[v] = wanted[v];

  for (int mend = 0; mend < most_mends; ++mend) {
    const triangle_bvh own(mesh.positions, mesh.triangles, threads, &monitor);
    if (monitor.cancelled()) return false;
    const auto crossing = list_self_crossings(mesh, own, threads, most_listed_crossings, monitor);
    if (!crossing) return false;
    if (crossing->empty()) return true;
    for (const auto& [a, b] : *crossing)
      for (const std::uint32_t t : {a, b})
        for (const std::uint32_t v : mesh.triangles[t])
          // One ring more each time: a triangle that went back alone may cross what stayed.
          for (const std::uint32_t beside : around.of(v)) {
            mesh.positions[v] = before[v];
            if (mend > 0)
              for (const std::uint32_t w : mesh.triangles[beside]) mesh.positions[w] = before[w];
          }
  }
  mesh.positions = before;
  return true;
}

std::optional<dropped_parts> keep_outermost(triangle_mesh& mesh, double smallest_m, unsigned threads,
                                            stage_monitor& monitor) {
  dropped_parts out;
  connectivity net = connect(mesh.triangles, mesh.positions.size());
  std::vector<component_shape> parts = shapes_of(mesh, net);
  std::vector<char> keep(parts.size(), 1);
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (!(parts[i].volume > 0.0)) {
      keep[i] = 0;
      ++out.cavities;
    }
  keep_parts(mesh, net, keep);
  if (mesh.triangles.empty()) return out;

  net = connect(mesh.triangles, mesh.positions.size());
  parts = shapes_of(mesh, net);
  keep.assign(parts.size(), 1);
  if (parts.size() > 1) {
    const triangle_bvh tree(mesh.positions, mesh.triangles, threads, &monitor);
    if (monitor.cancelled()) return std::nullopt;
    const winding_field field(tree);
    const auto largest = static_cast<std::size_t>(
        std::ranges::max_element(parts, {}, [](const component_shape& p) { return p.volume; }) - parts.begin());
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (i == largest) continue;
      const auto c = corners(mesh.positions, mesh.triangles[parts[i].first]);
      const vec3 just_outside = (c[0] + c[1] + c[2]) / 3.0 + 1e-6 * parts[i].box.diagonal() * unit_normal(c);
      if (field.at(just_outside) > 0.5) {
        keep[i] = 0;
        ++out.cavities;
      } else if (parts[i].box.diagonal() < smallest_m) {
        keep[i] = 0;
        ++out.specks;
      }
    }
    keep_parts(mesh, net, keep);
  }
  out.left = static_cast<std::size_t>(std::ranges::count(keep, 1));
  drop_unused_vertices(mesh);
  return out;
}

}  // namespace asperity::bake
