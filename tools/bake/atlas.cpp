#include "bake/atlas.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>

#include "bake/geometry.hpp"
#include "bake/halfedges.hpp"

namespace asperity::bake {
namespace {

constexpr double least_texels_per_triangle = 2.0;

// One or two triangles laid flat: metres, lower left corner of the bounding box at the origin, lying on its long side.
struct chart {
  std::vector<std::uint32_t> triangles;
  std::vector<std::array<vec2, 3>> corners;
  vec2 size{0.0};
  vec2 place{0.0};  // of its lower left corner, texels
};

// Unfolds the triangle of halfedge h: the halfedge from (0, 0) along +x, the third corner on the side of `up`.
std::array<vec2, 3> unfold(const triangle_mesh& mesh, std::uint32_t h, double up) {
  const auto c = bake::corners(mesh.positions, mesh.triangles[h / 3]);
  const std::size_t k = h % 3;
  const vec3 along = c[(k + 1) % 3] - c[k];
  const double length = glm::length(along);
  const vec3 to_apex = c[(k + 2) % 3] - c[k];
  std::array<vec2, 3> flat;
  flat[k] = {0.0, 0.0};
  flat[(k + 1) % 3] = {length, 0.0};
  flat[(k + 2) % 3] = {glm::dot(to_apex, along) / length, up * glm::length(glm::cross(along, to_apex)) / length};
  return flat;
}

chart single_chart(const triangle_mesh& mesh, std::uint32_t triangle) {
  return {{triangle}, {unfold(mesh, 3 * triangle, 1.0)}, {}, {}};
}

// The mate runs the other way along the shared edge: unfolded, it lies below, turned by half a turn.
chart pair_chart(const triangle_mesh& mesh, std::uint32_t h, std::uint32_t mate) {
  chart out{{h / 3, mate / 3}, {unfold(mesh, h, 1.0), unfold(mesh, mate, 1.0)}, {}, {}};
  const double length = out.corners[0][(h % 3 + 1) % 3].x;
  for (vec2& p : out.corners[1]) p = vec2(length, 0.0) - p;
  return out;
}

struct box2 {
  vec2 low{std::numeric_limits<double>::infinity()};
  vec2 high{-std::numeric_limits<double>::infinity()};
};

box2 turned_box(const chart& c, const vec2& axis) {
  box2 box;
  for (const auto& t : c.corners)
    for (const vec2& p : t) {
      const vec2 q{axis.x * p.x + axis.y * p.y, axis.x * p.y - axis.y * p.x};
      box.low = glm::min(box.low, q);
      box.high = glm::max(box.high, q);
    }
  return box;
}

// Turns the chart so that its bounding box is as small as can be: one side of it then runs along an edge of the hull,
// and with at most two triangles every hull edge joins two of the corners.
void settle(chart& c) {
  std::vector<vec2> points;
  for (const auto& t : c.corners) points.insert(points.end(), t.begin(), t.end());
  vec2 best_axis{1.0, 0.0};
  double best_area = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = i + 1; j < points.size(); ++j) {
      const double length = glm::length(points[j] - points[i]);
      if (!(length > 0.0)) continue;
      const vec2 axis = (points[j] - points[i]) / length;
      const box2 box = turned_box(c, axis);
      const vec2 size = box.high - box.low;
      if (size.x * size.y < best_area * (1.0 - 1e-9)) {
        best_area = size.x * size.y;
        best_axis = axis;
      }
    }
  box2 box = turned_box(c, best_axis);
  const bool upright = box.high.y - box.low.y > box.high.x - box.low.x;
  if (upright) {
    best_axis = {-best_axis.y, best_axis.x};
    box = turned_box(c, best_axis);
  }
  for (auto& t : c.corners)
    for (vec2& p : t) p = vec2(best_axis.x * p.x + best_axis.y * p.y, best_axis.x * p.y - best_axis.y * p.x) - box.low;
  c.size = box.high - box.low;
}

std::vector<chart> cut(const triangle_mesh& mesh) {
  const connectivity net = connect(mesh.triangles, mesh.positions.size());
  struct shared_edge {
    double length;
    std::uint32_t halfedge;
  };
  std::vector<shared_edge> edges;
  for (std::uint32_t h = 0; h < net.mate.size(); ++h) {
    if (net.mate[h] < h || net.mate[h] == no_halfedge) continue;
    const vec3& a = mesh.positions[origin_of(mesh.triangles, h)];
    const vec3& b = mesh.positions[origin_of(mesh.triangles, next_halfedge(h))];
    edges.push_back({glm::length(b - a), h});
  }
  std::sort(edges.begin(), edges.end(), [](const shared_edge& a, const shared_edge& b) {
    return std::tuple(-a.length, a.halfedge) < std::tuple(-b.length, b.halfedge);
  });
  std::vector<bool> taken(mesh.triangles.size(), false);
  std::vector<chart> charts;
  for (const shared_edge& e : edges) {
    const std::uint32_t mate = net.mate[e.halfedge];
    if (taken[e.halfedge / 3] || taken[mate / 3]) continue;
    taken[e.halfedge / 3] = taken[mate / 3] = true;
    charts.push_back(pair_chart(mesh, e.halfedge, mate));
  }
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    if (!taken[t]) charts.push_back(single_chart(mesh, t));
  for (chart& c : charts) settle(c);
  return charts;
}

// Rows of charts, highest first. @return false where they do not fit at this scale (texels per metre)
bool place_in_rows(std::vector<chart>& charts, double scale, double side) {
  vec2 pen{0.0};
  double row = 0.0;
  for (chart& c : charts) {
    const vec2 size = scale * c.size + 2.0 * gutter_texels;
    if (size.x > side) return false;
    if (pen.x + size.x > side) pen = {0.0, pen.y + row};
    if (pen.x == 0.0) row = size.y;
    if (pen.y + size.y > side) return false;
    c.place = pen + gutter_texels;
    pen.x += size.x;
  }
  return true;
}

// @return texels per metre, 0 where the charts cannot be placed at any scale
double pack(std::vector<chart>& charts, double side, double area) {
  std::stable_sort(charts.begin(), charts.end(), [](const chart& a, const chart& b) { return a.size.y > b.size.y; });
  double fits = 0.0;
  double too_large = side / std::sqrt(area);
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (fits + too_large);
    (place_in_rows(charts, middle, side) ? fits : too_large) = middle;
  }
  return fits > 0.0 && place_in_rows(charts, fits, side) ? fits : 0.0;
}

}  // namespace

result<void> check_room(double texels, std::size_t triangles, std::uint32_t texture_size) {
  if (texels >= least_texels_per_triangle * static_cast<double>(triangles)) return {};
  return error{error_code::invalid_argument, "a texture of " + std::to_string(texture_size) +
                                                 " texels is too small for " + std::to_string(triangles) +
                                                 " coarse triangles; ask for a larger texture or fewer triangles"};
}

result<atlas> make_atlas(const triangle_mesh& coarse, std::uint32_t texture_size) {
  double area = 0.0;
  for (const index_triangle& t : coarse.triangles) area += 0.5 * glm::length(area_normal(corners(coarse.positions, t)));
  std::vector<chart> charts = cut(coarse);
  const double side = texture_size;
  const double scale = pack(charts, side, area);
  const double texels = area * scale * scale;
  if (const auto enough = check_room(texels, coarse.triangles.size(), texture_size); !enough) return enough.error();
  atlas out;
  out.uv.resize(coarse.triangles.size());
  out.chart.resize(coarse.triangles.size());
  out.charts = charts.size();
  out.texel_m = out.narrow_m = out.wide_m = 1.0 / scale;
  out.utilisation = texels / (side * side);
  for (std::size_t i = 0; i < charts.size(); ++i)
    for (std::size_t j = 0; j < charts[i].triangles.size(); ++j) {
      const std::uint32_t t = charts[i].triangles[j];
      out.chart[t] = static_cast<std::uint32_t>(i);
      for (std::size_t k = 0; k < 3; ++k) {
        const vec2 uv = (scale * charts[i].corners[j][k] + charts[i].place) / side;
        out.uv[t][k] = {to_float32(uv.x), to_float32(uv.y)};
      }
    }
  return out;
}

}  // namespace asperity::bake
