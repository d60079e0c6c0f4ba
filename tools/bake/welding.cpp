// Borders that should be one: vertices welded, and T-junctions resolved. What is closed already is not looked at.
#include <algorithm>
#include <array>
#include <limits>
#include <tuple>
#include <utility>

#include "bake/edge_table.hpp"
#include "bake/repair_steps.hpp"
#include "bake/triangle_bvh.hpp"

namespace asperity::bake {
namespace {

std::vector<std::uint32_t> open_halfedges(const triangle_mesh& mesh) {
  std::vector<std::uint32_t> out;
  const std::vector<edge_use> edges = edges_of(mesh.triangles);
  for_each_edge(edges, [&](std::span<const edge_use> uses) {
    if (uses.size() == 1) out.push_back(uses[0].halfedge);
  });
  std::ranges::sort(out);
  return out;
}

std::vector<std::uint32_t> border_vertices(const triangle_mesh& mesh) {
  std::vector<std::uint32_t> out;
  for (const std::uint32_t h : open_halfedges(mesh)) {
    out.push_back(origin_of(mesh.triangles, h));
    out.push_back(origin_of(mesh.triangles, next_halfedge(h)));
  }
  std::ranges::sort(out);
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

/// Gives all triangles the vertices that theirs became.
void rename(triangle_mesh& mesh, const std::vector<std::uint32_t>& became, repair_report& report) {
  for (std::uint32_t v = 0; v < became.size(); ++v)
    if (became[v] != v)
      report.add(repair_kind::weld, mesh.positions[v], glm::length(mesh.positions[v] - mesh.positions[became[v]]));
  for (index_triangle& t : mesh.triangles)
    for (std::uint32_t& v : t) v = became[v];
}

std::vector<std::uint32_t> themselves(const triangle_mesh& mesh) {
  std::vector<std::uint32_t> out(mesh.positions.size());
  for (std::uint32_t v = 0; v < out.size(); ++v) out[v] = v;
  return out;
}

/// Border vertices at equal positions become the first of them.
void weld_equal(triangle_mesh& mesh, repair_report& report) {
  std::vector<std::uint32_t> border = border_vertices(mesh);
  const auto place = [&](std::uint32_t v) {
    const vec3& p = mesh.positions[v];
    return std::tuple(p.x, p.y, p.z);
  };
  std::ranges::sort(border,
                    [&](std::uint32_t a, std::uint32_t b) { return std::pair(place(a), a) < std::pair(place(b), b); });
  std::vector<std::uint32_t> became = themselves(mesh);
  for (std::size_t i = 1; i < border.size(); ++i)
    if (place(border[i]) == place(border[i - 1])) became[border[i]] = became[border[i - 1]];
  rename(mesh, became, report);
}

constexpr double weld_per_edge = 0.4;       // no edge loses both its ends to one vertex
constexpr std::size_t most_looked_at = 64;  // of one cell: bounds the work where much lies in little room

/// Border vertices in the cells of a grid as wide as the tolerance.
class border_grid {
 public:
  border_grid(const triangle_mesh& mesh, double width) : low_(bounds_of(mesh.positions).low), width_(width) {
    for (const std::uint32_t v : border_vertices(mesh)) entries_.emplace_back(key(cell(mesh.positions[v])), v);
    std::ranges::sort(entries_);
  }

  [[nodiscard]] const std::vector<std::pair<std::uint64_t, std::uint32_t>>& entries() const { return entries_; }

  template <class Visit>
  void near(const vec3& p, const Visit& visit) const {
    const std::array<std::int64_t, 3> c = cell(p);
    for (std::int64_t x = c[0] - 1; x <= c[0] + 1; ++x)
      for (std::int64_t y = c[1] - 1; y <= c[1] + 1; ++y)
        for (std::int64_t z = c[2] - 1; z <= c[2] + 1; ++z) {
          if (std::min({x, y, z}) < 0) continue;
          const std::uint64_t k = key({x, y, z});
          auto at = std::ranges::lower_bound(entries_, std::pair(k, std::uint32_t{0}));
          for (std::size_t n = 0; n < most_looked_at && at != entries_.end() && at->first == k; ++n, ++at)
            visit(at->second);
        }
  }

 private:
  [[nodiscard]] std::array<std::int64_t, 3> cell(const vec3& p) const {
    const vec3 at = (p - low_) / width_;
    return {static_cast<std::int64_t>(at.x), static_cast<std::int64_t>(at.y), static_cast<std::int64_t>(at.z)};
  }
  [[nodiscard]] static std::uint64_t key(const std::array<std::int64_t, 3>& c) {
    return static_cast<std::uint64_t>(c[0]) << 42U | static_cast<std::uint64_t>(c[1]) << 21U |
           static_cast<std::uint64_t>(c[2]);
  }

  vec3 low_;
  double width_;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> entries_;  // cell, vertex
};

/// Border vertices within the tolerance become the nearest earlier one that stays.
void weld_near(triangle_mesh& mesh, double tolerance_m, repair_report& report) {
  const border_grid grid(mesh, tolerance_m);
  const std::vector<double> shortest = shortest_edges(mesh);
  std::vector<std::uint32_t> border;
  for (const auto& [key, v] : grid.entries()) border.push_back(v);
  std::ranges::sort(border);
  std::vector<std::uint32_t> became = themselves(mesh);
  for (const std::uint32_t v : border) {
    double best = std::numeric_limits<double>::infinity();
    grid.near(mesh.positions[v], [&](std::uint32_t u) {
      if (u >= v || became[u] != u) return;
      const double d = glm::length(mesh.positions[u] - mesh.positions[v]);
      const double most = std::min(tolerance_m, weld_per_edge * std::min(shortest[u], shortest[v]));
      if (d > most || d > best || (d == best && became[v] < u)) return;
      best = d;
      became[v] = u;
    });
  }
  rename(mesh, became, report);
}

}  // namespace

void weld_borders(triangle_mesh& mesh, double tolerance_m, repair_report& report) {
  weld_equal(mesh, report);
  weld_near(mesh, tolerance_m, report);
}

// A vertex of one border that lies on an open edge of another: the edge's triangle is split there, so that the two
// borders have the same edges. One edge of a triangle at a time.
void split_t_junctions(triangle_mesh& mesh, double tolerance_m, repair_report& report) {
  constexpr int most_passes = 3;  // one for each edge of a triangle
  for (int pass = 0; pass < most_passes; ++pass) {
    const std::vector<std::uint32_t> open = open_halfedges(mesh);
    if (open.empty()) return;
    std::vector<index_triangle> segments;
    for (const std::uint32_t h : open) {
      const std::uint32_t b = origin_of(mesh.triangles, next_halfedge(h));
      segments.push_back({origin_of(mesh.triangles, h), b, b});
    }
    struct junction {
      std::uint32_t edge;
      double s;
      std::uint32_t vertex;
      double off_m;
    };
    std::vector<junction> found;
    const triangle_bvh tree(mesh.positions, segments);
    for (const std::uint32_t v : border_vertices(mesh)) {
      const vec3 p = mesh.positions[v];
      std::size_t looked_at = 0;
      tree.visit_box(p - vec3(tolerance_m), p + vec3(tolerance_m), [&](std::uint32_t e) {
        if (++looked_at > most_looked_at) return;
        const index_triangle& t = mesh.triangles[open[e] / 3];
        if (t[0] == v || t[1] == v || t[2] == v) return;
        const vec3 a = mesh.positions[segments[e][0]];
        const vec3 d = mesh.positions[segments[e][1]] - a;
        const double length2 = glm::dot(d, d);
        const double s = glm::dot(p - a, d) / length2;
        const double end = std::min(tolerance_m / std::sqrt(length2), 0.25);
        if (!(s > end && s < 1.0 - end)) return;
        const double off = glm::length(p - a - s * d);
        const vec3 apex = mesh.positions[origin_of(mesh.triangles, previous_halfedge(open[e]))];
        const double height = glm::length(glm::cross(d, apex - a)) / std::sqrt(length2);
        if (off <= std::min(tolerance_m, weld_per_edge * height)) found.push_back({e, s, v, off});
      });
    }
    std::ranges::sort(found, {}, [](const junction& j) { return std::tuple(j.edge, -j.s, j.vertex); });
    std::vector<bool> used(mesh.triangles.size(), false);
    bool done = true;
    for (std::size_t i = 0, j = 0; i < found.size(); i = j) {
      while (j < found.size() && found[j].edge == found[i].edge) ++j;
      const std::uint32_t h = open[found[i].edge];
      if (used[h / 3]) {
        done = false;
        continue;
      }
      used[h / 3] = true;
      double length = 1.0;  // of the part of the edge that triangle h / 3 still has
      for (std::size_t n = i; n < j; ++n) {
        if (n > i && found[n].s == found[n - 1].s) continue;
        split_at_edge(mesh, h / 3, h % 3, found[n].vertex, found[n].s / length);
        length = found[n].s;
        report.add(repair_kind::t_junction, mesh.positions[found[n].vertex], found[n].off_m);
      }
    }
    if (done) return;
  }
}

}  // namespace asperity::bake
