// From a textured model to its cells. Done once per model, when a renderer is made.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "asperity/cells/cell_clearance.hpp"
#include "asperity/cells/cell_relief.hpp"
#include "asperity/cells/coarse_regions.hpp"
#include "asperity/cells/relief_tap.hpp"
#include "asperity/cells/sharp_edges.hpp"
#include "asperity/cells/surface_cells.hpp"
#include "asperity/cells/surface_sampler.hpp"
#include "asperity/depth/texture_scale.hpp"

namespace asperity {

namespace detail {

/// Thickness of the body under a cell, m, or `most` where it is thicker: inward rays from points spread over its
/// region. What lies deeper is not in this body, or not behind this surface.
///
/// Near a sharp edge every wedge is thin, and the clearance already keeps a depth in bounds. Within an apron of such an
/// edge a thickness counts only where it is well below the clearance: that of a plate, not of a wedge.
/// @pre the cell's map is drawn
[[nodiscard]] inline double thickness_under(const coarse_mesh& mesh, const surface_index& index,
                                            const aabb_tree& triangles, const std::vector<std::uint32_t>& region,
                                            const surface_cells& body, const surface_cell& cell) {
  constexpr double of_a_plate = 0.7;  // times the clearance: a wedge of 35 degrees is where plate and wedge meet
  const vec3& n_b = cell.n_b;
  const double spacing_m = body.settings.apron_m;
  const relief_map map(body, cell);
  double thickness = body.settings.depth_limit_m;
  const auto shoot = [&](const vec3& from) {
    const vec3 over = cell.to_cell(from);
    relief_map::place place;
    if (!map.find(over.x, over.y, place)) return;
    const double clearance = map.read(place).clearance_m;
    const double counts_below = clearance >= body.settings.apron_m ? thickness : of_a_plate * clearance;
    const vec3 to = from - thickness * n_b;
    triangles.query({glm::min(from, to), glm::max(from, to)}, [&](std::uint32_t g) noexcept {
      if (glm::dot(index.normal[g], n_b) > -0.2) return;  // a wall beside the ray is no other side
      const auto o = corners(mesh, g);
      const vec3 e1 = o[1] - o[0], e2 = o[2] - o[0], x = glm::cross(-n_b, e2);
      const double det = glm::dot(e1, x);
      if (!(std::fabs(det) > 0.0)) return;
      const vec3 s = from - o[0], y = glm::cross(s, e1);
      const double u = glm::dot(s, x) / det, v = glm::dot(-n_b, y) / det, away = glm::dot(e2, y) / det;
      const bool hit = u >= 0.0 && v >= 0.0 && u + v <= 1.0 && away > 0.0;
      if (hit && away < counts_below) thickness = std::min(thickness, away);
    });
  };
  for (const std::uint32_t t : region) {
    const auto c = corners(mesh, t);
    const double size = std::sqrt(0.5 * glm::length(area_normal(c)));
    // Barycentric points of a triangular lattice about a spacing apart; at least the triangle's middle.
    const int side = static_cast<int>(std::clamp(2.0 * size / spacing_m, 1.0, 64.0));
    for (int i = 0; i < side; ++i) {
      for (int j = 0; i + j < side; ++j) {
        const double u = (i + 1.0 / 3.0) / side, v = (j + 1.0 / 3.0) / side;
        shoot((1.0 - u - v) * c[0] + u * c[1] + v * c[2]);
      }
    }
  }
  return thickness;
}

/// Most nodes of one map: half a gigabyte. An automatic pitch needs a tenth of that.
inline constexpr double max_map_nodes = 1 << 26;

/// Plane, axes and extent of a region's map; no columns and rows where there would be too many of them.
[[nodiscard]] inline surface_cell place_cell(const coarse_mesh& mesh, const surface_index& index,
                                             const coarse_regions& regions, std::uint32_t region,
                                             const cell_settings& settings) {
  surface_cell cell;
  cell.n_b = regions.normal[region];
  cell.pitch_m = settings.pitch_m;
  cell.triangles = static_cast<std::uint32_t>(regions.members[region].size());
  vec3 middle(0.0), longest(0.0);
  for (const std::uint32_t t : regions.members[region]) {
    const auto c = corners(mesh, t);
    const double area = 0.5 * glm::length(area_normal(c));
    cell.area_m2 += area;
    middle += area * (c[0] + c[1] + c[2]) / 3.0;
    for (std::size_t k = 0; k < 3; ++k) {
      if (!regions.is_border(index, t, k)) continue;
      const vec3 e = c[(k + 1) % 3] - c[k];
      if (glm::dot(e, e) > glm::dot(longest, longest)) longest = e;
    }
  }
  cell.origin_b = middle / cell.area_m2;
  // Rows along the longest border: a rectangle then wastes no nodes.
  const vec3 u = longest - glm::dot(longest, cell.n_b) * cell.n_b;
  cell.u_b = glm::dot(u, u) > 0.0 ? glm::normalize(u) : any_orthogonal(cell.n_b);
  cell.v_b = glm::cross(cell.n_b, cell.u_b);
  vec2 low(std::numeric_limits<double>::max()), high(-std::numeric_limits<double>::max());
  for (const std::uint32_t t : regions.members[region]) {
    for (const vec3& p : corners(mesh, t)) {
      const vec2 q(cell.to_cell(p));
      low = glm::min(low, q);
      high = glm::max(high, q);
    }
  }
  const double margin = settings.apron_m + 4.0 * cell.pitch_m;  // so that nothing is left at the border of the map
  cell.low = low - margin;
  const vec2 nodes = glm::ceil((high - low + 2.0 * margin) / cell.pitch_m) + 1.0;
  if (nodes.x * nodes.y <= max_map_nodes) {  // false for a NaN
    cell.columns = static_cast<std::uint32_t>(nodes.x);
    cell.rows = static_cast<std::uint32_t>(nodes.y);
  }
  return cell;
}

inline void draw_map(surface_cells& out, surface_cell& cell, std::uint32_t region, const textured_model& model,
                     const surface_index& index, const coarse_regions& regions) {
  const cell_outline outline = find_outline(cell, region, model.mesh, index, regions, out.settings);
  const cell_grid grid{&cell};
  constexpr std::uint32_t none = coarse_regions::none;
  std::vector<std::uint32_t> under(grid.size(), none);  // which of the shown triangles; the region's own come first
  std::vector<char> own(grid.size(), 0), shown(grid.size(), 0);
  for (std::size_t n = 0; n < outline.shown.size(); ++n) {
    const auto c = corners(model.mesh, outline.shown[n]);
    grid.fill(grid.to_grid(c[0]), grid.to_grid(c[1]), grid.to_grid(c[2]), [&](std::size_t i, double) {
      if (under[i] == none) under[i] = static_cast<std::uint32_t>(n);
      shown[i] = 1;
      if (n < outline.own) own[i] = 1;
    });
  }
  const std::vector<float> clearance = clearance_field(grid, outline, out.settings).make(own, shown);
  const std::vector<float> height = draw_relief(grid, outline, under, model, index, out.settings.steepest);
  cell.first = out.nodes.size();
  cell.lowest_m = std::numeric_limits<double>::max();
  cell.highest_m = -std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < grid.size(); ++i) {
    out.nodes.push_back({height[i], clearance[i]});
    // Nodes just beyond the end are known to the spline before it.
    if (!(clearance[i] > -2.0 * cell.pitch_m)) continue;
    cell.lowest_m = std::min<double>(cell.lowest_m, height[i]);
    cell.highest_m = std::max<double>(cell.highest_m, height[i]);
  }
}

}  // namespace detail

/// Cuts a model in cells, draws their relief maps and lays out its samples. Allocates; for seconds, not for a tick.
/// @return invalid_argument (a setting out of range, or a pitch too small for the model) | bad_mesh (no triangle with
/// an
///         area) | bad_texture (empty)
[[nodiscard]] inline result<surface_cells> make_surface_cells(const textured_model& model,
                                                              const cell_settings& settings = {}) {
  if (const result<void> ok = check(settings); !ok) return ok.error();
  if (model.texture.width < 2 || model.texture.height < 2) {
    return error{error_code::bad_texture, "the model " + model.name + " has no haptic texture to cut in cells"};
  }
  const detail::surface_index index(model);
  surface_cells out;
  const detail::texture_scale scale = detail::measure_texture(model, index);
  out.settings = resolve(settings, model, scale.texel_m);
  out.relief_m = scale.relief_m;
  const detail::coarse_regions regions(model.mesh, index, out.settings);
  if (regions.members.empty()) {
    return error{error_code::bad_mesh, "the model " + model.name + " has no coarse triangle with an area"};
  }

  const aabb_tree triangles(triangle_boxes(model.mesh));
  for (std::uint32_t r = 0; r < regions.members.size(); ++r) {
    surface_cell cell = detail::place_cell(model.mesh, index, regions, r, out.settings);
    if (cell.columns == 0) {
      return error{error_code::invalid_argument, "cell settings: pitch_m (" + std::to_string(out.settings.pitch_m) +
                                                     " m) is too small for the size of the model " + model.name +
                                                     "; raise it, or give the model its box"};
    }
    detail::draw_map(out, cell, r, model, index, regions);
    cell.depth_limit_m = detail::thickness_under(model.mesh, index, triangles, regions.members[r], out, cell);
    out.cells.push_back(cell);
  }
  out.nodes.shrink_to_fit();
  detail::surface_sampler sampler(out, model, index, regions);
  sampler.sample_regions();
  sampler.sample_edges();
  out.edges = detail::find_sharp_edges(model.mesh, index, regions, 0.5 * out.settings.taper_m);
  detail::lay_edge_relief(out, model, index, regions);

  std::vector<bounds> boxes;
  for (const sample_tile& t : out.tiles) boxes.push_back({t.centre_b - t.radius_m, t.centre_b + t.radius_m});
  out.tile_tree = aabb_tree(boxes);
  boxes.clear();
  for (const sharp_edge& e : out.edges) {
    const vec3 from = e.from_b - e.extension_m[0] * e.along_b;
    const vec3 to = e.from_b + (e.length_m + e.extension_m[1]) * e.along_b;
    boxes.push_back({glm::min(from, to), glm::max(from, to)});
  }
  out.edge_tree = aabb_tree(boxes);
  return out;
}

}  // namespace asperity
