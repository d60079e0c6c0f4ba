#include "bake/smooth.hpp"

#include <cmath>

#include "bake/halfedges.hpp"
#include "bake/parallel.hpp"

namespace asperity::bake {
namespace {

constexpr double step = 0.5;
constexpr double step_back = -0.52;
constexpr double passes_per_triangle_ratio = 0.116;
constexpr std::size_t most_passes = 400;

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
  std::vector<vec3> from = mesh.positions;
  if (passes == 0) return from;
  std::vector<vec3> to(from.size());
  const neighbours around(mesh);
  const std::size_t steps = 2 * passes;
  for (std::size_t i = 0; i < steps; ++i) {
    const double s = i % 2 == 0 ? step : step_back;
    const auto move = [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        vec3 sum{0.0};
        for (std::uint32_t k = around.first[v]; k < around.first[v + 1]; ++k) sum += from[around.vertex[k]];
        const auto count = static_cast<double>(around.first[v + 1] - around.first[v]);
        to[v] = from[v] + s * (sum / count - from[v]);
      }
    };
    const double n = static_cast<double>(steps);
    const double done = static_cast<double>(i);
    if (!parallel_blocks(from.size(), threads, monitor, done / n, (done + 1.0) / n, move)) return {};
    from.swap(to);
  }
  return from;
}

}  // namespace asperity::bake
