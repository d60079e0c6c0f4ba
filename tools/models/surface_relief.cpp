#include "surface_relief.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <queue>
#include <random>
#include <utility>

namespace asperity::models {
namespace {

constexpr double two_pi = 6.283185307179586;
constexpr std::size_t wave_count = 32;
/// A vertex is on a sharp edge where a triangle's normal is more than 26 degrees away from the vertex's.
constexpr double sharp_cosine = 0.9;

/// Uniform in [0, 1), the same on every platform, which the standard's distributions do not promise.
double uniform(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

vec3 area_normal_of(const triangle_mesh& mesh, const std::array<std::uint32_t, 3>& t) {
  const vec3& a = mesh.positions[t[0]];
  return glm::cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a);
}

std::vector<vec3> vertex_normals(const triangle_mesh& mesh) {
  std::vector<vec3> normals(mesh.positions.size(), vec3(0.0));
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t) normals[v] += area_normal_of(mesh, t);
  for (vec3& n : normals) n = glm::normalize(n);
  return normals;
}

std::vector<bool> sharp_vertices(const triangle_mesh& mesh, const std::vector<vec3>& normals) {
  std::vector<bool> sharp(mesh.positions.size(), false);
  for (const auto& t : mesh.triangles) {
    const vec3 n = glm::normalize(area_normal_of(mesh, t));
    for (const std::uint32_t v : t)
      if (glm::dot(n, normals[v]) < sharp_cosine) sharp[v] = true;
  }
  return sharp;
}

/// Neighbours of every vertex, packed: those of v are list[start[v]] to list[start[v + 1] - 1].
struct neighbours {
  std::vector<std::size_t> start;
  std::vector<std::uint32_t> list;
};

/// On a closed mesh every edge is some triangle's directed edge once each way, so each neighbour comes exactly once.
neighbours neighbours_of(const triangle_mesh& mesh) {
  neighbours out;
  out.start.assign(mesh.positions.size() + 1, 0);
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t) ++out.start[v + 1];
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) out.start[v + 1] += out.start[v];
  out.list.resize(out.start.back());
  std::vector<std::size_t> next(out.start.begin(), out.start.end() - 1);
  for (const auto& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) out.list[next[t[i]]++] = t[(i + 1) % 3];
  return out;
}

/// Distance of every vertex to the nearest sharp edge, along mesh edges; infinite beyond `limit_m`.
std::vector<double> distance_to_sharp(const triangle_mesh& mesh, const std::vector<vec3>& normals, double limit_m) {
  const neighbours around = neighbours_of(mesh);
  const std::vector<bool> sharp = sharp_vertices(mesh, normals);
  std::vector<double> distance(mesh.positions.size(), std::numeric_limits<double>::infinity());
  using entry = std::pair<double, std::uint32_t>;
  std::priority_queue<entry, std::vector<entry>, std::greater<>> front;
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    if (!sharp[v]) continue;
    distance[v] = 0.0;
    front.emplace(0.0, v);
  }
  while (!front.empty()) {
    const auto [d, v] = front.top();
    front.pop();
    if (d > distance[v]) continue;
    for (std::size_t i = around.start[v]; i < around.start[v + 1]; ++i) {
      const std::uint32_t w = around.list[i];
      const double reached = d + glm::length(mesh.positions[w] - mesh.positions[v]);
      if (reached > limit_m || reached >= distance[w]) continue;
      distance[w] = reached;
      front.emplace(reached, w);
    }
  }
  return distance;
}

}  // namespace

band_noise::band_noise(std::uint64_t seed, double shortest_m, double longest_m, double peak_m) : peak_m_(peak_m) {
  std::mt19937_64 random(seed);
  waves_.reserve(wave_count);
  for (std::size_t i = 0; i < wave_count; ++i) {
    const double z = 2.0 * uniform(random) - 1.0;
    const double turn = two_pi * uniform(random);
    const double across = std::sqrt(1.0 - z * z);
    const double wavelength = shortest_m + (longest_m - shortest_m) * uniform(random);
    const vec3 direction(across * std::cos(turn), across * std::sin(turn), z);
    waves_.push_back({two_pi / wavelength * direction, two_pi * uniform(random)});
  }
}

double band_noise::operator()(const vec3& p) const noexcept {
  double sum = 0.0;
  for (const wave& w : waves_) sum += std::sin(glm::dot(w.k_rad_per_m, p) + w.phase_rad);
  // Root mean square 1; then squeezed into (-1, 1) without a kink.
  const double x = sum * std::sqrt(2.0 / static_cast<double>(wave_count));
  return peak_m_ * x / std::sqrt(1.0 + x * x);
}

void displace(triangle_mesh& mesh, double fade_m, const std::function<double(const vec3&)>& height_m) {
  const std::vector<vec3> normals = vertex_normals(mesh);
  const std::vector<double> distance = distance_to_sharp(mesh, normals, fade_m);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const double share = smoothstep(distance[v] / fade_m);
    if (share > 0.0) mesh.positions[v] += share * height_m(mesh.positions[v]) * normals[v];
  }
}

}  // namespace asperity::models
