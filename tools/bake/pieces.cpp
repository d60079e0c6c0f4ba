#include "bake/pieces.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include "bake/convex_hull.hpp"
#include "bake/geometry.hpp"
#include "bake/solid.hpp"

namespace asperity::bake {
namespace {

constexpr std::uint32_t component_mark = no_halfedge - 1;  // in in_patch_, apart from all patch numbers

struct plane {
  vec3 normal{0.0};
  double offset = 0.0;

  explicit plane(const std::array<vec3, 3>& c) : normal(unit_normal(c)), offset(glm::dot(normal, c[0])) {}
  [[nodiscard]] double height(const vec3& p) const noexcept { return glm::dot(normal, p) - offset; }
};

// A patch under construction: triangles, their vertices, and the hull of these.
struct patch {
  std::vector<std::uint32_t> triangles;
  std::vector<std::uint32_t> vertices;
  convex_hull hull;

  explicit patch(std::span<const lattice_point> lattice) : hull(lattice) {}
};

class decomposition {
 public:
  decomposition(const triangle_mesh& mesh, const piece_limits& limits)
      : mesh_(mesh),
        net_(connect(mesh.triangles, mesh.positions.size())),
        solid_(mesh),
        owner_(mesh.triangles.size(), no_halfedge),
        in_patch_(mesh.positions.size(), no_halfedge) {
    const bounds box = bounds_of(mesh.positions);
    diagonal_ = box.diagonal();
    tolerance_ = limits.tolerance * diagonal_;
    bridged_air_ = limits.bridged_air * diagonal_;
    flat_ = limits.flat * diagonal_;
    most_triangles_ = limits.triangles != 0 ? limits.triangles : mesh.triangles.size();
    lattice_ = to_lattice(mesh.positions, box);
    for (const index_triangle& t : mesh.triangles) planes_.emplace_back(bake::corners(mesh.positions, t));
  }

  [[nodiscard]] std::optional<std::vector<convex_piece>> run(stage_monitor& monitor) {
    std::vector<convex_piece> pieces;
    for (std::uint32_t c = 0; c < net_.components; ++c)
      if (auto whole = convex_component(c)) pieces.push_back(finish(*whole));
    std::vector<std::uint32_t> seeds(mesh_.triangles.size());
    std::vector<double> area(seeds.size());
    for (std::uint32_t t = 0; t < seeds.size(); ++t) {
      seeds[t] = t;
      area[t] = glm::length(area_normal(bake::corners(mesh_.positions, mesh_.triangles[t])));
    }
    std::sort(seeds.begin(), seeds.end(),
              [&](std::uint32_t a, std::uint32_t b) { return std::tuple(-area[a], a) < std::tuple(-area[b], b); });
    for (std::size_t i = 0; i < seeds.size(); ++i) {
      if (owner_[seeds[i]] != no_halfedge) continue;
      if (!monitor.at(static_cast<double>(i) / static_cast<double>(seeds.size()))) return std::nullopt;
      pieces.push_back(finish(grow(seeds[i])));
    }
    return pieces;
  }

 private:
  // A component all of whose vertices lie below all of its planes needs no growing.
  std::optional<patch> convex_component(std::uint32_t component) {
    patch whole(lattice_);
    for (std::uint32_t t = 0; t < owner_.size(); ++t)
      if (net_.component[t] == component) whole.triangles.push_back(t);
    for (const std::uint32_t t : whole.triangles) take_vertices(whole, t, component_mark);
    for (const std::uint32_t t : whole.triangles)
      for (const std::uint32_t v : whole.vertices)
        if (planes_[t].height(mesh_.positions[v]) > tolerance_) {
          for (const std::uint32_t u : whole.vertices) in_patch_[u] = no_halfedge;
          return std::nullopt;
        }
    for (const std::uint32_t v : whole.vertices) whole.hull.insert(v);
    for (const std::uint32_t t : whole.triangles) owner_[t] = patches_;
    ++patches_;
    return whole;
  }

  void take_vertices(patch& p, std::uint32_t t, std::uint32_t mark) {
    for (const std::uint32_t v : mesh_.triangles[t])
      if (in_patch_[v] != mark) {
        in_patch_[v] = mark;
        p.vertices.push_back(v);
      }
  }

  patch grow(std::uint32_t seed) {
    const std::uint32_t number = patches_++;
    patch p(lattice_);
    const auto take = [&](std::uint32_t t) {
      owner_[t] = number;
      p.triangles.push_back(t);
      take_vertices(p, t, number);
    };
    take(seed);
    for (const std::uint32_t v : p.vertices) p.hull.insert(v);
    std::vector<std::uint32_t> refused;
    for (std::size_t i = 0; i < p.triangles.size(); ++i)
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t mate = net_.mate[3 * p.triangles[i] + k];
        const std::uint32_t t = mate / 3;
        if (p.triangles.size() >= most_triangles_) return p;
        if (owner_[t] != no_halfedge || std::find(refused.begin(), refused.end(), t) != refused.end()) continue;
        if (try_add(p, t, number))
          take(t);
        else
          refused.push_back(t);
      }
    return p;
  }

  // Extends the hull of p where triangle t may join it.
  bool try_add(patch& p, std::uint32_t t, std::uint32_t number) {
    for (const std::uint32_t v : p.vertices)
      if (planes_[t].height(mesh_.positions[v]) > tolerance_) return false;
    std::optional<std::uint32_t> added;  // a neighbour brings one new vertex at most
    for (const std::uint32_t v : mesh_.triangles[t])
      if (in_patch_[v] != number) added = v;
    if (!added) return true;
    for (const std::uint32_t u : p.triangles)
      if (planes_[u].height(mesh_.positions[*added]) > tolerance_) return false;
    convex_hull larger = p.hull;
    larger.insert(*added);
    if (larger.is_solid() && (bridges_air(larger, *added) || swallows_surface(larger, number))) return false;
    p.hull = std::move(larger);
    return true;
  }

  // Do the hull's new faces, those at vertex v, stand off the solid by more than the limit?
  bool bridges_air(const convex_hull& hull, std::uint32_t v) const {
    for (const index_triangle& f : hull.faces()) {
      if (f[0] != v && f[1] != v && f[2] != v) continue;
      const auto c = bake::corners(mesh_.positions, f);
      const double longest = std::max({glm::length(c[1] - c[0]), glm::length(c[2] - c[1]), glm::length(c[0] - c[2])});
      const int n = std::clamp(static_cast<int>(std::ceil(longest / (4.0 * bridged_air_))), 3, 24);
      for (int i = 0; i <= n; ++i)
        for (int j = 0; i + j <= n; ++j) {
          const double b1 = static_cast<double>(i) / n;
          const double b2 = static_cast<double>(j) / n;
          const vec3 q = (1.0 - b1 - b2) * c[0] + b1 * c[1] + b2 * c[2];
          if (solid_.surface().closest(q, bridged_air_).triangle == no_halfedge && !solid_.holds(q)) return true;
        }
    }
    return false;
  }

  // Does an edge of the rest of the mesh run through the hull deeper than the tolerance?
  bool swallows_surface(const convex_hull& hull, std::uint32_t number) const {
    std::vector<plane> sides;
    bounds box{mesh_.positions[hull.faces()[0][0]], mesh_.positions[hull.faces()[0][0]]};
    for (const index_triangle& f : hull.faces()) {
      const auto c = bake::corners(mesh_.positions, f);
      sides.emplace_back(c);
      for (const vec3& p : c) {
        box.low = glm::min(box.low, p);
        box.high = glm::max(box.high, p);
      }
    }
    for (std::uint32_t h = 0; h < net_.mate.size(); ++h) {
      if (net_.mate[h] < h || owner_[h / 3] == number || owner_[net_.mate[h] / 3] == number) continue;
      const vec3& a = mesh_.positions[origin_of(mesh_.triangles, h)];
      const vec3& b = mesh_.positions[origin_of(mesh_.triangles, next_halfedge(h))];
      if (glm::any(glm::lessThan(glm::max(a, b), box.low)) || glm::any(glm::greaterThan(glm::min(a, b), box.high)))
        continue;
      if (runs_through(sides, a, b)) return true;
    }
    return false;
  }

  // Clips the segment against all sides, each moved inwards by twice the tolerance.
  bool runs_through(const std::vector<plane>& sides, const vec3& a, const vec3& b) const {
    double from = 0.0;
    double to = 1.0;
    for (const plane& s : sides) {
      const double ha = s.height(a) + 2.0 * tolerance_;
      const double hb = s.height(b) + 2.0 * tolerance_;
      if (ha >= 0.0 && hb >= 0.0) return false;
      if (ha > 0.0) from = std::max(from, ha / (ha - hb));
      if (hb > 0.0) to = std::min(to, ha / (ha - hb));
      if (from >= to) return false;
    }
    return true;
  }

  convex_piece finish(const patch& p) const {
    convex_piece out;
    out.triangles = p.triangles;
    std::sort(out.triangles.begin(), out.triangles.end());
    vec3 normal{0.0};
    double area = 0.0;
    for (const std::uint32_t t : p.triangles) {
      const vec3 a = area_normal(bake::corners(mesh_.positions, mesh_.triangles[t]));
      normal += a;
      area += glm::length(a);
    }
    // The normals of a piece that goes all the way round cancel: it has no direction in which it could be flat.
    const bool one_sided = glm::length(normal) > 0.5 * area;
    normal = normalised(normal);
    double low = glm::dot(normal, mesh_.positions[p.vertices[0]]);
    double high = low;
    for (const std::uint32_t v : p.vertices) {
      low = std::min(low, glm::dot(normal, mesh_.positions[v]));
      high = std::max(high, glm::dot(normal, mesh_.positions[v]));
    }
    out.flat = !p.hull.is_solid() || (one_sided && high - low <= flat_);
    if (out.flat)
      finish_flat(p, normal, out);
    else
      finish_solid(p, out);
    return out;
  }

  void finish_flat(const patch& p, const vec3& normal, convex_piece& out) const {
    std::vector<vec3> points;
    for (const std::uint32_t v : p.vertices) points.push_back(mesh_.positions[v]);
    std::vector<std::uint32_t> polygon = convex_polygon(points, normal);
    if (polygon.size() < 3) polygon = {0, 1, 2};  // a sliver below the lattice's step: its own triangle
    for (const std::uint32_t i : polygon) out.vertices.push_back(points[i]);
    for (std::uint32_t i = 1; i + 1 < polygon.size(); ++i) out.hull.push_back({0, i, i + 1});
  }

  void finish_solid(const patch& p, convex_piece& out) const {
    std::vector<std::uint32_t> used;
    for (const index_triangle& f : p.hull.faces()) used.insert(used.end(), f.begin(), f.end());
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    for (const std::uint32_t v : used) out.vertices.push_back(mesh_.positions[v]);
    for (index_triangle f : p.hull.faces()) {
      for (std::uint32_t& v : f)
        v = static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), v) - used.begin());
      out.hull.push_back(f);
    }
  }

  const triangle_mesh& mesh_;
  connectivity net_;
  solid solid_;
  std::vector<plane> planes_;
  std::vector<lattice_point> lattice_;
  std::vector<std::uint32_t> owner_;     // patch of each triangle
  std::vector<std::uint32_t> in_patch_;  // per vertex: the patch that took it last
  std::uint32_t patches_ = 0;
  double diagonal_ = 0.0;
  double tolerance_ = 0.0;
  double bridged_air_ = 0.0;
  double flat_ = 0.0;
  std::size_t most_triangles_ = 0;
};

}  // namespace

result<std::vector<convex_piece>> decompose(const triangle_mesh& mesh, const piece_limits& limits,
                                            stage_monitor& monitor) {
  decomposition work(mesh, limits);
  auto pieces = work.run(monitor);
  if (!pieces) return error{error_code::cancelled, "the bake was cancelled"};
  return std::move(*pieces);
}

}  // namespace asperity::bake
