#include "bake/refine.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "bake/geometry.hpp"

namespace asperity::bake {
namespace {

using barycentrics = std::array<std::array<float, 3>, 3>;

std::array<float, 3> middle(const std::array<float, 3>& a, const std::array<float, 3>& b) noexcept {
  return {0.5F * (a[0] + b[0]), 0.5F * (a[1] + b[1]), 0.5F * (a[2] + b[2])};
}

// One round: every edge longer than edge_m gets a vertex in its middle, every triangle is cut along its new vertices.
class refinement_round {
 public:
  refinement_round(refined_mesh& mesh, double edge_m) : mesh_(mesh), edge2_(edge_m * edge_m) {}

  // @return false where no edge was too long
  bool run(const std::function<bool()>& keep_going) {
    const std::size_t before = mesh_.triangles.size();
    refined_mesh next;
    for (std::size_t t = 0; t < before; ++t) {
      if (t % 4096 == 0 && keep_going && !keep_going()) return false;
      cut(t, next);
    }
    const bool any = next.triangles.size() > before;
    mesh_.triangles = std::move(next.triangles);
    mesh_.source = std::move(next.source);
    mesh_.barycentric = std::move(next.barycentric);
    return any;
  }

 private:
  bool is_long(std::uint32_t a, std::uint32_t b) const {
    const vec3 d = mesh_.positions[a] - mesh_.positions[b];
    return glm::dot(d, d) > edge2_;
  }

  std::uint32_t middle_of(std::uint32_t a, std::uint32_t b) {
    if (a > b) std::swap(a, b);
    const auto [entry, added] =
        middles_.try_emplace(std::uint64_t{a} << 32 | b, static_cast<std::uint32_t>(mesh_.positions.size()));
    if (added) {
      mesh_.positions.push_back(0.5 * (mesh_.positions[a] + mesh_.positions[b]));
      mesh_.parents.push_back({a, b});
    }
    return entry->second;
  }

  void cut(std::size_t t, refined_mesh& next) {
    // Corners 0 to 2, then the middles of the edges that begin there.
    std::array<std::uint32_t, 6> v{};
    std::array<std::array<float, 3>, 6> b{};
    std::array<bool, 3> split{};
    std::size_t splits = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      v[k] = mesh_.triangles[t][k];
      b[k] = mesh_.barycentric[t][k];
      split[k] = is_long(mesh_.triangles[t][k], mesh_.triangles[t][(k + 1) % 3]);
      splits += split[k] ? 1U : 0U;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      if (!split[k]) continue;
      v[3 + k] = middle_of(v[k], v[(k + 1) % 3]);
      b[3 + k] = middle(b[k], b[(k + 1) % 3]);
    }
    const auto add = [&](std::size_t i, std::size_t j, std::size_t k) {
      next.triangles.push_back({v[i], v[j], v[k]});
      next.source.push_back(mesh_.source[t]);
      next.barycentric.push_back({b[i], b[j], b[k]});
    };
    if (splits == 0) add(0, 1, 2);
    if (splits == 3) {
      for (std::size_t k = 0; k < 3; ++k) add(k, 3 + k, 3 + (k + 2) % 3);
      add(3, 4, 5);
    }
    for (std::size_t k = 0; k < 3 && (splits == 1 || splits == 2); ++k) {
      const std::size_t k1 = (k + 1) % 3, k2 = (k + 2) % 3;
      if (splits == 1 && split[k]) {
        add(k, 3 + k, k2);
        add(3 + k, k1, k2);
      }
      if (splits == 2 && !split[k]) {  // the corner opposite is cut off, the rest along its shorter diagonal
        add(3 + k1, k2, 3 + k2);
        const auto length = [&](std::size_t i, std::size_t j) {
          return glm::length(mesh_.positions[v[i]] - mesh_.positions[v[j]]);
        };
        if (length(k, 3 + k1) <= length(k1, 3 + k2)) {
          add(k, k1, 3 + k1);
          add(k, 3 + k1, 3 + k2);
        } else {
          add(k, k1, 3 + k2);
          add(k1, 3 + k1, 3 + k2);
        }
      }
    }
  }

  refined_mesh& mesh_;
  double edge2_;
  std::unordered_map<std::uint64_t, std::uint32_t> middles_;  // looked up only: its order reaches nothing
};

}  // namespace

refined_mesh refine(const triangle_mesh& mesh, double edge_m, std::size_t most,
                    const std::function<bool()>& keep_going) {
  double area = 0.0;
  for (const index_triangle& t : mesh.triangles) area += 0.5 * glm::length(area_normal(corners(mesh.positions, t)));
  // Halving leaves edges of 0.5 to 1 times edge_m; triangles of about a fifth of its square, the narrow ones of a mesh
  // a good deal less.
  const double room = static_cast<double>(most) - 4.0 * static_cast<double>(mesh.triangles.size());
  edge_m = std::max(edge_m, std::sqrt(area / (0.15 * std::max(room, 1.0))));

  refined_mesh out;
  out.positions = mesh.positions;
  out.triangles = mesh.triangles;
  out.source.resize(mesh.triangles.size());
  for (std::size_t t = 0; t < out.source.size(); ++t) out.source[t] = static_cast<std::uint32_t>(t);
  out.barycentric.assign(mesh.triangles.size(), barycentrics{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}});
  while (out.triangles.size() < most && refinement_round(out, edge_m).run(keep_going)) {
  }
  for (const index_triangle& t : out.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      out.longest_edge_m =
          std::max(out.longest_edge_m, glm::length(out.positions[t[(k + 1) % 3]] - out.positions[t[k]]));
  return out;
}

}  // namespace asperity::bake
