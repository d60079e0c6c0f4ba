#include "bake/smooth.hpp"

#include <cmath>

#include "bake/halfedges.hpp"
#include "bake/parallel.hpp"

namespace asperity::bake {
namespace {

// Twicing leaves a tenth where the filter leaves a twentieth. At a third of a coarse edge that takes ln(20) passes
// times 2 / (3 pi)^2 times the ratio of the triangle counts.
constexpr double passes_per_triangle_ratio = 0.0675;
constexpr std::size_t most_passes = 500;

// Neighbours of every vertex, one after the other. In a closed mesh each edge leaves each of its ends once.
struct neighbours {
  std::vector<std::uint32_t> first;
  std::vector<std::uint32_t> vertex;

  explicit neighbours(const triangle_mesh& mesh) : first(mesh.positions.size() + 1, 0) {
    for (const index_triangle& t : mesh.triangles)
      for (const std::uint32_t v : t) ++first[v + 1];
    for (std::size_t v = 0; v + 1 < first.size(); ++v) first[v + 1] += first[v];
    vertex.resize(3 * mesh.triangles.size());
    std::vector<std::uint32_t> cursor(first.begin(), first.end() - 1);
    for (const index_triangle& t : mesh.triangles)
      for (std::size_t k = 0; k < 3; ++k) vertex[cursor[t[k]]++] = t[(k + 1) % 3];
  }
};

}  // namespace

std::size_t smoothing_passes(std::size_t full_triangles, std::size_t coarse_triangles) noexcept {
  const double ratio = static_cast<double>(full_triangles) / static_cast<double>(coarse_triangles);
  const auto passes = static_cast<std::size_t>(std::lround(passes_per_triangle_ratio * ratio));
  return passes < most_passes ? passes : most_passes;
}

std::vector<vec3> smooth(const triangle_mesh& mesh, std::size_t passes, unsigned threads, stage_monitor& monitor) {
  if (passes == 0) return mesh.positions;
  const neighbours around(mesh);
  std::vector<vec3> scratch(mesh.positions.size());
  const double steps = 2.0 * static_cast<double>(passes);
  double done = 0.0;
  const auto filter = [&](std::vector<vec3>& values) {
    for (std::size_t i = 0; i < passes; ++i, ++done) {
      const auto step = [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
          vec3 sum{0.0};
          for (std::uint32_t k = around.first[v]; k < around.first[v + 1]; ++k) sum += values[around.vertex[k]];
          scratch[v] = 0.5 * (values[v] + sum / static_cast<double>(around.first[v + 1] - around.first[v]));
        }
      };
      if (!parallel_blocks(values.size(), threads, monitor, done / steps, (done + 1.0) / steps, step)) return false;
      values.swap(scratch);
    }
    return true;
  };
  std::vector<vec3> smoothed = mesh.positions;
  if (!filter(smoothed)) return {};
  std::vector<vec3> removed = mesh.positions;
  for (std::size_t v = 0; v < removed.size(); ++v) removed[v] -= smoothed[v];
  if (!filter(removed)) return {};
  for (std::size_t v = 0; v < removed.size(); ++v) smoothed[v] += removed[v];
  return smoothed;
}

}  // namespace asperity::bake
