#include "bake/winding_number.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace asperity::bake {
namespace {

// A part of the tree is far where its centre is so many of its radii away.
constexpr double far_in_radii = 2.0;

struct exact_moments {
  vec3 centre{0.0};
  double area = 0.0;
  vec3 vector{0.0};
  std::array<double, 6> first{};

  void add_moment(const vec3& offset, const vec3& along) noexcept {
    first[0] += offset.x * along.x;
    first[1] += offset.y * along.y;
    first[2] += offset.z * along.z;
    first[3] += offset.x * along.y + offset.y * along.x;
    first[4] += offset.x * along.z + offset.z * along.x;
    first[5] += offset.y * along.z + offset.z * along.y;
  }
};

vec3 centroid(const std::array<vec3, 3>& c) noexcept { return (c[0] + c[1] + c[2]) / 3.0; }
vec3 area_vector(const std::array<vec3, 3>& c) noexcept { return 0.5 * glm::cross(c[1] - c[0], c[2] - c[0]); }

exact_moments of_leaf(const triangle_bvh& tree, const triangle_bvh::node& leaf) {
  exact_moments out;
  for (std::uint32_t i = leaf.right_or_first; i < leaf.right_or_first + leaf.count; ++i) {
    const auto c = tree.corners_at(i);
    const vec3 vector = area_vector(c);
    const double area = glm::length(vector);
    out.area += area;
    out.centre += area * centroid(c);
    out.vector += vector;
  }
  out.centre = out.area > 0.0 ? out.centre / out.area : centroid(tree.corners_at(leaf.right_or_first));
  for (std::uint32_t i = leaf.right_or_first; i < leaf.right_or_first + leaf.count; ++i) {
    const auto c = tree.corners_at(i);
    out.add_moment(centroid(c) - out.centre, area_vector(c));
  }
  return out;
}

exact_moments merged(const exact_moments& a, const exact_moments& b) {
  exact_moments out;
  out.area = a.area + b.area;
  out.centre = out.area > 0.0 ? (a.area * a.centre + b.area * b.centre) / out.area : a.centre;
  out.vector = a.vector + b.vector;
  for (std::size_t k = 0; k < 6; ++k) out.first[k] = a.first[k] + b.first[k];
  out.add_moment(a.centre - out.centre, a.vector);
  out.add_moment(b.centre - out.centre, b.vector);
  return out;
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
    waiting[i] = n.count > 0 ? of_leaf(tree, n) : merged(waiting[i + 1], waiting[n.right_or_first]);
    const exact_moments& m = waiting[i];
    moments& out = moments_[i];
    const double reach = reach_of(n, m.centre);
    out.reach2 = static_cast<float>(reach * reach);
    for (std::size_t k = 0; k < 3; ++k) {
      out.centre[k] = static_cast<float>(m.centre[static_cast<int>(k)]);
      out.area[k] = static_cast<float>(m.vector[static_cast<int>(k)]);
    }
    for (std::size_t k = 0; k < 6; ++k) out.first[k] = static_cast<float>(m.first[k]);
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
      const auto f = [&](std::size_t k) { return static_cast<double>(m.first[k]); };
      const double dipole = r.x * static_cast<double>(m.area[0]) + r.y * static_cast<double>(m.area[1]) +
                            r.z * static_cast<double>(m.area[2]);
      const double quadratic = r.x * r.x * f(0) + r.y * r.y * f(1) + r.z * r.z * f(2) + r.x * r.y * f(3) +
                               r.x * r.z * f(4) + r.y * r.z * f(5);
      far += inverse3 * (dipole + f(0) + f(1) + f(2) - 3.0 * quadratic * inverse2);
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
