#include "bake/piece_fit.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "bake/geometry.hpp"
#include "bake/parallel.hpp"
#include "bake/solid.hpp"

namespace asperity::bake {
namespace {

constexpr int fewest_samples = 3;  // along a side
constexpr int most_samples = 16;

template <class Visit>
void sample(const std::array<vec3, 3>& c, double spacing_m, const Visit& visit) {
  const double longest = std::max({glm::length(c[1] - c[0]), glm::length(c[2] - c[1]), glm::length(c[0] - c[2])});
  const int n = std::clamp(static_cast<int>(std::ceil(longest / spacing_m)), fewest_samples, most_samples);
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n - i; ++j) {
      const double b1 = static_cast<double>(i) / n;
      const double b2 = static_cast<double>(j) / n;
      visit((1.0 - b1 - b2) * c[0] + b1 * c[1] + b2 * c[2]);
    }
}

void raise(std::atomic<double>& largest, double x) noexcept {
  double before = largest.load(std::memory_order_relaxed);
  while (x > before && !largest.compare_exchange_weak(before, x, std::memory_order_relaxed)) {
  }
}

}  // namespace

std::optional<piece_fit> measure_fit(const triangle_mesh& mesh, const std::vector<convex_piece>& pieces,
                                     double spacing_m, stage_monitor& monitor, unsigned threads) {
  const solid body(mesh);
  std::atomic<double> surface_to_hull{0.0};
  std::atomic<double> bridged_air{0.0};
  const auto measure_piece = [&](std::size_t i) {
    const convex_piece& piece = pieces[i];
    const triangle_bvh hull(piece.vertices, piece.hull);
    double deepest = 0.0;
    for (const std::uint32_t t : piece.triangles)
      sample(corners(mesh.positions, mesh.triangles[t]), spacing_m,
             [&](const vec3& p) { deepest = std::max(deepest, hull.closest(p).distance_m); });
    raise(surface_to_hull, deepest);
    for (const index_triangle& f : piece.hull)
      sample(corners(piece.vertices, f), spacing_m, [&](const vec3& p) {
        // Nearer than the worst so far, of whichever piece, the side does not matter.
        const double distance = body.surface().closest(p).distance_m;
        if (distance > bridged_air.load(std::memory_order_relaxed) && !body.holds(p)) raise(bridged_air, distance);
      });
  };
  if (!parallel_tasks(pieces.size(), threads, monitor, 0.0, 1.0, measure_piece)) return std::nullopt;
  return piece_fit{surface_to_hull.load(), bridged_air.load()};
}

}  // namespace asperity::bake
