#include "bake/winding.hpp"

#include <algorithm>
#include <iterator>
#include <span>
#include <vector>

#include "bake/halfedges.hpp"

namespace asperity::bake {
namespace {

// For each halfedge the one other halfedge on its edge, whichever way that runs.
std::vector<std::uint32_t> pair_across_edges(std::span<const index_triangle> triangles) {
  struct entry {
    std::uint32_t low, high, halfedge;
    [[nodiscard]] bool same_edge(const entry& other) const { return low == other.low && high == other.high; }
  };
  std::vector<entry> entries(3 * triangles.size());
  for (std::uint32_t h = 0; h < entries.size(); ++h) {
    const auto [low, high] = std::minmax({origin_of(triangles, h), origin_of(triangles, next_halfedge(h))});
    entries[h] = {low, high, h};
  }
  std::ranges::sort(entries, [](const entry& a, const entry& b) {
    return std::pair(std::pair(a.low, a.high), a.halfedge) < std::pair(std::pair(b.low, b.high), b.halfedge);
  });
  std::vector<std::uint32_t> across(entries.size(), no_halfedge);
  for (std::size_t i = 0, j = 0; i < entries.size(); i = j) {
    while (j < entries.size() && entries[j].same_edge(entries[i])) ++j;
    if (j - i != 2) continue;
    across[entries[i].halfedge] = entries[i + 1].halfedge;
    across[entries[i + 1].halfedge] = entries[i].halfedge;
  }
  return across;
}

enum class side : unsigned char { unseen, kept, turned };

// Spreads over the surface that `seed` belongs to. @return its triangles, empty where it has one side only
std::vector<std::uint32_t> spread(std::uint32_t seed, std::span<const index_triangle> triangles,
                                  const std::vector<std::uint32_t>& across, std::vector<side>& sides) {
  std::vector<std::uint32_t> surface{seed};
  sides[seed] = side::kept;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const std::uint32_t t = surface[i];
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      const std::uint32_t g = across[h];
      if (g == no_halfedge) continue;
      const bool against = origin_of(triangles, h) == origin_of(triangles, g);
      const side wanted = against == (sides[t] == side::kept) ? side::turned : side::kept;
      if (sides[g / 3] == side::unseen) {
        sides[g / 3] = wanted;
        surface.push_back(g / 3);
      } else if (sides[g / 3] != wanted) {
        return {};
      }
    }
  }
  return surface;
}

}  // namespace

std::optional<std::size_t> make_winding_consistent(triangle_mesh& mesh) {
  const std::span<const index_triangle> triangles = mesh.triangles;
  const std::vector<std::uint32_t> across = pair_across_edges(triangles);
  std::vector<side> sides(triangles.size(), side::unseen);
  std::vector<std::uint32_t> to_turn;
  for (std::uint32_t seed = 0; seed < triangles.size(); ++seed) {
    if (sides[seed] != side::unseen) continue;
    const std::vector<std::uint32_t> surface = spread(seed, triangles, across, sides);
    if (surface.empty()) return std::nullopt;
    const auto turned = std::ranges::count_if(surface, [&](std::uint32_t t) { return sides[t] == side::turned; });
    const side fewer = 2 * static_cast<std::size_t>(turned) <= surface.size() ? side::turned : side::kept;
    std::ranges::copy_if(surface, std::back_inserter(to_turn), [&](std::uint32_t t) { return sides[t] == fewer; });
  }
  for (const std::uint32_t t : to_turn) turn(mesh, t);
  return to_turn.size();
}

}  // namespace asperity::bake
