#include "unit/field/field_measures.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <random>

#include "field/fill_distance.hpp"
#include "field/fine_surface.hpp"
#include "model/surface_index.hpp"

namespace asperity::test_support {

result<body_field> built_field(const textured_model& model, const field_settings& settings) {
  return make_body_field(model, settings);
}

brute_surface::brute_surface(const textured_model& model, double edge_m)
    : triangles_(detail::cut_fine_surface(model, edge_m)) {}

double brute_surface::distance(const vec3& p_b) const {
  double best = std::numeric_limits<double>::max();
  for (const auto& t : triangles_) {
    const vec3 d = p_b - detail::closest_on_triangle(t, p_b);
    best = std::min(best, glm::dot(d, d));
  }
  return std::sqrt(best);
}

double brute_surface::winding(const vec3& p_b) const {
  double sum = 0.0;  // van Oosterom and Strackee, The solid angle of a plane triangle, 1983
  for (const auto& t : triangles_) {
    const vec3 a = t[0] - p_b, b = t[1] - p_b, c = t[2] - p_b;
    const double x = glm::length(a), y = glm::length(b), z = glm::length(c);
    sum += std::atan2(glm::dot(a, glm::cross(b, c)),
                      x * y * z + glm::dot(a, b) * z + glm::dot(b, c) * x + glm::dot(c, a) * y);
  }
  return sum / (2.0 * std::numbers::pi);
}

std::vector<surface_point> random_surface_points(const textured_model& model, std::size_t count, std::uint64_t seed) {
  const detail::surface_index index(model);
  std::vector<double> area;
  double sum = 0.0;
  for (std::size_t t = 0; t < model.mesh.triangles.size(); ++t) {
    sum += glm::length(area_normal(corners(model.mesh, t)));
    area.push_back(sum);
  }
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<surface_point> out;
  for (std::size_t i = 0; i < count; ++i) {
    const auto t = std::min<std::size_t>(
        static_cast<std::size_t>(std::lower_bound(area.begin(), area.end(), unit(random) * sum) - area.begin()),
        area.size() - 1);
    double a = unit(random), b = unit(random);
    if (a + b > 1.0) {
      a = 1.0 - a;
      b = 1.0 - b;
    }
    const auto& uv = model.mesh.triangles[t].uv;
    const auto c = corners(model.mesh, t);
    surface_point s;
    s.p_b = model.texture.sample((1.0 - a - b) * uv[0] + a * uv[1] + b * uv[2]);
    if (!is_finite(s.p_b)) continue;
    const vec3 q = (1.0 - a - b) * c[0] + a * c[1] + b * c[2];
    s.to_sharp_edge_m = 1.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t other = index.neighbour[t][k];
      if (other == detail::surface_index::none || glm::dot(index.normal[other], index.normal[t]) > 0.8) continue;
      const vec3 along = c[(k + 1) % 3] - c[k];
      const double u = std::clamp(glm::dot(q - c[k], along) / glm::dot(along, along), 0.0, 1.0);
      s.to_sharp_edge_m = std::min(s.to_sharp_edge_m, glm::length(q - c[k] - u * along));
    }
    out.push_back(s);
  }
  return out;
}

zero_errors measure_zero(const body_field& field, const textured_model& model, std::size_t count, std::uint64_t seed) {
  std::vector<double> all, off, at;
  for (const surface_point& s : random_surface_points(model, count, seed)) {
    const double e = std::fabs(field.read(s.p_b).value_m) / model.box.diagonal();
    all.push_back(e);
    (s.to_sharp_edge_m < 2.0 * field.smooth.pitch_m ? at : off).push_back(e);
  }
  const auto part = [](std::vector<double>& v, double share) {
    if (v.empty()) return 0.0;
    std::sort(v.begin(), v.end());
    return v[static_cast<std::size_t>(share * static_cast<double>(v.size() - 1))];
  };
  return {part(all, 0.5), part(all, 0.99), part(off, 0.99), part(at, 0.99), part(all, 1.0), at.size()};
}

std::string to_text(const std::string& name, const body_field& field, const zero_errors& e) {
  char out[300];
  std::snprintf(out, sizeof out,
                "%-18s pitch %.3f mm, relief %.3f mm, thickness %.2f mm, %.1f MB; |D| on the surface, %% of the "
                "diagonal: median %.4f, p99 %.4f, off sharp edges %.4f, at them %.4f, largest %.3f",
                name.c_str(), 1e3 * field.smooth.pitch_m, 1e3 * field.fine.pitch_m, 1e3 * field.thickness_m,
                1e-6 * static_cast<double>(field.heap_bytes()), 100.0 * e.median, 100.0 * e.p99,
                100.0 * e.p99_off_edges, 100.0 * e.p99_at_edges, 100.0 * e.largest);
  return out;
}

}  // namespace asperity::test_support
