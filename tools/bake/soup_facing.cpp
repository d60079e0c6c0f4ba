#include "bake/soup_facing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "bake/geometry.hpp"
#include "bake/halfedges.hpp"
#include "bake/parallel.hpp"
#include "bake/winding.hpp"

namespace asperity::bake {
namespace {

constexpr std::size_t most_samples = 100'000;
constexpr std::size_t fewest_samples_of_part = 4;
constexpr std::size_t most_samples_of_part = 128;
// A ray starts so far off its own triangle, in lengths of the box's diagonal.
constexpr double off_surface = 1e-7;
// A part is turned where its back is seen so many times as often as its front, and by so many rays more.
constexpr double clearly_more = 1.5;
constexpr std::size_t least_more = 2;

bool box_on_ray(const triangle_bvh::node& n, const vec3& from, const vec3& inverse) noexcept {
  double enter = 0.0;
  double leave = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const auto axis = static_cast<std::size_t>(k);
    double a = (static_cast<double>(n.low[axis]) - from[k]) * inverse[k];
    double b = (static_cast<double>(n.high[axis]) - from[k]) * inverse[k];
    if (std::isnan(a) || std::isnan(b)) continue;
    if (a > b) std::swap(a, b);
    enter = std::max(enter, a);
    leave = std::min(leave, b);
  }
  return enter <= leave;
}

bool on_ray(const std::array<vec3, 3>& c, const vec3& from, const vec3& direction) noexcept {
  std::array<double, 3> turn{};
  for (std::size_t k = 0; k < 3; ++k) turn[k] = glm::dot(direction, glm::cross(c[k] - from, c[(k + 1) % 3] - from));
  const bool through =
      (turn[0] >= 0.0 && turn[1] >= 0.0 && turn[2] >= 0.0) || (turn[0] <= 0.0 && turn[1] <= 0.0 && turn[2] <= 0.0);
  if (!through) return false;
  const vec3 n = area_normal(c);
  const double along = glm::dot(n, direction);
  return along != 0.0 && glm::dot(n, c[0] - from) / along > 0.0;
}

double fraction(double x) noexcept { return x - std::floor(x); }

// The i-th of a sequence of directions about n, as likely as light that a matt surface scatters.
vec3 direction_about(const vec3& n, std::size_t i) noexcept {
  const auto k = static_cast<double>(i + 1);
  const double r = std::sqrt(fraction(0.5 + 0.7548776662466927 * k));
  const double angle = 2.0 * std::numbers::pi * fraction(0.5 + 0.5698402909980532 * k);
  const vec3 side = normalised(glm::cross(n, std::abs(n.x) < 0.6 ? vec3(1, 0, 0) : vec3(0, 1, 0)));
  return r * std::cos(angle) * side + r * std::sin(angle) * glm::cross(n, side) +
         std::sqrt(std::max(0.0, 1.0 - r * r)) * n;
}

struct part {
  std::vector<std::uint32_t> triangles;
  double area = 0.0;
  double volume = 0.0;
  bool closed = true;
};

std::vector<part> parts_of(const triangle_mesh& mesh, const connectivity& net) {
  std::vector<part> parts(net.components);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    part& p = parts[net.component[t]];
    const auto c = corners(mesh.positions, mesh.triangles[t]);
    p.triangles.push_back(t);
    p.area += 0.5 * glm::length(area_normal(c));
    p.volume += glm::dot(c[0], glm::cross(c[1], c[2])) / 6.0;
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) p.closed = p.closed && net.mate[h] != no_halfedge;
  }
  return parts;
}

// Is the part seen from outside from its back rather than its front?
bool seen_from_behind(const triangle_mesh& mesh, const part& p, const triangle_bvh& tree, double off,
                      std::size_t samples) {
  std::size_t front = 0, back = 0, next = 0;
  double passed = 0.0;
  for (std::size_t i = 0; i < samples; ++i) {
    const double at = (static_cast<double>(i) + 0.5) / static_cast<double>(samples) * p.area;
    const auto area_of = [&](std::uint32_t t) {
      return 0.5 * glm::length(area_normal(corners(mesh.positions, mesh.triangles[t])));
    };
    while (next + 1 < p.triangles.size() && passed + area_of(p.triangles[next]) < at)
      passed += area_of(p.triangles[next++]);
    const auto c = corners(mesh.positions, mesh.triangles[p.triangles[next]]);
    const double u = 1.0 - std::sqrt(fraction(0.5 + 0.6180339887498949 * static_cast<double>(i + 1)));
    const double v = (1.0 - u) * fraction(0.5 + 0.4142135623730950 * static_cast<double>(i + 1));
    const vec3 on = u * c[0] + v * c[1] + (1.0 - u - v) * c[2];
    const vec3 n = unit_normal(c);
    front += escapes(tree, on + off * n, direction_about(n, i)) ? 1U : 0U;
    back += escapes(tree, on - off * n, direction_about(-n, i)) ? 1U : 0U;
  }
  return static_cast<double>(back) > clearly_more * static_cast<double>(front) && back >= front + least_more;
}

}  // namespace

std::size_t drop_useless_triangles(triangle_mesh& mesh) {
  const std::size_t before = mesh.triangles.size();
  const bounds box = bounds_of(mesh.positions);
  const vec3 far = glm::max(glm::abs(box.low), glm::abs(box.high));
  const double reach = std::max({far.x, far.y, far.z});
  std::erase_if(mesh.triangles, [&](const index_triangle& t) {
    const auto c = corners(mesh.positions, t);
    const double longest = std::max({glm::length(c[1] - c[0]), glm::length(c[2] - c[1]), glm::length(c[0] - c[2])});
    return !(glm::length(area_normal(c)) > longest * reach * 1e-15);
  });
  for (index_triangle& t : mesh.triangles) std::rotate(t.begin(), std::ranges::min_element(t), t.end());
  std::vector<std::uint32_t> order(mesh.triangles.size());
  for (std::uint32_t t = 0; t < order.size(); ++t) order[t] = t;
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(mesh.triangles[a], a) < std::pair(mesh.triangles[b], b);
  });
  std::vector<bool> again(order.size(), false);
  for (std::size_t i = 1; i < order.size(); ++i)
    again[order[i]] = mesh.triangles[order[i]] == mesh.triangles[order[i - 1]];
  std::size_t kept = 0;
  for (std::size_t t = 0; t < again.size(); ++t)
    if (!again[t]) mesh.triangles[kept++] = mesh.triangles[t];
  mesh.triangles.resize(kept);
  mesh.uvs = {};
  return before - kept;
}

bool escapes(const triangle_bvh& tree, const vec3& from, const vec3& direction) noexcept {
  const vec3 inverse = 1.0 / direction;
  const auto nodes = tree.nodes();
  std::array<std::uint32_t, triangle_bvh::deepest> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t at = stack[--depth];
    const triangle_bvh::node& n = nodes[at];
    if (!box_on_ray(n, from, inverse)) continue;
    if (n.count == 0) {
      stack[depth++] = n.right_or_first;
      stack[depth++] = at + 1;
      continue;
    }
    for (std::uint32_t i = n.right_or_first; i < n.right_or_first + n.count; ++i)
      if (on_ray(tree.corners_at(i), from, direction)) return false;
  }
  return true;
}

std::optional<std::size_t> face_outwards(triangle_mesh& mesh, unsigned threads, stage_monitor& monitor) {
  const std::vector<index_triangle> given = mesh.triangles;
  // A surface with one side only stays as it is.
  static_cast<void>(make_winding_consistent(mesh));
  const connectivity net = connect(mesh.triangles, mesh.positions.size());
  const std::vector<part> parts = parts_of(mesh, net);
  const triangle_bvh tree(mesh.positions, mesh.triangles, threads, &monitor);
  if (monitor.cancelled()) return std::nullopt;
  const double off = off_surface * bounds_of(mesh.positions).diagonal();
  const std::size_t samples =
      std::clamp(most_samples / std::max<std::size_t>(1, parts.size()), fewest_samples_of_part, most_samples_of_part);
  std::vector<char> to_turn(parts.size(), 0);
  const auto judge = [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const bool behind =
          parts[i].closed ? parts[i].volume < 0.0 : seen_from_behind(mesh, parts[i], tree, off, samples);
      to_turn[i] = behind ? 1 : 0;
    }
  };
  if (!parallel_blocks(parts.size(), threads, monitor, monitor.done(), monitor.done(), judge)) return std::nullopt;
  std::size_t turned = 0;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (to_turn[net.component[t]] != 0) turn(mesh, t);
    turned += mesh.triangles[t] != given[t] ? 1U : 0U;
  }
  return turned;
}

}  // namespace asperity::bake
