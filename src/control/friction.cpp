#include "asperity/control/friction.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>

#include "control/bristle.hpp"

namespace asperity {

result<void> check(const friction_settings& s) {
  const auto bad = [](std::string what) { return error{error_code::invalid_argument, "friction: " + what}; };
  if (!(s.static_coefficient >= 0.0 && s.static_coefficient <= 10.0)) {
    return bad("static_coefficient must be from 0 to 10");
  }
  if (!(s.dynamic_coefficient >= 0.0 && s.dynamic_coefficient <= s.static_coefficient)) {
    return bad("dynamic_coefficient must be from 0 to static_coefficient");
  }
  if (!(std::isfinite(s.stribeck_m_per_s) && s.stribeck_m_per_s > 0.0)) {
    return bad("stribeck_m_per_s must be a finite speed above 0");
  }
  if (!(std::isfinite(s.stiffness_n_per_m) && s.stiffness_n_per_m > 0.0 && s.stiffness_n_per_m <= 1e8)) {
    return bad("stiffness_n_per_m must be above 0 and at most 1e8");
  }
  if (!(s.damping_s >= 0.0 && s.damping_s <= 0.1)) return bad("damping_s must be from 0 to 0.1");
  return {};
}

void friction::forget() noexcept {
  for (const bristle& b : bristles_) energy_.lost_j += b.stored_j;
  bristles_.clear();
  energy_.stored_j = 0.0;
  on_probe_w_ = {};
  slips_ = leaves_out_ = false;
}

void friction::forget(std::uint32_t body) noexcept {
  std::size_t kept = 0;
  for (const bristle& b : bristles_) {
    if (b.body == body) {
      energy_.lost_j += b.stored_j;
      energy_.stored_j -= b.stored_j;
    } else {
      bristles_[kept++] = b;
    }
  }
  bristles_.truncate(kept);
}

void friction::find_bodies(const support_planes& planes, const contact_solution& by, const contact_laws& laws,
                           std::span<const body_velocity> carried) noexcept {
  leaves_out_ = false;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    if (!(by.lambda_n[i] > 0.0)) continue;
    const std::uint32_t body = planes[i].body;
    const auto [at_rest, slipping] = coefficients(planes[i], laws);
    if (!(at_rest > 0.0) ||
        std::any_of(bristles_.begin(), bristles_.end(), [&](const bristle& b) { return b.body == body; })) {
      continue;
    }
    if (!bristles_.push_back({.body = body, .static_coefficient = at_rest, .dynamic_coefficient = slipping})) {
      leaves_out_ = true;
    }
  }
  for (bristle& b : bristles_) b.carried = velocity_of(carried, b.body);
}

friction::coefficients_of_plane friction::coefficients(const support_plane& p,
                                                       const contact_laws& laws) const noexcept {
  const surface_pair* const pair = laws.pair(p);
  if (pair == nullptr) return {settings_.static_coefficient, settings_.dynamic_coefficient};
  return {pair->static_friction, pair->dynamic_friction};
}

void friction::take_mean(bristle& b, const support_planes& planes,
                         const std::array<double, most_support_planes>& force_n,
                         const contact_laws& laws) const noexcept {
  b.static_coefficient = b.dynamic_coefficient = 0.0;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    if (planes[i].body != b.body || !(force_n[i] > 0.0)) continue;
    const auto [at_rest, slipping] = coefficients(planes[i], laws);
    b.static_coefficient += force_n[i] / b.normal_n * at_rest;
    b.dynamic_coefficient += force_n[i] / b.normal_n * slipping;
  }
}

void friction::measure(const support_planes& planes, const contact_solution& by, const vec6& v, double h_s,
                       const contact_laws& laws) noexcept {
  std::array<double, most_support_planes> force_n;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const vec3& slope = planes[i].gradient.linear;
    force_n[i] = by.lambda_n[i] * std::sqrt(glm::dot(slope, slope));
  }
  for (bristle& b : bristles_) {
    b.normal_n = 0.0;
    b.metric = {};
    for (std::size_t i = 0; i < planes.size(); ++i) b.normal_n += planes[i].body == b.body ? force_n[i] : 0.0;
    if (!(b.normal_n > 0.0)) continue;
    for (std::size_t i = 0; i < planes.size(); ++i) {
      if (planes[i].body != b.body || !(force_n[i] > 0.0)) continue;
      detail::add_point(b.metric, force_n[i] / b.normal_n, planes[i]);
      b.on_map = b.on_map || planes[i].of_probe != 0 || planes[i].of_body != 0;
    }
    if (b.on_map) take_mean(b, planes, force_n, laws);
    b.held = detail::held_in(b.metric, b.stretch, b.stored_j, settings_.stiffness_n_per_m);
    b.theta = detail::share_held(settings_, b.metric, b.held, v - b.carried, h_s, b.theta, b.normal_n,
                                 b.static_coefficient, b.dynamic_coefficient);
  }
}

void friction::settle(double h_s, const vec6& v) noexcept {
  const double k = settings_.stiffness_n_per_m;
  on_probe_w_ = {};
  slips_ = false;
  double stored_j = 0.0;
  std::size_t kept = 0;
  for (bristle& b : bristles_) {
    if (!(b.normal_n > 0.0)) {
      energy_.lost_j += b.stored_j;
      continue;
    }
    const vec6 slide = v - b.carried;
    b.stretch = b.theta * (b.held + h_s * slide);
    const vec6 f = -k * (b.metric * (b.stretch + (b.theta * settings_.damping_s) * slide));
    b.on_probe_w = to_wrench(f);
    on_probe_w_ += b.on_probe_w;
    energy_.from_bodies_j += h_s * dot(f, b.carried);
    slips_ = slips_ || b.theta < 1.0;
    b.stretch = detail::without_rest(b.metric, b.stretch);
    const double now_j = 0.5 * k * detail::squared(b.metric, b.stretch);
    energy_.lost_j += b.stored_j - h_s * dot(f, slide) - now_j;
    b.stored_j = now_j;
    stored_j += now_j;
    if (b.carried.angular != vec3(0.0)) {  // z is the body's, and turns with it
      const quat turned = exp_rotation(h_s * b.carried.angular);
      b.stretch = {turned * b.stretch.linear, turned * b.stretch.angular};
    }
    bristles_[kept++] = b;
  }
  bristles_.truncate(kept);
  energy_.stored_j = stored_j;
}

contact_solution friction::solve(mat6& a, const vec6& load, const vec6& v0, double h_s, const support_planes& planes,
                                 const vec6& moved, const contact_laws& laws,
                                 std::span<const body_velocity> carried) noexcept {
  constexpr int most_passes = 4;
  const double k = settings_.stiffness_n_per_m, horizon_s = h_s + settings_.damping_s;
  contact_solution out = solve_contact(a, load, v0, h_s, planes, moved, laws);
  if (!out.solved) return out;
  mat6 with;
  for (int pass = 0; pass < most_passes; ++pass) {
    find_bodies(planes, out, laws, carried);
    if (bristles_.empty()) return out;
    measure(planes, out, pass == 0 ? v0 : out.velocity, h_s, laws);
    with = a;
    vec6 pulled = load;
    for (const bristle& b : bristles_) {
      if (!(b.normal_n > 0.0)) continue;
      const mat6 spring = (b.theta * k) * b.metric;
      with += horizon_s * spring;
      pulled = pulled - spring * (b.held + horizon_s * (v0 - b.carried));
    }
    out = solve_contact(with, pulled, v0, h_s, planes, moved, laws);
    if (!out.solved) return out;
  }
  a = with;
  return out;
}

}  // namespace asperity
