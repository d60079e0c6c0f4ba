#include "bake/thin_features.hpp"

#include <cstdio>
#include <limits>
#include <vector>

#include "bake/geometry.hpp"
#include "bake/parallel.hpp"
#include "bake/surface_points.hpp"

namespace asperity::bake {
namespace {

constexpr std::size_t points_looked_at = 20'000;
constexpr double least_parallel = 0.8;  // cosine between the way in and the outward side of the wall that it leaves by

constexpr double thick = std::numeric_limits<double>::infinity();

class thickness_probe {
 public:
  thickness_probe(const triangle_mesh& mesh, const triangle_bvh& tree, double thinner_than_m)
      : mesh_(mesh), tree_(tree), thinner_than_m_(thinner_than_m) {}

  // Way from p straight inwards to the first wall that it leaves by; `thick` where there is none that near, or where
  // that wall stands across.
  [[nodiscard]] double operator()(const relief_point& p) const {
    const vec3 inwards = -p.normal;
    double left_m = thinner_than_m_;
    double found_m = thick;
    std::uint32_t wall = no_halfedge;
    // The tree answers with the crossing nearest to the middle of the way: the first one is what is left when no
    // nearer one is found.
    for (;;) {
      const double half = 0.5 * left_m;
      const auto exit = tree_.nearest_front_crossing(p.position + half * inwards, inwards, half);
      if (!exit) break;
      const double at_m = half + exit->offset_m;
      if (!(at_m < found_m) || !(at_m >= 0.0)) break;
      found_m = at_m;
      wall = exit->triangle;
      left_m = at_m * (1.0 - 1e-9);
      if (!(left_m > 0.0)) break;
    }
    if (wall == no_halfedge) return thick;
    const vec3 n = unit_normal(corners(mesh_.positions, mesh_.triangles[wall]));
    return glm::dot(n, inwards) >= least_parallel ? found_m : thick;
  }

 private:
  const triangle_mesh& mesh_;
  const triangle_bvh& tree_;
  double thinner_than_m_;
};

}  // namespace

std::optional<thin_features> find_thin_features(const triangle_mesh& mesh, const triangle_bvh& tree,
                                                double thinner_than_m, unsigned threads, stage_monitor& monitor) {
  const std::vector<relief_point> points = spread_points(mesh, points_looked_at);
  const thickness_probe thickness(mesh, tree, thinner_than_m);
  std::vector<double> found(points.size(), thick);
  const auto look = [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) found[i] = thickness(points[i]);
  };
  if (!parallel_blocks(points.size(), threads, monitor, 0.5, 1.0, look)) return std::nullopt;
  thin_features out;
  out.thinnest_m = thick;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (found[i] == thick) continue;
    ++out.points;
    if (found[i] < out.thinnest_m) {
      out.thinnest_m = found[i];
      out.at = points[i].position;
    }
  }
  if (out.points == 0) out.thinnest_m = 0.0;
  out.share = static_cast<double>(out.points) / static_cast<double>(points.size());
  return out;
}

std::string thin_remark(const thin_features& found, double thinner_than_m) {
  if (found.points == 0) return {};
  char text[320];
  std::snprintf(text, sizeof text,
                "%.3g %% of the surface is of parts thinner than two texels (%.3g mm), where both sides may be felt as "
                "one: the thinnest found is %.3g mm at (%.4g, %.4g, %.4g); more texels (--texture) resolve them",
                100.0 * found.share, 1e3 * thinner_than_m, 1e3 * found.thinnest_m, found.at.x, found.at.y, found.at.z);
  return text;
}

}  // namespace asperity::bake
