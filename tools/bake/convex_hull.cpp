#include "bake/convex_hull.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "bake/geometry.hpp"

namespace asperity::bake {
namespace {

constexpr double lattice_steps = 33554432.0;  // 2^25: a determinant of three differences then fits 128 bits with room

__extension__ using wide_integer = __int128;

lattice_point operator-(const lattice_point& a, const lattice_point& b) noexcept {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

lattice_point cross(const lattice_point& a, const lattice_point& b) noexcept {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

wide_integer dot(const lattice_point& a, const lattice_point& b) noexcept {
  return wide_integer{a.x} * b.x + wide_integer{a.y} * b.y + wide_integer{a.z} * b.z;
}

// Positive where d lies on the side of the plane abc from which abc runs counter-clockwise.
int side(const lattice_point& a, const lattice_point& b, const lattice_point& c, const lattice_point& d) noexcept {
  const wide_integer volume = dot(cross(b - a, c - a), d - a);
  return volume > 0 ? 1 : (volume < 0 ? -1 : 0);
}

}  // namespace

std::vector<lattice_point> to_lattice(std::span<const vec3> points, const bounds& box) {
  const vec3 extent = box.high - box.low;
  const double longest = std::max({extent.x, extent.y, extent.z});
  const double scale = longest > 0.0 ? lattice_steps / longest : 0.0;
  std::vector<lattice_point> out;
  out.reserve(points.size());
  for (const vec3& p : points) {
    const vec3 q = scale * (p - box.low);
    out.push_back({std::llround(q.x), std::llround(q.y), std::llround(q.z)});
  }
  return out;
}

void convex_hull::insert(std::uint32_t v) {
  if (is_solid()) return extend(v);
  waiting_.push_back(v);
  const auto at = [this](std::size_t i) -> const lattice_point& { return lattice_[frame_[i]]; };
  const lattice_point& p = lattice_[v];
  bool independent = true;
  if (frame_.size() == 1) independent = p != at(0);
  if (frame_.size() == 2) independent = cross(at(1) - at(0), p - at(0)) != lattice_point{};
  if (frame_.size() == 3) independent = side(at(0), at(1), at(2), p) != 0;
  if (!independent) return;
  frame_.push_back(v);
  if (frame_.size() == 4) begin_solid();
}

void convex_hull::begin_solid() {
  auto [a, b, c, d] = std::tuple(frame_[0], frame_[1], frame_[2], frame_[3]);
  if (side(lattice_[a], lattice_[b], lattice_[c], lattice_[d]) > 0) std::swap(b, c);
  faces_ = {{a, b, c}, {a, d, b}, {b, d, c}, {c, d, a}};
  for (const std::uint32_t v : waiting_) extend(v);
  waiting_.clear();
}

// Replaces the faces that see the point by a fan from the point to their outline. Faces in whose plane it lies stay:
// with exact tests the faces that see it then form one disc, and its outline never runs in line with the point.
void convex_hull::extend(std::uint32_t v) {
  const auto sees = [&](const index_triangle& f) {
    return side(lattice_[f[0]], lattice_[f[1]], lattice_[f[2]], lattice_[v]) > 0;
  };
  const auto seen = std::stable_partition(faces_.begin(), faces_.end(), [&](const auto& f) { return !sees(f); });
  if (seen == faces_.end()) return;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (auto f = seen; f != faces_.end(); ++f)
    for (std::size_t k = 0; k < 3; ++k) edges.emplace_back((*f)[k], (*f)[(k + 1) % 3]);
  faces_.erase(seen, faces_.end());
  std::sort(edges.begin(), edges.end());
  for (const auto& [a, b] : edges)
    if (!std::binary_search(edges.begin(), edges.end(), std::pair(b, a))) faces_.push_back({a, b, v});
}

std::vector<std::uint32_t> convex_polygon(std::span<const vec3> points, const vec3& normal) {
  const vec3 u = any_orthogonal(normal);
  const vec3 v = glm::cross(normal, u);
  std::vector<vec3> flat;
  for (const vec3& p : points) flat.emplace_back(glm::dot(p, u), glm::dot(p, v), 0.0);
  const std::vector<lattice_point> lattice = to_lattice(flat, bounds_of(flat));
  std::vector<std::uint32_t> order(points.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tuple(lattice[a].x, lattice[a].y, a) < std::tuple(lattice[b].x, lattice[b].y, b);
  });
  // Andrew's monotone chain: lower side left to right, then upper side back.
  std::vector<std::uint32_t> hull;
  const auto chain = [&](auto first, auto last) {
    const std::size_t base = hull.size();
    for (auto i = first; i != last; ++i) {
      while (hull.size() >= base + 2 &&
             cross(lattice[hull.back()] - lattice[hull[hull.size() - 2]], lattice[*i] - lattice[hull.back()]).z <= 0)
        hull.pop_back();
      hull.push_back(*i);
    }
    hull.pop_back();
  };
  chain(order.begin(), order.end());
  chain(order.rbegin(), order.rend());
  return hull;
}

}  // namespace asperity::bake
