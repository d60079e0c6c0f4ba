#include "mesh_parts.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "asperity/model/textured_model.hpp"

namespace asperity::io {
namespace {

constexpr std::uint32_t no_number = std::numeric_limits<std::uint32_t>::max();

// The triangles of each part, with the vertices that they use. @param part below `parts`, per triangle
std::vector<mesh_part> take_apart(const triangle_mesh& mesh, std::span<const std::uint32_t> part, std::size_t parts) {
  std::vector<mesh_part> out(parts);
  std::vector<std::uint32_t> in_order(parts, no_number);  // place of a part among those that have triangles
  std::uint32_t used = 0;
  std::vector<std::vector<std::uint32_t>> triangles(parts);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    std::uint32_t& place = in_order[part[t]];
    if (place == no_number) place = used++;
    triangles[place].push_back(t);
  }
  out.resize(used);
  std::vector<std::uint32_t> number(mesh.positions.size(), no_number);
  for (std::uint32_t p = 0; p < used; ++p) {
    triangle_mesh& to = out[p].mesh;
    for (const std::uint32_t t : triangles[p]) {
      auto corner = mesh.triangles[t];
      for (std::uint32_t& v : corner) {
        if (number[v] == no_number) {
          number[v] = static_cast<std::uint32_t>(to.positions.size());
          to.positions.push_back(mesh.positions[v]);
        }
        v = number[v];
      }
      to.triangles.push_back(corner);
      if (!mesh.uvs.empty()) to.uvs.push_back(mesh.uvs[t]);
    }
    for (const std::uint32_t t : triangles[p])
      for (const std::uint32_t v : mesh.triangles[t]) number[v] = no_number;
  }
  return out;
}

bool within(const bounds& inner, const bounds& outer) {
  return glm::all(glm::greaterThanEqual(inner.low, outer.low)) && glm::all(glm::lessThanEqual(inner.high, outer.high));
}

}  // namespace

std::vector<mesh_part> named_parts(const triangle_mesh& mesh, const part_list& named) {
  if (named.of_triangle.size() != mesh.triangles.size()) return {};
  std::vector<std::uint32_t> order;
  std::vector<bool> seen(named.names.size(), false);
  for (const std::uint32_t p : named.of_triangle) {
    if (!seen[p]) order.push_back(p);
    seen[p] = true;
  }
  std::vector<mesh_part> out = take_apart(mesh, named.of_triangle, named.names.size());
  for (std::size_t p = 0; p < out.size(); ++p) out[p].name = named.names[order[p]];
  return out;
}

std::optional<std::vector<mesh_part>> separate_surfaces(const triangle_mesh& mesh) {
  std::vector<std::uint32_t> root(mesh.positions.size());
  std::iota(root.begin(), root.end(), 0U);
  const auto find = [&](std::uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (const auto& t : mesh.triangles)
    for (const std::size_t k : {std::size_t{1}, std::size_t{2}}) {
      const std::uint32_t a = find(t[0]), b = find(t[k]);
      root[std::max(a, b)] = std::min(a, b);
    }
  std::vector<std::uint32_t> part(mesh.triangles.size());
  std::vector<std::uint32_t> number(mesh.positions.size(), no_number);
  std::vector<bounds> boxes;
  for (std::size_t t = 0; t < part.size(); ++t) {
    std::uint32_t& mine = number[find(mesh.triangles[t][0])];
    if (mine == no_number) {
      if (boxes.size() == max_mesh_parts) return std::nullopt;
      mine = static_cast<std::uint32_t>(boxes.size());
      const vec3& start = mesh.positions[mesh.triangles[t][0]];
      boxes.push_back({start, start});
    }
    part[t] = mine;
    for (const std::uint32_t v : mesh.triangles[t]) {
      boxes[mine].low = glm::min(boxes[mine].low, mesh.positions[v]);
      boxes[mine].high = glm::max(boxes[mine].high, mesh.positions[v]);
    }
  }
  std::vector<std::uint32_t> by_size(boxes.size());
  std::iota(by_size.begin(), by_size.end(), 0U);
  std::stable_sort(by_size.begin(), by_size.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return boxes[a].diagonal() > boxes[b].diagonal(); });
  std::vector<std::uint32_t> home(boxes.size());
  for (std::size_t i = 0; i < by_size.size(); ++i) {
    home[by_size[i]] = by_size[i];
    for (std::size_t j = 0; j < i; ++j)
      if (within(boxes[by_size[i]], boxes[by_size[j]])) {
        home[by_size[i]] = home[by_size[j]];
        break;
      }
  }
  for (std::uint32_t& p : part) p = home[p];
  return take_apart(mesh, part, boxes.size());
}

}  // namespace asperity::io
