#include "job_writer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace asperity::gl {

using detail::hit;
using detail::layer;
using detail::projected_triangle;
using detail::sample_grid;
using detail::window_map;

namespace {

/// The part of both rasters that a central difference needs to know beforehand.
struct overlap {
  bool any = false, any_b = false;
  double half_width_m = 0.0;  ///< as deepest_sample::half_width_m
};

overlap overlap_of(const detail::height_field& a, const detail::height_field& b, const sample_grid& grid) noexcept {
  overlap out;
  for (std::size_t row = 0, i = 0; row < grid.side; ++row) {
    for (std::size_t column = 0; column < grid.side; ++column, ++i) {
      if (b.kind[i] == hit::none) continue;
      out.any_b = true;
      if (a.kind[i] == hit::none) continue;
      out.any = true;
      const double u = std::fabs(grid.coordinate(column)), v = std::fabs(grid.coordinate(row));
      out.half_width_m = std::max(out.half_width_m, std::max(u, v) + 0.5 * grid.pitch_m);
    }
  }
  return out;
}

/// A texel near the samples of a triangle, so that positions counted from it are small.
glm::ivec2 base_texel(const projected_triangle& t, double half_m) noexcept {
  const vec3 middle = (t.corner[0] + t.corner[1] + t.corner[2]) / 3.0;
  const double u = std::clamp(middle.x, -half_m, half_m), v = std::clamp(middle.y, -half_m, half_m);
  const auto whole = [](double x) { return static_cast<int>(std::clamp(std::floor(x), -1e6, 1e6)); };
  return {whole(t.texel_x(u, v)), whole(t.texel_y(u, v))};
}

}  // namespace

job_writer::job_writer(scene s, const window_depth_settings& settings)
    : scene_(std::move(s)),
      settings_(settings),
      a_(std::size_t{settings.grid} * settings.grid, most_triangles(0, 1)),
      b_(std::size_t{settings.grid} * settings.grid, most_triangles(1, scene_.fixed.size() + 1)) {
  indices_.emplace_back(*scene_.probe);
  const detail::texture_scale probe = measure_texture(*scene_.probe, indices_.front());
  for (const model_ptr& model : scene_.fixed) {
    indices_.emplace_back(*model);
    pairs_.push_back(scale_of(settings_, probe, measure_texture(*model, indices_.back()),
                              std::min(scene_.probe->box.diagonal(), model->box.diagonal())));
  }
}

std::size_t job_writer::most_triangles(std::size_t first, std::size_t end) const noexcept {
  std::size_t most = 0;
  for (std::size_t i = first; i < end; ++i) most = std::max(most, body(i).mesh.triangles.size());
  return most;
}

bool job_writer::add(number_list& numbers, integer_list& integers, const contact& c,
                     std::span<const std::uint32_t> patch_a, std::span<const std::uint32_t> patch_b, const pose& T_wa,
                     const pose& T_wb, contact_jobs& place) noexcept {
  const contact_window& window = c.window;
  if (!(window.half_size_m > 0.0) || !std::isfinite(window.half_size_m)) return false;
  const sample_grid grid(settings_.grid, window.half_size_m);
  const std::size_t fixed = std::size_t{c.body} + 1;
  const window_map map_a(window, T_wa), map_b(window, T_wb);
  project(a_, 0, patch_a, map_a, layer::highest, grid);
  project(b_, fixed, patch_b, map_b, layer::lowest, grid);
  const bool differences = settings_.gradient == gradient_scheme::central_difference;
  const overlap shared = overlap_of(a_.field, b_.field, grid);
  if (!shared.any && !(differences && shared.any_b)) return false;

  const bool tapers = !differences && settings_.taper_silhouettes;
  if (tapers) {
    const double width = taper_width(grid);
    a_.taper.prepare(a_.patch, indices_.front(), map_a, layer::highest, grid, width, settings_.facing_cosine);
    b_.taper.prepare(b_.patch, indices_[fixed], map_b, layer::lowest, grid, width, settings_.facing_cosine);
  }
  written b = write(b_, fixed, map_b, layer::lowest, grid, numbers, integers);
  written a = write(a_, 0, map_a, layer::highest, grid, numbers, integers);
  if (tapers) {
    write_edges(a_, grid.half_m, numbers, a);
    write_edges(b_, grid.half_m, numbers, b);
  }
  const auto write_job = [&](std::size_t job, const written& probe, const pose& T, bool all_of_b) {
    integers.set(job, job::header, numbers.used());
    integers.set(job, job::triangles_a, probe.numbers);
    integers.set(job, job::triangle_integers_a, probe.integers);
    integers.set(job, job::triangles_b, b.numbers);
    integers.set(job, job::triangle_integers_b, b.integers);
    integers.set(job, job::owners_a, probe.owners);
    integers.set(job, job::owners_b, b.owners);
    integers.set(job, job::edges, probe.edges);
    integers.set(job, job::edge_count_a, probe.edge_count);
    integers.set(job, job::edge_count_b, b.edge_count);
    integers.set(job, job::all_of_b, all_of_b ? 1 : 0);
    write_header(c, T, T_wb, numbers);
  };
  write_job(place.first_job, a, T_wa, differences);
  if (!differences) return true;

  if (!shared.any) {
    for (std::uint32_t k = 1; k < jobs_per_contact(); ++k) integers.copy_job(place.first_job, place.first_job + k);
    return true;
  }
  place.step_m = detail::difference_step(settings_, pairs_[c.body], grid.pitch_m);
  place.step_rad = place.step_m / shared.half_width_m;
  std::array<pose, asked_poses::count> around;
  static_cast<void>(detail::central_difference(window, T_wa, centre_of_mass_w(scene_, T_wa), rotation_origin_w(c, T_wa),
                                               0.0, place.step_m, place.step_rad, asked_poses{&around, nullptr}));
  for (std::uint32_t k = 0; k < asked_poses::count; ++k) {
    const window_map map(window, around[k]);
    project(a_, 0, patch_a, map, layer::highest, grid);
    const written moved = write(a_, 0, map, layer::highest, grid, numbers, integers);
    write_job(place.first_job + 1 + k, moved, around[k], false);
  }
  return true;
}

void job_writer::project(side& s, std::size_t body_index, std::span<const std::uint32_t> patch, const window_map& map,
                         layer which, const sample_grid& grid) noexcept {
  s.patch.project(body(body_index).mesh, indices_[body_index], patch, map, which, settings_.facing_cosine);
  rasterise(s.patch, grid, which, s.field);
}

job_writer::written job_writer::write(const side& s, std::size_t body_index, const window_map& map, layer which,
                                      const sample_grid& grid, number_list& numbers,
                                      integer_list& integers) const noexcept {
  written out{.numbers = numbers.used(), .integers = integers.used()};
  for (const projected_triangle& t : s.patch.triangles()) {
    write_triangle(s, t, body_index, map, which, grid.half_m, numbers, integers);
  }
  out.owners = integers.used();
  const auto owner = [&](std::size_t i) -> std::uint32_t {
    return i < grid.size() && s.field.kind[i] != hit::none ? s.field.owner[i] : std::uint32_t{job::no_owner};
  };
  for (std::size_t i = 0; i < grid.size(); i += 2) {
    integers.add(static_cast<std::int32_t>(owner(i) | owner(i + 1) << 16));
  }
  return out;
}

void job_writer::write_triangle(const side& s, const projected_triangle& t, std::size_t body_index,
                                const window_map& map, layer which, double half_m, number_list& numbers,
                                integer_list& integers) const noexcept {
  const detail::surface_index& index = indices_[body_index];
  const glm::ivec2 base = base_texel(t, half_m);
  const auto add = [&](const detail::affine& f, double shift, double unit) {
    numbers.add((f.at_centre - shift) / unit);
    numbers.add(f.per_u * half_m / unit);
    numbers.add(f.per_v * half_m / unit);
  };
  add(t.texel_x, base.x, 1.0);
  add(t.texel_y, base.y, 1.0);
  add(t.height, 0.0, half_m);
  const detail::texel_triangle& chart = index.texels[t.triangle];
  for (std::size_t k = 0; k < 3; ++k) {
    const vec3& w = chart.weight[k];
    numbers.add_vector(chart.altitude[k] * vec3(w.x + w.y * base.x + w.z * base.y, w.y, w.z));
  }
  for (const double altitude : chart.altitude) numbers.add(altitude);
  for (const vec3& corner : t.corner) numbers.add_vector(vec2(corner) / half_m);
  const detail::facing_weight facing{settings_.facing_cosine};
  const bool tapers = settings_.gradient == gradient_scheme::soft_max && settings_.taper_silhouettes;
  const double weight = tapers ? facing.value(t.facing) : 1.0;
  numbers.add(weight);
  const bool turns = tapers && settings_.taper_gradient && weight > 0.0;
  numbers.add_vector(turns ? s.taper.facing_turn(t, index, map, which) / weight : vec3(0.0));

  integers.add(base.x);
  integers.add(base.y);
  for (const std::uint32_t beyond : index.neighbour[t.triangle]) {
    const projected_triangle* const next = s.patch.find(beyond);
    integers.add(next == nullptr ? -1 : static_cast<std::int32_t>(next - s.patch.triangles().data()));
  }
}

void job_writer::write_edges(const side& s, double half_m, number_list& numbers, written& to) const noexcept {
  to.edges = numbers.used();
  to.edge_count = s.taper.edges().size();
  for (const detail::taper_edge& e : s.taper.edges()) {
    numbers.add_vector(e.from / half_m);
    numbers.add_vector(e.to / half_m);
    numbers.add(e.strength);
    numbers.add_vector(e.strength_turn);
  }
}

void job_writer::write_header(const contact& c, const pose& T_wa, const pose& T_wb,
                              number_list& numbers) const noexcept {
  const double half = c.window.half_size_m;
  for (const pose* T : {&T_wa, &T_wb}) {
    const window_map map(c.window, *T);
    for (const vec3& axis : {map.u_b, map.v_b, map.n_b}) numbers.add_vector(axis / half);
    const vec3 centre_b = glm::conjugate(T->rotation) * (c.window.centre_w - T->position);
    const vec3 near(numbers.rounded(centre_b.x), numbers.rounded(centre_b.y), numbers.rounded(centre_b.z));
    numbers.add_vector(near);
    const vec3 rest = centre_b - near;
    numbers.add_vector(vec3(glm::dot(map.u_b, rest), glm::dot(map.v_b, rest), glm::dot(map.n_b, rest)) / half);
  }
  numbers.add(pairs_[c.body].tau_m / half);
  numbers.add(taper_width(sample_grid(settings_.grid, half)) / half);
}

}  // namespace asperity::gl
