#include "bake/stitch.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "bake/halfedges.hpp"
#include "bake/parallel.hpp"
#include "bake/stage_monitor.hpp"

namespace asperity::bake {
namespace {

constexpr int most_sweeps = 60;
constexpr double samples_per_texel = 4.0;
constexpr int least_samples = 32;

struct footprint {
  std::array<std::size_t, 4> texel;
  std::array<double, 4> weight;
};

// The texels that haptic_texture::sample mixes at uv.
footprint footprint_at(const haptic_texture& texture, const vec2& uv) {
  const double x = std::clamp(uv.x * texture.width - 0.5, 0.0, texture.width - 1.0);
  const double y = std::clamp(uv.y * texture.height - 0.5, 0.0, texture.height - 1.0);
  const auto i = static_cast<std::size_t>(x);
  const auto j = static_cast<std::size_t>(y);
  const std::size_t i1 = std::min<std::size_t>(i + 1, texture.width - 1);
  const std::size_t j1 = std::min<std::size_t>(j + 1, texture.height - 1);
  const double fx = x - static_cast<double>(i);
  const double fy = y - static_cast<double>(j);
  const std::size_t w = texture.width;
  return {{j * w + i, j * w + i1, j1 * w + i, j1 * w + i1},
          {(1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy}};
}

// The smallest change of the texels that moves their mix by `way`.
void move(haptic_texture& texture, const footprint& at, const vec3& way) {
  double squares = 0.0;
  for (const double w : at.weight) squares += w * w;
  for (std::size_t k = 0; k < 4; ++k)
    if (at.weight[k] > 0.0)
      texture.texels[at.texel[k]] = glm::vec3(vec3(texture.texels[at.texel[k]]) + at.weight[k] / squares * way);
}

struct seam {
  std::array<vec2, 2> here;   // texture coordinates of its ends in one triangle,
  std::array<vec2, 2> there;  // and in the other
  int samples;

  [[nodiscard]] static vec2 along(const std::array<vec2, 2>& ends, double s) {
    return (1.0 - s) * ends[0] + s * ends[1];
  }

  // Never false where a lookup along one seam reads a texel that one along the other reads.
  [[nodiscard]] bool shares_texels(const seam& other, const haptic_texture& texture) const {
    const vec2 reach = 3.0 / vec2(texture.width, texture.height);  // two texels of each lookup, and one to be safe
    for (const auto* a : {&here, &there})
      for (const auto* b : {&other.here, &other.there})
        if (glm::all(glm::lessThanEqual(glm::min((*a)[0], (*a)[1]) - reach, glm::max((*b)[0], (*b)[1]))) &&
            glm::all(glm::lessThanEqual(glm::min((*b)[0], (*b)[1]) - reach, glm::max((*a)[0], (*a)[1]))))
          return true;
    return false;
  }

  [[nodiscard]] double gap(const haptic_texture& texture) const {
    double largest = 0.0;
    for (int i = 0; i <= samples; ++i) {
      const double s = static_cast<double>(i) / samples;
      largest = std::max(largest, glm::length(texture.sample(along(here, s)) - texture.sample(along(there, s))));
    }
    return largest;
  }

  // Both sides go to the original's point nearest to their middle: a middle between two walls lies on neither.
  void close(const triangle_bvh& full, haptic_texture& texture) const {
    for (int i = 0; i <= samples; ++i) {
      const double s = static_cast<double>(i) / samples;
      const vec2 a = along(here, s);
      const vec2 b = along(there, s);
      const vec3 p = texture.sample(a);
      const vec3 q = texture.sample(b);
      const vec3 meet = full.closest(0.5 * (p + q)).point;
      move(texture, footprint_at(texture, a), meet - p);
      move(texture, footprint_at(texture, b), meet - q);
    }
  }
};

}  // namespace

std::size_t stitch(const coarse_mesh& coarse, const triangle_bvh& full, double limit_m, haptic_texture& texture,
                   unsigned threads, stage_monitor* monitor) {
  std::vector<index_triangle> triangles;
  for (const coarse_triangle& t : coarse.triangles) triangles.push_back(t.vertex);
  const connectivity net = connect(triangles, coarse.positions.size());
  const vec2 side{texture.width, texture.height};
  std::vector<seam> seams;
  for (std::uint32_t h = 0; h < net.mate.size(); ++h) {
    const std::uint32_t mate = net.mate[h];
    if (mate == no_halfedge || mate < h) continue;
    const auto& a = coarse.triangles[h / 3].uv;
    const auto& b = coarse.triangles[mate / 3].uv;
    seam s{{a[h % 3], a[next_halfedge(h) % 3]}, {b[next_halfedge(mate) % 3], b[mate % 3]}, 0};
    s.samples = std::max(least_samples,
                         static_cast<int>(std::ceil(samples_per_texel * glm::length(side * (s.here[1] - s.here[0])))));
    seams.push_back(s);
  }
  // Closing a seam moves texels that its neighbours use at their ends: those may open, and are then closed in turn.
  // Only they are looked at again: most seams share no texel with one that is closed.
  std::vector<double> gap(seams.size());
  stage_monitor no_one;
  stage_monitor& report = monitor != nullptr ? *monitor : no_one;
  const auto look = [&](std::size_t i) { gap[i] = seams[i].gap(texture); };
  if (!parallel_tasks(seams.size(), threads, report, report.done(), report.done(), look)) return 0;
  std::vector<bool> stale(seams.size(), false);
  std::vector<bool> touched(seams.size(), false);
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    bool open = false;
    for (std::size_t i = 0; i < seams.size(); ++i) {
      if (!report.ask()) return 0;
      if (stale[i]) look(i);
      stale[i] = false;
      if (gap[i] <= limit_m) continue;
      open = touched[i] = true;
      seams[i].close(full, texture);
      for (std::size_t j = 0; j < seams.size(); ++j) stale[j] = stale[j] || seams[i].shares_texels(seams[j], texture);
    }
    if (!open) break;
  }
  return static_cast<std::size_t>(std::count(touched.begin(), touched.end(), true));
}

}  // namespace asperity::bake
