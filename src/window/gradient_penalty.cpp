#include "asperity/window/gradient_penalty.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "window/direction_sameness.hpp"

namespace asperity {
namespace {

// A NaN stays one, to be reported.
double pressed_m(const penetration& p, depth_value value) noexcept {
  const double d = value == depth_value::soft ? p.soft_depth_m : p.depth_m;
  return d <= 0.0 || has(p.flags, depth_flag::no_overlap) ? 0.0 : d;
}

}  // namespace

status gradient_penalty::accumulate(const scene_pose&, const contact_set& contacts, std::span<const penetration> depths,
                                    force_report& out) const noexcept {
  out = {.by_body = out.by_body, .by_contact = out.by_contact};
  const detail::direction_sameness sameness(settings_.same_direction_rad, settings_.other_direction_rad);
  const auto depth = [this](const penetration& p) noexcept { return pressed_m(p, settings_.value); };
  const auto share_mass = [&](const penetration& p) noexcept { return p.area_m2 * depth(p) * depth(p); };
  if (depths.size() < contacts.size()) return status::not_ready;
  const std::span<const contact> list = contacts.contacts();
  contact_force sum;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const penetration& p = depths[i];
    if (!std::isfinite(depth(p)) || !std::isfinite(p.area_m2) || !is_finite(p.gradient)) return status::not_finite;
    const double own = share_mass(p);
    if (!(own > 0.0)) continue;
    double all = 0.0;
    for (std::size_t j = 0; j < list.size(); ++j) {
      if (list[j].body == list[i].body) {
        all += sameness(list[i].window.n_ab_w, list[j].window.n_ab_w) * share_mass(depths[j]);
      }
    }
    const double k = settings_.stiffness_n_per_m * own / all;
    const wrench push = to_wrench(-k * depth(p) * p.gradient);
    sum.on_probe_w += push;
    if (list[i].body < out.by_body.size()) out.by_body[list[i].body] += push;
    if (i < out.by_contact.size()) out.by_contact[i] = push;
    add_outer(sum.stiffness, -k, p.gradient);
    sum.stiffness += -k * depth(p) * p.curvature;
  }
  if (!is_finite(sum.on_probe_w)) return status::not_finite;
  for (const double x : sum.stiffness.m) {
    if (!std::isfinite(x)) return status::not_finite;
  }
  out = {sum, list, depths.first(list.size()), out.by_body,
         out.by_contact.first(std::min(out.by_contact.size(), list.size()))};
  return status::ok;
}

}  // namespace asperity
