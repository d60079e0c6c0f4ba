#include "bake/uv_atlas.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "bake/geometry.hpp"
#include "bake/halfedges.hpp"
#include "bake/image_triangle.hpp"
#include "bake/measure.hpp"
#include "bake/texel_map.hpp"
#include "bake/uv_room.hpp"

namespace asperity::bake {
namespace {

constexpr double thinnest_texels = 0.01;
constexpr double border_texels = 0.5;  // a lookup nearer to the border finds no texel beyond it
constexpr double distorted = 2.0;      // texels that differ by more are worth a word
constexpr std::string_view or_without = ", or bake without --keep-uvs";

error bad(const std::string& fault) { return {error_code::bad_mesh, fault + std::string(or_without)}; }

std::string number(double x) {
  std::ostringstream out;
  out.precision(3);
  out << x;
  return out.str();
}

std::string name(std::size_t t) { return std::string("triangle ").append(std::to_string(t)) + " of the coarse mesh"; }

std::string text(const vec2& uv) {
  std::ostringstream out;
  out.precision(3);
  out << " has the texture coordinates (" << uv.x << ", " << uv.y << ")";
  return out.str();
}

error overlap_error(const triangle_pair& pair) {
  return bad("triangles " + std::to_string(pair.first) + " and " + std::to_string(pair.second) +
             " of the coarse mesh overlap in its texture coordinates, and a texel cannot be two places of the surface; "
             "give mirrored halves and repeated parts a place of their own");
}

error crowding_error(const triangle_pair& pair, std::uint32_t size) {
  constexpr double needed = 2.0 * gutter_texels;
  const double enough = std::ceil(needed * size / std::max(pair.apart_texels, 1e-6));
  const std::string larger = enough <= largest_texture
                                 ? "bake with --texture " + std::to_string(static_cast<std::uint32_t>(enough)) + ", "
                                 : std::string();
  return bad("triangles " + std::to_string(pair.first) + " and " + std::to_string(pair.second) +
             " of the coarse mesh are not neighbours and are " + number(pair.apart_texels) +
             " texels apart in its texture coordinates, nearer than the " + number(needed) +
             " that lookups need between charts; " + larger + "leave a margin of " + number(needed / size) +
             " of the image's width between charts");
}

std::uint32_t root_of(std::vector<std::uint32_t>& parent, std::uint32_t t) {
  while (parent[t] != t) t = parent[t] = parent[parent[t]];
  return t;
}

// Numbers the sets of triangles that are joined by edges without a seam. @return their number
std::size_t number_charts(const triangle_mesh& mesh, std::uint32_t size, std::vector<std::uint32_t>& chart) {
  const connectivity net = connect(mesh.triangles, mesh.positions.size());
  std::vector<std::uint32_t> parent(mesh.triangles.size());
  for (std::uint32_t t = 0; t < parent.size(); ++t) parent[t] = t;
  const auto agree = [&](std::uint32_t a, std::uint32_t b) {
    return glm::length(mesh.uvs[a / 3][a % 3] - mesh.uvs[b / 3][b % 3]) * size <= uv_slack_texels;
  };
  for (std::uint32_t h = 0; h < net.mate.size(); ++h) {
    const std::uint32_t mate = net.mate[h];
    if (mate == no_halfedge || mate < h) continue;
    if (!agree(h, next_halfedge(mate)) || !agree(next_halfedge(h), mate)) continue;
    const std::uint32_t a = root_of(parent, h / 3);
    const std::uint32_t b = root_of(parent, mate / 3);
    parent[std::max(a, b)] = std::min(a, b);
  }
  std::uint32_t charts = 0;
  chart.resize(parent.size());
  for (std::uint32_t t = 0; t < parent.size(); ++t) {
    const std::uint32_t root = root_of(parent, t);
    chart[t] = root == t ? charts++ : chart[root];
  }
  return charts;
}

// Sizes of texels on the surface, and the share of the image that is used.
void measure_texels(const triangle_mesh& mesh, const std::vector<image_triangle>& image, std::uint32_t size,
                    atlas& out) {
  std::vector<double> wide, per_narrow, areas;
  double area = 0.0;
  double texels = 0.0;
  for (std::size_t t = 0; t < image.size(); ++t) {
    const auto c = corners(mesh.positions, mesh.triangles[t]);
    const texel_map map(c, image[t]);
    wide.push_back(map.wide_m());
    per_narrow.push_back(1.0 / std::max(map.narrow_m(), 1e-300));
    areas.push_back(0.5 * glm::length(area_normal(c)));
    area += areas.back();
    texels += 0.5 * std::abs(image[t].twice_area);
  }
  out.texel_m = std::sqrt(area / texels);
  out.wide_m = spread_of(wide, areas).p99_m;
  out.narrow_m = 1.0 / spread_of(per_narrow, areas).p99_m;
  out.utilisation = texels / (static_cast<double>(size) * size);
}

}  // namespace

result<void> check_uvs(const triangle_mesh& coarse, std::uint32_t texture_size) {
  if (coarse.uvs.size() != coarse.triangles.size() || coarse.uvs.empty())
    return bad("the coarse mesh has no texture coordinates to keep; export it with its UVs (OBJ, glTF)");
  const double side = texture_size;
  for (std::size_t t = 0; t < coarse.uvs.size(); ++t) {
    const auto& uv = coarse.uvs[t];
    for (const vec2& p : uv) {
      if (!std::isfinite(p.x) || !std::isfinite(p.y))
        return bad(name(t) + " has a texture coordinate that is not a number; unwrap it again");
      const double margin = std::min({p.x, p.y, 1.0 - p.x, 1.0 - p.y});
      if (margin < 0.0)
        return bad(name(t) + text(p) +
                   ", outside the unit square; a haptic texture does not repeat, so move all charts into the square, "
                   "each to a place of its own");
      if (margin * side < border_texels - uv_slack_texels)
        return bad(name(t) + text(p) + ", less than half a texel from the border of the image; leave a margin of " +
                   number(border_texels / side) + " of the image's width");
    }
    const image_triangle image(uv, side);
    double longest = 0.0;
    for (std::size_t k = 0; k < 3; ++k) longest = std::max(longest, glm::length(image.c[(k + 1) % 3] - image.c[k]));
    if (!(std::abs(image.twice_area) > thinnest_texels * longest))
      return bad(name(t) + " has no area in its texture coordinates; unwrap it again");
  }
  return {};
}

result<atlas> atlas_from_uvs(const triangle_mesh& coarse, std::uint32_t texture_size) {
  if (const auto sound = check_uvs(coarse, texture_size); !sound) return sound.error();
  triangle_mesh mesh = coarse;
  std::vector<image_triangle> image;
  double texels = 0.0;
  for (auto& uv : mesh.uvs) {
    for (vec2& p : uv) p = {to_float32(p.x), to_float32(p.y)};
    image.emplace_back(uv, texture_size);
    texels += 0.5 * std::abs(image.back().twice_area);
  }
  if (const auto enough = check_room(texels, image.size(), texture_size); !enough) return enough.error();
  if (const auto few = check_boxes(image, texture_size); !few) return few.error();
  if (const auto pair = find_overlap(image)) return overlap_error(*pair);
  if (const auto pair = find_crowding(mesh, image, texture_size)) return crowding_error(*pair, texture_size);
  atlas out;
  out.charts = number_charts(mesh, texture_size, out.chart);
  measure_texels(mesh, image, texture_size, out);
  out.uv = std::move(mesh.uvs);
  return out;
}

std::string distortion_remark(const atlas& charts) {
  if (charts.wide_m <= distorted * charts.narrow_m) return {};
  std::ostringstream out;
  out.precision(3);
  out << "the texture coordinates that were kept stretch the texels: on the coarse mesh they measure " << charts.texel_m
      << " m in the mean, but " << charts.narrow_m << " m at the narrowest and " << charts.wide_m
      << " m at the widest, 1 % of the surface each left out";
  return out.str();
}

}  // namespace asperity::bake
