#include "bake/wrap_lattice.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "bake/parallel.hpp"

namespace asperity::bake {
namespace {

constexpr std::int32_t block_units = 16;  // half cells along the edge of a block
constexpr std::size_t block_nodes = 1024;
constexpr std::uint32_t no_block = 0xffffffffU;

// Edges of the lattice by their lower end: along the axes, and to the middles of the cells around.
constexpr std::array<lattice_point, 7> edge_steps{
    {{2, 0, 0}, {0, 2, 0}, {0, 0, 2}, {1, 1, 1}, {1, 1, -1}, {1, -1, 1}, {1, -1, -1}}};

constexpr lattice_point operator+(const lattice_point& a, const lattice_point& b) noexcept {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
constexpr lattice_point operator-(const lattice_point& a, const lattice_point& b) noexcept {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

// The nodes that share a tetrahedron with the edge from u by `step`: 4 around an axis edge, 6 around a slanted one.
template <class Visit>
void around_edge(const lattice_point& u, std::size_t kind, const Visit& visit) {
  const lattice_point s = edge_steps[kind];
  if (kind < 3) {
    const lattice_point middle{u.x + s.x / 2, u.y + s.y / 2, u.z + s.z / 2};
    for (const std::int32_t a : {-1, 1})
      for (const std::int32_t b : {-1, 1}) {
        const std::array<std::int32_t, 2> ab{a, b};
        std::array<std::int32_t, 3> d{};
        d[(kind + 1) % 3] = ab[0];
        d[(kind + 2) % 3] = ab[1];
        visit(middle + lattice_point{d[0], d[1], d[2]});
      }
    return;
  }
  const lattice_point v = u + s;
  for (const lattice_point along : {lattice_point{2 * s.x, 0, 0}, {0, 2 * s.y, 0}, {0, 0, 2 * s.z}}) {
    visit(u + along);
    visit(v - along);
  }
}

struct lattice_block {
  std::array<float, block_nodes> value;
  std::array<bool, block_nodes> known{};
  std::array<std::uint8_t, block_nodes> cuts{};        // edges from this node, by kind, that the surface crosses
  std::array<std::uint32_t, block_nodes> first_cut{};  // number of the first of their vertices
};

struct place {
  std::uint32_t block = no_block;
  std::uint32_t node = 0;
};

class node_store {
 public:
  [[nodiscard]] static std::uint64_t block_key(const lattice_point& p) noexcept {
    return static_cast<std::uint64_t>(p.z / block_units) << 32U | static_cast<std::uint64_t>(p.y / block_units) << 16U |
           static_cast<std::uint64_t>(p.x / block_units);
  }
  [[nodiscard]] static std::uint32_t node_in_block(const lattice_point& p) noexcept {
    const auto x = static_cast<std::uint32_t>(p.x), y = static_cast<std::uint32_t>(p.y),
               z = static_cast<std::uint32_t>(p.z);
    return (x & 1U) << 9U | (z >> 1U & 7U) << 6U | (y >> 1U & 7U) << 3U | (x >> 1U & 7U);
  }
  [[nodiscard]] static lattice_point point_in_block(std::uint64_t key, std::uint32_t node) noexcept {
    const std::uint32_t odd = node >> 9U;
    const auto at = [&](std::uint64_t block, std::uint32_t cell) {
      return static_cast<std::int32_t>(block * block_units + 2 * std::uint64_t{cell} + odd);
    };
    return {at(key & 0xffffU, node & 7U), at(key >> 16U & 0xffffU, node >> 3U & 7U), at(key >> 32U, node >> 6U & 7U)};
  }

  // Only while no other thread looks.
  void put(const lattice_point& p, float value) {
    const std::uint64_t key = block_key(p);
    const auto [found, added] = index_.try_emplace(key, static_cast<std::uint32_t>(blocks_.size()));
    if (added) {
      blocks_.push_back(std::make_unique<lattice_block>());
      keys_.push_back(key);
    }
    const std::uint32_t node = node_in_block(p);
    blocks_[found->second]->value[node] = value;
    blocks_[found->second]->known[node] = true;
  }

  [[nodiscard]] place find(const lattice_point& p) const noexcept {
    if (p.x < 0 || p.y < 0 || p.z < 0) return {};
    const auto found = index_.find(block_key(p));
    if (found == index_.end()) return {};
    const std::uint32_t node = node_in_block(p);
    return blocks_[found->second]->known[node] ? place{found->second, node} : place{};
  }
  [[nodiscard]] float value(const place& at) const noexcept { return blocks_[at.block]->value[at.node]; }
  [[nodiscard]] bool inside(const place& at) const noexcept { return value(at) >= 0.0F; }

  [[nodiscard]] std::size_t size() const noexcept { return blocks_.size(); }
  [[nodiscard]] lattice_block& block(std::uint32_t b) noexcept { return *blocks_[b]; }
  [[nodiscard]] const lattice_block& block(std::uint32_t b) const noexcept { return *blocks_[b]; }
  [[nodiscard]] std::uint64_t key(std::uint32_t b) const noexcept { return keys_[b]; }

  // Block numbers by place, which does not depend on the order in which they were met.
  [[nodiscard]] std::vector<std::uint32_t> in_order() const {
    std::vector<std::uint32_t> order(blocks_.size());
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::sort(order, {}, [&](std::uint32_t b) { return keys_[b]; });
    return order;
  }

 private:
  std::unordered_map<std::uint64_t, std::uint32_t> index_;
  std::vector<std::unique_ptr<lattice_block>> blocks_;
  std::vector<std::uint64_t> keys_;
};

enum class filling : unsigned char { done, too_large, cancelled };

// Asks the seeds, and then whatever shares a tetrahedron with an edge between inside and outside, until nothing is left.
filling fill(const lattice_frame& frame, std::vector<lattice_key> open, const lattice_body& body, unsigned threads,
             stage_monitor& monitor, node_store& store) {
  std::vector<float> values;
  std::vector<lattice_key> next;
  while (!open.empty()) {
    std::ranges::sort(open);
    open.erase(std::unique(open.begin(), open.end()), open.end());
    values.resize(open.size());
    const auto ask = [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const lattice_point p = point_of(open[i]);
        const bool beyond =
            p.x < 2 || p.y < 2 || p.z < 2 || p.x > frame.most[0] || p.y > frame.most[1] || p.z > frame.most[2];
        values[i] = beyond ? -1.0F : body.value(frame.position(p));
      }
    };
    if (!parallel_blocks(open.size(), threads, monitor, monitor.done(), monitor.done(), ask)) return filling::cancelled;
    for (std::size_t i = 0; i < open.size(); ++i) store.put(point_of(open[i]), values[i]);
    if (store.size() > most_lattice_blocks) return filling::too_large;
    next.clear();
    const auto want = [&](const lattice_point& p) {
      if (store.find(p).block == no_block) next.push_back(key_of(p));
    };
    for (std::size_t i = 0; i < open.size(); ++i) {
      const lattice_point p = point_of(open[i]);
      const bool inside = values[i] >= 0.0F;
      for (std::size_t kind = 0; kind < edge_steps.size(); ++kind)
        for (const bool up : {true, false}) {
          const lattice_point q = up ? p + edge_steps[kind] : p - edge_steps[kind];
          const place at = store.find(q);
          if (at.block == no_block || store.inside(at) == inside) continue;
          around_edge(up ? p : q, kind, want);
        }
    }
    open.swap(next);
  }
  return filling::done;
}

struct cut_edge {
  lattice_point from;
  std::uint8_t kind = 0;
};

// Numbers the edges that the surface crosses, block by block.
std::vector<cut_edge> number_cuts(node_store& store, const std::vector<std::uint32_t>& order,
                                  std::size_t most_vertices) {
  std::vector<cut_edge> cuts;
  for (const std::uint32_t b : order) {
    lattice_block& block = store.block(b);
    for (std::uint32_t node = 0; node < block_nodes; ++node) {
      if (!block.known[node]) continue;
      block.first_cut[node] = static_cast<std::uint32_t>(cuts.size());
      const lattice_point p = node_store::point_in_block(store.key(b), node);
      const bool inside = block.value[node] >= 0.0F;
      for (std::size_t kind = 0; kind < edge_steps.size(); ++kind) {
        const place other = store.find(p + edge_steps[kind]);
        if (other.block == no_block || store.inside(other) == inside) continue;
        block.cuts[node] = static_cast<std::uint8_t>(block.cuts[node] | 1U << kind);
        cuts.push_back({p, static_cast<std::uint8_t>(kind)});
      }
    }
    if (cuts.size() > most_vertices) break;
  }
  return cuts;
}

struct corner_node {
  lattice_point point;
  place at;
};

class tetrahedra {
 public:
  tetrahedra(const node_store& store, const std::vector<vec3>& vertices) : store_(store), vertices_(vertices) {}

  // The triangles of all tetrahedra at the three edges of the even grid that start in p.
  void add_at(const lattice_point& p, const place& at, std::vector<index_triangle>& out) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const lattice_point q = p + edge_steps[axis];
      const place at_q = store_.find(q);
      if (at_q.block == no_block) continue;
      std::array<corner_node, 4> ring;
      constexpr std::array<std::array<std::int32_t, 2>, 4> turns{{{1, 1}, {-1, 1}, {-1, -1}, {1, -1}}};
      for (std::size_t k = 0; k < 4; ++k) {
        std::array<std::int32_t, 3> d{};
        d[axis] = 1;
        d[(axis + 1) % 3] = turns[k][0];
        d[(axis + 2) % 3] = turns[k][1];
        const lattice_point r = p + lattice_point{d[0], d[1], d[2]};
        ring[k] = {r, store_.find(r)};
      }
      for (std::size_t k = 0; k < 4; ++k) {
        const corner_node& r = ring[k];
        const corner_node& s = ring[(k + 1) % 4];
        if (r.at.block != no_block && s.at.block != no_block) add({{{p, at}, {q, at_q}, r, s}}, out);
      }
    }
  }

 private:
  [[nodiscard]] std::uint32_t vertex(const corner_node& a, const corner_node& b) const noexcept {
    const lattice_point up = b.point - a.point;
    const bool forward = up.x > 0 || (up.x == 0 && (up.y > 0 || (up.y == 0 && up.z > 0)));
    const corner_node& low = forward ? a : b;
    const lattice_point step = forward ? up : a.point - b.point;
    std::size_t kind = 0;
    while (key_of_step(edge_steps[kind]) != key_of_step(step)) ++kind;
    const lattice_block& block = store_.block(low.at.block);
    const unsigned before = block.cuts[low.at.node] & ((1U << kind) - 1U);
    std::uint32_t count = 0;
    for (unsigned rest = before; rest != 0; rest &= rest - 1) ++count;
    return block.first_cut[low.at.node] + count;
  }
  [[nodiscard]] static constexpr std::int32_t key_of_step(const lattice_point& s) noexcept {
    return s.x * 25 + s.y * 5 + s.z;
  }

  // The corners come so that the last three turn left seen from outside, away from the first.
  void add(const std::array<corner_node, 4>& c, std::vector<index_triangle>& out) const {
    std::array<std::size_t, 4> in{}, off{};
    std::size_t ins = 0, offs = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      if (store_.inside(c[k].at)) {
        in[ins++] = k;
      } else {
        off[offs++] = k;
      }
    }
    if (ins == 0 || offs == 0) return;
    // Others of a corner, in the order in which they turn left seen away from it.
    constexpr std::array<std::array<std::size_t, 3>, 4> others{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};
    if (ins == 1 || offs == 1) {
      const std::size_t lone = ins == 1 ? in[0] : off[0];
      const auto& o = others[lone];
      const std::uint32_t a = vertex(c[lone], c[o[0]]), b = vertex(c[lone], c[o[1]]), d = vertex(c[lone], c[o[2]]);
      out.push_back(ins == 1 ? index_triangle{a, b, d} : index_triangle{a, d, b});
      return;
    }
    // Two and two: an even permutation brings the inside corners first.
    std::array<std::size_t, 4> order{in[0], in[1], off[0], off[1]};
    const auto& o = others[order[0]];
    const std::size_t at = o[0] == order[1] ? 0 : o[1] == order[1] ? 1 : 2;
    order[2] = o[(at + 1) % 3];
    order[3] = o[(at + 2) % 3];
    const std::array<std::uint32_t, 4> quad{vertex(c[order[0]], c[order[2]]), vertex(c[order[0]], c[order[3]]),
                                            vertex(c[order[1]], c[order[3]]), vertex(c[order[1]], c[order[2]])};
    const auto length2 = [&](std::size_t i, std::size_t j) {
      const vec3 d = vertices_[quad[i]] - vertices_[quad[j]];
      return glm::dot(d, d);
    };
    if (length2(0, 2) <= length2(1, 3)) {
      out.push_back({quad[0], quad[1], quad[2]});
      out.push_back({quad[0], quad[2], quad[3]});
    } else {
      out.push_back({quad[0], quad[1], quad[3]});
      out.push_back({quad[1], quad[2], quad[3]});
    }
  }

  const node_store& store_;
  const std::vector<vec3>& vertices_;
};

}  // namespace

std::array<lattice_key, 16> lattice_frame::around(const vec3& p) const noexcept {
  const vec3 in_units = (p - origin) * (2.0 / cell_m);
  std::array<lattice_key, 16> out{};
  std::size_t n = 0;
  for (const std::int32_t odd : {0, 1}) {
    const auto low = [&](double x) { return 2 * static_cast<std::int32_t>(std::floor((x - odd) / 2.0)) + odd; };
    const lattice_point corner{low(in_units.x), low(in_units.y), low(in_units.z)};
    for (const std::int32_t x : {0, 2})
      for (const std::int32_t y : {0, 2})
        for (const std::int32_t z : {0, 2}) out[n++] = key_of(corner + lattice_point{x, y, z});
  }
  return out;
}

std::optional<lattice_surface> surface_on_lattice(const lattice_frame& frame, std::vector<lattice_key> seeds,
                                                  const lattice_body& body, unsigned threads, stage_monitor& monitor) {
  node_store store;
  lattice_surface out;
  const filling filled = fill(frame, std::move(seeds), body, threads, monitor, store);
  if (filled == filling::cancelled) return std::nullopt;
  out.too_large = filled == filling::too_large;
  if (out.too_large) return out;

  const std::vector<std::uint32_t> order = store.in_order();
  const std::vector<cut_edge> cuts = number_cuts(store, order, frame.most_vertices);
  out.too_large = cuts.size() > frame.most_vertices;
  if (out.too_large) return out;
  out.positions.resize(cuts.size());
  const auto place_vertices = [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const lattice_point a = cuts[i].from;
      const lattice_point b = a + edge_steps[cuts[i].kind];
      const float at_a = store.value(store.find(a));
      const float at_b = store.value(store.find(b));
      const vec3 p = frame.position(a);
      const vec3 q = frame.position(b);
      const double from_inside = at_a >= 0.0F ? body.cut(p, q, at_a, at_b) : 1.0 - body.cut(q, p, at_b, at_a);
      const double s = std::clamp(from_inside, least_cut, 1.0 - least_cut);
      out.positions[i] = p + s * (q - p);
    }
  };
  if (!parallel_blocks(cuts.size(), threads, monitor, monitor.done(), monitor.done(), place_vertices))
    return std::nullopt;

  const tetrahedra all(store, out.positions);
  std::vector<std::vector<index_triangle>> of_block(order.size());
  const auto cut_block = [&](std::size_t i) {
    const std::uint32_t b = order[i];
    for (std::uint32_t node = 0; node < block_nodes / 2; ++node)
      if (store.block(b).known[node])
        all.add_at(node_store::point_in_block(store.key(b), node), {b, node}, of_block[i]);
  };
  if (!parallel_tasks(order.size(), threads, monitor, monitor.done(), monitor.done(), cut_block)) return std::nullopt;
  for (const auto& part : of_block) out.triangles.insert(out.triangles.end(), part.begin(), part.end());
  return out;
}

}  // namespace asperity::bake
