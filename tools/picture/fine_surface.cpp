#include "picture/fine_surface.hpp"

#include <algorithm>
#include <cmath>

#include "bake/parallel.hpp"

namespace asperity::picture {
namespace {

constexpr std::uint32_t most_segments = 16384;  // twice as many as an 8192-texel edge

bool finite(const vec3& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

std::uint32_t segments(double length_m, double step_m) {
  return static_cast<std::uint32_t>(std::clamp(std::ceil(length_m / step_m), 1.0, double{most_segments}));
}

// Derivative of the surface along a direction of the texture; one-sided where the other side has no texel.
vec3 slope(const haptic_texture& texture, const vec2& uv, const vec2& step) {
  const vec3 ahead = texture.sample(uv + step);
  const vec3 behind = texture.sample(uv - step);
  if (finite(ahead) && finite(behind)) return ahead - behind;
  const vec3 here = texture.sample(uv);
  return finite(ahead) ? ahead - here : here - behind;
}

// Over one texel, so that the faces of the bilinear surface do not show. Across the edge of a chart the gutter is read:
// the light does not break there.
vec3 fine_normal(const haptic_texture& texture, const vec2& uv, double turn, const vec3& coarse_normal) {
  const vec3 along_u = slope(texture, uv, vec2(0.5 / texture.width, 0.0));
  const vec3 along_v = slope(texture, uv, vec2(0.0, 0.5 / texture.height));
  const vec3 n = turn * glm::cross(along_u, along_v);
  const double length = glm::length(n);
  return std::isfinite(length) && length > 0.0 ? n / length : coarse_normal;
}

void sample_triangle(const textured_model& model, std::size_t t, double least_step_m, fine_surface& out) {
  const coarse_triangle& triangle = model.mesh.triangles[t];
  const std::array<vec3, 3> c = corners(model.mesh, t);
  std::array<double, 3> edge{};
  for (std::size_t k = 0; k < 3; ++k) edge[k] = glm::length(c[(k + 1) % 3] - c[k]);
  const auto base = static_cast<std::size_t>(std::max_element(edge.begin(), edge.end()) - edge.begin());
  const std::array<vec3, 3> p{c[base], c[(base + 1) % 3], c[(base + 2) % 3]};
  const std::array<vec2, 3> uv{triangle.uv[base], triangle.uv[(base + 1) % 3], triangle.uv[(base + 2) % 3]};

  const vec3 normal_and_area = area_normal(c);
  const double twice_area_m2 = glm::length(normal_and_area);
  const vec3 normal = twice_area_m2 > 0.0 ? normal_and_area / twice_area_m2 : vec3(0.0, 0.0, 1.0);
  const vec2 side{model.texture.width, model.texture.height};
  const vec2 e1 = side * (uv[1] - uv[0]);
  const vec2 e2 = side * (uv[2] - uv[0]);
  const double twice_texels = e1.x * e2.y - e1.y * e2.x;
  const double turn = twice_texels < 0.0 ? -1.0 : 1.0;  // a mirrored chart
  const double texel_m = twice_texels != 0.0 ? std::sqrt(twice_area_m2 / std::fabs(twice_texels)) : 0.0;
  const double step_m = std::max({texel_m, least_step_m, 1e-12});

  fine_patch patch{out.points.size(), segments(edge[base], step_m), segments(twice_area_m2 / edge[base], step_m)};
  const double area_m2 = 0.5 * twice_area_m2 / ((patch.columns + 1.0) * (patch.rows + 1.0));
  for (std::uint32_t j = 0; j <= patch.rows; ++j) {
    const double s = static_cast<double>(j) / patch.rows;
    for (std::uint32_t i = 0; i <= patch.columns; ++i) {
      const double r = static_cast<double>(i) / patch.columns;
      const double w0 = (1.0 - s) * (1.0 - r);
      const double w1 = (1.0 - s) * r;
      const vec2 at = w0 * uv[0] + w1 * uv[1] + s * uv[2];
      const vec3 coarse = w0 * p[0] + w1 * p[1] + s * p[2];
      const vec3 read = model.texture.sample(at);
      const vec3 point = finite(read) ? read : coarse;
      out.points.emplace_back(point);
      out.normals.emplace_back(fine_normal(model.texture, at, turn, normal));
      out.heights.push_back(static_cast<float>(glm::dot(point - coarse, normal)));
      out.areas.push_back(static_cast<float>(2.0 * (1.0 - s) * area_m2));
    }
  }
  out.patches.push_back(patch);
}

}  // namespace

fine_surface sample_fine_surface(const textured_model& model, double least_step_m) {
  fine_surface out;
  out.patches.reserve(model.mesh.triangles.size());
  for (std::size_t t = 0; t < model.mesh.triangles.size(); ++t) sample_triangle(model, t, least_step_m, out);
  return out;
}

result<std::vector<float>> distances(const fine_surface& from, const bake::triangle_bvh& original, unsigned threads,
                                     bake::stage_monitor& monitor) {
  std::vector<float> out(from.points.size());
  const auto measure = [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      out[i] = static_cast<float>(original.closest(vec3(from.points[i])).distance_m);
    }
  };
  if (!bake::parallel_blocks(out.size(), bake::resolve_threads(threads), monitor, 0.1, 0.6, measure)) {
    return error{error_code::cancelled, "interrupted: no picture was written"};
  }
  return out;
}

double quantile(const std::vector<float>& values, const std::vector<float>& areas, double share) {
  std::vector<std::uint32_t> order(values.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::uint32_t>(i);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return values[a] < values[b] || (values[a] == values[b] && a < b);
  });
  double whole = 0.0;
  for (const float area : areas) whole += static_cast<double>(area);
  double below = 0.0;
  for (const std::uint32_t i : order) {
    below += static_cast<double>(areas[i]);
    if (below >= share * whole) return static_cast<double>(values[i]);
  }
  return static_cast<double>(values[order.back()]);
}

}  // namespace asperity::picture
