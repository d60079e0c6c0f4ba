#include "asperity/bake/bake.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>

#include "bake/atlas.hpp"
#include "bake/cage.hpp"
#include "bake/check.hpp"
#include "bake/crease_normals.hpp"
#include "bake/geometry.hpp"
#include "bake/measure.hpp"
#include "bake/parallel.hpp"
#include "bake/pieces.hpp"
#include "bake/project.hpp"
#include "bake/refine.hpp"
#include "bake/relief_fit.hpp"
#include "bake/simplify.hpp"
#include "bake/stage_monitor.hpp"
#include "bake/surface_points.hpp"
#include "bake/triangle_bvh.hpp"

namespace asperity::bake {
namespace {

constexpr std::size_t fewest_triangles = 4;
constexpr std::uint32_t smallest_texture = 16;
constexpr std::uint32_t largest_texture = 8192;

// Rays go a little past the measured distance between the surfaces: along a slanted normal the way is longer.
constexpr double range_per_cage = 2.0;
constexpr double least_range_in_diagonals = 0.005;
constexpr double least_band_texels = 0.5;

constexpr std::size_t relief_samples = 65536;
constexpr double finest_per_texel = 1.5;  // texels up to this many times a relief's detail are not worth a word
constexpr double reference_edge_texels = 1.4;
constexpr std::size_t most_reference_triangles = 1'000'000;

error cancelled() { return {error_code::cancelled, "the bake was cancelled"}; }

result<void> check_options(const bake_options& options) {
  if (!options.coarse && options.triangles < fewest_triangles)
    return error{error_code::invalid_argument, "a coarse mesh of " + std::to_string(options.triangles) +
                                                   " triangles cannot enclose a volume; ask for 4 or more"};
  if (options.texture_size < smallest_texture || options.texture_size > largest_texture)
    return error{error_code::invalid_argument, "texture size " + std::to_string(options.texture_size) + " is outside " +
                                                   std::to_string(smallest_texture) + " to " +
                                                   std::to_string(largest_texture) + " texels per side"};
  return {};
}

// The coarse mesh that the user gives, checked, or one made by simplifying.
result<simplified_mesh> coarse_of(const checked_mesh& full, const triangle_bvh& full_tree, const bake_options& options,
                                  unsigned threads, stage_monitor& monitor) {
  if (!options.coarse) {
    auto made = simplify(full, options.triangles, threads, monitor);
    const double diagonal = bounds_of(full.mesh.positions).diagonal();
    if (made && made->mesh.triangles.size() < full.mesh.triangles.size())
      fit_to_relief(made->mesh, full_tree, widest_cage_in_diagonals * diagonal);
    return made;
  }
  triangle_mesh rounded = *options.coarse;
  round_to_float32(rounded);
  auto given = check(rounded, "the coarse mesh");
  if (!given) return given.error();
  simplified_mesh out{std::move(given->mesh), {}};
  if (given->flipped) out.note = "the coarse mesh was inside-out and has been turned";
  return out;
}

void remark(const bake_options& options, std::string_view sentence) {
  if (options.remark && !sentence.empty()) options.remark(sentence);
}

coarse_mesh with_uvs(const triangle_mesh& mesh, const atlas& charts) {
  coarse_mesh out;
  out.positions = mesh.positions;
  out.triangles.resize(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) out.triangles[t] = {mesh.triangles[t], charts.uv[t]};
  return out;
}

// Heights that cannot be meant are refused before any work is done on them.
result<void> check_relief(const added_relief& added, double diagonal_m) {
  if (!added.heights) return {};
  double highest = 0.0;
  for (const relief_point& p : spread_points(added.original, relief_samples)) {
    const double h = std::abs(added.at(p.triangle, p.position));
    if (!std::isfinite(h))
      return error{error_code::bad_texture, "the relief has a height that is not finite; mend its source"};
    highest = std::max(highest, h);
  }
  if (highest <= widest_cage_in_diagonals * diagonal_m) return {};
  std::ostringstream text;
  text << "the relief reaches " << highest << " m, more than " << 100.0 * widest_cage_in_diagonals
       << " % of the mesh's diagonal of " << diagonal_m << " m: its heights or the mesh are not in metres, or it "
       << "describes a shape, which belongs into the mesh";
  return error{error_code::bad_texture, text.str()};
}

std::string too_coarse(double texel_m, double finest_m, std::uint32_t texture_size) {
  std::ostringstream text;
  text << "the haptic texture has texels of " << texel_m << " m, too coarse for a relief whose detail is " << finest_m
       << " m: what is finer is lost or distorted; ask for about "
       << static_cast<std::uint64_t>(std::ceil(texture_size * texel_m / finest_m)) << " texels per side";
  return text.str();
}

// The original with its relief as triangles, about one per texel, against the textured surface.
result<surface_error> measure_with_relief(const added_relief& added, double texel_m, const textured_model& model,
                                          unsigned threads, stage_monitor& monitor) {
  const refined_mesh fine = refine(added.original, reference_edge_texels * texel_m, most_reference_triangles);
  triangle_mesh raised;
  raised.triangles.reserve(fine.triangles.size());
  // A vertex stands once for each triangle of the original that it belongs to; the parts of one follow one another.
  std::vector<std::uint32_t> number(fine.positions.size(), no_halfedge);
  std::vector<std::uint32_t> number_is_of(fine.positions.size(), no_halfedge);
  for (std::size_t t = 0; t < fine.triangles.size(); ++t) {
    const std::uint32_t source = fine.source[t];
    const vec3 n = unit_normal(corners(added.original.positions, added.original.triangles[source]));
    index_triangle corner_numbers{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = fine.triangles[t][k];
      if (number_is_of[v] != source) {
        number_is_of[v] = source;
        number[v] = static_cast<std::uint32_t>(raised.positions.size());
        raised.positions.push_back(fine.positions[v] + added.at(source, fine.positions[v]) * n);
      }
      corner_numbers[k] = number[v];
    }
    raised.triangles.push_back(corner_numbers);
  }
  return measure(raised, triangle_bvh(raised.positions, raised.triangles), model.mesh, model.texture, threads, monitor);
}

}  // namespace

result<textured_model> bake(const triangle_mesh& full_mesh, const bake_options& options) {
  stage_monitor monitor(options.progress);
  const unsigned threads = resolve_threads(options.threads);

  if (!monitor.begin("check")) return cancelled();
  if (const auto sound = check_options(options); !sound) return sound.error();
  const auto full = check(full_mesh);
  if (!full) return full.error();
  if (full->flipped) remark(options, "the mesh was inside-out and has been turned");
  const triangle_bvh full_tree(full->mesh.positions, full->mesh.triangles);
  const double diagonal = bounds_of(full->mesh.positions).diagonal();

  if (!monitor.begin("simplify")) return cancelled();
  const auto coarse = coarse_of(*full, full_tree, options, threads, monitor);
  if (!coarse) return coarse.error();
  remark(options, coarse->note);
  const added_relief added{options.relief, full->mesh, full->flipped};
  if (const auto sound = check_relief(added, diagonal); !sound) return sound.error();
  if (!monitor.begin("compare")) return cancelled();
  const auto cage = measure_cage(full->mesh, full_tree, coarse->mesh, threads, monitor);
  if (!cage) return cage.error();

  if (!monitor.begin("atlas")) return cancelled();
  const auto charts = make_atlas(coarse->mesh, options.texture_size);
  if (!charts) return charts.error();
  if (options.relief && charts->texel_m > options.relief.finest_m * finest_per_texel && options.relief.finest_m > 0.0)
    remark(options, too_coarse(charts->texel_m, options.relief.finest_m, options.texture_size));

  if (!monitor.begin("project")) return cancelled();
  const double range = std::max(range_per_cage * *cage, least_range_in_diagonals * diagonal);
  auto projected =
      project(coarse->mesh, *charts, crease_normals(coarse->mesh, full_tree, least_band_texels * charts->texel_m),
              full_tree, range, options.texture_size, threads, monitor, options.relief ? &added : nullptr);
  if (!projected) return projected.error();

  if (!monitor.begin("pieces")) return cancelled();
  auto pieces = decompose(coarse->mesh, piece_limits{}, monitor);
  if (!pieces) return pieces.error();

  textured_model out;
  out.name = options.name;
  out.mesh = with_uvs(coarse->mesh, *charts);
  out.texture = std::move(projected->texture);
  out.pieces = std::move(*pieces);
  out.mass = compute_mass_properties(out.mesh);
  out.box = bounds_of(out.mesh.positions);

  if (!monitor.begin("measure")) return cancelled();
  const auto errors = options.relief ? measure_with_relief(added, charts->texel_m, out, threads, monitor)
                                     : measure(full->mesh, full_tree, out.mesh, out.texture, threads, monitor);
  if (!errors) return errors.error();
  out.report.rms_error_m = errors->rms_m();
  out.report.max_error_m = errors->max_m();
  out.report.relief_m = projected->highest_m - projected->lowest_m;
  out.report.max_displacement_m = projected->max_displacement_m;
  out.report.full_triangles = full->mesh.triangles.size();
  out.report.fallback_texels = projected->fallback_texels;
  out.report.texels = projected->texels;
  return out;
}

}  // namespace asperity::bake
