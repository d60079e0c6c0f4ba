#include "bake/fine_points.hpp"

#include <algorithm>
#include <array>

#include "bake/geometry.hpp"

namespace asperity::bake {
namespace {

struct row {
  std::uint32_t first;
  std::uint32_t segments;
};

// Triangles between two rows of points over the same directions, the longer row below.
void stitch(const row& below, const row& above, std::vector<index_triangle>& out) {
  std::uint32_t i = 0;
  std::uint32_t j = 0;
  while (i < below.segments || j < above.segments) {
    const bool step_below =
        j == above.segments || (i < below.segments && (2 * i + 1) * above.segments <= (2 * j + 1) * below.segments);
    if (step_below) {
      out.push_back({below.first + i, below.first + i + 1, above.first + j});
      ++i;
    } else {
      out.push_back({below.first + i, above.first + j + 1, above.first + j});
      ++j;
    }
  }
}

// Rows parallel to the triangle's longest edge, about one step apart, so that slivers do not get more than their share.
// edge and height are in steps; point(b) is the surface point at barycentric coordinates b, counted from corner `base`.
template <class Point>
void sample_triangle(double longest_edge, double height, std::size_t base, const Point& point, triangle_mesh& out) {
  const auto rows = static_cast<std::uint32_t>(std::max(1.0, std::ceil(height)));
  row below{};
  for (std::uint32_t j = 0; j <= rows; ++j) {
    const double s = static_cast<double>(j) / rows;
    const row here{static_cast<std::uint32_t>(out.positions.size()),
                   j == rows ? 0U : static_cast<std::uint32_t>(std::max(1.0, std::ceil((1.0 - s) * longest_edge)))};
    for (std::uint32_t i = 0; i <= here.segments; ++i) {
      const double r = here.segments == 0 ? 0.0 : static_cast<double>(i) / here.segments;
      std::array<double, 3> b{};
      b[base] = (1.0 - s) * (1.0 - r);
      b[(base + 1) % 3] = (1.0 - s) * r;
      b[(base + 2) % 3] = s;
      out.positions.push_back(point(b));
    }
    if (j > 0) stitch(below, here, out.triangles);
    below = here;
  }
}

void fill_areas(fine_points& points) {
  points.area.assign(points.mesh.positions.size(), 0.0);
  for (const index_triangle& t : points.mesh.triangles) {
    const double third = glm::length(area_normal(corners(points.mesh.positions, t))) / 6.0;
    for (const std::uint32_t v : t) points.area[v] += third;
  }
}

template <class Corners>
std::size_t longest(const Corners& c, double& length) {
  std::size_t base = 0;
  length = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double l = glm::length(c[(k + 1) % 3] - c[k]);
    if (l > length) {
      length = l;
      base = k;
    }
  }
  return base;
}

}  // namespace

fine_points sample_textured(const coarse_mesh& coarse, const haptic_texture& texture) {
  fine_points out;
  const vec2 side{texture.width, texture.height};
  for (std::uint32_t t = 0; t < coarse.triangles.size(); ++t) {
    const auto& uv = coarse.triangles[t].uv;
    const std::array<vec2, 3> c{side * uv[0], side * uv[1], side * uv[2]};
    double edge = 0.0;
    const std::size_t base = longest(c, edge);
    const vec2 u = c[1] - c[0];
    const vec2 v = c[2] - c[0];
    const auto at = [&](const std::array<double, 3>& b) {
      return texture.sample(b[0] * uv[0] + b[1] * uv[1] + b[2] * uv[2]);
    };
    sample_triangle(edge, std::abs(u.x * v.y - u.y * v.x) / edge, base, at, out.mesh);
    out.source.resize(out.mesh.triangles.size(), t);
  }
  fill_areas(out);
  return out;
}

fine_points sample_mesh(const triangle_mesh& mesh, double step_m) {
  fine_points out;
  out.mesh.positions = mesh.positions;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto c = corners(mesh.positions, mesh.triangles[t]);
    double edge = 0.0;
    const std::size_t base = longest(c, edge);
    if (edge <= step_m) {
      out.mesh.triangles.push_back(mesh.triangles[t]);
    } else {
      const auto at = [&](const std::array<double, 3>& b) { return b[0] * c[0] + b[1] * c[1] + b[2] * c[2]; };
      sample_triangle(edge / step_m, glm::length(area_normal(c)) / edge / step_m, base, at, out.mesh);
    }
    out.source.resize(out.mesh.triangles.size(), t);
  }
  fill_areas(out);
  return out;
}

}  // namespace asperity::bake
