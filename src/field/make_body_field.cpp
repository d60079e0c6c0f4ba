#include "field/make_body_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "field/fill_distance.hpp"
#include "field/fine_surface.hpp"
#include "field/fit_relief.hpp"
#include "field/inside_columns.hpp"
#include "field/quick_read.hpp"
#include "field/threads.hpp"
#include "model/surface_index.hpp"
#include "model/texture_scale.hpp"

namespace asperity {
namespace {

using namespace detail;  // what a field is made of

/// A grid around a box.
coarse_grid lay_grid(const bounds& box, double margin_m, double pitch_m) {
  coarse_grid out;
  out.pitch_m = pitch_m;
  // Two nodes beyond the margin: the spline needs them. No round number: faces of a box must not lie in nodes.
  const double around = margin_m + 1.4142 * pitch_m;
  out.low = box.low - around;
  for (std::size_t k = 0; k < 3; ++k) {
    const int axis = static_cast<int>(k);
    out.nodes[k] = static_cast<std::size_t>(std::ceil((box.high[axis] - box.low[axis] + 2.0 * around) / pitch_m)) + 1;
  }
  return out;
}

double nodes_of(const coarse_grid& grid) noexcept {
  return static_cast<double>(grid.nodes[0]) * static_cast<double>(grid.nodes[1]) * static_cast<double>(grid.nodes[2]);
}

bounds box_of(const std::vector<fine_triangle>& surface) {
  bounds out{surface[0][0], surface[0][0]};
  for (const fine_triangle& t : surface) {
    for (const vec3& p : t) {
      out.low = glm::min(out.low, p);
      out.high = glm::max(out.high, p);
    }
  }
  return out;
}

double area_of(const std::vector<fine_triangle>& surface) {
  double out = 0.0;
  for (const fine_triangle& t : surface) out += 0.5 * glm::length(area_normal(t));
  return out;
}

/// Lays the smooth part's grid, with a pitch raised until it keeps to its nodes.
void lay_smooth(coarse_grid& out, const bounds& box, const field_settings& settings, double pitch_m) {
  const double margin = settings.margin_m > 0.0 ? settings.margin_m : 0.04 * box.diagonal();
  const vec3 around = box.high - box.low + 2.0 * margin;
  // From below, whatever was asked for: no count of nodes may overflow.
  pitch_m =
      std::max(pitch_m, 0.5 * std::cbrt(around.x * around.y * around.z / static_cast<double>(settings.most_nodes)));
  do {
    out = lay_grid(box, std::max(margin, 3.0 * pitch_m), pitch_m);
    pitch_m *= 1.02;
  } while (nodes_of(out) > static_cast<double>(settings.most_nodes));
}

/// Lays the relief's box of bricks, none of them made yet.
void lay_relief(body_field& out, const bounds& box, const field_settings& settings, double texel_m, double area_m2) {
  relief_bricks& fine = out.fine;
  fine.pitch_m = settings.relief_pitch_m;
  if (!(fine.pitch_m > 0.0)) {
    fine.pitch_m = out.smooth.pitch_m / 3.0;
    if (texel_m > 0.0) fine.pitch_m = std::min(fine.pitch_m, texel_m);
  }
  // About 2.6 layers of bricks along the surface.
  const double layers = 2.6 * static_cast<double>(sizeof(relief_bricks::brick)) / 16.0;
  fine.pitch_m = std::max(fine.pitch_m, std::sqrt(layers * area_m2 / static_cast<double>(settings.relief_bytes)));
  constexpr double most_places = 8e6;
  for (;; fine.pitch_m *= 1.02) {
    const double around = out.smooth.pitch_m + 4.0 * fine.pitch_m;
    const vec3 bricks = glm::ceil((box.high - box.low + 2.0 * around) / (relief_bricks::side * fine.pitch_m)) + 1.0;
    fine.low = box.low - around;
    if (bricks.x * bricks.y * bricks.z > most_places) continue;
    for (std::size_t k = 0; k < 3; ++k) fine.bricks_along[k] = static_cast<std::size_t>(bricks[static_cast<int>(k)]);
    return;
  }
}

/// Measures slopes at every second point of the fine surface, above and below it, and all over the blocks near it: beside
/// an edge no point of the surface lies straight below.
[[nodiscard]] slope_boxes measure_slopes(const relief_points& points, const body_field& of, unsigned threads) {
  constexpr std::array<double, 11> off_surface{0.0, -0.4, 0.2, -0.9, 0.7, -1.5, 1.3, -2.2, 2.1, -3.0, 3.0};  // pitches
  static_assert(off_surface.back() == body_field::slopes_to);
  constexpr std::size_t in_block = 4;  // along each axis
  const double farthest_m = body_field::slopes_to * of.smooth.pitch_m;
  // Boxes for each part, because a point's block may be any thread's; not more than memory is there for.
  const std::size_t parts = std::min(8U, threads);
  std::vector<slope_boxes> boxes(parts);
  for_each_task(parts, threads, [&](std::size_t part) {
    slope_boxes& out = boxes[part] = slope_boxes(of.smooth);
    const auto measure = [&](const vec3& p_b, const coarse_reading& at) {
      out.add(p_b, at.slope + of.relief(p_b, at).slope);
    };
    const auto add = [&](std::size_t n, const vec3& foot_b, const vec3& inwards) {
      if (n % 2 != 0) return;
      const vec3 p_b = foot_b + off_surface[n / 2 % off_surface.size()] * of.smooth.pitch_m * inwards;
      measure(p_b, quick_read(of.smooth, p_b).at);
    };
    points.for_each_foot(part_begin(points.points(), parts, part), part_begin(points.points(), parts, part + 1), add);
    const std::size_t end = part_begin(out.blocks(), parts, part + 1);
    for (std::size_t block = part_begin(out.blocks(), parts, part); block < end; ++block) {
      const vec3 middle_b = out.place_in(block, vec3(0.5));
      if (!(std::fabs(of.smooth.most_beside(of.smooth.clamped(middle_b))) < 2.0 * farthest_m)) continue;
      for (std::size_t n = 0; n < in_block * in_block * in_block; ++n) {
        const vec3 place(static_cast<double>(n % in_block), static_cast<double>(n / in_block % in_block),
                         static_cast<double>(n / (in_block * in_block)));
        const vec3 p_b = out.place_in(block, (place + 0.5) / static_cast<double>(in_block));
        const quick_reading q = quick_read(of.smooth, p_b);
        if (q.in_grid && std::fabs(q.at.value_m) < farthest_m) measure(p_b, q.at);
      }
    }
  });
  for (std::size_t i = 1; i < parts; ++i) boxes[0].add(boxes[i]);
  return std::move(boxes[0]);
}

}  // namespace

result<void> check_field_model(const textured_model& model, const field_settings& settings) {
  for (const double length : {settings.pitch_m, settings.relief_pitch_m, settings.margin_m}) {
    if (!(length >= 0.0 && std::isfinite(length))) {
      return error{error_code::invalid_argument,
                   "field settings: pitch_m, relief_pitch_m and margin_m must be finite lengths, or 0 for automatic"};
    }
  }
  if (settings.most_nodes < 10'000 || settings.relief_bytes < 100'000) {
    return error{error_code::invalid_argument,
                 "field settings: most_nodes must be 10000 or more, relief_bytes 100000 or more"};
  }
  const std::string& name = model.name;
  if (model.texture.width == 0 || model.texture.height == 0) {
    return error{error_code::bad_texture, "model \"" + name + "\" has no haptic texture; bake it first"};
  }
  const vec3 size = model.box.high - model.box.low;
  const double extent = std::max({size.x, size.y, size.z});
  if (model.mesh.triangles.empty() || !(extent > 0.0) || !std::isfinite(extent)) {
    return error{error_code::bad_mesh, "model \"" + name + "\" has no surface, or its box has no extent"};
  }
  return {};
}

result<body_field> make_body_field(const textured_model& model, const field_settings& settings) {
  if (const result<void> ok = check_field_model(model, settings); !ok) return ok.error();
  constexpr double piece_per_pitch = 0.75;  // longest edge of the pieces that distances are measured to
  const std::string& name = model.name;
  const unsigned threads = resolve_threads(settings.threads);
  const vec3 size = model.box.high - model.box.low;
  const double extent = std::max({size.x, size.y, size.z});

  body_field out;
  const double usual = extent / 96.0;
  std::vector<detail::fine_triangle> surface = detail::cut_fine_surface(model, piece_per_pitch * usual, threads);
  const bounds box = box_of(surface);
  detail::coarse_grid measured;
  lay_smooth(measured, box, {.margin_m = settings.margin_m}, usual);
  detail::axis_crossings crossings = detail::cross_lines(surface, measured, threads);
  out.thickness_m = detail::measure_thickness(crossings, measured);
  double pitch = settings.pitch_m;
  if (!(pitch > 0.0)) {
    pitch = usual;
    if (out.thickness_m > 0.0) pitch = std::min(pitch, out.thickness_m / 3.0);
  }
  lay_smooth(out.smooth, box, settings, pitch);
  pitch = out.smooth.pitch_m;
  if (out.thickness_m > 0.0 && out.thickness_m < 1.5 * pitch) {
    return error{error_code::limit_exceeded,
                 "model \"" + name + "\" has walls " + std::to_string(1e3 * out.thickness_m) +
                     " mm thick, and a grid that shows them needs more nodes than most_nodes = " +
                     std::to_string(settings.most_nodes) + "; raise most_nodes, or make the walls thicker"};
  }
  out.thinnest_resolved_m = 3.0 * pitch;
  if (pitch != measured.pitch_m) {
    surface = std::vector<detail::fine_triangle>();  // gives its memory back, as = {} does not
    surface = detail::cut_fine_surface(model, piece_per_pitch * pitch, threads);
    crossings = detail::cross_lines(surface, out.smooth, threads);
  }
  detail::fill_distance(surface, crossings, out.smooth, threads);
  crossings = {};

  if (std::none_of(out.smooth.value.begin(), out.smooth.value.end(), [](float d) { return d > 0.0F; })) {
    return error{error_code::bad_mesh, "model \"" + name +
                                           "\" has no inside that a grid shows; its triangles must go "
                                           "counter-clockwise seen from outside, around a volume"};
  }
  const double texel = detail::measure_texture(model, detail::surface_index(model)).texel_m;
  const double area_m2 = area_of(surface);
  lay_relief(out, box, settings, texel, area_m2);
  surface = std::vector<detail::fine_triangle>();
  const double step_m = 0.95 * out.fine.pitch_m;
  detail::relief_points points(out.fine, out);
  detail::for_each_task(2, threads, [&](std::size_t task) {
    if (task == 0) {
      points.take(model, step_m, 1.1 * area_m2 / (step_m * step_m), threads);
      detail::relief_fit(out.fine, points, 1e-6 * model.box.diagonal(), threads).solve();
    } else {
      out.most_third = detail::third_bounds(out.smooth);
    }
  });
  for (const detail::relief_bricks::brick& b : out.fine.bricks) {
    for (const float c : b) {
      out.lowest_relief_m = std::min(out.lowest_relief_m, static_cast<double>(c));
      out.highest_relief_m = std::max(out.highest_relief_m, static_cast<double>(c));
    }
  }
  out.most_relief = detail::relief_bounds(out.fine);
  out.slopes = measure_slopes(points, out, threads);
  return out;
}

}  // namespace asperity
