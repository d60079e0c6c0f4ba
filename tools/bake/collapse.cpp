#include "bake/collapse.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "bake/edge_queue.hpp"
#include "bake/geometry.hpp"
#include "bake/halfedges.hpp"
#include "bake/parallel.hpp"
#include "bake/quadric.hpp"

namespace asperity::bake {
namespace {

constexpr double most_turn_cosine = 0.5;
constexpr double sliver = 0.06;             // height over longest edge; a triangle that was worse may stay as bad
constexpr double evenness = 1e-4;           // weight of the edge's length: decides where the surface is flat
constexpr double least_determinant = 1e-4;  // of the normalised quadric: below it the optimum is too far away
constexpr std::uint32_t none = no_halfedge;

double height_ratio(const std::array<vec3, 3>& c) noexcept {
  const vec3 e0 = c[1] - c[0];
  const vec3 e1 = c[2] - c[1];
  const vec3 e2 = c[0] - c[2];
  const double longest2 = std::max({glm::dot(e0, e0), glm::dot(e1, e1), glm::dot(e2, e2)});
  return longest2 > 0.0 ? glm::length(area_normal(c)) / longest2 : 0.0;
}

// The quadric's own optimum where it is well defined and near; else the best of both ends and the middle.
vec3 best_place(const quadric& q, const vec3& pa, const vec3& pb) {
  const vec3 middle = 0.5 * (pa + pb);
  const mat3 m = q.matrix();
  const double scale = (m[0][0] + m[1][1] + m[2][2]) / 3.0;
  if (scale > 0.0 && glm::determinant(m / scale) > least_determinant) {
    const vec3 p = glm::inverse(m) * q.b;
    if (glm::length(p - middle) <= glm::length(pa - pb)) return p;
  }
  vec3 best = middle;
  for (const vec3& p : {pa, pb})
    if (q.at(p) < q.at(best)) best = p;
  return best;
}

// What one vertex needs, side by side: a collapse looks at some fifteen vertices that lie anywhere in memory.
struct vertex {
  vec3 normal{0.0};  // of the original surface that went into it, weighted with area
  vec3 position{0.0};
  quadric error;
  std::uint32_t first = none;  // a corner of a living triangle; corners of one vertex are linked
  std::uint32_t stamp = 0;
};

// Corner 3 t + k is where halfedge 3 t + k starts. An edge stands in the queue as that one of its two halfedges that
// runs from the lower to the higher vertex.
class collapser {
 public:
  // Works about the first vertex: quadrics far from the origin lose digits.
  collapser(triangle_mesh&& mesh, unsigned threads)
      : origin_(mesh.positions.front()),
        threads_(threads),
        triangles_(std::move(mesh.triangles)),
        vertices_(mesh.positions.size()),
        next_(3 * triangles_.size(), none),
        queue_(3 * triangles_.size(), ends_first{this}),
        left_(triangles_.size()) {
    for (std::size_t v = 0; v < vertices_.size(); ++v) vertices_[v].position = mesh.positions[v] - origin_;
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      const auto c = corners_of(t);
      const vec3 n = area_normal(c);
      const quadric q = quadric::of_plane(normalised(n), c[0], 0.5 * glm::length(n));
      for (std::uint32_t k = 0; k < 3; ++k) {
        vertex& v = vertices_[triangles_[t][k]];
        link(v, 3 * t + k);
        v.error += q;
        v.normal += n;
      }
    }
    mesh.positions = std::vector<vec3>();  // not needed twice
  }
  collapser(const collapser&) = delete;
  collapser& operator=(const collapser&) = delete;

  // An edge that was refused is offered again when one of its ends has changed, and, at the end, all of them once more.
  [[nodiscard]] bool reduce_to(std::size_t target, stage_monitor& monitor) {
    const std::size_t all = left_;
    for (std::size_t before = left_ + 1; left_ > target && left_ < before;) {
      before = left_;
      if (!offer_all(share_done(all), monitor)) return false;
      for (std::size_t i = 0; left_ > target && !queue_.empty(); ++i) {
        if (i % 4096 == 0 && !monitor.at(share_done(all))) return false;
        const std::uint32_t h = queue_.top();
        queue_.erase(h);
        try_collapse(origin(h), target_of(h));
      }
    }
    return true;
  }

  [[nodiscard]] triangle_mesh take() const {
    triangle_mesh out;
    std::vector<std::uint32_t> number(vertices_.size(), none);
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      if (!alive(t)) continue;
      index_triangle moved{};
      for (std::size_t k = 0; k < 3; ++k) {
        std::uint32_t& n = number[triangles_[t][k]];
        if (n == none) {
          n = static_cast<std::uint32_t>(out.positions.size());
          out.positions.push_back(vertices_[triangles_[t][k]].position + origin_);
        }
        moved[k] = n;
      }
      out.triangles.push_back(moved);
    }
    return out;
  }

 private:
  struct ends_first {  // of edges that cost the same, the one with the lower vertices
    const collapser* of;
    bool operator()(std::uint32_t g, std::uint32_t h) const {
      return std::pair(of->origin(g), of->target_of(g)) < std::pair(of->origin(h), of->target_of(h));
    }
  };

  [[nodiscard]] double share_done(std::size_t all) const noexcept {
    return static_cast<double>(all - left_) / static_cast<double>(all);
  }
  [[nodiscard]] bool alive(std::uint32_t t) const noexcept { return triangles_[t][0] != none; }
  [[nodiscard]] std::uint32_t origin(std::uint32_t h) const noexcept { return triangles_[h / 3][h % 3]; }
  [[nodiscard]] std::uint32_t target_of(std::uint32_t h) const noexcept { return origin(next_halfedge(h)); }
  [[nodiscard]] std::array<vec3, 3> corners_of(std::uint32_t t) const noexcept {
    const index_triangle& v = triangles_[t];
    return {vertices_[v[0]].position, vertices_[v[1]].position, vertices_[v[2]].position};
  }

  void link(vertex& v, std::uint32_t corner) {
    next_[corner] = v.first;
    v.first = corner;
  }

  void unlink(std::uint32_t corner) {
    std::uint32_t* at = &vertices_[origin(corner)].first;
    while (*at != corner) at = &next_[*at];
    *at = next_[corner];
  }

  template <class Visit>
  void for_each_corner(std::uint32_t v, const Visit& visit) const {
    for (std::uint32_t corner = vertices_[v].first; corner != none;) {
      const std::uint32_t following = next_[corner];  // the visit may move the corner to another vertex
      visit(corner);
      corner = following;
    }
  }

  [[nodiscard]] bool offer_all(double done, stage_monitor& monitor) {
    std::vector<std::uint32_t> edges;
    edges.reserve(3 * left_ / 2);
    for (std::uint32_t h = 0; h < 3 * triangles_.size(); ++h)
      if (alive(h / 3) && origin(h) < target_of(h)) edges.push_back(h);
    std::vector<double> costs(edges.size());
    const auto rate_block = [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) costs[i] = rate(edges[i]);
    };
    if (!parallel_blocks(edges.size(), threads_, monitor, done, done, rate_block)) return false;
    queue_.fill(std::move(edges), std::move(costs));
    return true;
  }

  [[nodiscard]] double rate(std::uint32_t h) const {
    const vertex& a = vertices_[origin(h)];
    const vertex& b = vertices_[target_of(h)];
    quadric q = a.error;
    q += b.error;
    const vec3 p = best_place(q, a.position, b.position);
    const vec3 edge = a.position - b.position;
    return q.at(p) + evenness * q.weight * glm::dot(edge, edge);
  }

  [[nodiscard]] bool has_more_than_three(std::uint32_t v) const {
    std::uint32_t corner = vertices_[v].first;
    for (int i = 0; i < 3 && corner != none; ++i) corner = next_[corner];
    return corner != none;
  }

  // Link condition: only the two apexes may neighbour both ends, or the surface would touch itself afterwards.
  [[nodiscard]] bool keeps_topology(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t of_a = ++last_stamp_;
    for_each_corner(a, [&](std::uint32_t corner) {
      for (const std::uint32_t u : triangles_[corner / 3]) vertices_[u].stamp = of_a;
    });
    const std::uint32_t of_both = ++last_stamp_;
    std::size_t common = 0;
    bool apexes_stay = true;
    for_each_corner(b, [&](std::uint32_t corner) {
      for (const std::uint32_t u : triangles_[corner / 3]) {
        if (u == a || u == b || vertices_[u].stamp != of_a) continue;
        vertices_[u].stamp = of_both;
        ++common;
        apexes_stay = apexes_stay && has_more_than_three(u);
      }
    });
    return common == 2 && apexes_stay;
  }

  [[nodiscard]] bool has(std::uint32_t t, std::uint32_t v) const noexcept {
    return triangles_[t][0] == v || triangles_[t][1] == v || triangles_[t][2] == v;
  }

  // Looks at the triangles of `moving` that stay when the edge to `other` collapses to p.
  [[nodiscard]] bool keeps_shape(std::uint32_t moving, std::uint32_t other, const vec3& p, const vec3& surface) const {
    for (std::uint32_t corner = vertices_[moving].first; corner != none; corner = next_[corner]) {
      const std::uint32_t t = corner / 3;
      if (has(t, other)) continue;
      const auto before = corners_of(t);
      auto after = before;
      after[corner % 3] = p;
      const vec3 n = unit_normal(after);
      const vec3 n_before = unit_normal(before);
      if (!(glm::dot(n, n_before) > most_turn_cosine) || !(glm::dot(n, surface) > 0.0)) return false;
      for (const std::uint32_t v : triangles_[t])
        if (v != moving && !(glm::dot(n, vertices_[v].normal) > 0.0) && glm::dot(n_before, vertices_[v].normal) > 0.0)
          return false;
      if (height_ratio(after) < std::min(sliver, 0.9 * height_ratio(before))) return false;
    }
    return true;
  }

  // The edge goes from the lower vertex a, which stays, to b.
  void try_collapse(std::uint32_t a, std::uint32_t b) {
    quadric q = vertices_[a].error;
    q += vertices_[b].error;
    const vec3 p = best_place(q, vertices_[a].position, vertices_[b].position);
    const vec3 surface = vertices_[a].normal + vertices_[b].normal;
    if (!keeps_topology(a, b) || !keeps_shape(a, b, p, surface) || !keeps_shape(b, a, p, surface)) return;
    vertex& kept = vertices_[a];
    kept.position = p;
    kept.error = q;
    kept.normal = surface;
    // The queue must never hold two edges whose order has changed unseen: one after the other gets its new end and
    // cost.
    for_each_corner(b, [&](std::uint32_t corner) {
      if (has(corner / 3, a)) remove(corner);
    });
    for_each_corner(a, [&](std::uint32_t corner) { offer_both(corner); });
    for_each_corner(b, [&](std::uint32_t corner) {
      if (!alive(corner / 3)) return;
      queue_.erase(previous_halfedge(corner));
      triangles_[corner / 3][corner % 3] = a;
      link(kept, corner);
      offer_both(corner);
    });
    vertices_[b].first = none;
  }

  // The two halfedges of a corner's triangle that meet in it.
  void offer_both(std::uint32_t corner) {
    for (const std::uint32_t h : {corner, previous_halfedge(corner)})
      if (origin(h) < target_of(h)) queue_.set(h, rate(h));
  }

  // The triangle of a corner goes; the vertex of that corner goes too, and needs no unlinking.
  void remove(std::uint32_t corner) {
    const std::uint32_t t = corner / 3;
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      queue_.erase(h);
      if (h != corner) unlink(h);
    }
    triangles_[t][0] = none;
    --left_;
  }

  vec3 origin_;
  unsigned threads_;
  std::vector<index_triangle> triangles_;
  std::vector<vertex> vertices_;
  std::vector<std::uint32_t> next_;  // after each corner, another one of the same vertex
  edge_queue<ends_first> queue_;
  std::uint32_t last_stamp_ = 0;
  std::size_t left_;
};

}  // namespace

std::optional<triangle_mesh> collapse_edges(triangle_mesh mesh, std::size_t target, stage_monitor& monitor,
                                            unsigned threads) {
  collapser work(std::move(mesh), threads);
  if (!work.reduce_to(target, monitor)) return std::nullopt;
  return work.take();
}

}  // namespace asperity::bake
