#include "bake/hole_fill.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "bake/geometry.hpp"

namespace asperity::bake {
namespace {

// The open halfedge that follows h around its hole: turn about h's end point until an edge without a mate comes.
std::uint32_t next_along_border(std::uint32_t h, const std::vector<std::uint32_t>& mate) {
  std::uint32_t g = next_halfedge(h);
  while (mate[g] != no_halfedge) g = next_halfedge(mate[g]);
  return g;
}

// Triangulation of a hole that folds back onto itself or onto the triangles around as rarely as it can, and of those
// the one of least area: best(i, k) over the corners between i and k, by increasing distance. Area alone is not enough:
// where a rim is ragged, the least of it may lie back to back with the surface.
class smallest_fill {
 public:
  /// @param rim  normal of what lies at the edge from each corner to the next
  smallest_fill(const std::vector<vec3>& positions, std::vector<std::uint32_t> polygon, std::vector<vec3> rim)
      : positions_(positions), n_(polygon.size()), polygon_(std::move(polygon)), rim_(std::move(rim)), best_(n_ * n_) {
    for (std::size_t gap = 2; gap < n_; ++gap) {
      for (std::size_t i = 0; i + gap < n_; ++i) find_best_split(i, i + gap);
    }
  }

  [[nodiscard]] double area() const { return best_[n_ - 1].area; }
  [[nodiscard]] const vec3& normal() const { return best_[n_ - 1].normal; }

  void append_to(std::vector<index_triangle>& out) const {
    std::vector<std::pair<std::size_t, std::size_t>> open{{0, n_ - 1}};
    while (!open.empty()) {
      const auto [i, k] = open.back();
      open.pop_back();
      if (k - i < 2) continue;
      const std::size_t j = best_[i * n_ + k].split;
      // The hole's border runs against the new triangles: its neighbours already run along it this way.
      out.push_back({polygon_[k], polygon_[j], polygon_[i]});
      open.emplace_back(i, j);
      open.emplace_back(j, k);
    }
  }

 private:
  static constexpr double folded_cosine = -0.866;  // two triangles that leave less than 30 degrees between them

  // The fill between corner i and corner k, and of it the triangle at the edge from i to k.
  struct fill {
    int folds = 0;
    double area = 0.0;
    std::size_t split = 0;
    vec3 normal{0.0};
  };

  [[nodiscard]] const vec3& normal_across(std::size_t i, std::size_t k) const {
    return k - i == 1 ? rim_[i] : best_[i * n_ + k].normal;
  }

  // Corners on a line: what has no area is no better than a fold.
  [[nodiscard]] bool flat(std::size_t i, std::size_t j, std::size_t k) const {
    constexpr double least_sine = 1e-7;
    const vec3 a = positions_[polygon_[j]] - positions_[polygon_[i]];
    const vec3 b = positions_[polygon_[k]] - positions_[polygon_[i]];
    const double longest = std::max({glm::dot(a, a), glm::dot(b, b), glm::dot(b - a, b - a)});
    return glm::length(glm::cross(a, b)) <= least_sine * longest;
  }

  void find_best_split(std::size_t i, std::size_t k) {
    fill best{std::numeric_limits<int>::max(), 0.0, 0, vec3(0.0)};
    for (std::size_t j = i + 1; j < k; ++j) {
      const vec3 across = area_normal(corners(positions_, {polygon_[k], polygon_[j], polygon_[i]}));
      const fill& before = best_[i * n_ + j];
      const fill& after = best_[j * n_ + k];
      fill here{before.folds + after.folds, before.area + after.area + 0.5 * glm::length(across), j,
                normalised(across)};
      const auto fold = [&](const vec3& beside) { return glm::dot(here.normal, beside) < folded_cosine ? 1 : 0; };
      if (here.normal == vec3(0.0) || flat(i, j, k)) here.folds += 1;
      here.folds += fold(normal_across(i, j)) + fold(normal_across(j, k));
      if (k - i == n_ - 1) here.folds += fold(rim_[n_ - 1]);
      if (std::pair(here.folds, here.area) < std::pair(best.folds, best.area)) best = here;
    }
    best_[i * n_ + k] = best;
  }

  const std::vector<vec3>& positions_;
  std::size_t n_;
  std::vector<std::uint32_t> polygon_;
  std::vector<vec3> rim_;  // normal of the triangle at the edge from each corner to the next
  std::vector<fill> best_;
};

struct rim {
  std::vector<std::uint32_t> polygon;
  std::vector<vec3> normals;  // of what lies at the edge from each corner to the next
};

/// Does the rim from its first to its last vertex run straight?
bool is_straight(const std::vector<vec3>& positions, const std::vector<std::uint32_t>& chain) {
  constexpr double straight = 1e-7;
  const vec3 a = positions[chain.front()];
  const vec3 b = positions[chain.back()];
  return std::ranges::all_of(chain, [&](std::uint32_t v) {
    return glm::length(positions[v] - closest_on_segment(positions[v], a, b)) <= straight * glm::length(b - a);
  });
}

double fill_rim(triangle_mesh& mesh, const rim& border, std::size_t at_once) {
  const std::size_t n = border.polygon.size();
  if (n <= at_once) {
    const smallest_fill fill(mesh.positions, border.polygon, border.normals);
    fill.append_to(mesh.triangles);
    return fill.area();
  }
  // Parts of the rim, each closed by a chord; then what the chords leave. Where a part runs straight, its vertices are
  // set into the triangle at the chord.
  const std::size_t step = (n + at_once - 1) / at_once;
  double area = 0.0;
  rim inner;
  std::vector<std::vector<std::uint32_t>> straight;
  for (std::size_t from = 0; from < n; from += step) {
    const std::size_t to = std::min(from + step, n);
    rim part;
    for (std::size_t i = from; i <= to; ++i) part.polygon.push_back(border.polygon[i % n]);
    for (std::size_t i = from; i < to; ++i) part.normals.push_back(border.normals[i]);
    inner.polygon.push_back(border.polygon[from]);
    inner.normals.push_back(part.normals.front());
    if (part.polygon.size() < 3) continue;
    if (is_straight(mesh.positions, part.polygon)) {
      straight.push_back(part.polygon);
      continue;
    }
    part.normals.push_back(vec3(0.0));  // nothing lies at the chord yet
    if (part.polygon.size() > at_once) {
      area += fill_rim(mesh, part, at_once);
      continue;
    }
    const smallest_fill fill(mesh.positions, part.polygon, part.normals);
    fill.append_to(mesh.triangles);
    area += fill.area();
    inner.normals.back() = fill.normal();
  }
  const std::size_t first = mesh.triangles.size();
  area += fill_rim(mesh, inner, at_once);
  // The chord runs from the later vertex to the earlier one in its triangle.
  std::ranges::sort(straight, {}, [](const std::vector<std::uint32_t>& c) { return std::pair(c.back(), c.front()); });
  for (std::size_t t = first, end = mesh.triangles.size(); t < end; ++t) {
    std::vector<index_triangle> open{mesh.triangles[t]};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::pair ends(mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]);
      const auto chain = std::ranges::lower_bound(
          straight, ends, {}, [](const std::vector<std::uint32_t>& c) { return std::pair(c.back(), c.front()); });
      if (chain == straight.end() || std::pair(chain->back(), chain->front()) != ends) continue;
      for (index_triangle& whole : open) {
        std::size_t at = 0;
        while (at < 3 && (whole[at] != ends.first || whole[(at + 1) % 3] != ends.second)) ++at;
        if (at == 3) continue;
        const std::uint32_t apex = whole[(at + 2) % 3];
        const index_triangle last{(*chain)[1], ends.second, apex};
        whole = last;
        for (std::size_t i = 1; i + 1 < chain->size(); ++i) open.push_back({(*chain)[i + 1], (*chain)[i], apex});
        break;
      }
    }
    mesh.triangles[t] = open.front();
    mesh.triangles.insert(mesh.triangles.end(), open.begin() + 1, open.end());
  }
  return area;
}

}  // namespace

std::vector<std::vector<std::uint32_t>> find_holes(const connectivity& around) {
  std::vector<std::vector<std::uint32_t>> holes;
  std::vector<bool> seen(around.mate.size(), false);
  for (std::uint32_t start = 0; start < around.mate.size(); ++start) {
    if (around.mate[start] != no_halfedge || seen[start]) continue;
    auto& hole = holes.emplace_back();
    for (std::uint32_t h = start; !seen[h]; h = next_along_border(h, around.mate)) {
      seen[h] = true;
      hole.push_back(h);
    }
  }
  return holes;
}

std::vector<std::vector<std::uint32_t>> find_simple_holes(const triangle_mesh& mesh, const connectivity& around) {
  std::vector<std::vector<std::uint32_t>> out;
  constexpr std::size_t nowhere = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> place(mesh.positions.size(), nowhere);
  for (const auto& border : find_holes(around)) {
    std::vector<std::uint32_t> path;
    for (const std::uint32_t h : border) {
      const std::uint32_t v = origin_of(mesh.triangles, h);
      if (place[v] != nowhere) {  // the path has come back to where it was: that part is a hole of its own
        const std::size_t from = place[v];
        auto& loop = out.emplace_back(path.begin() + static_cast<std::ptrdiff_t>(from), path.end());
        for (const std::uint32_t g : loop) place[origin_of(mesh.triangles, g)] = nowhere;
        path.resize(from);
      }
      place[v] = path.size();
      path.push_back(h);
    }
    for (const std::uint32_t h : path) place[origin_of(mesh.triangles, h)] = nowhere;
    out.push_back(std::move(path));
  }
  std::erase_if(out, [](const auto& hole) { return hole.size() < 3; });
  return out;
}

double fill_hole(triangle_mesh& mesh, const std::vector<std::uint32_t>& hole, double& budget) {
  rim border;
  for (const std::uint32_t h : hole) {
    border.polygon.push_back(origin_of(mesh.triangles, h));
    border.normals.push_back(unit_normal(corners(mesh.positions, mesh.triangles[h / 3])));
  }
  constexpr std::size_t at_once = 200;
  constexpr std::size_t at_once_late = 40;
  const auto n = static_cast<double>(hole.size());
  const bool rich = budget > 0.0;
  budget -= hole.size() <= largest_hole_edges ? n * n * n : n * at_once * at_once;
  return fill_rim(mesh, border,
                  !rich                               ? at_once_late
                  : hole.size() <= largest_hole_edges ? largest_hole_edges
                                                      : at_once);
}

double widest_distance(const triangle_mesh& mesh, const std::vector<std::uint32_t>& hole) {
  const auto at = [&](std::uint32_t h) { return mesh.positions[origin_of(mesh.triangles, h)]; };
  double widest = 0.0;
  constexpr std::size_t most_compared = 2000;
  if (hole.size() > most_compared) {
    std::vector<vec3> points;
    for (const std::uint32_t h : hole) points.push_back(at(h));
    return bounds_of(points).diagonal();
  }
  for (const std::uint32_t a : hole) {
    for (const std::uint32_t b : hole) widest = std::max(widest, glm::length(at(a) - at(b)));
  }
  return widest;
}

}  // namespace asperity::bake
