#include "asperity/bake/wrap.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "bake/check.hpp"
#include "bake/geometry.hpp"
#include "bake/measure.hpp"
#include "bake/parallel.hpp"
#include "bake/soup_facing.hpp"
#include "bake/surface_points.hpp"
#include "bake/winding_number.hpp"
#include "bake/wrap_fit.hpp"
#include "bake/wrap_lattice.hpp"
#include "bake/wrap_sheets.hpp"
#include "bake/wrapped_body.hpp"

namespace asperity::bake {
namespace {

constexpr double margin_in_diagonals = 0.3;  // the surface may leave the box of the soup by so much
constexpr double coarser = 1.4;              // a cell that met a limit, where the size was not asked for
// Half as many as triangles: what a bake takes in some seconds.
constexpr std::size_t most_unasked_vertices = 500'000;
constexpr int most_tries = 12;
constexpr double smallest_part_in_cells = 2.0;
constexpr double far_in_thicknesses = 0.6;  // the faces of a plate are at one half
constexpr std::size_t fewest_measured = 5'000;
constexpr std::size_t most_measured = 100'000;

error cancelled() { return {error_code::cancelled, "the wrap was cancelled"}; }

std::string metres(double x) {
  std::ostringstream out;
  out.precision(3);
  out << x << " m";
  return out.str();
}

result<cell_sizes> sizes_of(const wrap_settings& settings, double diagonal) {
  const auto positive = [](const std::optional<double>& x) { return !x || (std::isfinite(*x) && *x > 0.0); };
  if (!positive(settings.cell_m) || !positive(settings.thickness_m))
    return error{error_code::invalid_argument, "the cell and the thickness of a wrap have to be greater than zero"};
  cell_sizes out;
  out.asked = settings.cell_m || settings.thickness_m;
  out.cell_m = settings.cell_m.value_or(diagonal / default_wrap_cells);
  if (settings.thickness_m && !settings.cell_m)
    out.cell_m = std::min(out.cell_m, *settings.thickness_m / default_plate_cells);
  out.thickness_m = settings.thickness_m.value_or(default_plate_cells * out.cell_m);
  const double least_cell = diagonal / most_wrap_cells;
  if (out.cell_m < least_cell)
    return error{error_code::invalid_argument, "a wrap with cells of " + metres(out.cell_m) + " has more than the " +
                                                   std::to_string(static_cast<int>(most_wrap_cells)) +
                                                   " along the diagonal that fit in memory; ask for cells of " +
                                                   metres(least_cell) + " or larger, and plates of " +
                                                   metres(default_plate_cells * least_cell) + " or thicker"};
  if (out.cell_m > 0.25 * diagonal)
    return error{error_code::invalid_argument, "a wrap with cells of " + metres(out.cell_m) +
                                                   " would not show the object of " + metres(diagonal) +
                                                   "; ask for cells of " + metres(0.25 * diagonal) + " or smaller"};
  if (out.thickness_m < least_plate_cells * out.cell_m * (1.0 - 1e-9))
    return error{error_code::invalid_argument,
                 "plates of " + metres(out.thickness_m) + " are too thin for cells of " + metres(out.cell_m) +
                     ": ask for cells of " + metres(out.thickness_m / least_plate_cells) +
                     " or smaller, or for plates of " + metres(least_plate_cells * out.cell_m) + " or thicker"};
  return out;
}

// Faults that no wrap can mend.
result<void> check_input(const triangle_mesh& mesh) {
  const auto bad = [](std::string what) { return error{error_code::bad_mesh, "the mesh " + std::move(what)}; };
  if (mesh.triangles.empty()) return bad("is empty; give a file that contains triangles");
  if (mesh.triangles.size() > most_triangles)
    return error{error_code::limit_exceeded, "the mesh has " + std::to_string(mesh.triangles.size()) +
                                                 " triangles, more than the " + std::to_string(most_triangles) +
                                                 " that a wrap takes; decimate it first"};
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t]) {
      if (v >= mesh.positions.size())
        return bad("has a vertex index out of range: triangle " + std::to_string(t) + " uses vertex " +
                   std::to_string(v) + " of " + std::to_string(mesh.positions.size()) +
                   "; export it again, the file is damaged");
      if (!is_finite(mesh.positions[v]))
        return bad("has a coordinate that is not a number: vertex " + std::to_string(v) + ", used by triangle " +
                   std::to_string(t) + "; remove or correct that vertex");
    }
  return {};
}

// The vertices in use, about the middle of their box.
triangle_mesh centred(const triangle_mesh& mesh, vec3& middle) {
  triangle_mesh out;
  std::vector<std::uint32_t> number(mesh.positions.size(), no_halfedge);
  out.triangles = mesh.triangles;
  for (index_triangle& t : out.triangles)
    for (std::uint32_t& v : t) {
      if (number[v] == no_halfedge) {
        number[v] = static_cast<std::uint32_t>(out.positions.size());
        out.positions.push_back(mesh.positions[v]);
      }
      v = number[v];
    }
  const bounds box = bounds_of(out.positions);
  middle = 0.5 * box.low + 0.5 * box.high;
  for (vec3& p : out.positions) p -= middle;
  return out;
}

lattice_frame frame_over(const triangle_mesh& mesh, double cell_m, double thickness_m) {
  const bounds box = bounds_of(mesh.positions);
  const double margin = margin_in_diagonals * box.diagonal() + thickness_m + 4.0 * cell_m;
  lattice_frame frame;
  frame.cell_m = cell_m;
  // No plane of a model that has whole numbers for coordinates lies in the lattice.
  frame.origin = box.low - vec3(margin) - cell_m * vec3(0.371, 0.413, 0.297);
  const vec3 span = box.high - box.low + 2.0 * vec3(margin);
  for (int k = 0; k < 3; ++k)
    frame.most[static_cast<std::size_t>(k)] = static_cast<std::int32_t>(std::ceil(2.0 * span[k] / cell_m));
  return frame;
}

std::vector<lattice_key> seeds_of(const lattice_frame& frame, const sorted_soup& soup, double thickness_m) {
  std::vector<lattice_key> seeds;
  const auto add = [&](const vec3& p) {
    const auto around = frame.around(p);
    seeds.insert(seeds.end(), around.begin(), around.end());
  };
  for (std::size_t i = 0; i < soup.places.size(); ++i) {
    add(soup.places[i]);
    if (soup.plated[i] == 0) continue;
    add(soup.places[i] + 0.5 * thickness_m * soup.normals[i]);
    add(soup.places[i] - 0.5 * thickness_m * soup.normals[i]);
  }
  std::ranges::sort(seeds);
  seeds.erase(std::unique(seeds.begin(), seeds.end()), seeds.end());
  return seeds;
}

struct wrapped {
  triangle_mesh mesh;
  double plate_share = 0.0;
  bool too_large = false;
};

std::optional<wrapped> wrap_with(const triangle_mesh& soup, const cell_sizes& sizes, unsigned threads,
                                 stage_monitor& monitor) {
  const auto sorted = sort_soup(soup, sizes.cell_m, threads, monitor);
  if (!sorted) return std::nullopt;
  wrapped out;
  out.plate_share = sorted->plate_share;
  out.too_large = sorted->too_large;
  if (out.too_large) return out;
  const wrapped_body body(sorted->body, sorted->plates, sizes, threads);
  lattice_frame frame = frame_over(soup, sizes.cell_m, sizes.thickness_m);
  if (!sizes.asked) frame.most_vertices = most_unasked_vertices;
  auto surface = surface_on_lattice(
      frame, seeds_of(frame, *sorted, sizes.thickness_m),
      {[&](const vec3& p) { return body.value(p); },
       [&](const vec3& inside, const vec3& outside, float, float) { return body.cut(inside, outside); }},
      threads, monitor);
  if (!surface) return std::nullopt;
  out.too_large = surface->too_large || surface->triangles.size() > most_triangles;
  out.mesh.positions = std::move(surface->positions);
  out.mesh.triangles = std::move(surface->triangles);
  return out;
}

// Distances from points spread over one surface, and its vertices, to the other.
struct one_way {
  length_spread spread;
  double far_share = 0.0;
};
std::optional<one_way> measure_from(const triangle_mesh& from, const triangle_bvh& to, double far_m, std::size_t count,
                                    unsigned threads, stage_monitor& monitor) {
  const std::vector<relief_point> points = spread_points(from, count);
  std::vector<double> distance(points.size() + from.positions.size());
  const auto visit = [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      distance[i] = to.closest(i < points.size() ? points[i].position : from.positions[i - points.size()]).distance_m;
  };
  if (!parallel_blocks(distance.size(), threads, monitor, monitor.done(), monitor.done(), visit)) return std::nullopt;
  std::vector<double> weight(distance.size(), 0.0);
  std::fill_n(weight.begin(), points.size(), 1.0);
  const auto far =
      std::count_if(distance.begin(), distance.begin() + std::ssize(points), [&](double d) { return d > far_m; });
  return one_way{spread_of(distance, weight), static_cast<double>(far) / static_cast<double>(points.size())};
}

}  // namespace

bool can_wrap(const triangle_mesh& mesh) noexcept {
  if (mesh.triangles.empty() || mesh.triangles.size() > most_triangles) return false;
  bounds box;
  bool any = false;
  double area = 0.0;
  for (const index_triangle& t : mesh.triangles) {
    for (const std::uint32_t v : t) {
      if (v >= mesh.positions.size() || !is_finite(mesh.positions[v])) return false;
      const vec3& p = mesh.positions[v];
      box = any ? bounds{glm::min(box.low, p), glm::max(box.high, p)} : bounds{p, p};
      any = true;
    }
    area += glm::length(area_normal(corners(mesh.positions, t)));
  }
  const double diagonal = box.diagonal();
  const vec3 reach = glm::max(glm::abs(box.low), glm::abs(box.high));
  return diagonal >= smallest_diagonal_m && diagonal <= 0.9 * largest_diagonal_m && area > 1e-9 * diagonal * diagonal &&
         std::max({reach.x, reach.y, reach.z}) <= farthest_in_diagonals * diagonal;
}

result<triangle_mesh> wrap(const triangle_mesh& mesh, const wrap_settings& settings, wrap_report& report) {
  stage_monitor monitor(settings.progress);
  const unsigned threads = resolve_threads(settings.threads);
  if (!monitor.begin("wrap")) return cancelled();
  if (const auto sound = check_input(mesh); !sound) return sound.error();
  vec3 middle{0.0};
  triangle_mesh soup = centred(mesh, middle);
  if (const double diagonal = bounds_of(soup.positions).diagonal();
      !(diagonal >= smallest_diagonal_m && diagonal <= largest_diagonal_m))
    return error{error_code::bad_mesh, "the mesh measures " + metres(diagonal) +
                                           " across, which is no object that is felt; scale it to metres"};
  wrap_report told;
  told.triangles_in = mesh.triangles.size();
  told.dropped_triangles = drop_useless_triangles(soup);
  if (soup.triangles.empty())
    return error{error_code::bad_mesh, "the mesh has no triangle with an area; export it again as a surface"};
  vec3 again{0.0};
  soup = centred(soup, again);
  middle += again;
  const double diagonal = bounds_of(soup.positions).diagonal();
  const auto turned = face_outwards(soup, threads, monitor);
  if (!turned || !monitor.at(0.1)) return cancelled();
  told.turned_triangles = *turned;

  auto sizes = sizes_of(settings, diagonal);
  if (!sizes) return sizes.error();
  auto made = wrap_with(soup, *sizes, threads, monitor);
  for (int i = 0; made && made->too_large && !sizes->asked && i < most_tries; ++i) {
    sizes->cell_m *= coarser;
    sizes->thickness_m *= coarser;
    made = wrap_with(soup, *sizes, threads, monitor);
  }
  if (!made || !monitor.at(0.6)) return cancelled();
  if (made->too_large)
    return error{error_code::limit_exceeded, "a wrap with cells of " + metres(sizes->cell_m) +
                                                 " takes more memory than is given to it; ask for larger cells"};

  const triangle_bvh tree(soup.positions, soup.triangles, threads, &monitor);
  if (monitor.cancelled()) return cancelled();
  if (!fit_to_original(made->mesh, soup, tree, sizes->cell_m, threads, monitor)) return cancelled();
  if (!monitor.at(0.8)) return cancelled();
  const auto dropped = keep_outermost(made->mesh, smallest_part_in_cells * sizes->cell_m, threads, monitor);
  if (!dropped) return cancelled();
  if (made->mesh.triangles.empty())
    return error{error_code::bad_mesh,
                 "nothing of the mesh is left with cells of " + metres(sizes->cell_m) + "; ask for smaller ones"};
  const triangle_bvh own(made->mesh.positions, made->mesh.triangles, threads, &monitor);
  if (monitor.cancelled()) return cancelled();
  const std::size_t points = std::clamp(made->mesh.triangles.size(), fewest_measured, most_measured);
  told.far_m = std::max(sizes->cell_m, made->plate_share > 0.0 ? far_in_thicknesses * sizes->thickness_m : 0.0);
  const auto to_original = measure_from(made->mesh, tree, told.far_m, points, threads, monitor);
  const auto to_wrap = to_original ? measure_from(soup, own, told.far_m, points, threads, monitor) : std::nullopt;
  if (!to_wrap) return cancelled();

  for (vec3& p : made->mesh.positions) p += middle;
  auto checked = check(std::move(made->mesh), "the wrapped mesh");
  if (!checked) return checked.error();
  told.cell_m = sizes->cell_m;
  told.thickness_m = sizes->thickness_m;
  told.triangles = checked->mesh.triangles.size();
  told.components = checked->components;
  told.plate_share = made->plate_share;
  told.cavities_filled = dropped->cavities;
  told.specks_dropped = dropped->specks;
  told.to_original = to_original->spread;
  told.to_wrap = to_wrap->spread;
  told.made_up_share = to_original->far_share;
  told.lost_share = to_wrap->far_share;
  report = told;
  return std::move(checked->mesh);
}

}  // namespace asperity::bake
