#include "bake/self_crossing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <vector>

#include "bake/geometry.hpp"
#include "bake/parallel.hpp"

namespace asperity::bake {
namespace {

using corner_list = std::array<vec3, 3>;

// Which side of a triangle's plane; 0 within the rounding of the coordinates.
int side_of(const corner_list& c, const vec3& normal, double slack, const vec3& p) noexcept {
  const double d = glm::dot(normal, p - c[0]);
  return d > slack ? 1 : d < -slack ? -1 : 0;
}

struct plane {
  corner_list c;
  vec3 normal;   // twice the area long
  double slack;  // of a side, in the same measure

  explicit plane(const corner_list& at) : c(at), normal(glm::cross(at[1] - at[0], at[2] - at[0])) {
    const double size = std::max({glm::length(c[1] - c[0]), glm::length(c[2] - c[1]), glm::length(c[0] - c[2])});
    slack = 1e-10 * size * glm::length(normal);
  }
  [[nodiscard]] int side(const vec3& p) const noexcept { return side_of(c, normal, slack, p); }
};

// The segment goes through the inside of the triangle.
bool pierces(const vec3& p, const vec3& q, const plane& t) noexcept {
  if (t.side(p) * t.side(q) >= 0) return false;
  const vec3 d = q - p;
  std::array<double, 3> turn{};
  for (std::size_t k = 0; k < 3; ++k) turn[k] = glm::dot(d, glm::cross(t.c[k] - p, t.c[(k + 1) % 3] - p));
  return (turn[0] > 0.0 && turn[1] > 0.0 && turn[2] > 0.0) || (turn[0] < 0.0 && turn[1] < 0.0 && turn[2] < 0.0);
}

bool has_vertex(const index_triangle& t, std::uint32_t v) noexcept { return t[0] == v || t[1] == v || t[2] == v; }

// Edges of `t` that do not end in a vertex of `other` against its inside.
bool an_edge_pierces(const index_triangle& t, const corner_list& c, const index_triangle& other, const plane& at) {
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    if (has_vertex(other, t[k]) || has_vertex(other, t[next])) continue;
    if (pierces(c[k], c[next], at)) return true;
  }
  return false;
}

bool cross(const triangle_mesh& mesh, const index_triangle& a, const plane& at_a, const index_triangle& b) {
  if (has_vertex(b, a[0]) + has_vertex(b, a[1]) + has_vertex(b, a[2]) > 1) return false;
  const corner_list cb = corners(mesh.positions, b);
  const int first = at_a.side(cb[0]);
  if (first != 0 && at_a.side(cb[1]) == first && at_a.side(cb[2]) == first) return false;
  return an_edge_pierces(b, cb, a, at_a) || an_edge_pierces(a, at_a.c, b, plane(cb));
}

// Calls found(block, triangle, other) once for every pair of which at least one is `from` or above. @return false where
// cancelled
template <class Found>
bool visit_crossings(const triangle_mesh& mesh, const triangle_bvh& tree, std::size_t from, unsigned threads,
                     stage_monitor& monitor, const Found& found) {
  const auto body = [&](std::size_t block, std::size_t begin, std::size_t end) {
    for (std::size_t t = from + begin; t < from + end; ++t) {
      const index_triangle& a = mesh.triangles[t];
      const plane at(corners(mesh.positions, a));
      const vec3 low = glm::min(at.c[0], glm::min(at.c[1], at.c[2]));
      const vec3 high = glm::max(at.c[0], glm::max(at.c[1], at.c[2]));
      tree.visit_box(low, high, [&](std::uint32_t other) {
        if ((other > t || other < from) && cross(mesh, a, at, mesh.triangles[other]))
          found(block, static_cast<std::uint32_t>(t), other);
      });
    }
  };
  return parallel_blocks(mesh.triangles.size() - from, threads, monitor, 0.0, 0.5, body);
}

}  // namespace

std::optional<self_crossings> find_self_crossings(const triangle_mesh& mesh, const triangle_bvh& tree, unsigned threads,
                                                  stage_monitor& monitor) {
  std::vector<self_crossings> of_block(block_count(mesh.triangles.size()));
  const auto found = [&](std::size_t block, std::uint32_t t, std::uint32_t /*other*/) {
    if (of_block[block].pairs++ > 0) return;
    const corner_list c = corners(mesh.positions, mesh.triangles[t]);
    of_block[block].first = (c[0] + c[1] + c[2]) / 3.0;
  };
  if (!visit_crossings(mesh, tree, 0, threads, monitor, found)) return std::nullopt;
  self_crossings out;
  for (const self_crossings& found_there : of_block) {
    if (out.pairs == 0) out.first = found_there.first;
    out.pairs += found_there.pairs;
  }
  return out;
}

std::optional<crossing_pairs> list_self_crossings(const triangle_mesh& mesh, const triangle_bvh& tree, unsigned threads,
                                                  std::size_t most, stage_monitor& monitor) {
  return list_crossings_from(mesh, tree, 0, threads, most, monitor);
}

std::optional<crossing_pairs> list_crossings_from(const triangle_mesh& mesh, const triangle_bvh& tree, std::size_t from,
                                                  unsigned threads, std::size_t most, stage_monitor& monitor) {
  std::vector<crossing_pairs> of_block(block_count(mesh.triangles.size() - from));
  const auto found = [&](std::size_t block, std::uint32_t t, std::uint32_t other) {
    if (of_block[block].size() < most) of_block[block].emplace_back(std::min(t, other), std::max(t, other));
  };
  if (!visit_crossings(mesh, tree, from, threads, monitor, found)) return std::nullopt;
  crossing_pairs out;
  for (const crossing_pairs& part : of_block) out.insert(out.end(), part.begin(), part.end());
  std::ranges::sort(out);
  if (out.size() > most) out.resize(most);
  return out;
}

std::string crossing_remark(const self_crossings& found) {
  std::ostringstream out;
  out.precision(6);
  out << "the mesh passes through itself: " << found.pairs
      << (found.pairs == 1 ? " pair of triangles crosses" : " pairs of triangles cross, the first") << " near ("
      << found.first.x << ", " << found.first.y << ", " << found.first.z
      << ") m; the texture there may follow either surface";
  return out.str();
}

}  // namespace asperity::bake
