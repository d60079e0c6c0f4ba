#include "bake/measure.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "bake/geometry.hpp"
#include "bake/halfedges.hpp"
#include "bake/parallel.hpp"

namespace asperity::bake {
namespace {

// The textured surface as triangles, with the area that each vertex stands for.
struct sampled_surface {
  triangle_mesh mesh;
  std::vector<double> area;
};

struct row {
  std::uint32_t first;
  std::uint32_t segments;
};

// Triangles between two rows of points over the same directions, the longer row below.
void stitch(const row& below, const row& above, std::vector<index_triangle>& out) {
  std::uint32_t i = 0;
  std::uint32_t j = 0;
  while (i < below.segments || j < above.segments) {
    const bool step_below =
        j == above.segments || (i < below.segments && (2 * i + 1) * above.segments <= (2 * j + 1) * below.segments);
    if (step_below) {
      out.push_back({below.first + i, below.first + i + 1, above.first + j});
      ++i;
    } else {
      out.push_back({below.first + i, above.first + j + 1, above.first + j});
      ++j;
    }
  }
}

// Rows parallel to the triangle's longest edge, about one texel apart, so that slivers do not get more than their
// share.
void sample_triangle(const coarse_triangle& t, const haptic_texture& texture, sampled_surface& out) {
  const vec2 side{texture.width, texture.height};
  std::array<double, 3> edge{};
  for (std::size_t k = 0; k < 3; ++k) edge[k] = glm::length(side * (t.uv[(k + 1) % 3] - t.uv[k]));
  const auto base = static_cast<std::size_t>(std::max_element(edge.begin(), edge.end()) - edge.begin());
  const vec2 a = t.uv[base];
  const vec2 b = t.uv[(base + 1) % 3];
  const vec2 apex = t.uv[(base + 2) % 3];
  const vec2 along = side * (b - a);
  const vec2 up = side * (apex - a);
  const double height = std::abs(along.x * up.y - along.y * up.x) / edge[base];
  const auto rows = static_cast<std::uint32_t>(std::max(1.0, std::ceil(height)));
  row below{};
  for (std::uint32_t j = 0; j <= rows; ++j) {
    const double s = static_cast<double>(j) / rows;
    const row here{static_cast<std::uint32_t>(out.mesh.positions.size()),
                   j == rows ? 0U : static_cast<std::uint32_t>(std::max(1.0, std::ceil((1.0 - s) * edge[base])))};
    for (std::uint32_t i = 0; i <= here.segments; ++i) {
      const double r = here.segments == 0 ? 0.0 : static_cast<double>(i) / here.segments;
      out.mesh.positions.push_back(texture.sample((1.0 - s) * ((1.0 - r) * a + r * b) + s * apex));
    }
    if (j > 0) stitch(below, here, out.mesh.triangles);
    below = here;
  }
}

std::vector<double> vertex_areas(const triangle_mesh& mesh) {
  std::vector<double> area(mesh.positions.size(), 0.0);
  for (const index_triangle& t : mesh.triangles) {
    const double third = glm::length(area_normal(corners(mesh.positions, t))) / 6.0;
    for (const std::uint32_t v : t) area[v] += third;
  }
  return area;
}

sampled_surface sample_surface(const coarse_mesh& coarse, const haptic_texture& texture) {
  sampled_surface out;
  for (const coarse_triangle& t : coarse.triangles) sample_triangle(t, texture, out);
  out.area = vertex_areas(out.mesh);
  return out;
}

struct distance_sum {
  double weighted_squares = 0.0;
  double weight = 0.0;
  double largest = 0.0;
};

// @return false where the bake was cancelled
bool measure_one_way(const std::vector<vec3>& from, const std::vector<double>& weight, const triangle_bvh& to,
                     unsigned threads, stage_monitor& monitor, double start, double& rms, double& largest) {
  std::vector<distance_sum> of_block(block_count(from.size()));
  const auto visit = [&](std::size_t block, std::size_t begin, std::size_t end) {
    distance_sum& sum = of_block[block];
    for (std::size_t i = begin; i < end; ++i) {
      const double d = to.closest(from[i]).distance_m;
      sum.weighted_squares += weight[i] * d * d;
      sum.weight += weight[i];
      sum.largest = std::max(sum.largest, d);
    }
  };
  if (!parallel_blocks(from.size(), threads, monitor, start, start + 0.5, visit)) return false;
  distance_sum all;
  for (const distance_sum& s : of_block) {
    all.weighted_squares += s.weighted_squares;
    all.weight += s.weight;
    all.largest = std::max(all.largest, s.largest);
  }
  rms = all.weight > 0.0 ? std::sqrt(all.weighted_squares / all.weight) : 0.0;
  largest = all.largest;
  return true;
}

// The two triangles at an edge look it up in two places of the texture; the answers should be the same.
double largest_crack(const coarse_mesh& coarse, const haptic_texture& texture) {
  constexpr int samples = 32;
  std::vector<index_triangle> triangles;
  for (const coarse_triangle& t : coarse.triangles) triangles.push_back(t.vertex);
  const connectivity net = connect(triangles, coarse.positions.size());
  double largest = 0.0;
  for (std::uint32_t h = 0; h < net.mate.size(); ++h) {
    const std::uint32_t mate = net.mate[h];
    if (mate == no_halfedge || mate < h) continue;
    const auto& here = coarse.triangles[h / 3].uv;
    const auto& there = coarse.triangles[mate / 3].uv;
    for (int i = 0; i <= samples; ++i) {
      const double s = static_cast<double>(i) / samples;
      const vec3 p = texture.sample((1.0 - s) * here[h % 3] + s * here[next_halfedge(h) % 3]);
      const vec3 q = texture.sample((1.0 - s) * there[next_halfedge(mate) % 3] + s * there[mate % 3]);
      largest = std::max(largest, glm::length(p - q));
    }
  }
  return largest;
}

}  // namespace

double surface_error::rms_m() const noexcept {
  return std::sqrt(0.5 * (to_original_rms_m * to_original_rms_m + to_textured_rms_m * to_textured_rms_m));
}

double surface_error::max_m() const noexcept { return std::max(to_original_max_m, to_textured_max_m); }

result<surface_error> measure(const triangle_mesh& full, const triangle_bvh& full_tree, const coarse_mesh& coarse,
                              const haptic_texture& texture, unsigned threads, stage_monitor& monitor) {
  const sampled_surface textured = sample_surface(coarse, texture);
  const triangle_bvh textured_tree(textured.mesh.positions, textured.mesh.triangles);
  surface_error out;
  const bool done = measure_one_way(textured.mesh.positions, textured.area, full_tree, threads, monitor, 0.0,
                                    out.to_original_rms_m, out.to_original_max_m) &&
                    measure_one_way(full.positions, vertex_areas(full), textured_tree, threads, monitor, 0.5,
                                    out.to_textured_rms_m, out.to_textured_max_m);
  if (!done) return error{error_code::cancelled, "the bake was cancelled"};
  out.crack_max_m = largest_crack(coarse, texture);
  return out;
}

}  // namespace asperity::bake
