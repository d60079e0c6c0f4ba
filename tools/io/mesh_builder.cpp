#include "mesh_builder.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <random>
#include <span>
#include <string>

#include "file_bytes.hpp"
#include "polygon_splitter.hpp"

namespace asperity::io {
namespace {

constexpr std::uint32_t unset = std::numeric_limits<std::uint32_t>::max();

/// A number that no file can know: positions that share a slot of the table below could otherwise be computed, and a
/// file of them would take quadratic time. It decides nothing but where in the table a position stands.
std::uint64_t secret() {
  static const std::uint64_t chosen = [] {
    std::random_device source;
    return std::uint64_t{source()} << 32U | source();
  }();
  return chosen;
}

std::size_t hash(const vec3& p, std::uint64_t h) noexcept {
  for (const double x : {p.x, p.y, p.z}) {  // SplitMix64 over each
    h = (h ^ std::bit_cast<std::uint64_t>(x)) + 0x9e3779b97f4a7c15U;
    h = (h ^ h >> 30U) * 0xbf58476d1ce4e5b9U;
    h = (h ^ h >> 27U) * 0x94d049bb133111ebU;
    h ^= h >> 31U;
  }
  return static_cast<std::size_t>(h);
}

/// New index of every position; equal positions get the same one, in the order of first appearance.
std::vector<std::uint32_t> weld(std::vector<vec3>& positions, reading_watch& watch) {
  const std::uint64_t key = secret();
  std::vector<std::uint32_t> slots(std::bit_ceil(2 * positions.size() + 1), unset);
  std::vector<std::uint32_t> renamed(positions.size());
  std::uint32_t kept = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    watch.step();
    const vec3 p = positions[i] + 0.0;  // -0 becomes +0, so that equal numbers are equal bits
    std::size_t slot = hash(p, key) & (slots.size() - 1);
    while (slots[slot] != unset && positions[slots[slot]] != p) slot = (slot + 1) & (slots.size() - 1);
    if (slots[slot] == unset) {
      slots[slot] = kept;
      positions[kept++] = p;
    }
    renamed[i] = slots[slot];
  }
  positions.resize(kept);
  return renamed;
}

/// Removes positions that no triangle uses; the others keep their order.
void drop_unused(triangle_mesh& mesh) {
  std::vector<std::uint32_t> renamed(mesh.positions.size(), unset);
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t v : t) renamed[v] = 0;
  }
  std::uint32_t kept = 0;
  for (std::size_t v = 0; v < renamed.size(); ++v) {
    if (renamed[v] == unset) continue;
    mesh.positions[kept] = mesh.positions[v];
    renamed[v] = kept++;
  }
  if (kept == mesh.positions.size()) return;
  mesh.positions.resize(kept);
  for (auto& t : mesh.triangles) {
    for (std::uint32_t& v : t) v = renamed[v];
  }
}

void check_count(std::uint64_t count, std::uint64_t most, const char* what, const char* mend) {
  if (count <= most) return;
  throw rejection{error_code::limit_exceeded, "has " + std::to_string(count) + " " + what + ", more than the " +
                                                  std::to_string(most) + " that " + mend};
}

}  // namespace

void check_vertex_count(std::uint64_t count) {
  check_count(count, max_mesh_vertices, "vertices", "a mesh may have; weld and decimate it first");
}

void check_triangle_count(std::uint64_t count) {
  check_count(count, max_mesh_triangles, "triangles", "a mesh may have; decimate it first");
}

void check_corner_count(std::uint64_t count) {
  check_count(count, max_polygon_corners, "corners in one face", "a polygon may have; triangulate the mesh first");
}

std::uint32_t part_list::number_of(std::string_view name, bool fresh) {
  if (!fresh) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end()) return static_cast<std::uint32_t>(found - names.begin());
  }
  check_count(names.size() + 1, max_mesh_parts, "parts", "can be told apart; join them");
  names.emplace_back(name);
  return static_cast<std::uint32_t>(names.size() - 1);
}

void polygon_soup::refuse_triangles() {
  throw rejection{error_code::limit_exceeded, "has more than the " + std::to_string(max_mesh_triangles) +
                                                  " triangles that a mesh may have; decimate it first"};
}

result<triangle_mesh> build_mesh(polygon_soup&& soup, const std::filesystem::path& file, reading_watch& watch) {
  if (soup.ends.empty()) {
    return fault(error_code::bad_format, file, "holds no faces; export it as a surface mesh, not as points or curves");
  }
  const std::vector<std::uint32_t> renamed = weld(soup.positions, watch);
  triangle_mesh mesh;
  mesh.positions = std::move(soup.positions);
  for (std::uint32_t& v : soup.corners) v = renamed[v];
  const std::size_t triangles = soup.corners.size() - 2 * soup.ends.size();
  mesh.triangles.reserve(triangles);
  if (!soup.corner_uvs.empty()) mesh.uvs.reserve(triangles);

  polygon_splitter splitter(mesh.positions);
  std::size_t first = 0;
  for (std::size_t k = 0; k < soup.ends.size(); ++k) {
    watch.step();
    const auto polygon = std::span(soup.corners).subspan(first, soup.ends[k] - first);
    if (!splitter.split(polygon, watch)) {
      return fault(error_code::limit_exceeded, file,
                   "face " + std::to_string(k) + " is concave, has " + std::to_string(polygon.size()) +
                       " corners and winds too much to be split; triangulate the mesh before exporting it");
    }
    for (const auto& t : splitter.triangles()) {
      mesh.triangles.push_back({polygon[t[0]], polygon[t[1]], polygon[t[2]]});
      if (soup.parts != nullptr) soup.parts->of_triangle.push_back(soup.part_of_polygon[k]);
      if (soup.corner_uvs.empty()) continue;
      const auto uv = [&](std::uint32_t corner) { return soup.uvs[soup.corner_uvs[first + corner]]; };
      mesh.uvs.push_back({uv(t[0]), uv(t[1]), uv(t[2])});
    }
    first = soup.ends[k];
  }
  drop_unused(mesh);
  if (mesh.positions.capacity() > 2 * mesh.positions.size()) mesh.positions.shrink_to_fit();  // STL: six times as many
  return mesh;
}

}  // namespace asperity::io
