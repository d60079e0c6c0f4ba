#include "bake/crease_normals.hpp"

#include <algorithm>
#include <cmath>

#include "bake/geometry.hpp"

namespace asperity::bake {
namespace {

constexpr double sharp_cosine = 0.766;  // 40 degrees between the faces
constexpr double band_per_distance = 4.0;

// Largest distance between an edge and the original.
double distance_to(const triangle_bvh& full, const std::array<vec3, 2>& ends) {
  constexpr int samples = 16;
  double largest = 0.0;
  for (int i = 0; i <= samples; ++i)
    largest = std::max(largest, full.closest(glm::mix(ends[0], ends[1], static_cast<double>(i) / samples)).distance_m);
  return largest;
}

// Sum over the fan of triangles around the origin of h that can be reached without crossing a sharp edge.
vec3 fan_normal(const triangle_mesh& mesh, const connectivity& net, const std::vector<vec3>& faces,
                const std::vector<bool>& sharp, std::uint32_t h) {
  const auto share = [&](std::uint32_t at) {
    return corner_angle(corners(mesh.positions, mesh.triangles[at / 3]), at % 3) * faces[at / 3];
  };
  std::uint32_t start = h;  // turn clockwise to the sharp edge where the fan begins, or once round
  while (!sharp[start]) {
    start = next_halfedge(net.mate[start]);
    if (start == h) break;
  }
  vec3 sum = share(start);
  for (std::uint32_t at = start;;) {
    const std::uint32_t incoming = previous_halfedge(at);
    if (sharp[incoming]) break;
    at = net.mate[incoming];
    if (at == start) break;
    sum += share(at);
  }
  return normalised(sum);
}

}  // namespace

crease_normals::crease_normals(const triangle_mesh& coarse, const triangle_bvh& full, double least_band_m) {
  const connectivity net = connect(coarse.triangles, coarse.positions.size());
  const std::size_t count = coarse.triangles.size();
  std::vector<vec3> faces(count);
  corners_.resize(count);
  for (std::size_t t = 0; t < count; ++t) {
    corners_[t] = corners(coarse.positions, coarse.triangles[t]);
    faces[t] = unit_normal(corners_[t]);
  }
  std::vector<bool> sharp(net.mate.size(), false);
  std::vector<sharp_edge> edges;
  for (std::uint32_t h = 0; h < sharp.size(); ++h) {
    sharp[h] = net.mate[h] == no_halfedge || glm::dot(faces[h / 3], faces[net.mate[h] / 3]) < sharp_cosine;
    if (!sharp[h] || net.mate[h] < h) continue;
    const std::array<vec3, 2> ends{corners_[h / 3][h % 3], corners_[h / 3][next_halfedge(h) % 3]};
    edges.push_back({ends, std::max(least_band_m, band_per_distance * distance_to(full, ends))});
  }
  sharp_edges_ = edges.size();

  const std::vector<vec3> vertices = vertex_normals(coarse.positions, coarse.triangles);
  smooth_.resize(count);
  one_sided_.resize(count);
  first_near_.assign(count + 1, 0);
  for (std::uint32_t t = 0; t < count; ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      smooth_[t][k] = vertices[coarse.triangles[t][k]];
      one_sided_[t][k] = fan_normal(coarse, net, faces, sharp, 3 * t + k);
    }
    const bounds box = bounds_of(corners_[t]);
    for (const sharp_edge& e : edges) {
      const vec3 low = glm::min(e.ends[0], e.ends[1]) - e.band_m;
      const vec3 high = glm::max(e.ends[0], e.ends[1]) + e.band_m;
      if (glm::all(glm::lessThanEqual(low, box.high)) && glm::all(glm::greaterThanEqual(high, box.low)))
        near_.push_back(e);
    }
    first_near_[t + 1] = static_cast<std::uint32_t>(near_.size());
  }
}

vec3 crease_normals::mix(const std::array<vec3, 3>& values, const std::array<double, 3>& b) const noexcept {
  return normalised(b[0] * values[0] + b[1] * values[1] + b[2] * values[2]);
}

vec3 crease_normals::at(std::uint32_t t, const std::array<double, 3>& b) const noexcept {
  const vec3 away = mix(one_sided_[t], b);
  if (first_near_[t] == first_near_[t + 1]) return away;
  const auto& c = corners_[t];
  const vec3 p = b[0] * c[0] + b[1] * c[1] + b[2] * c[2];
  double w = 1.0;
  for (std::uint32_t i = first_near_[t]; i < first_near_[t + 1]; ++i) {
    const auto& [ends, band_m] = near_[i];
    w = std::min(w, smoothstep(glm::length(p - closest_on_segment(p, ends[0], ends[1])) / band_m));
  }
  if (w >= 1.0) return away;
  return normalised((1.0 - w) * mix(smooth_[t], b) + w * away);
}

}  // namespace asperity::bake
