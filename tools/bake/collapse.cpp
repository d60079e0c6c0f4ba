#include "bake/collapse.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>
#include <tuple>

#include "bake/geometry.hpp"
#include "bake/halfedges.hpp"

namespace asperity::bake {
namespace {

constexpr double most_turn_cosine = 0.5;
constexpr double sliver = 0.06;             // height over longest edge; a triangle that was worse may stay as bad
constexpr double evenness = 1e-4;           // weight of the edge's length: decides where the surface is flat
constexpr double least_determinant = 1e-4;  // of the normalised quadric: below it the optimum is too far away

// Sum of squared distances to planes, weighted with area: x A x - 2 b x + c.
struct quadric {
  mat3 a{0.0};
  vec3 b{0.0};
  double c = 0.0;
  double weight = 0.0;

  quadric& operator+=(const quadric& o) noexcept {
    a += o.a;
    b += o.b;
    c += o.c;
    weight += o.weight;
    return *this;
  }
  [[nodiscard]] double at(const vec3& x) const noexcept {
    return std::max(0.0, glm::dot(x, a * x) - 2.0 * glm::dot(b, x) + c);
  }
};

quadric plane_quadric(const vec3& normal, const vec3& point, double area) {
  const double d = glm::dot(normal, point);
  return {area * glm::outerProduct(normal, normal), area * d * normal, area * d * d, area};
}

struct candidate {
  double cost;
  std::uint32_t a, b;
  std::uint32_t version_a, version_b;

  // Cheapest first; the vertex numbers make the order of equal costs a fixed one.
  friend bool operator<(const candidate& x, const candidate& y) noexcept {
    if (x.cost != y.cost) return x.cost > y.cost;
    return std::tuple(x.a, x.b) > std::tuple(y.a, y.b);
  }
};

double height_ratio(const std::array<vec3, 3>& c) noexcept {
  const vec3 e0 = c[1] - c[0];
  const vec3 e1 = c[2] - c[1];
  const vec3 e2 = c[0] - c[2];
  const double longest2 = std::max({glm::dot(e0, e0), glm::dot(e1, e1), glm::dot(e2, e2)});
  return longest2 > 0.0 ? glm::length(area_normal(c)) / longest2 : 0.0;
}

class collapser {
 public:
  // Works about the first vertex: quadrics far from the origin lose digits.
  explicit collapser(const triangle_mesh& mesh)
      : origin_(mesh.positions.front()),
        positions_(mesh.positions),
        triangles_(mesh.triangles),
        alive_(mesh.triangles.size(), true),
        around_(mesh.positions.size()),
        quadrics_(mesh.positions.size()),
        normals_(mesh.positions.size(), vec3(0.0)),
        versions_(mesh.positions.size(), 0),
        left_(mesh.triangles.size()) {
    for (vec3& p : positions_) p -= origin_;
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      const auto c = bake::corners(positions_, triangles_[t]);
      const vec3 n = area_normal(c);
      const quadric q = plane_quadric(normalised(n), c[0], 0.5 * glm::length(n));
      for (const std::uint32_t v : triangles_[t]) {
        around_[v].push_back(t);
        quadrics_[v] += q;
        normals_[v] += n;
      }
    }
    stamp_.assign(positions_.size(), 0);
  }

  // An edge that was refused is offered again when one of its ends has changed, and, at the end, all of them once more.
  [[nodiscard]] bool reduce_to(std::size_t target, stage_monitor& monitor) {
    const std::size_t all = left_;
    for (std::size_t before = left_ + 1; left_ > target && left_ < before;) {
      before = left_;
      offer_all();
      for (std::size_t i = 0; left_ > target && !queue_.empty(); ++i) {
        if (i % 4096 == 0 && !monitor.at(static_cast<double>(all - left_) / static_cast<double>(all))) return false;
        const candidate next = queue_.top();
        queue_.pop();
        if (versions_[next.a] != next.version_a || versions_[next.b] != next.version_b) continue;
        try_collapse(next.a, next.b);
      }
    }
    return true;
  }

  [[nodiscard]] triangle_mesh take() const {
    triangle_mesh out;
    std::vector<std::uint32_t> number(positions_.size(), no_halfedge);
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      if (!alive_[t]) continue;
      index_triangle moved{};
      for (std::size_t k = 0; k < 3; ++k) {
        std::uint32_t& n = number[triangles_[t][k]];
        if (n == no_halfedge) {
          n = static_cast<std::uint32_t>(out.positions.size());
          out.positions.push_back(positions_[triangles_[t][k]] + origin_);
        }
        moved[k] = n;
      }
      out.triangles.push_back(moved);
    }
    return out;
  }

 private:
  void offer_all() {
    std::vector<candidate> edges;
    edges.reserve(3 * left_ / 2);
    for (std::uint32_t t = 0; t < triangles_.size(); ++t)
      for (std::size_t k = 0; alive_[t] && k < 3; ++k)
        if (triangles_[t][k] < triangles_[t][(k + 1) % 3])
          edges.push_back(rate(triangles_[t][k], triangles_[t][(k + 1) % 3]));
    queue_ = std::priority_queue<candidate>(std::less<candidate>(), std::move(edges));
  }

  [[nodiscard]] candidate rate(std::uint32_t a, std::uint32_t b) const {
    if (a > b) std::swap(a, b);
    quadric q = quadrics_[a];
    q += quadrics_[b];
    const vec3 p = best_place(q, a, b);
    const vec3 edge = positions_[a] - positions_[b];
    return {q.at(p) + evenness * q.weight * glm::dot(edge, edge), a, b, versions_[a], versions_[b]};
  }

  // The quadric's own optimum where it is well defined and near; else the best of both ends and the middle.
  [[nodiscard]] vec3 best_place(const quadric& q, std::uint32_t a, std::uint32_t b) const {
    const vec3& pa = positions_[a];
    const vec3& pb = positions_[b];
    const vec3 middle = 0.5 * (pa + pb);
    const double scale = (q.a[0][0] + q.a[1][1] + q.a[2][2]) / 3.0;
    if (scale > 0.0 && glm::determinant(q.a / scale) > least_determinant) {
      const vec3 p = glm::inverse(q.a) * q.b;
      if (glm::length(p - middle) <= glm::length(pa - pb)) return p;
    }
    vec3 best = middle;
    for (const vec3& p : {pa, pb})
      if (q.at(p) < q.at(best)) best = p;
    return best;
  }

  // Every neighbour of v once. The stamp tells which vertices this call and later ones of the same number have met.
  template <class Visit>
  void for_each_neighbour(std::uint32_t v, std::uint32_t stamp, const Visit& visit) {
    for (const std::uint32_t t : around_[v])
      for (const std::uint32_t u : triangles_[t])
        if (u != v && stamp_[u] != stamp) {
          stamp_[u] = stamp;
          visit(u);
        }
  }

  // Link condition: only the two apexes may neighbour both ends, or the surface would touch itself afterwards.
  [[nodiscard]] bool keeps_topology(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t of_a = ++last_stamp_;
    for_each_neighbour(a, of_a, [](std::uint32_t) {});
    std::size_t common = 0;
    bool apexes_stay = true;
    scratch_.clear();
    for (const std::uint32_t t : around_[b])
      for (const std::uint32_t u : triangles_[t])
        if (u != b && u != a && stamp_[u] == of_a) scratch_.push_back(u);
    std::sort(scratch_.begin(), scratch_.end());
    scratch_.erase(std::unique(scratch_.begin(), scratch_.end()), scratch_.end());
    for (const std::uint32_t u : scratch_) {
      ++common;
      apexes_stay = apexes_stay && around_[u].size() > 3;
    }
    return common == 2 && apexes_stay;
  }

  [[nodiscard]] bool has(std::uint32_t t, std::uint32_t v) const noexcept {
    return triangles_[t][0] == v || triangles_[t][1] == v || triangles_[t][2] == v;
  }

  // Looks at the triangles of `moving` that stay when the edge to `other` collapses to p.
  [[nodiscard]] bool keeps_shape(std::uint32_t moving, std::uint32_t other, const vec3& p, const vec3& surface) const {
    for (const std::uint32_t t : around_[moving]) {
      if (has(t, other)) continue;
      const auto before = bake::corners(positions_, triangles_[t]);
      auto after = before;
      for (std::size_t k = 0; k < 3; ++k)
        if (triangles_[t][k] == moving) after[k] = p;
      const vec3 n = unit_normal(after);
      if (!(glm::dot(n, unit_normal(before)) > most_turn_cosine) || !(glm::dot(n, surface) > 0.0)) return false;
      for (const std::uint32_t v : triangles_[t])
        if (v != moving && !(glm::dot(n, normals_[v]) > 0.0) && glm::dot(unit_normal(before), normals_[v]) > 0.0)
          return false;
      if (height_ratio(after) < std::min(sliver, 0.9 * height_ratio(before))) return false;
    }
    return true;
  }

  void try_collapse(std::uint32_t a, std::uint32_t b) {
    quadric q = quadrics_[a];
    q += quadrics_[b];
    const vec3 p = best_place(q, a, b);
    const vec3 surface = normals_[a] + normals_[b];
    if (!keeps_topology(a, b) || !keeps_shape(a, b, p, surface) || !keeps_shape(b, a, p, surface)) return;
    positions_[a] = p;
    quadrics_[a] = q;
    normals_[a] = surface;
    for (const std::uint32_t t : around_[b]) {
      if (has(t, a)) {
        alive_[t] = false;
        --left_;
        for (const std::uint32_t v : triangles_[t])
          if (v != b) std::erase(around_[v], t);
        continue;
      }
      for (std::uint32_t& v : triangles_[t])
        if (v == b) v = a;
      around_[a].push_back(t);
    }
    around_[b].clear();
    ++versions_[a];
    ++versions_[b];
    for_each_neighbour(a, ++last_stamp_, [&](std::uint32_t v) { queue_.push(rate(a, v)); });
  }

  vec3 origin_;
  std::vector<vec3> positions_;
  std::vector<index_triangle> triangles_;
  std::vector<bool> alive_;
  std::vector<std::vector<std::uint32_t>> around_;  // living triangles of each vertex
  std::vector<quadric> quadrics_;
  std::vector<vec3> normals_;  // of the original surface that went into each vertex, weighted with area
  std::vector<std::uint32_t> versions_;
  std::priority_queue<candidate> queue_;
  std::vector<std::uint32_t> stamp_;
  std::uint32_t last_stamp_ = 0;
  std::vector<std::uint32_t> scratch_;
  std::size_t left_;
};

}  // namespace

std::optional<triangle_mesh> collapse_edges(const triangle_mesh& mesh, std::size_t target, stage_monitor& monitor) {
  collapser work(mesh);
  if (!work.reduce_to(target, monitor)) return std::nullopt;
  return work.take();
}

}  // namespace asperity::bake
