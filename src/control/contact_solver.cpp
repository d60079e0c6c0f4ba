#include "asperity/control/contact_solver.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>

#include "core/cholesky.hpp"

namespace asperity {

namespace {

/// The planes as one step sees them: x_i = d_i + h_i (g_i . v + c_i) is the depth that plane i answers to at the
/// velocity v, c_i the approach of its body.
template <std::size_t Most>
struct plane_rows {
  std::size_t count = 0;
  std::array<double, Most> stiffness_n_per_m{};  // k_i
  std::array<double, Most> horizon_s{};          // h_i
  std::array<double, Most> depth_m{};            // x_i
  std::array<double, Most> change_m{};           // of x_i by the step that is tried
};

/// Where along a step the potential is least: its slope there is the sum of p0 + p1 t and of each pressed plane's part,
/// which is linear between the places where a plane begins or ceases to be pressed.
template <std::size_t Most>
[[nodiscard]] double least_along(const plane_rows<Most>& rows, double p0, double p1) noexcept {
  double from = 0.0;
  for (std::size_t piece = 0; piece <= rows.count; ++piece) {
    double at_zero = p0;
    double rate = p1;
    double until = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < rows.count; ++i) {
      const double x = rows.depth_m[i];
      const double dx = rows.change_m[i];
      const double turns = dx != 0.0 ? -x / dx : -1.0;
      if (turns > from) until = std::min(until, turns);
      const bool pressed = dx > 0.0 ? turns <= from : (dx < 0.0 ? turns > from : x > 0.0);
      if (!pressed) continue;
      const double slope = rows.stiffness_n_per_m[i] * dx / rows.horizon_s[i];
      at_zero += slope * x;
      rate += slope * dx;
    }
    const double least = -at_zero / rate;
    if (!(least > until)) return std::max(from, least);
    from = until;
  }
  return from;
}

// The velocity, and with which depths the planes answer to it. @param out what is known of the solution without forces
template <std::size_t Most>
[[nodiscard]] bool solve_rows(const mat6& a, const vec6& load, const vec6& v0, double h_s,
                              std::span<const support_plane> planes, const vec6& moved, const contact_laws& laws,
                              bool moves, plane_rows<Most>& rows, contact_solution& out) noexcept {
  constexpr double tolerance_n = 1e-9;
  vec6 v = v0;
  rows.count = std::min(planes.size(), Most);
  for (std::size_t i = 0; i < rows.count; ++i) {
    const double d = planes[i].depth_m + dot(planes[i].gradient, moved);
    const double alpha = moves ? laws.dissipation_s_per_m(planes[i]) : 0.0;
    out.deepest_m = std::max(out.deepest_m, d);
    rows.stiffness_n_per_m[i] = laws.stiffness_n_per_m(planes[i]);
    rows.horizon_s[i] = h_s + 1.5 * alpha * std::max(0.0, d);
    rows.depth_m[i] = d + rows.horizon_s[i] * dot(planes[i].gradient, v);
    if (moves) rows.depth_m[i] += rows.horizon_s[i] * planes[i].closing_m_per_s;
  }
  for (;;) {
    ++out.passes;
    mat6 curvature = a;
    const vec6 imbalance = a * (v - v0) - load;
    vec6 slope = imbalance;
    for (std::size_t i = 0; i < rows.count; ++i) {
      if (!(rows.depth_m[i] > 0.0)) continue;
      const double k = rows.stiffness_n_per_m[i];
      add_outer(curvature, k * rows.horizon_s[i], planes[i].gradient);
      slope += (k * rows.depth_m[i]) * planes[i].gradient;
    }
    const cholesky6 factors(curvature);
    if (!factors.positive()) return false;
    const vec6 step = -1.0 * factors.solve(slope);
    // A full step is exact where no plane changes between pressed and free.
    out.residual_n = 0.0;
    for (std::size_t i = 0; i < rows.count; ++i) {
      const double x = rows.depth_m[i];
      rows.change_m[i] = rows.horizon_s[i] * dot(planes[i].gradient, step);
      const double end = x + rows.change_m[i];
      const double supposed = x > 0.0 ? end : 0.0;
      out.residual_n = std::max(out.residual_n, rows.stiffness_n_per_m[i] * std::fabs(std::max(0.0, end) - supposed));
    }
    const bool done = out.residual_n <= tolerance_n || out.passes >= laws.usual.most_passes;
    const double part = done ? 1.0 : least_along(rows, dot(step, imbalance), dot(step, a * step));
    v += part * step;
    for (std::size_t i = 0; i < rows.count; ++i) rows.depth_m[i] += part * rows.change_m[i];
    if (done) break;
  }
  out.velocity = v;
  return true;
}

[[nodiscard]] contact_solution solve_planes(const mat6& a, const vec6& load, const vec6& v0, double h_s,
                                            const support_planes& planes, const vec6& moved, const contact_laws& laws,
                                            bool moves) noexcept {
  contact_solution out;
  plane_rows<most_support_planes> rows;
  out.solved = solve_rows(a, load, v0, h_s, {planes.data(), planes.size()}, moved, laws, moves, rows, out);
  if (!out.solved) return out;
  vec6 pushed;
  for (std::size_t i = 0; i < rows.count; ++i) {
    out.lambda_n[i] = rows.stiffness_n_per_m[i] * std::max(0.0, rows.depth_m[i]);
    pushed = pushed - out.lambda_n[i] * planes[i].gradient;
    out.from_bodies_w += out.lambda_n[i] * planes[i].closing_m_per_s;
  }
  out.on_probe_w = to_wrench(pushed);
  return out;
}

}  // namespace

contact_solution solve_contact(const mat6& a, const vec6& load, const vec6& v0, double h_s,
                               const support_planes& planes, const vec6& moved, const contact_laws& laws) noexcept {
  return solve_planes(a, load, v0, h_s, planes, moved, laws, true);
}

contact_solution balance_of(const mat6& springs, const vec6& pull, const support_planes& planes, const vec6& moved,
                            const contact_laws& laws) noexcept {
  // A step of one second with the springs in the place of the mass.
  return solve_planes(springs, pull, {}, 1.0, planes, moved, laws, false);
}

std::optional<vec6> way_to_balance(const mat6& springs, const vec6& pull, std::span<const support_plane> planes,
                                   const contact_laws& laws) noexcept {
  contact_solution out;
  plane_rows<most_balanced_planes> rows;
  const bool solved = solve_rows(springs, pull, {}, 1.0, planes, {}, laws, false, rows, out);
  return solved && is_finite(out.velocity) ? std::optional(out.velocity) : std::nullopt;
}

}  // namespace asperity
