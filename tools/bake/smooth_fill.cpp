#include "bake/smooth_fill.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>

#include "bake/geometry.hpp"
#include "bake/hole_patch.hpp"
#include "bake/rim_shape.hpp"
#include "bake/self_crossing.hpp"
#include "bake/stage_monitor.hpp"
#include "bake/triangle_bvh.hpp"

namespace asperity::bake {
namespace {

constexpr std::size_t fewest_rim_edges = 4;
constexpr std::size_t most_rim_edges = 5000;
constexpr std::size_t most_added = 3000;  // vertices to a patch: each takes the square of their number to fair
constexpr std::size_t most_added_in_all = 60'000;
constexpr double least_edge_sine = 0.01;    // below, the smooth patch would be the flat one
constexpr double largest_edge_sine = 0.95;  // a surface that stands on its hole ends there
constexpr double least_curving = 0.5;
constexpr double largest_curving = 2.0;     // beyond, what curves is a lip, narrower than the hole
constexpr double largest_area_ratio = 2.5;  // to the flat patch
constexpr double folded_cosine = 0.0;       // between neighbouring triangles
constexpr int fairings = 3;                 // each with the weights of the patch before
constexpr int most_crossing_rounds = 4;

struct rim_of_hole {
  hole_patch patch;
  patch_surroundings around;
  std::vector<std::uint32_t> vertices;                         // of the mesh
  std::vector<std::pair<std::uint32_t, std::uint32_t>> taken;  // edges between them, outside of the patch
};

// The hole with its flat patch and the triangles at its rim, apart from the mesh.
rim_of_hole cut_out(const triangle_mesh& mesh, const connectivity& net, const closed_hole& hole,
                    std::span<const index_triangle> flat) {
  rim_of_hole out;
  std::unordered_map<std::uint32_t, std::uint32_t> number;  // looked up only: its order reaches nothing
  for (const std::uint32_t h : hole.border) {
    const std::uint32_t v = origin_of(mesh.triangles, h);
    number.emplace(v, static_cast<std::uint32_t>(out.vertices.size()));
    out.vertices.push_back(v);
    out.patch.positions.push_back(mesh.positions[v]);
  }
  out.patch.rim = out.vertices.size();
  std::vector<std::uint32_t> near;
  for (const std::uint32_t open : hole.border)
    visit_fan(net, open, [&](std::uint32_t t, std::uint32_t) { near.push_back(t); });
  std::ranges::sort(near);
  near.erase(std::unique(near.begin(), near.end()), near.end());
  out.patch.spacing_m.assign(out.patch.rim, 0.0);
  std::vector<std::size_t> edges(out.patch.rim, 0);
  for (const std::uint32_t t : near) {
    index_triangle local{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[t][k];
      const auto [entry, added] =
          number.try_emplace(v, static_cast<std::uint32_t>(out.patch.rim + out.around.positions.size()));
      if (added) out.around.positions.push_back(mesh.positions[v]);
      local[k] = entry->second;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = local[k], b = local[(k + 1) % 3];
      const double length =
          glm::length(mesh.positions[mesh.triangles[t][k]] - mesh.positions[mesh.triangles[t][(k + 1) % 3]]);
      for (const std::uint32_t v : {a, b}) {
        if (v >= out.patch.rim) continue;
        out.patch.spacing_m[v] += length;
        ++edges[v];
      }
      if (a < out.patch.rim && b < out.patch.rim) out.taken.emplace_back(std::min(a, b), std::max(a, b));
    }
    out.around.triangles.push_back(local);
  }
  for (std::size_t i = 0; i < edges.size(); ++i) out.patch.spacing_m[i] /= static_cast<double>(edges[i]);
  for (const index_triangle& t : flat)
    out.patch.triangles.push_back({number.at(t[0]), number.at(t[1]), number.at(t[2])});
  return out;
}

double area_of(const hole_patch& patch) {
  double sum = 0.0;
  for (const index_triangle& t : patch.triangles) sum += 0.5 * glm::length(area_normal(corners(patch.positions, t)));
  return sum;
}

// No triangle without area and none folded back, within the patch and across the rim.
bool is_even(const rim_of_hole& hole, double reach) {
  triangle_mesh all{hole.patch.positions, hole.patch.triangles, {}};
  all.positions.insert(all.positions.end(), hole.around.positions.begin(), hole.around.positions.end());
  const auto shift = static_cast<std::uint32_t>(hole.patch.positions.size() - hole.patch.rim);
  for (index_triangle t : hole.around.triangles) {
    for (std::uint32_t& v : t) v += v < hole.patch.rim ? 0U : shift;
    all.triangles.push_back(t);
  }
  const connectivity net = connect(all.triangles, all.positions.size());
  if (net.non_manifold_edges.count + net.misoriented_edges.count > 0) return false;
  for (std::size_t t = 0; t < hole.patch.triangles.size(); ++t) {
    const auto c = corners(all.positions, all.triangles[t]);
    if (has_no_area(c, reach)) return false;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t g = net.mate[3 * t + k];
      if (g == no_halfedge) return false;
      if (glm::dot(unit_normal(c), unit_normal(corners(all.positions, all.triangles[g / 3]))) < folded_cosine)
        return false;
    }
  }
  return true;
}

std::optional<rim_of_hole> make_smooth(const triangle_mesh& mesh, const connectivity& net, const closed_hole& hole,
                                       std::span<const index_triangle> flat, std::size_t most, double reach) {
  if (hole.border.size() < fewest_rim_edges || hole.border.size() > most_rim_edges || most == 0) return std::nullopt;
  const rim_shape shape = shape_of_rim(mesh, net, hole.border, flat);
  if (shape.edge_sine < least_edge_sine || shape.edge_sine > largest_edge_sine) return std::nullopt;
  if (shape.curving < least_curving || shape.curving > largest_curving) return std::nullopt;
  rim_of_hole out = cut_out(mesh, net, hole, flat);
  for (int i = 0; i < fairings; ++i) {
    refine_patch(out.patch, out.taken, most);
    if (out.patch.positions.size() == out.patch.rim || !fair_patch(out.patch, out.around)) return std::nullopt;
  }
  if (area_of(out.patch) > largest_area_ratio * hole.area_m2 || !is_even(out, reach)) return std::nullopt;
  return out;
}

struct exchange {
  std::size_t hole;
  rim_of_hole made;
};

// The patches in their order, those that are exchanged with their own vertices. `owner` tells of each triangle from the
// first patch on whose it is, if of a smooth one.
triangle_mesh assemble(const triangle_mesh& mesh, std::size_t kept, const std::vector<closed_hole>& holes,
                       const std::vector<exchange>& exchanges, std::vector<std::uint32_t>& owner) {
  triangle_mesh out{
      mesh.positions, {mesh.triangles.begin(), mesh.triangles.begin() + static_cast<std::ptrdiff_t>(kept)}, {}};
  owner.clear();
  std::size_t from = kept;
  auto next = exchanges.begin();
  for (std::size_t i = 0; i < holes.size(); ++i) {
    if (next == exchanges.end() || next->hole != i) {
      const auto first = mesh.triangles.begin() + static_cast<std::ptrdiff_t>(from);
      out.triangles.insert(out.triangles.end(), first, first + static_cast<std::ptrdiff_t>(holes[i].triangles));
      owner.resize(out.triangles.size() - kept, no_halfedge);
    } else {
      const rim_of_hole& made = next->made;
      const auto shift = static_cast<std::uint32_t>(out.positions.size() - made.patch.rim);
      out.positions.insert(out.positions.end(),
                           made.patch.positions.begin() + static_cast<std::ptrdiff_t>(made.patch.rim),
                           made.patch.positions.end());
      for (index_triangle t : made.patch.triangles) {
        for (std::uint32_t& v : t) v = v < made.patch.rim ? made.vertices[v] : v + shift;
        out.triangles.push_back(t);
      }
      owner.resize(out.triangles.size() - kept, static_cast<std::uint32_t>(i));
      ++next;
    }
    from += holes[i].triangles;
  }
  return out;
}

}  // namespace

void smooth_patches(triangle_mesh& mesh, const connectivity& net, std::vector<closed_hole>& holes,
                    const smoothing_limits& limits) {
  const std::size_t kept = net.mate.size() / 3;
  double whole = 0.0, reach = 0.0, made_up = limits.made_up_m2;
  for (const index_triangle& t : mesh.triangles) whole += 0.5 * glm::length(area_normal(corners(mesh.positions, t)));
  for (const vec3& p : mesh.positions) reach = std::max({reach, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  for (const closed_hole& hole : holes) made_up += hole.area_m2;

  std::vector<exchange> exchanges;
  std::size_t from = kept, room = most_added_in_all;
  for (std::size_t i = 0; i < holes.size(); ++i) {
    const std::span<const index_triangle> flat(mesh.triangles.data() + from, holes[i].triangles);
    from += holes[i].triangles;
    auto made = make_smooth(mesh, net, holes[i], flat, std::min(most_added, room), reach);
    if (!made) continue;
    const double more = area_of(made->patch) - holes[i].area_m2;
    if (more > 0.0 && made_up + more > limits.largest_share * (whole + more)) continue;
    made_up += more;
    whole += more;
    room -= std::min(room, made->patch.positions.size() - made->patch.rim);
    exchanges.push_back({i, std::move(*made)});
  }

  // What crosses anything goes back to its flat patch, which may cross another one.
  for (int round = 0; !exchanges.empty(); ++round) {
    std::vector<std::uint32_t> owner;
    triangle_mesh next = assemble(mesh, kept, holes, exchanges, owner);
    const triangle_bvh tree(next.positions, next.triangles, limits.threads);
    stage_monitor unwatched;
    const auto pairs = list_crossings_from(next, tree, kept, limits.threads, most_listed_crossings, unwatched);
    std::vector<bool> crosses(holes.size(), false);
    bool any = false;
    for (const auto& pair : *pairs)
      for (const std::uint32_t t : {pair.first, pair.second}) {
        if (t < kept || owner[t - kept] == no_halfedge) continue;
        crosses[owner[t - kept]] = any = true;
      }
    if (!any) {
      for (const exchange& e : exchanges) {
        holes[e.hole].smooth = true;
        holes[e.hole].triangles = e.made.patch.triangles.size();
        holes[e.hole].area_m2 = area_of(e.made.patch);
      }
      mesh.positions = std::move(next.positions);
      mesh.triangles = std::move(next.triangles);
      return;
    }
    std::erase_if(exchanges, [&](const exchange& e) { return round >= most_crossing_rounds || crosses[e.hole]; });
  }
}

}  // namespace asperity::bake
