// Heights from the slopes of a normal map.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "asperity/bake/map_relief.hpp"
#include "bake/check.hpp"
#include "bake/geometry.hpp"
#include "bake/map_lookup.hpp"
#include "bake/refine.hpp"
#include "bake/slope_solver.hpp"
#include "bake/triangle_bvh.hpp"

namespace asperity::bake {
namespace {

constexpr std::size_t most_triangles_solved = 1'000'000;
constexpr double steepest_slope = 10.0;       // about 84 degrees: what lies beyond is no height field
constexpr double most_backward_pixels = 0.1;  // share of pixels that face inwards: then the map is of another kind

error bad_normal_map(std::string what) { return {error_code::bad_texture, "the normal map " + std::move(what)}; }

// Red and green of flat are 127.5 of 255: 8 bits cannot say that, and programs write 127 or 128 for it.
double centred(float sample, std::uint32_t bits) noexcept {
  const double c = 2.0 * static_cast<double>(sample) - 1.0;
  return bits == 8 && std::abs(c) < 1.5 / 255.0 ? 0.0 : c;
}

// Slopes along increasing u (x) and along decreasing v (y) of every pixel.
result<map_lookup<vec2>> slopes_of(const map_image& map, const normal_map_settings& settings) {
  const std::size_t pixels = std::size_t{map.width} * map.height;
  if (map.channels != 3 || pixels == 0 || map.samples.size() != 3 * pixels)
    return bad_normal_map("is grey: a tangent-space normal map has three channels; for heights use --height-map");
  map_lookup<vec2> out{map.width, map.height, settings.wrap_u, settings.wrap_v, std::vector<vec2>(pixels)};
  // Floating-point maps hold the vector itself, or, where none of their numbers is negative, the usual encoding of it.
  const bool vectors =
      map.bits == 0 && std::any_of(map.samples.begin(), map.samples.end(), [](float x) { return x < 0.0F; });
  std::size_t backward = 0;
  for (std::size_t i = 0; i < pixels; ++i) {
    if (i % 65536 == 0 && settings.keep_going && !settings.keep_going()) return cancelled_map();
    const float* at = &map.samples[3 * i];
    vec3 n{centred(at[0], map.bits), centred(at[1], map.bits), 2.0 * static_cast<double>(at[2]) - 1.0};
    if (vectors) n = {at[0], at[1], at[2]};
    if (!is_finite(n)) return bad_normal_map("has a sample that is not finite; export it again");
    if (settings.green_is_down) n.y = -n.y;
    if (!(n.z > 0.0)) ++backward;
    const double z = std::max(n.z, 1e-3);
    const vec2 slope = -settings.scale * vec2(n.x, n.y) / z;
    const double steepness = glm::length(slope);
    out.pixels[i] = steepness > steepest_slope ? slope * (steepest_slope / steepness) : slope;
  }
  if (static_cast<double>(backward) > most_backward_pixels * static_cast<double>(pixels))
    return bad_normal_map("faces inwards in " + std::to_string(100 * backward / pixels) +
                          " % of its pixels, so it is no tangent-space map; export it in tangent space");
  return out;
}

// Directions of the map's slopes in the plane of a triangle.
struct tangent_frame {
  vec3 along_u{0.0};  // unit
  vec3 up{0.0};       // unit, at right angles, to the side of decreasing v
};

tangent_frame frame_of(const std::array<vec3, 3>& c, const std::array<vec2, 3>& uv) noexcept {
  const vec2 a = uv[1] - uv[0];
  const vec2 b = uv[2] - uv[0];
  const double det = a.x * b.y - a.y * b.x;
  if (!(std::abs(det) > 0.0)) return {};
  const vec3 per_u = (b.y * (c[1] - c[0]) - a.y * (c[2] - c[0])) / det;
  tangent_frame out;
  out.along_u = normalised(per_u);
  // u to the right and v downwards, seen from outside, is a map that is not mirrored: its det is negative.
  out.up = (det < 0.0 ? 1.0 : -1.0) * glm::cross(unit_normal(c), out.along_u);
  return out;
}

struct solved_surface {
  std::vector<vec3> positions;
  std::vector<index_triangle> triangles;
  std::vector<double> heights_m;  // per position
  triangle_bvh tree;              // looks at positions: it has to stay where they are

  solved_surface(const refined_mesh& fine, std::vector<double> heights)
      : positions(fine.positions),
        triangles(fine.triangles),
        heights_m(std::move(heights)),
        tree(positions, triangles) {}
  solved_surface(const solved_surface&) = delete;
  solved_surface& operator=(const solved_surface&) = delete;
};

double height_at(const solved_surface& s, const vec3& p) {
  const auto nearest = s.tree.closest(p);
  const index_triangle& t = s.triangles[nearest.triangle];
  const auto c = corners(s.positions, t);
  const vec3 up = area_normal(c);
  const double whole = glm::dot(up, up);
  const double b1 = glm::dot(up, glm::cross(nearest.point - c[0], c[2] - c[0])) / whole;
  const double b2 = glm::dot(up, glm::cross(c[1] - c[0], nearest.point - c[0])) / whole;
  const double first = s.heights_m[t[0]];
  return first + b1 * (s.heights_m[t[1]] - first) + b2 * (s.heights_m[t[2]] - first);
}

}  // namespace

result<normal_map_relief> integrate_normal_map(const triangle_mesh& given, const map_image& map,
                                               const normal_map_settings& settings) {
  if (given.uvs.size() != given.triangles.size() || given.triangles.empty())
    return error{error_code::bad_mesh,
                 "the mesh has no texture coordinates, so a map cannot be laid on it; export it with its UVs (OBJ, "
                 "glTF)"};
  if (!std::isfinite(settings.scale))
    return error{error_code::invalid_argument, "the scale of a normal map has to be a finite number"};
  const auto sound = check(given);
  if (!sound) return sound.error();
  const triangle_mesh& mesh = sound->mesh;  // its normals point outwards, whatever the winding was
  const auto slopes = slopes_of(map, settings);
  if (!slopes) return slopes.error();
  normal_map_relief out;
  out.fit.texel_m = mean_texel_m(mesh, map.width, map.height);
  if (!(out.fit.texel_m > 0.0))
    return error{error_code::bad_mesh, "the mesh's texture coordinates span no area; unwrap it and export it again"};

  std::vector<tangent_frame> frames(mesh.triangles.size());
  double area = 0.0;
  double unmapped = 0.0;
  for (std::size_t t = 0; t < frames.size(); ++t) {
    const auto c = corners(mesh.positions, mesh.triangles[t]);
    frames[t] = frame_of(c, mesh.uvs[t]);
    area += glm::length(area_normal(c));
    if (frames[t].along_u == vec3(0.0)) unmapped += glm::length(area_normal(c));
  }
  out.fit.unmapped_area = unmapped / area;

  const refined_mesh fine = refine(mesh, out.fit.texel_m, most_triangles_solved, settings.keep_going);
  out.fit.step_m = fine.longest_edge_m;
  const vec2 size{map.width, map.height};
  const auto rise = [&](std::size_t t, std::size_t k) {
    constexpr double steps_per_pixel = 2.0;
    constexpr double most_steps = 64.0;
    const std::uint32_t source = fine.source[t];
    const tangent_frame& frame = frames[source];
    const auto uv_at = [&](std::size_t corner) {
      const auto& b = fine.barycentric[t][corner];
      return mixed(mesh.uvs[source], {b[0], b[1], b[2]});
    };
    const vec2 from = uv_at(k);
    const vec2 to = uv_at((k + 1) % 3);
    const double steps = std::clamp(std::ceil(steps_per_pixel * glm::length(size * (to - from))), 1.0, most_steps);
    vec2 mean{0.0};
    for (double i = 0.5; i < steps; i += 1.0) mean += (*slopes)(glm::mix(from, to, i / steps)) / steps;
    const auto& v = fine.triangles[t];
    const vec3 way = fine.positions[v[(k + 1) % 3]] - fine.positions[v[k]];
    return mean.x * glm::dot(frame.along_u, way) + mean.y * glm::dot(frame.up, way);
  };
  slope_solution solved = solve_slopes(fine, mesh.positions.size(), rise, settings.keep_going);
  if (settings.keep_going && !settings.keep_going()) return cancelled_map();
  if (!solved.converged)
    return error{error_code::bad_mesh,
                 "the heights of the normal map could not be solved for on this mesh; remesh it "
                 "without very narrow triangles"};
  out.fit.slope_rms = solved.slope_rms;
  out.fit.residual_rms = solved.residual_rms;
  out.fit.points = fine.positions.size();
  out.fit.iterations = solved.iterations;

  auto surface = std::make_shared<const solved_surface>(fine, std::move(solved.heights_m));
  out.heights.finest_m = out.fit.texel_m;
  out.heights.height_m = [shared = std::move(surface)](const relief_point& p) {
    return height_at(*shared, p.position);
  };
  return out;
}

}  // namespace asperity::bake
