#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <unordered_set>

#include "bake/geometry.hpp"
#include "bake/hole_patch.hpp"

namespace asperity::bake {
namespace {

constexpr int most_rounds = 24;
constexpr int most_sweeps = 60;
constexpr double least_turn_cosine = 0.5;  // an edge is exchanged where both new triangles stay within 60 degrees

class refiner {
 public:
  refiner(hole_patch& patch, const std::vector<std::pair<std::uint32_t, std::uint32_t>>& taken) : patch_(patch) {
    mate_ = connect(patch.triangles, patch.positions.size()).mate;
    for (const auto& [a, b] : taken) edges_.insert(key(a, b));
    for (const index_triangle& t : patch.triangles)
      for (std::size_t k = 0; k < 3; ++k) edges_.insert(key(t[k], t[(k + 1) % 3]));
  }

  void run(std::size_t most) {
    relax();
    for (int round = 0; round < most_rounds && split_large(most); ++round) relax();
  }

 private:
  static std::uint64_t key(std::uint32_t a, std::uint32_t b) noexcept {
    return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
  }

  // A triangle is large where its middle is farther from each corner than the spacing there allows.
  bool split_large(std::size_t most) {
    bool any = false;
    for (std::uint32_t t = 0, end = static_cast<std::uint32_t>(patch_.triangles.size()); t < end; ++t) {
      const index_triangle v = patch_.triangles[t];
      const auto c = corners(patch_.positions, v);
      const vec3 middle = (c[0] + c[1] + c[2]) / 3.0;
      const double spacing = (patch_.spacing_m[v[0]] + patch_.spacing_m[v[1]] + patch_.spacing_m[v[2]]) / 3.0;
      bool large = patch_.positions.size() < patch_.rim + most;
      for (std::size_t k = 0; k < 3; ++k)
        large = large && std::numbers::sqrt2 * glm::length(middle - c[k]) > std::max(spacing, patch_.spacing_m[v[k]]);
      if (!large) continue;
      any = true;
      patch_.positions.push_back(middle);
      patch_.spacing_m.push_back(spacing);
      split(t, static_cast<std::uint32_t>(patch_.positions.size() - 1));
    }
    return any;
  }

  void split(std::uint32_t t, std::uint32_t v) {
    const auto [a, b, c] = patch_.triangles[t];
    const auto second = static_cast<std::uint32_t>(patch_.triangles.size());
    const std::uint32_t third = second + 1;
    const std::size_t first = 3 * std::size_t{t};
    const std::array<std::uint32_t, 3> outer{mate_[first], mate_[first + 1], mate_[first + 2]};
    patch_.triangles[t] = {a, b, v};
    patch_.triangles.push_back({b, c, v});
    patch_.triangles.push_back({c, a, v});
    mate_.resize(3 * patch_.triangles.size());
    const std::array<std::uint32_t, 3> part{t, second, third};
    for (std::size_t k = 0; k < 3; ++k) {
      join(3 * part[k], outer[k]);
      join(3 * part[k] + 1, 3 * part[(k + 1) % 3] + 2);
      edges_.insert(key(patch_.triangles[part[k]][0], v));
    }
  }

  void join(std::uint32_t h, std::uint32_t g) {
    mate_[h] = g;
    if (g != no_halfedge) mate_[g] = h;
  }

  void relax() {
    bool any = true;
    for (int sweep = 0; any && sweep < most_sweeps; ++sweep) {
      any = false;
      for (std::uint32_t h = 0; h < mate_.size(); ++h) any = exchange(h) || any;
    }
  }

  [[nodiscard]] std::uint32_t apex(std::uint32_t h) const { return origin_of(patch_.triangles, previous_halfedge(h)); }

  // The edge goes for the other diagonal where the angles across from it are more than two right angles.
  bool exchange(std::uint32_t h) {
    const std::uint32_t g = mate_[h];
    if (g == no_halfedge || g < h) return false;
    const std::uint32_t a = origin_of(patch_.triangles, h), b = origin_of(patch_.triangles, g);
    const std::uint32_t c = apex(h), d = apex(g);
    const auto& p = patch_.positions;
    const auto cosine_at = [&](std::uint32_t from) {
      return glm::dot(normalised(p[a] - p[from]), normalised(p[b] - p[from]));
    };
    constexpr double slack = 1e-6;
    const double at_c = std::acos(std::clamp(cosine_at(c), -1.0, 1.0));
    const double at_d = std::acos(std::clamp(cosine_at(d), -1.0, 1.0));
    if (!(at_c + at_d > std::numbers::pi + slack) || edges_.contains(key(c, d))) return false;
    const vec3 before =
        normalised(area_normal(std::array{p[a], p[b], p[c]}) + area_normal(std::array{p[b], p[a], p[d]}));
    const vec3 first = unit_normal({p[a], p[d], p[c]}), second = unit_normal({p[d], p[b], p[c]});
    if (!(glm::dot(first, before) > least_turn_cosine && glm::dot(second, before) > least_turn_cosine)) return false;
    edges_.erase(key(a, b));
    edges_.insert(key(c, d));
    const std::uint32_t t = h / 3, s = g / 3;
    const std::uint32_t bc = mate_[next_halfedge(h)], ca = mate_[previous_halfedge(h)];
    const std::uint32_t ad = mate_[next_halfedge(g)], db = mate_[previous_halfedge(g)];
    patch_.triangles[t] = {a, d, c};
    patch_.triangles[s] = {d, b, c};
    join(3 * t, ad);
    join(3 * t + 2, ca);
    join(3 * s, db);
    join(3 * s + 1, bc);
    join(3 * t + 1, 3 * s + 2);
    return true;
  }

  hole_patch& patch_;
  std::vector<std::uint32_t> mate_;
  std::unordered_set<std::uint64_t> edges_;  // looked up only: its order reaches nothing
};

}  // namespace

void refine_patch(hole_patch& patch, const std::vector<std::pair<std::uint32_t, std::uint32_t>>& taken,
                  std::size_t most) {
  // Triangles of edges as long as the spacing are about 0.43 of its square, and a vertex has two.
  double vertices = 0.0;
  for (const index_triangle& t : patch.triangles) {
    const double spacing = (patch.spacing_m[t[0]] + patch.spacing_m[t[1]] + patch.spacing_m[t[2]]) / 3.0;
    vertices += 0.5 * glm::length(area_normal(corners(patch.positions, t))) / (0.87 * spacing * spacing);
  }
  if (const double wider = std::sqrt(vertices / static_cast<double>(most)); wider > 1.0)
    for (double& s : patch.spacing_m) s *= wider;
  refiner(patch, taken).run(most);
}

}  // namespace asperity::bake
