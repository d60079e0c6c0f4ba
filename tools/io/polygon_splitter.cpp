#include "polygon_splitter.hpp"

#include <algorithm>

namespace asperity::io {
namespace {

/// Steps, of a few operations each, that splitting may take for each corner. Outlines of parts take tens of them.
constexpr std::size_t most_steps_per_corner = 1024;
/// Up to here looking at all corners is quicker than a grid of them.
constexpr std::size_t few_corners = 16;

/// Twice the signed area of a triangle in the plane.
double area2(const vec2& a, const vec2& b, const vec2& c) noexcept {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

}  // namespace

bool polygon_splitter::split(std::span<const std::uint32_t> polygon, reading_watch& watch) {
  triangles_.clear();
  const auto n = static_cast<std::uint32_t>(polygon.size());
  if (n == 3) {
    triangles_.push_back({0, 1, 2});
    return true;
  }
  project(polygon);
  if (is_convex()) {
    for (std::uint32_t i = 1; i + 1 < n; ++i) triangles_.push_back({0, i, i + 1});
    return true;
  }
  return cut_ears(watch);
}

/// The polygon in the plane of its Newell normal's largest axis, so that it turns counter-clockwise.
void polygon_splitter::project(std::span<const std::uint32_t> polygon) {
  vec3 normal{0.0};
  const vec3& first = positions_[polygon[0]];
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    normal += glm::cross(positions_[polygon[i]] - first, positions_[polygon[(i + 1) % polygon.size()]] - first);
  }
  const vec3 size = glm::abs(normal);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
  flat_.clear();
  for (const std::uint32_t v : polygon) {
    const vec3& p = positions_[v];
    const vec2 q(p[(axis + 1) % 3], p[(axis + 2) % 3]);
    flat_.push_back(normal[axis] < 0.0 ? vec2(q.y, q.x) : q);
  }
}

bool polygon_splitter::is_convex() const noexcept {
  const std::size_t n = flat_.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (!(area2(flat_[i], flat_[(i + 1) % n], flat_[(i + 2) % n]) >= 0.0)) return false;
  }
  return true;
}

/// Looks at every second corner first, so that triangles stay compact, and again at the neighbours of each ear that is
/// cut: no other corner has become one by it, but for polygons that touch or cross themselves.
bool polygon_splitter::cut_ears(reading_watch& watch) {
  const auto n = static_cast<std::uint32_t>(flat_.size());
  next_.resize(n);
  previous_.resize(n);
  for (std::uint32_t i = 0; i < n; ++i) {
    next_[i] = (i + 1) % n;
    previous_[i] = (i + n - 1) % n;
  }
  left_ = n;
  in_grid_ = 0;
  work_ = 0;
  to_look_at_.clear();
  for (std::uint32_t i = 0; i < n; i += 2) to_look_at_.push_back(i);
  for (std::uint32_t i = 1; i < n; i += 2) to_look_at_.push_back(i);
  std::size_t cut_since_all = 1;
  std::uint32_t at = 0;
  for (std::size_t k = 0; left_ > 3;) {
    watch.step();
    if (n > few_corners) {
      if (work_ > most_steps_per_corner * n) return false;
      if (in_grid_ == 0 || 2 * left_ < in_grid_) use_grid(at);
    }
    bool any = false;
    if (k == to_look_at_.size()) {
      any = cut_since_all == 0;  // a polygon that crosses itself may have no ear: then any corner is cut
      k = 0;
      to_look_at_ = ring(at);
      work_ += left_;
      cut_since_all = 0;
    }
    const std::uint32_t corner = to_look_at_[k++];
    if (next_[corner] == corner || !(any || is_ear(corner))) continue;
    ++cut_since_all;
    const std::uint32_t before = previous_[corner];
    at = next_[corner];
    triangles_.push_back({before, corner, at});
    next_[before] = at;
    previous_[at] = before;
    next_[corner] = corner;  // no longer in the ring
    --left_;
    to_look_at_.insert(to_look_at_.end(), {at, before});
  }
  const std::uint32_t first = std::min({previous_[at], at, next_[at]});
  triangles_.push_back({first, next_[first], previous_[first]});
  return true;
}

std::vector<std::uint32_t> polygon_splitter::ring(std::uint32_t any_corner) const {
  std::vector<std::uint32_t> out;
  out.reserve(left_);
  for (std::uint32_t c = any_corner; out.size() < left_; c = next_[c]) out.push_back(c);
  return out;
}

void polygon_splitter::use_grid(std::uint32_t any_corner) {
  grid_.fill(flat_, ring(any_corner));
  in_grid_ = left_;
}

bool polygon_splitter::is_ear(std::uint32_t corner) {
  const vec2& a = flat_[previous_[corner]];
  const vec2& b = flat_[corner];
  const vec2& c = flat_[next_[corner]];
  ++work_;
  if (!(area2(a, b, c) > 0.0)) return false;
  const auto is_inside = [&](std::uint32_t k) {
    const vec2& p = flat_[k];
    if (next_[k] == k || p == a || p == b || p == c) return false;
    return area2(a, b, p) >= 0.0 && area2(b, c, p) >= 0.0 && area2(c, a, p) >= 0.0;
  };
  if (flat_.size() > few_corners) return !grid_.any_near(a, b, c, work_, is_inside);
  for (std::uint32_t k = next_[next_[corner]]; k != previous_[corner]; k = next_[k]) {
    if (is_inside(k)) return false;
  }
  return true;
}

}  // namespace asperity::io
