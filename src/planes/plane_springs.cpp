#include "asperity/planes/plane_springs.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "asperity/core/math.hpp"

namespace asperity {

result<void> check(const plane_spring_settings& s) {
  const auto bad = [](std::string what) { return error{error_code::invalid_argument, "plane springs: " + what}; };
  if (!(std::isfinite(s.stiffness_n_per_m) && s.stiffness_n_per_m >= 0.0)) {
    return bad("stiffness_n_per_m must be a finite number, 0 or more");
  }
  if (!(s.same_direction > 0.0 && s.same_direction < 1.0)) {
    return bad("same_direction must be a cosine between 0 and 1");
  }
  return {};
}

status plane_springs::accumulate(const near_samples&, std::span<const near_plane> planes,
                                 contact_force& out) const noexcept {
  out = {};
  group(planes);
  for (const near_plane& deepest : deepest_) {
    const support_plane& p = deepest.plane;
    if (!(p.depth_m > 0.0)) continue;
    out.on_probe_w += to_wrench((-settings_.stiffness_n_per_m * p.depth_m) * p.gradient);
    add_outer(out.stiffness, -settings_.stiffness_n_per_m, p.gradient);
  }
  return status::ok;
}

void plane_springs::describe(contact_set& contacts, std::span<penetration> depths) const noexcept {
  contacts.clear();
  for (const near_plane& deepest : deepest_) {
    const support_plane& p = deepest.plane;
    if (contacts.size() == depths.size()) return;
    penetration& d = depths[contacts.size()];
    d = {};
    d.depth_m = d.soft_depth_m = p.depth_m;
    d.gradient = p.gradient;
    d.samples = 1;
    d.witness_w = deepest.point_w;
    contact c;
    c.id = static_cast<std::uint32_t>(contacts.size());
    c.body = p.body;
    c.separation_m = -p.depth_m;
    c.p_a_w = c.p_b_w = c.window.centre_w = deepest.point_w;
    c.window.n_ab_w = p.n_ab_w;
    c.window.u_w = any_orthogonal(p.n_ab_w);
    c.window.v_w = glm::cross(p.n_ab_w, c.window.u_w);
    if (!contacts.add(c, {}, {})) return;
  }
}

void plane_springs::group(std::span<const near_plane> planes) const noexcept {
  deepest_.clear();
  for (;;) {
    const near_plane* best = nullptr;
    for (const near_plane& p : planes) {
      if (!std::isfinite(p.plane.depth_m) || (best != nullptr && !(p.plane.depth_m > best->plane.depth_m))) continue;
      const bool known = std::any_of(deepest_.begin(), deepest_.end(), [&](const near_plane& g) {
        return g.plane.body == p.plane.body && glm::dot(g.plane.n_ab_w, p.plane.n_ab_w) >= settings_.same_direction;
      });
      if (!known) best = &p;
    }
    if (best == nullptr || !deepest_.push_back(*best)) return;
  }
}

}  // namespace asperity
