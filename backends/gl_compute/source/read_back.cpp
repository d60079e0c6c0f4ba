#include "read_back.hpp"

#include <array>
#include <cmath>

#include "window/height_lookup.hpp"

namespace asperity::gl {
namespace {

constexpr std::size_t moments = 5;  // u, v; about u, v, n: the component along n is always 1

/// The groups of one job put together. Lengths in half sizes of the window.
struct job_sum {
  double depth = 0.0, inner_depth = 0.0;
  std::size_t index = 0;
  vec2 texel{0.0};
  std::uint32_t samples = 0, inner_samples = 0;
  bool bad_texel = false;
};

struct group_view {
  const number_list& results;
  std::size_t at;
  [[nodiscard]] double operator()(int what) const noexcept { return results[at + static_cast<std::size_t>(what)]; }
  [[nodiscard]] std::uint32_t count(int what) const noexcept { return static_cast<std::uint32_t>((*this)(what)); }
};

group_view group_of(const number_list& results, std::size_t groups, std::size_t job, std::size_t group) noexcept {
  return {results, (job * groups + group) * static_cast<std::size_t>(job::result_numbers)};
}

job_sum sum_of(const number_list& results, std::size_t groups, std::size_t job,
               const detail::sample_grid& grid) noexcept {
  job_sum out;
  double best_radius = 0.0;
  for (std::size_t g = 0; g < groups; ++g) {
    const group_view v = group_of(results, groups, job, g);
    out.bad_texel = out.bad_texel || v(job::bad) > 0.0;
    if (v.count(job::inner_samples) > 0 && (out.inner_samples == 0 || v(job::inner_depth) > out.inner_depth)) {
      out.inner_depth = v(job::inner_depth);
    }
    out.inner_samples += v.count(job::inner_samples);
    if (v.count(job::samples) == 0) continue;
    const auto index = static_cast<std::size_t>(v(job::index));
    const vec2 at = grid.position(index);
    const double depth = v(job::depth), radius = glm::dot(at, at);
    // Groups come in the order of their samples, so of equals the first has the lowest index.
    if (out.samples == 0 || depth > out.depth || (depth == out.depth && radius < best_radius)) {
      out.depth = depth;
      out.index = index;
      out.texel = vec2(v(job::base), v(job::base + 1)) + vec2(v(job::texel), v(job::texel + 1));
      best_radius = radius;
    }
    out.samples += v.count(job::samples);
  }
  return out;
}

/// Sums of the soft maximum in half sizes of the window; false where no sample has any weight.
bool soft_sums(const number_list& results, std::size_t groups, std::size_t job, double tau, double& top,
               std::array<double, job::soft_sums>& sums) noexcept {
  top = -1e30;
  for (std::size_t g = 0; g < groups; ++g) top = std::max(top, group_of(results, groups, job, g)(job::top));
  if (!(top > -1e30)) return false;
  sums = {};
  for (std::size_t g = 0; g < groups; ++g) {
    const group_view v = group_of(results, groups, job, g);
    const double scale = std::exp((v(job::top) - top) / tau);
    if (!(scale > 0.0)) continue;
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += scale * v(job::sums + static_cast<int>(k));
  }
  return sums[0] > 0.0;
}

/// Gradient and curvature in the window's axes, about its centre, become those in world axes about the centre of mass.
struct transport {
  const contact_window& window;
  vec3 lever;  ///< from the centre of mass to the window's centre

  [[nodiscard]] vec6 operator()(const vec6& g) const noexcept {
    const vec3 linear = detail::direction_to_world(window, g.linear);
    return {linear, detail::direction_to_world(window, g.angular) + glm::cross(lever, linear)};
  }
  /// L C L^T, its upper half mirrored so that it is symmetric to the bit.
  [[nodiscard]] mat6 operator()(const mat6& c) const noexcept {
    mat6 half{};  // L C
    for (std::size_t j = 0; j < 6; ++j) {
      const vec6 column = (*this)(vec6{{c(0, j), c(1, j), c(2, j)}, {c(3, j), c(4, j), c(5, j)}});
      for (std::size_t i = 0; i < 6; ++i) half(i, j) = column[i];
    }
    mat6 out{};
    for (std::size_t i = 0; i < 6; ++i) {
      const vec6 row = (*this)(vec6{{half(i, 0), half(i, 1), half(i, 2)}, {half(i, 3), half(i, 4), half(i, 5)}});
      for (std::size_t j = i; j < 6; ++j) out(i, j) = out(j, i) = row[j];
    }
    return out;
  }
};

bool soften(penetration& to, const number_list& results, std::size_t groups, std::size_t job,
            const detail::sample_grid& grid, const detail::pair_scale& pair, const transport& to_world) noexcept {
  double top = 0.0;
  std::array<double, job::soft_sums> sums{};
  const double half = grid.half_m;
  if (!soft_sums(results, groups, job, pair.tau_m / half, top, sums)) return false;
  to.soft_depth_m = half * top + pair.tau_m * std::log(sums[0] * grid.cell_m2() / pair.reference_area_m2);
  // Arms are in half sizes of the window.
  constexpr std::array<std::size_t, moments> place{0, 1, 3, 4, 5};
  std::array<double, moments> mean{};
  vec6 gradient{{0.0, 0.0, 1.0}, vec3(0.0)};
  mat6 curvature{};
  std::size_t k = 1 + moments;
  for (std::size_t i = 0; i < moments; ++i) {
    const double unit_i = i < 2 ? 1.0 : half;
    mean[i] = sums[1 + i] / sums[0];
    gradient[place[i]] = unit_i * mean[i];
    for (std::size_t j = 0; j <= i; ++j) {
      const double unit = unit_i * (j < 2 ? 1.0 : half);
      const double covariance = unit * (sums[k++] / sums[0] - mean[i] * mean[j]) / pair.tau_m;
      curvature(place[i], place[j]) = curvature(place[j], place[i]) = covariance;
    }
  }
  to.gradient = to_world(gradient);
  to.curvature = to_world(curvature);
  return true;
}

}  // namespace

penetration read_back(const job_writer& writer, const number_list& results, std::size_t groups,
                      const contact_jobs& place, const contact& c, const pose& T_wa) noexcept {
  const detail::sample_grid grid(writer.settings().grid, c.window.half_size_m);
  const detail::pair_scale& pair = writer.pair(c.body);
  const double half = grid.half_m;
  const job_sum here = sum_of(results, groups, place.first_job, grid);
  const depth_flag texels = here.bad_texel ? depth_flag::bad_texel : depth_flag::none;
  const penetration nothing{.flags = depth_flag::no_overlap | texels};
  if (here.samples == 0) return nothing;
  penetration out{.flags = texels};
  out.depth_m = half * here.depth;
  out.samples = here.samples;
  out.area_m2 = here.samples * grid.cell_m2();
  const detail::window_map map_a(c.window, T_wa);
  out.witness_w =
      detail::to_world(c.window, map_a.point(detail::read(writer.bodies().probe->texture, here.texel).point));
  if (here.inner_samples == 0 || out.depth_m > half * here.inner_depth + 0.1 * pair.tau_m) {
    out.flags |= depth_flag::window_too_small;
  }
  const vec3 centre_w = centre_of_mass_w(writer.bodies(), T_wa);
  if (writer.settings().gradient == gradient_scheme::soft_max) {
    const bool found =
        soften(out, results, groups, place.first_job, grid, pair, {c.window, c.window.centre_w - centre_w});
    return found ? out : nothing;
  }
  std::array<std::optional<double>, asked_poses::count> answers;
  for (std::size_t k = 0; k < answers.size(); ++k) {
    const job_sum moved = sum_of(results, groups, place.first_job + 1 + k, grid);
    if (moved.samples > 0) answers[k] = half * moved.depth;
  }
  out.soft_depth_m = out.depth_m;
  out.gradient = detail::central_difference(c.window, T_wa, centre_w, writer.rotation_origin_w(c, T_wa), out.depth_m,
                                            place.step_m, place.step_rad, asked_poses{nullptr, &answers});
  return out;
}

}  // namespace asperity::gl
