#include "asperity/planes/plane_springs.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "asperity/core/fixed_vector.hpp"
#include "asperity/core/math.hpp"

namespace asperity {
namespace {

constexpr std::size_t most_directions = 16;
using directions = fixed_vector<near_plane, most_directions>;

// The deepest plane of each direction, the deepest of all first.
directions deepest_of_each(std::span<const near_plane> planes, double same_direction) noexcept {
  directions out;
  for (;;) {
    const near_plane* best = nullptr;
    for (const near_plane& p : planes) {
      if (!std::isfinite(p.plane.depth_m) || (best != nullptr && !(p.plane.depth_m > best->plane.depth_m))) continue;
      const bool known = std::any_of(out.begin(), out.end(), [&](const near_plane& g) {
        return g.plane.body == p.plane.body && glm::dot(g.plane.n_ab_w, p.plane.n_ab_w) >= same_direction;
      });
      if (!known) best = &p;
    }
    if (best == nullptr || !out.push_back(*best)) return out;
  }
}

}  // namespace

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

status plane_springs::accumulate(const scene_pose&, const near_samples&, std::span<const near_plane> planes,
                                 force_report& out) noexcept {
  out = {.by_body = out.by_body, .by_contact = out.by_contact};
  reported_.clear();
  for (const near_plane& deepest : deepest_of_each(planes, settings_.same_direction)) {
    const support_plane& p = deepest.plane;
    penetration d;
    d.depth_m = d.soft_depth_m = p.depth_m;
    d.gradient = p.gradient;
    d.samples = 1;
    d.witness_w = deepest.point_w;
    contact c;
    c.id = static_cast<std::uint32_t>(reported_.size());
    c.body = p.body;
    c.separation_m = -p.depth_m;
    c.p_a_w = c.p_b_w = c.window.centre_w = deepest.point_w;
    c.window.n_ab_w = p.n_ab_w;
    c.window.u_w = any_orthogonal(p.n_ab_w);
    c.window.v_w = glm::cross(p.n_ab_w, c.window.u_w);
    reported_.add(c, d);
    if (!(p.depth_m > 0.0)) continue;
    const wrench push = to_wrench((-settings_.stiffness_n_per_m * p.depth_m) * p.gradient);
    out.force.on_probe_w += push;
    if (c.id < out.by_contact.size()) out.by_contact[c.id] = push;
    if (p.body < out.by_body.size()) out.by_body[p.body] += push;
    add_outer(out.force.stiffness, -settings_.stiffness_n_per_m, p.gradient);
  }
  out.contacts = reported_.contacts();
  out.depths = reported_.depths();
  out.by_contact = out.by_contact.first(std::min(out.by_contact.size(), reported_.size()));
  return status::ok;
}

}  // namespace asperity
