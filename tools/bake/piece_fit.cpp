#include "bake/piece_fit.hpp"

#include <algorithm>
#include <cmath>

#include "bake/geometry.hpp"
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

}  // namespace

std::optional<piece_fit> measure_fit(const triangle_mesh& mesh, const std::vector<convex_piece>& pieces,
                                     double spacing_m, stage_monitor& monitor) {
  const solid body(mesh);
  piece_fit out;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (!monitor.at(static_cast<double>(i) / static_cast<double>(pieces.size()))) return std::nullopt;
    const convex_piece& piece = pieces[i];
    const triangle_bvh hull(piece.vertices, piece.hull);
    for (const std::uint32_t t : piece.triangles)
      sample(corners(mesh.positions, mesh.triangles[t]), spacing_m, [&](const vec3& p) {
        out.surface_to_hull_max_m = std::max(out.surface_to_hull_max_m, hull.closest(p).distance_m);
      });
    for (const index_triangle& f : piece.hull)
      sample(corners(piece.vertices, f), spacing_m, [&](const vec3& p) {
        // Nearer than the worst so far, the side does not matter.
        const double distance = body.surface().closest(p).distance_m;
        if (distance > out.bridged_air_max_m && !body.holds(p)) out.bridged_air_max_m = distance;
      });
  }
  return out;
}

}  // namespace asperity::bake
