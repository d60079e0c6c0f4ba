#include "asperity/bake/bake.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "bake/added_relief.hpp"
#include "bake/atlas.hpp"
#include "bake/check.hpp"
#include "bake/coarse.hpp"
#include "bake/crease_normals.hpp"
#include "bake/geometry.hpp"
#include "bake/measure.hpp"
#include "bake/parallel.hpp"
#include "bake/piece_fit.hpp"
#include "bake/pieces.hpp"
#include "bake/project.hpp"
#include "bake/self_crossing.hpp"
#include "bake/simplify.hpp"
#include "bake/stage_monitor.hpp"
#include "bake/stitch.hpp"
#include "bake/thin_features.hpp"
#include "bake/triangle_bvh.hpp"
#include "bake/uv_atlas.hpp"
#include "bake/winding.hpp"

namespace asperity::bake {
namespace {

constexpr std::size_t fewest_triangles = 4;

// Rays go a little past the measured distance between the surfaces: along a slanted normal the way is longer.
constexpr double range_per_cage = 2.0;
constexpr double least_range_in_diagonals = 0.005;
constexpr double least_band_texels = 0.5;
// Wider gaps at coarse edges are worked on; narrower ones are what bilinear lookups leave where the surface is curved.
constexpr double widest_gap_texels = 0.25;
constexpr double fit_spacing_in_diagonals = 0.005;
constexpr double thin_texels = 2.0;

error cancelled() { return {error_code::cancelled, "the bake was cancelled"}; }

result<void> check_options(const bake_settings& settings) {
  if (!settings.coarse && settings.triangles < fewest_triangles)
    return error{error_code::invalid_argument, "a coarse mesh of " + std::to_string(settings.triangles) +
                                                   " triangles cannot enclose a volume; ask for 4 or more"};
  if (settings.texture_size < smallest_texture || settings.texture_size > largest_texture)
    return error{error_code::invalid_argument, "texture size " + std::to_string(settings.texture_size) +
                                                   " is outside " + std::to_string(smallest_texture) + " to " +
                                                   std::to_string(largest_texture) + " texels per side"};
  if (settings.pieces && *settings.pieces == 0)
    return error{error_code::invalid_argument, "a model of no convex pieces cannot be touched; ask for 1 or more"};
  return {};
}

// What can be told of texture coordinates that are to be kept before any work is done.
result<void> check_kept_uvs(const triangle_mesh& full, const bake_settings& settings) {
  if (!settings.keep_uvs) return {};
  if (settings.coarse) return check_uvs(*settings.coarse, settings.texture_size);
  if (full.triangles.size() > settings.triangles)
    return error{error_code::invalid_argument,
                 "the mesh has " + std::to_string(full.triangles.size()) + " triangles, and simplifying it to " +
                     std::to_string(settings.triangles) +
                     " would lose its texture coordinates; to keep them give a coarse mesh that has some, or ask for "
                     "as many triangles as the mesh has"};
  return check_uvs(full, settings.texture_size);
}

void remark(const bake_settings& settings, std::string_view sentence) {
  if (settings.remark && !sentence.empty()) settings.remark(sentence);
}

coarse_mesh with_uvs(const triangle_mesh& mesh, const atlas& charts) {
  coarse_mesh out;
  out.positions = mesh.positions;
  out.triangles.resize(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) out.triangles[t] = {mesh.triangles[t], charts.uv[t]};
  return out;
}

bake_quality quality_of(const surface_error& errors, const atlas& charts, const length_spread& spacing,
                        const piece_fit& fit) {
  bake_quality out;
  out.to_original = errors.to_original;
  out.to_textured = errors.to_textured;
  out.to_original_rms_m = errors.to_original_rms_m;
  out.to_textured_rms_m = errors.to_textured_rms_m;
  out.crack_max_m = errors.crack_max_m;
  out.texel_m = charts.texel_m;
  out.atlas_utilisation = charts.utilisation;
  out.texel_spacing = spacing;
  out.lost_share = errors.lost.share;
  out.lost_part_share = errors.lost.part_share;
  out.lost_part_centre = errors.lost.part_centre;
  out.lost_part_low = errors.lost.part_low;
  out.lost_part_high = errors.lost.part_high;
  out.surface_to_hull_max_m = fit.surface_to_hull_max_m;
  out.bridged_air_max_m = fit.bridged_air_max_m;
  return out;
}

}  // namespace

result<textured_model> bake(triangle_mesh full_mesh, const bake_settings& settings) {
  stage_monitor monitor(settings.progress);
  const unsigned threads = resolve_threads(settings.threads);

  if (!monitor.begin("check")) return cancelled();
  if (const auto sound = check_options(settings); !sound) return sound.error();
  if (const auto sound = check_kept_uvs(full_mesh, settings); !sound) return sound.error();
  auto full = check(std::move(full_mesh));
  if (!full) return full.error();
  if (!settings.relief.reads_uvs && !settings.keep_uvs) full->mesh.uvs = {};
  if (full->turned_triangles > 0) remark(settings, winding_remark(full->turned_triangles));
  if (full->flipped) remark(settings, "the mesh was inside-out and has been turned");
  const double diagonal = bounds_of(full->mesh.positions).diagonal();

  auto chosen = choose_coarse(*full, settings, threads, monitor);
  if (!chosen) return chosen.error();
  simplified_mesh* const coarse = &chosen->made;
  const triangle_bvh& full_tree = chosen->full_tree;
  const double cage_m = chosen->cage_m;
  const auto crossings = find_self_crossings(full->mesh, full_tree, threads, monitor);
  if (!crossings) return cancelled();
  if (crossings->pairs > 0) remark(settings, crossing_remark(*crossings));
  remark(settings, coarse->note);
  const added_relief added{settings.relief, full->mesh};
  if (const auto sound = check_relief(added, diagonal); !sound) return sound.error();

  if (!monitor.begin("atlas")) return cancelled();
  const auto charts = settings.keep_uvs ? atlas_from_uvs(coarse->mesh, settings.texture_size)
                                        : make_atlas(coarse->mesh, settings.texture_size);
  if (!charts) return charts.error();
  remark(settings, distortion_remark(*charts));
  remark(settings, too_coarse_remark(settings.relief, charts->wide_m, settings.texture_size));

  const auto thin = find_thin_features(full->mesh, full_tree, thin_texels * charts->texel_m, threads, monitor);
  if (!thin) return cancelled();
  remark(settings, thin_remark(*thin, thin_texels * charts->texel_m));

  if (!monitor.begin("project")) return cancelled();
  const double range = std::max(range_per_cage * cage_m, least_range_in_diagonals * diagonal);
  auto projected = project(
      coarse->mesh, *charts, crease_normals(coarse->mesh, full_tree, least_band_texels * charts->texel_m), full_tree,
      range, settings.texture_size, threads, monitor, settings.relief ? &added : nullptr, settings.texels);
  if (!projected) return projected.error();

  if (!monitor.begin("pieces")) return cancelled();
  auto pieces = settings.pieces ? decompose_into(coarse->mesh, *settings.pieces, monitor)
                                : decompose(coarse->mesh, piece_limits{}, monitor);
  if (!pieces) return pieces.error();

  if (settings.pieces && pieces->size() != *settings.pieces)
    remark(settings, "made " + std::to_string(pieces->size()) + " convex pieces, not the " +
                         std::to_string(*settings.pieces) + " asked for");
  const auto fit = measure_fit(coarse->mesh, *pieces, fit_spacing_in_diagonals * diagonal, monitor, threads);
  if (!fit) return cancelled();

  // What the textured surface should be: the mesh, or the mesh with its relief.
  const triangle_mesh raised = settings.relief ? raise(added, charts->texel_m, monitor) : triangle_mesh{};
  if (monitor.cancelled()) return cancelled();
  std::optional<triangle_bvh> raised_tree;
  if (settings.relief) raised_tree.emplace(raised.positions, raised.triangles, threads, &monitor);
  if (monitor.cancelled()) return cancelled();
  const triangle_mesh& original = settings.relief ? raised : full->mesh;
  const triangle_bvh& original_tree = raised_tree ? *raised_tree : full_tree;

  textured_model out;
  out.name = settings.name;
  out.mesh = with_uvs(coarse->mesh, *charts);
  out.texture = std::move(projected->texture);
  stitch(out.mesh, original_tree, widest_gap_texels * charts->texel_m, out.texture, threads, &monitor);
  if (monitor.cancelled()) return cancelled();
  out.pieces = std::move(*pieces);
  out.mass = compute_mass_properties(out.mesh);
  out.box = bounds_of(out.mesh.positions);

  if (!monitor.begin("measure")) return cancelled();
  const auto errors = measure(original, original_tree, out.mesh, out.texture, charts->texel_m, threads, monitor);
  if (!errors) return errors.error();
  out.report.rms_error_m = errors->rms_m();
  out.report.max_error_m = errors->max_m();
  out.report.peak_to_valley_m = projected->highest_m - projected->lowest_m;
  out.report.max_displacement_m = projected->max_displacement_m;
  out.report.full_triangles = full->mesh.triangles.size();
  out.report.fallback_texels = projected->fallback_texels;
  out.report.texels = projected->texels;
  out.report.quality = quality_of(*errors, *charts, texel_spacing(out.texture, projected->chart), *fit);
  return out;
}

}  // namespace asperity::bake
