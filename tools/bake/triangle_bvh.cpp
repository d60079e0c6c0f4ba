#include "bake/triangle_bvh.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>
#include <utility>

#include "bake/geometry.hpp"

namespace asperity::bake {
namespace {

constexpr std::size_t leaf_size = 4;
constexpr std::size_t least_shared_items = 4096;  // fewer are not worth another thread

// Nodes of the tree over n items. At depth d the halves have n / 2^d items, rounded down or up, and n % 2^d of them up.
std::size_t node_count(std::size_t n) noexcept {
  std::size_t d = 0;
  while ((n >> d) > leaf_size) ++d;
  const std::size_t larger = (n >> d) == leaf_size ? n & ((std::size_t{1} << d) - 1) : 0;  // these have two leaves
  return 2 * ((std::size_t{1} << d) + larger) - 1;
}

float below(double x) noexcept {
  const auto f = static_cast<float>(x);
  return static_cast<double>(f) <= x ? f : std::nextafter(f, -std::numeric_limits<float>::infinity());
}
float above(double x) noexcept {
  const auto f = static_cast<float>(x);
  return static_cast<double>(f) >= x ? f : std::nextafter(f, std::numeric_limits<float>::infinity());
}

template <class Node>
double distance2(const Node& n, const vec3& p) noexcept {
  double sum = 0.0;
  for (int k = 0; k < 3; ++k) {
    const auto axis = static_cast<std::size_t>(k);
    const double low = static_cast<double>(n.low[axis]) - p[k];
    const double high = p[k] - static_cast<double>(n.high[axis]);
    const double d = std::max({low, high, 0.0});
    sum += d * d;
  }
  return sum;
}

// Smallest |s| at which the line p + s d is inside the box, or infinity.
template <class Node>
double smallest_offset(const Node& n, const vec3& p, const vec3& inverse_d) noexcept {
  double enter = -std::numeric_limits<double>::infinity();
  double leave = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const auto axis = static_cast<std::size_t>(k);
    double a = (static_cast<double>(n.low[axis]) - p[k]) * inverse_d[k];
    double b = (static_cast<double>(n.high[axis]) - p[k]) * inverse_d[k];
    if (std::isnan(a) || std::isnan(b)) continue;  // 0 * infinity: the line runs in the face of the box
    if (a > b) std::swap(a, b);
    enter = std::max(enter, a);
    leave = std::min(leave, b);
  }
  if (enter > leave) return std::numeric_limits<double>::infinity();
  return enter > 0.0 ? enter : (leave < 0.0 ? -leave : 0.0);
}

// Offset at which the line crosses the triangle from inside to outside, or NaN.
double front_crossing(const vec3& p, const vec3& d, const std::array<vec3, 3>& c) noexcept {
  constexpr double edge_slack = 1e-9;  // barycentric: neighbours overlap by this much instead of leaving a slit
  const double none = std::numeric_limits<double>::quiet_NaN();
  const vec3 ab = c[1] - c[0];
  const vec3 ac = c[2] - c[0];
  const vec3 n = glm::cross(ab, ac);
  const double facing = glm::dot(n, d);
  if (!(facing > 0.0)) return none;
  const vec3 q = glm::cross(p - c[0], d);
  const double v = -glm::dot(ac, q) / facing;
  const double w = glm::dot(ab, q) / facing;
  if (v < -edge_slack || w < -edge_slack || v + w > 1.0 + edge_slack) return none;
  return glm::dot(n, c[0] - p) / facing;
}

}  // namespace

vec3 closest_on_triangle(const vec3& p, const std::array<vec3, 3>& c) noexcept {
  const vec3 n = area_normal(c);
  const double n2 = glm::dot(n, n);
  if (n2 > 0.0) {
    const vec3 q = p - glm::dot(p - c[0], n) / n2 * n;
    bool within = true;
    for (std::size_t k = 0; k < 3; ++k)
      within = within && glm::dot(glm::cross(c[(k + 1) % 3] - c[k], q - c[k]), n) >= 0.0;
    if (within) return q;
  }
  vec3 best{0.0};
  double best2 = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const vec3 q = closest_on_segment(p, c[k], c[(k + 1) % 3]);
    const double d2 = glm::dot(p - q, p - q);
    if (d2 < best2) {
      best2 = d2;
      best = q;
    }
  }
  return best;
}

struct triangle_bvh::item {
  std::array<float, 3> centre;
  std::uint32_t triangle;
};

/// What all parts of one tree's making share.
struct triangle_bvh::making {
  std::span<const index_triangle> triangles;
  stage_monitor* monitor;
  std::atomic<bool> cancelled{false};
};

triangle_bvh::triangle_bvh(std::span<const vec3> positions, std::span<const index_triangle> triangles, unsigned threads,
                           stage_monitor* monitor)
    : positions_(positions) {
  std::vector<item> items(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto c = corners(positions, triangles[t]);
    const vec3 centre = (c[0] + c[1] + c[2]) / 3.0;
    items[t] = {{static_cast<float>(centre.x), static_cast<float>(centre.y), static_cast<float>(centre.z)},
                static_cast<std::uint32_t>(t)};
  }
  nodes_.resize(node_count(items.size()));
  making all{triangles, monitor};
  build(all, items, 0, 0, threads, true);
  if (all.cancelled) return;
  triangle_.resize(items.size());
  for (std::size_t i = 0; i < items.size(); ++i) triangle_[i] = items[i].triangle;
  items = std::vector<item>();
  corners_.resize(triangle_.size());
  for (std::size_t i = 0; i < triangle_.size(); ++i) corners_[i] = triangles[triangle_[i]];
}

void triangle_bvh::make_leaf(std::span<const index_triangle> triangles, std::span<const item> items, std::size_t first,
                             node& out) {
  const vec3& start = positions_[triangles[items[0].triangle][0]];
  bounds box{start, start};
  for (const item& i : items)
    for (const std::uint32_t v : triangles[i.triangle]) {
      box.low = glm::min(box.low, positions_[v]);
      box.high = glm::max(box.high, positions_[v]);
    }
  out = {{below(box.low.x), below(box.low.y), below(box.low.z)},
         {above(box.high.x), above(box.high.y), above(box.high.z)},
         static_cast<std::uint32_t>(first),
         static_cast<std::uint32_t>(items.size())};
}

// The number of items alone tells where the nodes of each half go, so that both halves can be built at the same time.
void triangle_bvh::build(making& all, std::span<item> items, std::size_t first, std::size_t index, unsigned threads,
                         bool on_calling_thread) {
  if (items.size() <= leaf_size) return make_leaf(all.triangles, items, first, nodes_[index]);
  if (items.size() >= least_shared_items) {
    if (on_calling_thread && all.monitor != nullptr && !all.monitor->ask()) all.cancelled = true;
    if (all.cancelled) return;
  }
  std::array<float, 3> low = items[0].centre;
  std::array<float, 3> high = items[0].centre;
  for (const item& i : items)
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], i.centre[k]);
      high[k] = std::max(high[k], i.centre[k]);
    }
  std::size_t axis = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
  const std::size_t half = items.size() / 2;
  std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(half), items.end(),
                   [axis](const item& a, const item& b) {
                     return std::pair(a.centre[axis], a.triangle) < std::pair(b.centre[axis], b.triangle);
                   });
  const std::size_t left = index + 1;
  const std::size_t right = left + node_count(half);
  const auto build_left = [&](unsigned with, bool here) { build(all, items.first(half), first, left, with, here); };
  const auto build_right = [&](unsigned with) {
    build(all, items.subspan(half), first + half, right, with, on_calling_thread);
  };
  if (threads > 1 && items.size() >= least_shared_items) {
    const std::jthread helper(build_left, threads / 2, false);
    build_right(threads - threads / 2);
  } else {
    build_left(1, on_calling_thread);
    build_right(1);
  }
  const node& l = nodes_[left];
  const node& r = nodes_[right];
  node merged{l.low, l.high, static_cast<std::uint32_t>(right), 0};
  for (std::size_t k = 0; k < 3; ++k) {
    merged.low[k] = std::min(l.low[k], r.low[k]);
    merged.high[k] = std::max(l.high[k], r.high[k]);
  }
  nodes_[index] = merged;
}

triangle_bvh::nearest triangle_bvh::closest(const vec3& p, double within) const noexcept {
  nearest best;
  double best2 = within * within;
  std::array<std::pair<double, std::uint32_t>, deepest> stack;
  std::size_t depth = 0;
  stack[depth++] = {distance2(nodes_[0], p), 0};
  while (depth > 0) {
    const auto [d2, at] = stack[--depth];
    if (d2 > best2) continue;
    const node& n = nodes_[at];
    if (n.count == 0) {
      std::pair<double, std::uint32_t> left{distance2(nodes_[at + 1], p), at + 1};
      std::pair<double, std::uint32_t> right{distance2(nodes_[n.right_or_first], p), n.right_or_first};
      if (left.first < right.first) std::swap(left, right);
      if (left.first <= best2) stack[depth++] = left;
      if (right.first <= best2) stack[depth++] = right;
      continue;
    }
    for (std::uint32_t i = n.right_or_first; i < n.right_or_first + n.count; ++i) {
      const vec3 q = closest_on_triangle(p, corners_at(i));
      const double q2 = glm::dot(p - q, p - q);
      if (q2 > best2 || (q2 == best2 && best.triangle != no_halfedge)) continue;
      best2 = q2;
      best = {q, std::sqrt(q2), triangle_[i]};
    }
  }
  return best;
}

bool triangle_bvh::has_facing(const vec3& p, const vec3& n, double within) const noexcept {
  const double within2 = within * within;
  std::array<std::uint32_t, deepest> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t at = stack[--depth];
    const node& here = nodes_[at];
    if (distance2(here, p) > within2) continue;
    if (here.count == 0) {
      stack[depth++] = here.right_or_first;
      stack[depth++] = at + 1;
      continue;
    }
    for (std::uint32_t i = here.right_or_first; i < here.right_or_first + here.count; ++i) {
      if (!(glm::dot(area_normal(corners_at(i)), n) > 0.0)) continue;
      const vec3 q = closest_on_triangle(p, corners_at(i));
      if (glm::dot(p - q, p - q) <= within2) return true;
    }
  }
  return false;
}

std::optional<triangle_bvh::crossing> triangle_bvh::nearest_front_crossing(const vec3& p, const vec3& d,
                                                                           double range) const noexcept {
  const vec3 inverse = 1.0 / d;
  std::optional<crossing> best;
  double reach = range;
  std::array<std::pair<double, std::uint32_t>, deepest> stack;
  std::size_t depth = 0;
  stack[depth++] = {smallest_offset(nodes_[0], p, inverse), 0};
  while (depth > 0) {
    const auto [offset, at] = stack[--depth];
    if (offset > reach) continue;
    const node& n = nodes_[at];
    if (n.count == 0) {
      std::pair<double, std::uint32_t> left{smallest_offset(nodes_[at + 1], p, inverse), at + 1};
      std::pair<double, std::uint32_t> right{smallest_offset(nodes_[n.right_or_first], p, inverse), n.right_or_first};
      if (left.first < right.first) std::swap(left, right);
      if (left.first <= reach) stack[depth++] = left;
      if (right.first <= reach) stack[depth++] = right;
      continue;
    }
    for (std::uint32_t i = n.right_or_first; i < n.right_or_first + n.count; ++i) {
      const double s = front_crossing(p, d, corners_at(i));
      if (!(std::abs(s) <= reach) || (best && std::abs(s) == reach)) continue;
      reach = std::abs(s);
      best = crossing{p + s * d, s, triangle_[i]};
    }
  }
  return best;
}

}  // namespace asperity::bake
