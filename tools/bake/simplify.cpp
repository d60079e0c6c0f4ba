#include "bake/simplify.hpp"

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bake/collapse.hpp"
#include "bake/geometry.hpp"
#include "bake/halfedges.hpp"
#include "bake/smooth.hpp"

namespace asperity::bake {
namespace {

// Smoothing and triangle count, each as a multiple of what was asked for.
struct attempt {
  double smoothing;
  double triangles;
};
constexpr std::array attempts{attempt{1.0, 1.0}, attempt{2.0, 1.0}, attempt{4.0, 1.0}, attempt{1.0, 1.5},
                              attempt{2.0, 2.0}, attempt{0.0, 1.0}, attempt{0.0, 2.0}, attempt{0.0, 4.0}};

constexpr double folded_cosine = -0.985;     // two triangles less than 10 degrees from lying back to back
constexpr double least_height_ratio = 1e-4;  // height over longest edge

bool same_topology(const triangle_mesh& mesh, const checked_mesh& full) {
  if (mesh.triangles.size() < 4) return false;
  const connectivity net = connect(mesh.triangles, mesh.positions.size());
  return net.closed_manifold() && net.euler == full.euler && net.components == full.components;
}

std::string describe(const attempt& a, std::size_t asked, std::size_t made) {
  const auto& first = attempts.front();
  if (a.smoothing == first.smoothing && a.triangles == first.triangles) return {};
  std::string note = "the coarse mesh has " + std::to_string(made) + " triangles (" + std::to_string(asked) +
                     " asked for), because simpler attempts changed the topology";
  if (a.smoothing > 1.0) note += "; the relief was smoothed more than usual";
  if (a.smoothing < 1.0) note += "; the relief could not be smoothed away first";
  return note;
}

}  // namespace

void round_to_float32(triangle_mesh& mesh) noexcept {
  for (vec3& p : mesh.positions) p = to_float32(p);
}

bool is_unfolded(const triangle_mesh& mesh) {
  std::vector<vec3> normals;
  normals.reserve(mesh.triangles.size());
  for (const index_triangle& t : mesh.triangles) {
    const auto c = corners(mesh.positions, t);
    const double longest = std::max({glm::length(c[1] - c[0]), glm::length(c[2] - c[1]), glm::length(c[0] - c[2])});
    if (!(glm::length(area_normal(c)) > least_height_ratio * longest * longest)) return false;
    normals.push_back(unit_normal(c));
  }
  const connectivity net = connect(mesh.triangles, mesh.positions.size());
  for (std::size_t h = 0; h < net.mate.size(); ++h)
    if (net.mate[h] != no_halfedge && glm::dot(normals[h / 3], normals[net.mate[h] / 3]) < folded_cosine) return false;
  return true;
}

result<simplified_mesh> simplify(const checked_mesh& full, std::size_t triangles, unsigned threads,
                                 stage_monitor& monitor, std::size_t* stuck_at) {
  simplified_mesh out;
  std::size_t fewest_stuck = 0;
  if (full.mesh.triangles.size() <= triangles) {
    out.mesh = full.mesh;
    round_to_float32(out.mesh);
    return out;
  }
  const double passes = static_cast<double>(smoothing_passes(full.mesh.triangles.size(), triangles));
  for (const attempt& a : attempts) {
    triangle_mesh smoothed;
    smoothed.triangles = full.mesh.triangles;
    smoothed.positions =
        smooth(full.mesh, static_cast<std::size_t>(std::lround(a.smoothing * passes)), threads, monitor);
    if (monitor.cancelled()) return error{error_code::cancelled, "the bake was cancelled"};
    const auto target = static_cast<std::size_t>(std::lround(a.triangles * static_cast<double>(triangles)));
    auto reduced = collapse_edges(std::move(smoothed), target, monitor, threads);
    if (!reduced) return error{error_code::cancelled, "the bake was cancelled"};
    out.mesh = std::move(*reduced);
    round_to_float32(out.mesh);
    // An edge collapse stops early where the topology is in its way: then less than asked for has been removed.
    const bool reached = 2 * out.mesh.triangles.size() <= 3 * target;
    if (!reached && (fewest_stuck == 0 || out.mesh.triangles.size() < fewest_stuck))
      fewest_stuck = out.mesh.triangles.size();
    if (!reached || !same_topology(out.mesh, full) || !is_unfolded(out.mesh)) continue;
    out.note = describe(a, triangles, out.mesh.triangles.size());
    return out;
  }
  if (stuck_at != nullptr) *stuck_at = fewest_stuck;
  return error{error_code::bad_mesh, "no sound coarse mesh of " + std::to_string(triangles) +
                                         " triangles could be made (" + std::to_string(full.components) +
                                         " components, Euler characteristic " + std::to_string(full.euler) +
                                         "); ask for more triangles, give a coarse mesh, or close tiny handles"};
}

}  // namespace asperity::bake
