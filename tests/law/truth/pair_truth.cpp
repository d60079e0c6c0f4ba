#include "law/truth/pair_truth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <numbers>

namespace asperity::truth {
namespace {

constexpr double one_wall_rad = 30.0 * std::numbers::pi / 180.0;

// Cut into cells once per original.
std::shared_ptr<const near_triangles> near_triangles_of(const truth_body& body) {
  static std::map<const triangle_mesh*, std::shared_ptr<const near_triangles>> known;
  auto& at = known[&body.full];
  if (!at) at = std::make_shared<const near_triangles>(body.full);
  return at;
}

}  // namespace

double plane_case::tilt_rad() const {
  const vec3 wall = of_probe ? -truth.out_b_w : truth.out_a_w;
  return std::acos(std::clamp(glm::dot(reported->n_ab_w, wall), -1.0, 1.0));
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

double half_thickness_m(const oracle::approach_sampler& sampler, const oracle::approach& on) {
  constexpr double off_the_surface_m = 1e-6;
  // The sampler left both meshes with the approach along +z: its frame has the window's axes.
  const auto in_sampler = [&](const vec3& v) {
    return vec3(glm::dot(v, on.window.u_w), glm::dot(v, on.window.v_w), glm::dot(v, on.window.n_ab_w));
  };
  const vec3 point = in_sampler(on.window.centre_w), up = in_sampler(on.out_w);
  const auto through = [&](const oracle::placed_mesh& mesh, const vec3& direction) {
    return mesh.contains(point + off_the_surface_m * direction)
               ? mesh.crossing_along(point, direction, off_the_surface_m)
               : std::numeric_limits<double>::infinity();
  };
  return 0.5 * std::min(through(sampler.probe(), up), through(sampler.fixed(), -up));
}

pair_originals::pair_originals(const truth_body& probe, const truth_body& fixed)
    : name_(probe.name + " on " + fixed.name),
      probe_pitch_m_(probe.field->field.smooth.pitch_m),
      fixed_pitch_m_(fixed.field->field.smooth.pitch_m),
      sampler_(name_, probe.full, fixed.full),
      probe_(near_triangles_of(probe)),
      fixed_(near_triangles_of(fixed)) {}

plane_truth::plane_truth(const truth_body& probe, const truth_body& fixed)
    : plane_truth(probe, fixed, pair_of(probe, fixed)) {}

plane_truth::plane_truth(const truth_body& probe, const truth_body& fixed, const truth_pair& felt)
    : pair_originals(probe, fixed),
      diagonal_m_(std::min(probe.diagonal_m(), fixed.diagonal_m())),
      window_m_(std::max(probe.sample_pitch_m(), fixed.sample_pitch_m())),
      bake_error_m_(probe.model->report.max_error_m + fixed.model->report.max_error_m),
      law_(felt.bodies, felt.fields) {}

plane_case plane_truth::judge(const pose& T_wa) {
  plane_case out;
  out.T_wa = T_wa;
  out.reported = law_.deepest(T_wa);
  if (!out.reported) return out;
  if (bend) bend(*out.reported);
  const reported_plane& p = *out.reported;
  // Whose sample: it lies on one of the two surfaces, and as deep as the plane in the other.
  out.of_probe = probe_->distance(inverse(T_wa) * p.point_w, window_m_) <= fixed_->distance(p.point_w, window_m_);
  asked_place at;
  at.n_ab_w = p.n_ab_w;
  at.radius_m = window_m_;
  at.point_a_w = out.of_probe ? p.point_w : p.point_w + p.depth_m * p.n_ab_w;
  at.point_b_w = out.of_probe ? p.point_w - p.depth_m * p.n_ab_w : p.point_w;
  out.truth = depth_near(*probe_, T_wa, *fixed_, pose{}, at);
  out.one_wall = (out.of_probe ? fixed_->turn_rad(p.point_w, std::fabs(p.depth_m) + 2.0 * fixed_pitch_m_)
                               : probe_->turn_rad(inverse(T_wa) * p.point_w,
                                                  std::fabs(p.depth_m) + 2.0 * probe_pitch_m_)) < one_wall_rad;
  return out;
}

std::vector<plane_case> plane_truth::approach(std::uint64_t seed, std::uint64_t index) {
  constexpr double least_facing = 0.2, share_of_half_thickness = 0.9;
  const oracle::approach on = sampler_.draw(seed, index);
  const double thick_m = share_of_half_thickness * half_thickness_m(sampler_, on);
  const bool faces = glm::dot(on.out_w, on.window.n_ab_w) <= -least_facing;
  constexpr std::array<double, 3> from_m{10e-6, 50e-6, 1e-3}, to_m{1e-3, 1e-3, 4e-3};
  std::vector<plane_case> out;
  for (std::size_t k = 0; k < 3; ++k) {
    const double way_m = (k == 0 ? -1.0 : 1.0) * sampler_.log_between(from_m[k], to_m[k]);
    const bool against = sampler_.between(0.0, 1.0) < 0.5;
    if (k > 0 && (way_m > thick_m || !faces)) continue;
    const pose T_wa =
        k > 0 && against ? pose{on.touching.rotation, on.touching.position - way_m * on.out_w} : on.pressed(way_m);
    plane_case one = judge(T_wa);
    one.index = index;
    one.of = band{static_cast<std::uint8_t>(k)};
    one.way_m = way_m;
    one.against = against;
    if (k == 0) {
      one.overlap_m = -oracle::surface_distance(sampler_.probe(), sampler_.fixed(), way_m, -way_m);
    } else {
      sampler_.put(T_wa, on.window.n_ab_w);
      one.overlap_m = oracle::overlap_at_least(sampler_.probe(), sampler_.fixed(), 0.0);
      sampler_.put(on.touching, on.window.n_ab_w);
    }
    out.push_back(one);
  }
  return out;
}

force_truth::force_truth(const truth_body& probe, const truth_body& fixed)
    : force_truth(probe, fixed, pair_of(probe, fixed)) {}

force_truth::force_truth(const truth_body& probe, const truth_body& fixed, const truth_pair& felt)
    : pair_originals(probe, fixed), law_(felt.bodies, felt.fields) {}

std::optional<press_case> force_truth::press(std::uint64_t seed, std::uint64_t index, double depth_m, double alone) {
  constexpr double least_facing = 0.2, share_of_half_thickness = 0.9;
  const oracle::approach on = sampler_.draw(seed, index);
  if (glm::dot(on.out_w, on.window.n_ab_w) > -least_facing) return std::nullopt;
  if (depth_m > share_of_half_thickness * half_thickness_m(sampler_, on)) return std::nullopt;
  press_case out;
  out.index = index;
  out.depth_m = depth_m;
  out.n_ab_w = -on.out_w;
  out.T_wa = {on.touching.rotation, on.touching.position - depth_m * on.out_w};
  sampler_.put(out.T_wa, on.window.n_ab_w);
  out.least_m = oracle::overlap_at_least(sampler_.probe(), sampler_.fixed(), 0.0);
  if (out.least_m < alone * depth_m) return std::nullopt;
  const vec3 touch_w = on.window.centre_w;
  out.one_wall = fixed_->turn_rad(touch_w, depth_m + 2.0 * fixed_pitch_m_) < one_wall_rad ||
                 probe_->turn_rad(inverse(on.touching) * touch_w, depth_m + 2.0 * probe_pitch_m_) < one_wall_rad;
  out.reported = law_.at(out.T_wa);
  if (bend) bend(out.reported);
  return out;
}

}  // namespace asperity::truth
