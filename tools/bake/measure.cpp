#include "bake/measure.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "bake/fine_points.hpp"
#include "bake/geometry.hpp"
#include "bake/halfedges.hpp"
#include "bake/parallel.hpp"

namespace asperity::bake {
namespace {

// Distances from points of the original this far apart miss nothing that is as wide as the texture's own detail.
constexpr double original_step_texels = 2.0;
constexpr int least_crack_samples = 32;
constexpr double crack_samples_per_texel = 2.0;

struct one_way {
  std::vector<double> distance;
  length_spread spread;
  double rms = 0.0;
};

// @return false where the bake was cancelled
bool measure_one_way(const fine_points& from, const triangle_bvh& to, unsigned threads, stage_monitor& monitor,
                     double start, one_way& out) {
  const std::vector<vec3>& points = from.mesh.positions;
  out.distance.resize(points.size());
  const auto visit = [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) out.distance[i] = to.closest(points[i]).distance_m;
  };
  if (!parallel_blocks(points.size(), threads, monitor, start, start + 0.45, visit)) return false;
  double weighted_squares = 0.0;
  double weight = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    weighted_squares += from.area[i] * out.distance[i] * out.distance[i];
    weight += from.area[i];
  }
  out.rms = weight > 0.0 ? std::sqrt(weighted_squares / weight) : 0.0;
  out.spread = spread_of(out.distance, from.area);
  return true;
}

}  // namespace

length_spread spread_of(const std::vector<double>& values_m, const std::vector<double>& weights) {
  if (values_m.empty()) return {};
  std::vector<std::pair<double, double>> sorted(values_m.size());
  double whole = 0.0;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    sorted[i] = {values_m[i], weights[i]};
    whole += weights[i];
  }
  std::sort(sorted.begin(), sorted.end());
  const auto percentile = [&](double share) {
    double sum = 0.0;
    for (const auto& [value, weight] : sorted) {
      sum += weight;
      if (sum >= share * whole) return value;
    }
    return sorted.back().first;
  };
  return {percentile(0.5), percentile(0.99), sorted.back().first};
}

double largest_crack(const coarse_mesh& coarse, const haptic_texture& texture) {
  const vec2 side{texture.width, texture.height};
  std::vector<index_triangle> triangles;
  for (const coarse_triangle& t : coarse.triangles) triangles.push_back(t.vertex);
  const connectivity net = connect(triangles, coarse.positions.size());
  double largest = 0.0;
  for (std::uint32_t h = 0; h < net.mate.size(); ++h) {
    const std::uint32_t mate = net.mate[h];
    if (mate == no_halfedge || mate < h) continue;
    const auto& here = coarse.triangles[h / 3].uv;
    const auto& there = coarse.triangles[mate / 3].uv;
    const double texels = glm::length(side * (here[next_halfedge(h) % 3] - here[h % 3]));
    const int samples = std::max(least_crack_samples, static_cast<int>(std::ceil(crack_samples_per_texel * texels)));
    for (int i = 0; i <= samples; ++i) {
      const double s = static_cast<double>(i) / samples;
      const vec3 p = texture.sample((1.0 - s) * here[h % 3] + s * here[next_halfedge(h) % 3]);
      const vec3 q = texture.sample((1.0 - s) * there[next_halfedge(mate) % 3] + s * there[mate % 3]);
      largest = std::max(largest, glm::length(p - q));
    }
  }
  return largest;
}

length_spread texel_spacing(const haptic_texture& texture, const std::vector<std::uint32_t>& chart) {
  std::vector<double> spacing;
  spacing.reserve(2 * chart.size());
  const auto take = [&](std::size_t a, std::size_t b) {
    if (chart[a] != no_halfedge && chart[a] == chart[b])
      spacing.push_back(glm::length(vec3(texture.texels[b]) - vec3(texture.texels[a])));
  };
  for (std::size_t i = 0; i < chart.size(); ++i) {
    if ((i + 1) % texture.width != 0) take(i, i + 1);
    if (i + texture.width < chart.size()) take(i, i + texture.width);
  }
  return spread_of(spacing, std::vector<double>(spacing.size(), 1.0));
}

double surface_error::rms_m() const noexcept {
  return std::sqrt(0.5 * (to_original_rms_m * to_original_rms_m + to_textured_rms_m * to_textured_rms_m));
}

double surface_error::max_m() const noexcept { return std::max(to_original.max_m, to_textured.max_m); }

result<surface_error> measure(const triangle_mesh& full, const triangle_bvh& full_tree, const coarse_mesh& coarse,
                              const haptic_texture& texture, double texel_m, unsigned threads, stage_monitor& monitor) {
  const error cancelled{error_code::cancelled, "the bake was cancelled"};
  surface_error out;
  const fine_points textured = sample_textured(coarse, texture);
  one_way forth;
  if (!measure_one_way(textured, full_tree, threads, monitor, 0.0, forth)) return cancelled;
  out.to_original = forth.spread;
  out.to_original_rms_m = forth.rms;
  const triangle_bvh textured_tree(textured.mesh.positions, textured.mesh.triangles, threads);
  const fine_points original = sample_mesh(full, original_step_texels * texel_m);
  one_way back;
  if (!measure_one_way(original, textured_tree, threads, monitor, 0.45, back)) return cancelled;
  out.to_textured = back.spread;
  out.to_textured_rms_m = back.rms;
  const std::vector<char> lost =
      find_lost(original, back.distance, textured_tree, lost_reach_texels * texel_m, threads, monitor);
  if (monitor.cancelled()) return cancelled;
  out.lost = measure_lost(full, original, lost);
  out.crack_max_m = largest_crack(coarse, texture);
  return out;
}

}  // namespace asperity::bake
