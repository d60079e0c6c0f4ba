#include "bake/rim_shape.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <unordered_map>
#include <unordered_set>

#include "bake/geometry.hpp"

namespace asperity::bake {
namespace {

constexpr double window_in_half_widths = 0.25;  // of the rim, each way: over what normals are averaged
constexpr std::size_t most_in_window = 100;
constexpr std::size_t rim_per_window_vertex = 12;  // a rim of so many edges has at least one in the window each way,
constexpr std::size_t fewest_in_window = 2;        // and of twice as many two: a rim may go up and down at every vertex
constexpr double reach_in_half_widths = 0.5;       // from the rim: how far the surface around is looked at
constexpr int fewest_rings = 3;                    // of triangles, where these are large
constexpr double creased_mean = 0.88;   // length of the mean of unit normals: they are some 30 degrees off it
constexpr double crease_cosine = 0.77;  // 40 degrees: what lies behind a crease says nothing of this side

// What is known at each vertex of the rim, averaged over a window of it.
struct rim_vertex {
  vec3 at{0.0};
  vec3 along{0.0};       // the rim's direction
  vec3 normal{0.0};      // of the surface around
  vec3 middle{0.0};      // of the triangles around, which is where that normal is right
  vec3 patch{0.0};       // normal of the patch
  vec3 inwards{0.0};     // along the surface, into the hole
  bool creased = false;  // the surface around has a crease here that runs into the hole
  double share = 0.0;    // of the rim's length
  double sine = 0.0;     // of the angle between surface and patch; positive where the surface rises over the patch
};

std::size_t least_window(std::size_t edges) { return std::min(fewest_in_window, edges / rim_per_window_vertex); }

// The mean of the member over the rim, as far as the window goes each way.
vec3 mean_of(const std::vector<rim_vertex>& rim, std::size_t i, vec3 rim_vertex::*member, double window) {
  const std::size_t n = rim.size();
  vec3 sum = rim[i].*member;
  std::size_t count = 1;
  for (const std::size_t step : {std::size_t{1}, n - 1}) {
    double gone = 0.0;
    std::size_t at = i;
    for (std::size_t k = 0; k < std::min(most_in_window, (n - 1) / 2); ++k) {
      const std::size_t next = (at + step) % n;
      gone += glm::length(rim[next].at - rim[at].at);
      if (gone > window && k >= least_window(n)) break;
      at = next;
      sum += rim[at].*member;
      ++count;
    }
  }
  return sum / static_cast<double>(count);
}

double length_of(const std::vector<rim_vertex>& rim) {
  double out = 0.0;
  for (std::size_t i = 0; i < rim.size(); ++i) out += glm::length(rim[(i + 1) % rim.size()].at - rim[i].at);
  return out;
}

// What a ragged rim has in its notches lies in the surface around: only triangles that reach farther say where the patch
// goes.
void read_patch(std::vector<rim_vertex>& rim, const triangle_mesh& mesh, std::span<const std::uint32_t> border,
                std::span<const index_triangle> patch, double notch) {
  std::unordered_map<std::uint32_t, std::size_t> place;  // looked up only: its order reaches nothing
  std::vector<double> gone(rim.size(), 0.0);
  for (std::size_t i = 0; i < rim.size(); ++i) {
    place[origin_of(mesh.triangles, border[i])] = i;
    if (i > 0) gone[i] = gone[i - 1] + glm::length(rim[i].at - rim[i - 1].at);
  }
  const double around = length_of(rim);
  for (const index_triangle& t : patch) {
    double reach = 0.0;
    std::size_t edges = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [i, j] = std::minmax({place.at(t[k]), place.at(t[(k + 1) % 3])});
      reach = std::max(reach, std::min(gone[j] - gone[i], around - (gone[j] - gone[i])));
      edges = std::max(edges, std::min(j - i, rim.size() - (j - i)));
    }
    if (reach <= notch || edges <= 2 * least_window(rim.size())) continue;
    for (const std::uint32_t v : t) rim[place.at(v)].patch += area_normal(corners(mesh.positions, t));
  }
}

std::vector<rim_vertex> read_rim(const triangle_mesh& mesh, const connectivity& net,
                                 std::span<const std::uint32_t> border, std::span<const index_triangle> patch,
                                 double area) {
  const std::size_t n = border.size();
  std::vector<rim_vertex> rim(n);
  for (std::size_t i = 0; i < n; ++i) {
    rim[i].at = mesh.positions[origin_of(mesh.triangles, border[i])];
    double weights = 0.0;
    visit_fan(net, border[i], [&](std::uint32_t t, std::uint32_t k) {
      const auto c = corners(mesh.positions, mesh.triangles[t]);
      const double weight = corner_angle(c, k);
      rim[i].normal += weight * unit_normal(c);
      rim[i].middle += weight * (c[0] + c[1] + c[2]) / 3.0;
      weights += weight;
    });
    rim[i].normal /= weights;
    rim[i].middle /= weights;
  }
  for (std::size_t i = 0; i < n; ++i) rim[i].along = rim[(i + 1) % n].at - rim[(i + n - 1) % n].at;
  const double window = window_in_half_widths * 2.0 * area / length_of(rim);
  read_patch(rim, mesh, border, patch, 2.0 * window);
  std::vector<rim_vertex> out(n);
  for (std::size_t i = 0; i < n; ++i) {
    rim_vertex& r = out[i];
    r.at = mean_of(rim, i, &rim_vertex::at, window);
    r.middle = mean_of(rim, i, &rim_vertex::middle, window);
    r.along = normalised(mean_of(rim, i, &rim_vertex::along, window));
    const vec3 normal = mean_of(rim, i, &rim_vertex::normal, window);
    r.creased = glm::length(normal) < creased_mean;
    r.normal = normalised(normal);
    r.patch = normalised(mean_of(rim, i, &rim_vertex::patch, window));
    r.inwards = normalised(glm::cross(r.along, r.normal));
    r.sine = glm::dot(r.inwards, r.patch);
    if (glm::dot(r.normal, r.patch) < 0.0) r.sine = r.sine < 0.0 ? -1.0 : 1.0;
  }
  const double length = length_of(out);
  for (std::size_t i = 0; i < n; ++i) out[i].share = glm::length(out[(i + 1) % n].at - out[i].at) / length;
  return out;
}

}  // namespace

// The normals of the surface around turn towards the hole as one comes nearer to it. How fast is measured, over all
// triangles near the rim, in units of how fast they have to turn for the surface to close over the hole: by the sine of
// the angle at the rim within half the hole's width.
rim_shape shape_of_rim(const triangle_mesh& mesh, const connectivity& net, std::span<const std::uint32_t> border,
                       std::span<const index_triangle> patch) {
  double area = 0.0;
  for (const index_triangle& t : patch) area += 0.5 * glm::length(area_normal(corners(mesh.positions, t)));
  if (!(area > 0.0)) return {1.0, 0.0};
  const std::vector<rim_vertex> rim = read_rim(mesh, net, border, patch, area);
  const double half_width = 2.0 * area / length_of(rim);  // of a circle, its radius

  rim_shape out;
  for (const rim_vertex& r : rim) out.edge_sine += r.share * r.sine * r.sine;
  out.edge_sine = std::sqrt(out.edge_sine);

  struct visited {
    std::uint32_t triangle;
    std::size_t from;
    int ring;
  };
  std::vector<visited> near;
  std::unordered_set<std::uint32_t> seen;  // looked up only: its order reaches nothing
  for (std::size_t i = 0; i < rim.size(); ++i)
    visit_fan(net, border[i], [&](std::uint32_t t, std::uint32_t) {
      const vec3 normal = unit_normal(corners(mesh.positions, mesh.triangles[t]));
      if (glm::dot(normal, rim[i].normal) > crease_cosine && seen.insert(t).second) near.push_back({t, i, 0});
    });
  double turned = 0.0, wanted = 0.0;
  for (std::size_t at = 0; at < near.size(); ++at) {
    const visited here = near[at];
    const auto c = corners(mesh.positions, mesh.triangles[here.triangle]);
    const vec3 normal = unit_normal(c);
    const rim_vertex& r = rim[here.from];
    const vec3 middle = (c[0] + c[1] + c[2]) / 3.0;
    const double weight = glm::length(area_normal(c));
    const double closing = r.sine / half_width * glm::dot(middle - r.middle, r.inwards);
    wanted += weight * closing * closing;
    if (!r.creased) turned += weight * glm::dot(normal, r.inwards) * closing;
    if (here.ring >= fewest_rings && glm::length(middle - r.at) > reach_in_half_widths * half_width) continue;
    for (std::uint32_t h = 3 * here.triangle; h < 3 * here.triangle + 3; ++h) {
      const std::uint32_t g = net.mate[h];
      if (g == no_halfedge) continue;
      if (glm::dot(unit_normal(corners(mesh.positions, mesh.triangles[g / 3])), normal) < crease_cosine) continue;
      if (seen.insert(g / 3).second) near.push_back({g / 3, here.from, here.ring + 1});
    }
  }
  out.curving = wanted > 0.0 ? turned / wanted : 0.0;
  return out;
}

}  // namespace asperity::bake
