#include "full_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace asperity::experiment {

static constexpr double no_surface_m = -std::numeric_limits<double>::infinity();

surface_from_above::surface_from_above(const triangle_mesh& full, const pose& T_wb, const vec3& middle_m, double half_m,
                                       double step_m)
    : x0_(middle_m.x - half_m),
      y0_(middle_m.y - half_m),
      step_(step_m),
      n_(static_cast<long>(std::ceil(2.0 * half_m / step_m)) + 1),
      z_(static_cast<std::size_t>(n_ * n_), no_surface_m) {
  std::vector<vec3> placed;
  placed.reserve(full.positions.size());
  for (const vec3& p : full.positions) placed.push_back(T_wb * p);
  for (const auto& t : full.triangles) draw(placed[t[0]], placed[t[1]], placed[t[2]]);
}

void surface_from_above::draw(const vec3& a, const vec3& b, const vec3& c) {
  const double area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
  if (area == 0.0) return;
  const auto first = [&](double low, double from) {
    return std::max(0L, static_cast<long>(std::ceil((low - from) / step_)));
  };
  const auto last = [&](double high, double from) {
    return std::min(n_ - 1, static_cast<long>(std::floor((high - from) / step_)));
  };
  constexpr double rim = -1e-9;  // a lattice point on an edge belongs to both triangles
  const long j_last = last(std::max({a.y, b.y, c.y}), y0_), i_last = last(std::max({a.x, b.x, c.x}), x0_);
  for (long j = first(std::min({a.y, b.y, c.y}), y0_); j <= j_last; ++j) {
    for (long i = first(std::min({a.x, b.x, c.x}), x0_); i <= i_last; ++i) {
      const double x = x0_ + static_cast<double>(i) * step_, y = y0_ + static_cast<double>(j) * step_;
      const double of_b = ((x - a.x) * (c.y - a.y) - (c.x - a.x) * (y - a.y)) / area;
      const double of_c = ((b.x - a.x) * (y - a.y) - (x - a.x) * (b.y - a.y)) / area;
      if (of_b < rim || of_c < rim || of_b + of_c > 1.0 - rim) continue;
      at(i, j) = std::max(at(i, j), a.z + of_b * (b.z - a.z) + of_c * (c.z - a.z));
    }
  }
}

double surface_from_above::height(double x_m, double y_m) const noexcept {
  const double u = (x_m - x0_) / step_, v = (y_m - y0_) / step_;
  const auto i = static_cast<long>(std::floor(u)), j = static_cast<long>(std::floor(v));
  if (i < 0 || j < 0 || i + 1 >= n_ || j + 1 >= n_) return no_surface_m;
  const double s = u - static_cast<double>(i), t = v - static_cast<double>(j);
  return (1.0 - t) * ((1.0 - s) * at(i, j) + s * at(i + 1, j)) + t * ((1.0 - s) * at(i, j + 1) + s * at(i + 1, j + 1));
}

double depth_along_z(const surface_from_above& fixed, const std::vector<vec3>& points_a, const pose& T_wa) noexcept {
  const mat3 r = glm::mat3_cast(T_wa.rotation);
  double deepest = no_surface_m;
  for (const vec3& p_a : points_a) {
    const vec3 p = r * p_a + T_wa.position;
    deepest = std::max(deepest, fixed.height(p.x, p.y) - p.z);
  }
  return deepest;
}

}  // namespace asperity::experiment
