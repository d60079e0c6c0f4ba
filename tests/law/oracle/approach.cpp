#include "law/oracle/approach.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>
#include <utility>

#include "support/fresh_seed.hpp"

namespace asperity::oracle {
namespace {

std::vector<double> summed_areas(const triangle_mesh& mesh) {
  std::vector<double> out;
  out.reserve(mesh.triangles.size());
  double sum = 0.0;
  for (const auto& t : mesh.triangles) {
    const vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    out.push_back(sum += 0.5 * glm::length(glm::cross(b - a, c - a)));
  }
  return out;
}

quat conjugated(const quat& q) { return {q.w, -q.x, -q.y, -q.z}; }

}  // namespace

approach_sampler::approach_sampler(std::string name, const triangle_mesh& probe, const triangle_mesh& fixed)
    : name_(std::move(name)),
      probe_mesh_(&probe),
      fixed_mesh_(&fixed),
      probe_areas_(summed_areas(probe)),
      fixed_areas_(summed_areas(fixed)),
      probe_(probe),
      fixed_(fixed) {}

double approach_sampler::between(double low, double high) {
  return low + (high - low) * static_cast<double>(bits_() >> 11U) * 0x1p-53;
}
double approach_sampler::log_between(double low, double high) { return low * std::pow(high / low, between(0.0, 1.0)); }

quat approach_sampler::orientation() {  // Shoemake's uniform rotation
  const double u = between(0.0, 1.0), a = between(0.0, 2.0 * std::numbers::pi),
               b = between(0.0, 2.0 * std::numbers::pi);
  const double r = std::sqrt(1.0 - u), s = std::sqrt(u);
  return {s * std::cos(b), r * std::sin(a), r * std::cos(a), s * std::sin(b)};
}

vec3 approach_sampler::point_of(const triangle_mesh& mesh, const std::vector<double>& areas) {
  const double at = between(0.0, areas.back());
  const auto found = std::min(std::upper_bound(areas.begin(), areas.end(), at), areas.end() - 1);
  const auto& t = mesh.triangles[static_cast<std::size_t>(found - areas.begin())];
  double u = between(0.0, 1.0), v = between(0.0, 1.0);
  if (u + v > 1.0) {
    u = 1.0 - u;
    v = 1.0 - v;
  }
  const vec3& a = mesh.positions[t[0]];
  return a + u * (mesh.positions[t[1]] - a) + v * (mesh.positions[t[2]] - a);
}

approach approach_sampler::draw(std::uint64_t seed, std::uint64_t index) {
  bits_.seed(test_support::seed_of(seed, name_, index));
  const quat a = orientation(), b = orientation();
  vec3 shift = b * point_of(*fixed_mesh_, fixed_areas_) - a * point_of(*probe_mesh_, probe_areas_);
  shift.z = 0.0;
  probe_.place(a, shift);
  fixed_.place(b, vec3(0.0));
  const first_touch met = touch_along_z(probe_, fixed_);
  shift.z = met.way_m;
  probe_.place(a, shift);

  const quat back = conjugated(b);
  approach out;
  out.window.centre_w = back * met.point;
  out.window.u_w = back * vec3(1.0, 0.0, 0.0);
  out.window.v_w = back * vec3(0.0, 1.0, 0.0);
  out.window.n_ab_w = back * vec3(0.0, 0.0, 1.0);
  out.touching = {glm::normalize(back * a), back * shift};
  out.out_w = back * met.normal;
  return out;
}

void approach_sampler::put(const pose& T_wa, const vec3& n_ab_w) {
  const vec3 z(0.0, 0.0, 1.0), axis = glm::cross(n_ab_w, z);
  const double cosine = glm::dot(n_ab_w, z), sine = glm::length(axis);
  const quat b = sine > 1e-12   ? exp_rotation(std::atan2(sine, cosine) / sine * axis)
                 : cosine > 0.0 ? quat(1.0, 0.0, 0.0, 0.0)
                                : quat(0.0, 1.0, 0.0, 0.0);
  probe_.place(b * T_wa.rotation, b * T_wa.position);
  fixed_.place(b, vec3(0.0));
}

touch_bracket bracket_of(const placed_mesh& probe, const placed_mesh& fixed, double error_m, double furthest_m) {
  touch_bracket out;
  // Forward from well before the touch by no more than what surely is free, until the swollen surfaces touch.
  double before = std::min(furthest_m, 100.0 * error_m);
  while (surface_distance(probe, fixed, -before, 1.01 * error_m) <= 1.001 * error_m && before < 1e3 * furthest_m) {
    before *= 2.0;
  }
  for (int i = 0; i < 400; ++i) {
    const double free = surface_distance(probe, fixed, -before, before + error_m) - error_m;
    if (free <= 0.02 * error_m) break;
    before = std::max(0.0, before - free);
  }
  out.earlier_m = before;
  for (double way = error_m; way < furthest_m; way *= 1.3) {
    out.later_m = way;
    if (overlap_at_least(probe, fixed, way) > error_m) return out;
  }
  out.later_m = furthest_m;
  return out;
}

}  // namespace asperity::oracle
