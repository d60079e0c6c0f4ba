#include "mesh_builder.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <span>
#include <string>

#include "file_bytes.hpp"

namespace asperity::io {
namespace {

constexpr std::uint32_t unset = std::numeric_limits<std::uint32_t>::max();

std::size_t hash(const vec3& p) noexcept {
  std::uint64_t h = 0;
  for (const double x : {p.x, p.y, p.z}) {
    h = (h ^ std::bit_cast<std::uint64_t>(x)) * 0x9e3779b97f4a7c15U;
    h ^= h >> 32;
  }
  return static_cast<std::size_t>(h);
}

/// New index of every position; equal positions get the same one, in the order of first appearance.
std::vector<std::uint32_t> weld(std::vector<vec3>& positions) {
  std::vector<std::uint32_t> slots(std::bit_ceil(2 * positions.size() + 1), unset);
  std::vector<std::uint32_t> renamed(positions.size());
  std::uint32_t kept = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const vec3 p = positions[i] + 0.0;  // -0 becomes +0, so that equal numbers are equal bits
    std::size_t slot = hash(p) & (slots.size() - 1);
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

/// Twice the signed area of a triangle in the plane.
double area2(const vec2& a, const vec2& b, const vec2& c) noexcept {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// The polygon in the plane of its Newell normal's largest axis, so that it turns counter-clockwise.
std::vector<vec2> project(const std::vector<vec3>& positions, std::span<const std::uint32_t> polygon) {
  vec3 normal{0.0};
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    normal += glm::cross(positions[polygon[i]] - positions[polygon[0]],
                         positions[polygon[(i + 1) % polygon.size()]] - positions[polygon[0]]);
  }
  const vec3 size = glm::abs(normal);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
  std::vector<vec2> flat;
  for (const std::uint32_t v : polygon) {
    const vec3& p = positions[v];
    const vec2 q(p[(axis + 1) % 3], p[(axis + 2) % 3]);
    flat.push_back(normal[axis] < 0.0 ? vec2(q.y, q.x) : q);
  }
  return flat;
}

/// Splits polygons into triangles of corner numbers (places in the polygon, not vertices).
class polygon_splitter {
 public:
  /// @return false for a concave polygon with too many corners
  bool split(const std::vector<vec3>& positions, std::span<const std::uint32_t> polygon) {
    triangles.clear();
    const std::size_t n = polygon.size();
    if (n == 3) {
      triangles.push_back({0, 1, 2});
      return true;
    }
    const std::vector<vec2> flat = project(positions, polygon);
    bool convex = true;
    for (std::size_t i = 0; i < n; ++i) convex = convex && area2(flat[i], flat[(i + 1) % n], flat[(i + 2) % n]) >= 0.0;
    if (convex) {
      for (std::size_t i = 1; i + 1 < n; ++i) triangles.push_back({0, i, i + 1});
      return true;
    }
    if (n > max_concave_corners) return false;
    cut_ears(flat);
    return true;
  }

  std::vector<std::array<std::size_t, 3>> triangles;

 private:
  static constexpr std::size_t max_concave_corners = 256;

  void cut_ears(const std::vector<vec2>& flat) {
    std::vector<std::size_t> rest(flat.size());
    for (std::size_t i = 0; i < rest.size(); ++i) rest[i] = i;
    while (rest.size() > 3) {
      std::size_t ear = 0;  // a polygon that crosses itself may have none: then cut anywhere, every corner stays used
      for (std::size_t i = 0; i < rest.size(); ++i) {
        if (is_ear(flat, rest, i)) {
          ear = i;
          break;
        }
      }
      const std::size_t n = rest.size();
      triangles.push_back({rest[(ear + n - 1) % n], rest[ear], rest[(ear + 1) % n]});
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(ear));
    }
    triangles.push_back({rest[0], rest[1], rest[2]});
  }

  static bool is_ear(const std::vector<vec2>& flat, const std::vector<std::size_t>& rest, std::size_t i) {
    const std::size_t n = rest.size();
    const vec2& a = flat[rest[(i + n - 1) % n]];
    const vec2& b = flat[rest[i]];
    const vec2& c = flat[rest[(i + 1) % n]];
    if (!(area2(a, b, c) > 0.0)) return false;
    for (const std::size_t k : rest) {
      const vec2& p = flat[k];
      if (p == a || p == b || p == c) continue;
      if (area2(a, b, p) >= 0.0 && area2(b, c, p) >= 0.0 && area2(c, a, p) >= 0.0) return false;
    }
    return true;
  }
};

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

}  // namespace

result<triangle_mesh> build_mesh(polygon_soup&& soup, const std::filesystem::path& file) {
  if (soup.ends.empty()) {
    return fault(error_code::bad_format, file, "holds no faces; export it as a surface mesh, not as points or curves");
  }
  const std::vector<std::uint32_t> renamed = weld(soup.positions);
  triangle_mesh mesh;
  mesh.positions = std::move(soup.positions);
  mesh.triangles.reserve(soup.corners.size() - 2 * soup.ends.size());
  for (std::uint32_t& v : soup.corners) v = renamed[v];

  polygon_splitter splitter;
  std::size_t first = 0;
  for (std::size_t k = 0; k < soup.ends.size(); ++k) {
    const auto polygon = std::span(soup.corners).subspan(first, soup.ends[k] - first);
    if (!splitter.split(mesh.positions, polygon)) {
      return fault(error_code::limit_exceeded, file,
                   "face " + std::to_string(k) + " is concave and has " + std::to_string(polygon.size()) +
                       " corners, more than the limit of 256; triangulate the mesh before exporting it");
    }
    for (const auto& t : splitter.triangles) {
      mesh.triangles.push_back({polygon[t[0]], polygon[t[1]], polygon[t[2]]});
      if (!soup.corner_uvs.empty()) {
        mesh.uvs.push_back(
            {soup.corner_uvs[first + t[0]], soup.corner_uvs[first + t[1]], soup.corner_uvs[first + t[2]]});
      }
    }
    first = soup.ends[k];
  }
  drop_unused(mesh);
  if (mesh.positions.capacity() > 2 * mesh.positions.size()) mesh.positions.shrink_to_fit();  // STL: six times as many
  return mesh;
}

}  // namespace asperity::io
