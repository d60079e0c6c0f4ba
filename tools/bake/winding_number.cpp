#include "bake/winding_number.hpp"

#include <algorithm>
#include <cmath>
#include <glm/mat3x3.hpp>
#include <numbers>
#include <span>

#include "asperity/model/textured_model.hpp"

namespace asperity::bake {
namespace {

// A part of the tree is far where its centre is so many of its radii away.
constexpr double far_in_radii = 2.0;
constexpr double long_in_diagonals = 32.0;
constexpr std::size_t most_cuts = 1'000'000;

struct exact_moments {
  vec3 centre{0.0};
  double area = 0.0;
  vec3 vector{0.0};       // sum of n, triangles' areas long
  glm::dmat3 first{0.0};  // [j] is the sum of d n_j
  std::array<glm::dmat3, 3> second{glm::dmat3(0.0), glm::dmat3(0.0), glm::dmat3(0.0)};  // [j]: the sum of d d' n_j

  // Moments about `centre` of what has these about its own.
  void add(const exact_moments& other) {
    const vec3 s = other.centre - centre;
    vector += other.vector;
    for (int j = 0; j < 3; ++j) {
      second[static_cast<std::size_t>(j)] +=
          other.second[static_cast<std::size_t>(j)] + glm::outerProduct(s, other.first[j]) +
          glm::outerProduct(other.first[j], s) + other.vector[j] * glm::outerProduct(s, s);
      first[j] += other.first[j] + other.vector[j] * s;
    }
  }
};

exact_moments of_triangle(const std::array<vec3, 3>& c) {
  exact_moments out;
  out.centre = (c[0] + c[1] + c[2]) / 3.0;
  out.vector = 0.5 * glm::cross(c[1] - c[0], c[2] - c[0]);
  out.area = glm::length(out.vector);
  glm::dmat3 spread(0.0);
  for (const vec3& p : c) spread += glm::outerProduct(p - out.centre, p - out.centre) / 12.0;
  for (int j = 0; j < 3; ++j) out.second[static_cast<std::size_t>(j)] = out.vector[j] * spread;
  return out;
}

exact_moments merged(std::span<const exact_moments> parts) {
  exact_moments out;
  for (const exact_moments& part : parts) {
    out.area += part.area;
    out.centre += part.area * part.centre;
  }
  out.centre = out.area > 0.0 ? out.centre / out.area : parts.front().centre;
  for (const exact_moments& part : parts) out.add(part);
  return out;
}

exact_moments of_leaf(const triangle_bvh& tree, const triangle_bvh::node& leaf) {
  std::vector<exact_moments> parts;
  for (std::uint32_t i = leaf.right_or_first; i < leaf.right_or_first + leaf.count; ++i)
    parts.push_back(of_triangle(tree.corners_at(i)));
  return merged(parts);
}

double reach_of(const triangle_bvh::node& n, const vec3& centre) noexcept {
  vec3 farthest{0.0};
  for (int k = 0; k < 3; ++k) {
    const auto axis = static_cast<std::size_t>(k);
    farthest[k] = std::max(std::abs(centre[k] - static_cast<double>(n.low[axis])),
                           std::abs(static_cast<double>(n.high[axis]) - centre[k]));
  }
  return far_in_radii * glm::length(farthest);
}

}  // namespace

triangle_mesh without_long_triangles(const triangle_mesh& mesh) {
  double longest = bounds_of(mesh.positions).diagonal() / long_in_diagonals;
  for (;; longest *= 2.0) {
    triangle_mesh out{mesh.positions, {}, {}};
    std::vector<index_triangle> open(mesh.triangles.rbegin(), mesh.triangles.rend());
    while (!open.empty() && out.triangles.size() <= mesh.triangles.size() + most_cuts) {
      const index_triangle t = open.back();
      open.pop_back();
      const auto length2 = [&](std::size_t k) {
        const vec3 edge = out.positions[t[(k + 1) % 3]] - out.positions[t[k]];
        return glm::dot(edge, edge);
      };
      const std::size_t k =
          length2(0) >= length2(1) ? (length2(0) >= length2(2) ? 0 : 2) : (length2(1) >= length2(2) ? 1 : 2);
      if (!(length2(k) > longest * longest)) {
        out.triangles.push_back(t);
        continue;
      }
      const auto middle = static_cast<std::uint32_t>(out.positions.size());
      out.positions.push_back(0.5 * (out.positions[t[k]] + out.positions[t[(k + 1) % 3]]));
      open.push_back({middle, t[(k + 1) % 3], t[(k + 2) % 3]});
      open.push_back({t[k], middle, t[(k + 2) % 3]});
    }
    if (open.empty()) return out;
  }
}

double winding_of(const std::array<vec3, 3>& c, const vec3& p) noexcept {
  const vec3 a = c[0] - p;
  const vec3 b = c[1] - p;
  const vec3 d = c[2] - p;
  const double la = glm::length(a);
  const double lb = glm::length(b);
  const double ld = glm::length(d);
  return std::atan2(glm::dot(a, glm::cross(b, d)),
                    la * lb * ld + glm::dot(a, b) * ld + glm::dot(b, d) * la + glm::dot(d, a) * lb) /
         (2.0 * std::numbers::pi);
}

winding_field::winding_field(const triangle_bvh& tree) : tree_(tree), moments_(tree.nodes().size()) {
  const auto nodes = tree.nodes();
  // Children stand after their parent, so from the back all that a node needs is there. Kept exact along the way; a
  // right child waits until its sibling is done.
  std::vector<exact_moments> waiting(nodes.size());
  for (std::size_t i = nodes.size(); i-- > 0;) {
    const triangle_bvh::node& n = nodes[i];
    waiting[i] = n.count > 0 ? of_leaf(tree, n) : merged(std::array{waiting[i + 1], waiting[n.right_or_first]});
    const exact_moments& m = waiting[i];
    const auto first = [&](int d, int along) { return m.first[along][d]; };
    const auto second = [&](int d, int e, int along) { return m.second[static_cast<std::size_t>(along)][d][e]; };
    moments& out = moments_[i];
    const double reach = reach_of(n, m.centre);
    out.reach2 = static_cast<float>(reach * reach);
    for (int k = 0; k < 3; ++k) {
      const auto axis = static_cast<std::size_t>(k);
      out.centre[axis] = static_cast<float>(m.centre[k]);
      out.area[axis] = static_cast<float>(m.vector[k]);
      double linear = 0.0;
      for (int j = 0; j < 3; ++j) linear += 2.0 * second(k, j, j) + second(j, j, k);
      out.linear[axis] = static_cast<float>(linear);
      out.first[axis] = static_cast<float>(first(k, k));
      out.cubic[axis] = static_cast<float>(second(k, k, k));
    }
    const auto mixed = [&](int j, int k) { return static_cast<float>(first(j, k) + first(k, j)); };
    out.first[3] = mixed(0, 1);
    out.first[4] = mixed(0, 2);
    out.first[5] = mixed(1, 2);
    const auto twice = [&](int j, int k) { return static_cast<float>(second(j, j, k) + 2.0 * second(j, k, j)); };
    out.cubic[3] = twice(0, 1);
    out.cubic[4] = twice(0, 2);
    out.cubic[5] = twice(1, 0);
    out.cubic[6] = twice(1, 2);
    out.cubic[7] = twice(2, 0);
    out.cubic[8] = twice(2, 1);
    out.cubic[9] = static_cast<float>(2.0 * (second(0, 1, 2) + second(0, 2, 1) + second(1, 2, 0)));
  }
}

double winding_field::at(const vec3& p) const noexcept {
  const auto nodes = tree_.nodes();
  std::array<std::uint32_t, triangle_bvh::deepest> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  double near = 0.0;
  double far = 0.0;
  while (depth > 0) {
    const std::uint32_t at = stack[--depth];
    const moments& m = moments_[at];
    const vec3 r =
        vec3(static_cast<double>(m.centre[0]), static_cast<double>(m.centre[1]), static_cast<double>(m.centre[2])) - p;
    const double r2 = glm::dot(r, r);
    if (r2 > static_cast<double>(m.reach2)) {
      const double inverse2 = 1.0 / r2;
      const double inverse3 = inverse2 * std::sqrt(inverse2);
      const auto dot3 = [&](const std::array<float, 3>& v) {
        return r.x * static_cast<double>(v[0]) + r.y * static_cast<double>(v[1]) + r.z * static_cast<double>(v[2]);
      };
      const auto f = [&](std::size_t k) { return static_cast<double>(m.first[k]); };
      const auto g = [&](std::size_t k) { return static_cast<double>(m.cubic[k]); };
      const double xx = r.x * r.x, yy = r.y * r.y, zz = r.z * r.z;
      const double quadratic =
          xx * f(0) + yy * f(1) + zz * f(2) + r.x * r.y * f(3) + r.x * r.z * f(4) + r.y * r.z * f(5);
      const double cubic = xx * (r.x * g(0) + r.y * g(3) + r.z * g(4)) + yy * (r.y * g(1) + r.x * g(5) + r.z * g(6)) +
                           zz * (r.z * g(2) + r.x * g(7) + r.y * g(8)) + r.x * r.y * r.z * g(9);
      far += inverse3 * (dot3(m.area) + f(0) + f(1) + f(2) - 3.0 * quadratic * inverse2 +
                         0.5 * inverse2 * (15.0 * cubic * inverse2 - 3.0 * dot3(m.linear)));
      continue;
    }
    const triangle_bvh::node& n = nodes[at];
    if (n.count == 0) {
      stack[depth++] = n.right_or_first;
      stack[depth++] = at + 1;
      continue;
    }
    for (std::uint32_t i = n.right_or_first; i < n.right_or_first + n.count; ++i)
      near += winding_of(tree_.corners_at(i), p);
  }
  return near + far / (4.0 * std::numbers::pi);
}

}  // namespace asperity::bake
