// Which way each component faces, by how often the others wind around it; those that nothing can touch are dropped.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "bake/halfedges.hpp"
#include "bake/repair_steps.hpp"
#include "bake/self_crossing.hpp"
#include "bake/stage_monitor.hpp"
#include "bake/triangle_bvh.hpp"
#include "bake/winding.hpp"

namespace asperity::bake {
namespace {

struct component {
  double volume_m3 = 0.0;
  bounds box;
  std::vector<std::uint32_t> triangles;
};

std::vector<component> components_of(const triangle_mesh& mesh, const connectivity& net) {
  std::vector<component> out(net.components);
  const vec3 apex = mesh.positions.front();
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto c = corners(mesh.positions, mesh.triangles[t]);
    component& part = out[net.component[t]];
    if (part.triangles.empty()) part.box = {c[0], c[0]};
    part.triangles.push_back(t);
    part.volume_m3 += glm::dot(c[0] - apex, glm::cross(c[1] - apex, c[2] - apex)) / 6.0;
    for (const vec3& p : c) {
      part.box.low = glm::min(part.box.low, p);
      part.box.high = glm::max(part.box.high, p);
    }
  }
  return out;
}

/// How often each component winds around p, from where a line along an axis leaves and enters it; nothing where the line
/// runs too near to an edge to tell.
std::optional<std::map<std::uint32_t, int>> windings(const triangle_mesh& mesh, const connectivity& net,
                                                     const triangle_bvh& tree, const vec3& p, int axis, double sign) {
  constexpr double far = 1e30;
  constexpr double near_edge = 1e-9;
  std::map<std::uint32_t, int> out;
  bool sure = true;
  vec3 low = p;
  vec3 high = p;
  (sign > 0.0 ? high : low)[axis] = sign * far;
  const int u = (axis + 1) % 3;
  const int v = (axis + 2) % 3;
  tree.visit_box(low, high, [&](std::uint32_t t) {
    const auto c = corners(mesh.positions, mesh.triangles[t]);
    std::array<double, 3> turn{};
    double size = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const vec3 a = c[k] - p;
      const vec3 b = c[(k + 1) % 3] - p;
      turn[k] = a[u] * b[v] - a[v] * b[u];
      size = std::max(size, std::abs(a[u] * b[v]) + std::abs(a[v] * b[u]));
    }
    const double slack = near_edge * size;
    if (std::ranges::any_of(turn, [&](double x) { return x > slack; }) &&
        std::ranges::any_of(turn, [&](double x) { return x < -slack; }))
      return;
    const vec3 n = area_normal(c);
    const double height = glm::dot(n, c[0] - p) / n[axis] * sign;
    if (std::ranges::any_of(turn, [&](double x) { return std::abs(x) <= slack; })) {
      if (!(height < 0.0)) sure = false;
      return;
    }
    if (height > 0.0) out[net.component[t]] += n[axis] * sign > 0.0 ? 1 : -1;
  });
  return sure ? std::optional(out) : std::nullopt;
}

bool within(const bounds& inner, const bounds& outer) noexcept {
  return glm::all(glm::greaterThanEqual(inner.low, outer.low)) && glm::all(glm::lessThanEqual(inner.high, outer.high));
}

}  // namespace

// From the largest to the smallest, so that what may hold a component is known. One that faces outwards belongs where
// nothing winds around it, one that faces inwards (a cavity) where something winds once.
void order_components(triangle_mesh& mesh, const repair_settings& settings, repair_report& report) {
  const connectivity net = connect(mesh.triangles, mesh.positions.size());
  if (net.components < 2) return;
  std::vector<component> parts = components_of(mesh, net);
  double volume = 0.0;
  for (const component& part : parts) volume += part.volume_m3;
  const double sign = volume < 0.0 ? -1.0 : 1.0;  // check turns a mesh that is inside-out as a whole
  std::vector<std::uint32_t> order(parts.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return -std::abs(parts[i].volume_m3); });

  std::vector<std::vector<std::uint32_t>> crosses(parts.size());
  const triangle_bvh tree(mesh.positions, mesh.triangles, settings.threads);
  stage_monitor unwatched;
  const auto crossings = list_self_crossings(mesh, tree, settings.threads, most_listed_crossings, unwatched);
  for (const auto& [a, b] : *crossings) {
    if (net.component[a] == net.component[b]) continue;
    crosses[net.component[a]].push_back(net.component[b]);
    crosses[net.component[b]].push_back(net.component[a]);
  }
  for (auto& c : crosses) std::ranges::sort(c);

  std::vector<int> facing(parts.size(), 0);  // 1 as it is, -1 turned, 0 not there
  std::vector<bool> gone(mesh.triangles.size(), false);
  constexpr double flat = 1e-12;
  const double size = std::pow(bounds_of(mesh.positions).diagonal(), 3);
  std::size_t placed = 0;
  for (const std::uint32_t i : order) {
    const component& part = parts[i];
    // How often what is there winds around this one.
    int around = 0;
    bool could_be_held = false;
    // Only few can be larger than a part and hold its box: all of them are looked at for the first some thousand parts.
    constexpr std::size_t most_compared = 4096;
    for (std::size_t k = 0; k < std::min(placed, most_compared) && !could_be_held; ++k)
      could_be_held = facing[order[k]] != 0 && within(part.box, parts[order[k]].box);
    ++placed;
    if (could_be_held) {
      std::optional<std::map<std::uint32_t, int>> found;
      constexpr std::size_t tries = 12;
      for (std::size_t n = 0; n < tries && !found; ++n) {
        const auto c = corners(mesh.positions, mesh.triangles[part.triangles[n * part.triangles.size() / tries]]);
        found = windings(mesh, net, tree, (c[0] + c[1] + c[2]) / 3.0, static_cast<int>(n % 3), n % 2 == 0 ? 1.0 : -1.0);
      }
      if (!found) {
        facing[i] = 1;
        continue;
      }
      for (const auto& [other, times] : *found)
        if (other != i && facing[other] != 0 && !std::ranges::binary_search(crosses[i], other))
          around += facing[other] * times * (sign > 0.0 ? 1 : -1);
    }
    const bool outwards = part.volume_m3 * sign > 0.0;
    const bool nothing = std::abs(part.volume_m3) <= flat * size && part.volume_m3 == 0.0;
    facing[i] = 1;
    if ((outwards && around >= 1 && crosses[i].empty()) || nothing) {
      if (!settings.drop_inner) continue;
      facing[i] = 0;
      for (const std::uint32_t t : part.triangles) gone[t] = true;
      report.add(repair_kind::inner_component, mesh.positions[mesh.triangles[part.triangles.front()][0]],
                 part.box.diagonal());
    } else if (!outwards && around <= 0) {
      facing[i] = -1;
      for (const std::uint32_t t : part.triangles) turn(mesh, t);
      report.add(repair_kind::turned_inside_out, mesh.positions[mesh.triangles[part.triangles.front()][0]], 0.0);
    }
  }
  if (report[repair_kind::inner_component].count > 0) drop_triangles(mesh, gone);
}

}  // namespace asperity::bake
