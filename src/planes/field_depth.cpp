#include "asperity/planes/field_depth.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "asperity/core/memory.hpp"
#include "planes/field_watch.hpp"

namespace asperity {
namespace {

void keep_deepest(const support_plane& p, plane_list& in) noexcept {
  if (in.push_back(p)) return;
  support_plane* const least =
      std::min_element(in.begin(), in.end(), [](const auto& a, const auto& b) { return a.depth_m < b.depth_m; });
  if (least->depth_m < p.depth_m) *least = p;
}

// How far a sample whose surface looks away from the direction that it would be pushed in may count: in full up to 35
// degrees beyond its cone, since relief leans, and not at all from 60 degrees on.
double facing_share(double cosine, double cone_rad) noexcept {
  constexpr double full_rad = 35.0 * std::numbers::pi / 180.0, none_rad = 60.0 * std::numbers::pi / 180.0;
  const double full = std::cos(std::min(cone_rad + full_rad, std::numbers::pi));
  const double none = std::cos(std::min(cone_rad + none_rad, std::numbers::pi));
  return full > none ? smoothstep((cosine - none) / (full - none)) : 1.0;
}

}  // namespace

field_depth::field_depth(std::shared_ptr<const field_scene> bodies, const scene& of, double reach_m, std::size_t most)
    : bodies_(std::move(bodies)),
      centre_of_mass_a_(of.probe->mass.centre_of_mass),
      reach_m_(reach_m),
      watch_(std::make_unique<field_watch>(*bodies_, of)) {
  detail::reserve_resident(told_, most);
  constexpr double of_the_diagonal = 0.03;
  double smaller_m = of.probe->box.diagonal();
  for (const model_ptr& b : of.fixed) smaller_m = std::min(smaller_m, b->box.diagonal());
  sinking_m_ = of_the_diagonal * smaller_m;
}
field_depth::field_depth(field_depth&&) noexcept = default;
field_depth& field_depth::operator=(field_depth&&) noexcept = default;
field_depth::~field_depth() = default;

status field_depth::measure(const scene_pose& at, const near_samples& found, std::span<near_plane> out) noexcept {
  const vec3 c_a_w = at.T_wa * centre_of_mass_a_;
  told_.clear();
  for (std::size_t i = 0; i < out.size(); ++i) {
    const near_leaf& leaf = found.leaves()[i];
    const field_body &A = *bodies_->probe, &B = *bodies_->fixed[leaf.body];
    const pose T_ba = inverse(at.T_wb[leaf.body]) * at.T_wa;
    out[i] = leaf.of_probe
                 ? deepest(leaf, B.field, T_ba, at.T_wb[leaf.body].rotation, at.T_wa, 1.0, c_a_w, -reach_m_)
                 : deepest(leaf, A.field, inverse(T_ba), at.T_wa.rotation, at.T_wb[leaf.body], -1.0, c_a_w, -reach_m_);
    if (out[i].plane.depth_m > -reach_m_ && told_.size() < told_.capacity()) told_.push_back(out[i].plane);
  }
  flags_ = watch_->look(*bodies_, at, told_, c_a_w);
  return status::ok;
}

status field_depth::planes_at(const scene_pose& at, const near_samples& found, std::span<const near_plane> read,
                              const vec6& moved, double above_m, plane_list& out) const noexcept {
  // No depth grows faster than this with the way of its point: smooth part and relief together.
  constexpr double steepest = 3.0;
  const vec3 c_a_w = at.T_wa * centre_of_mass_a_;
  const double slid_m = std::sqrt(glm::dot(moved.linear, moved.linear));
  const double turned_rad = std::sqrt(glm::dot(moved.angular, moved.angular));
  for (std::size_t i = 0; i < read.size(); ++i) {
    const support_plane& before = read[i].plane;
    const double way_m = slid_m + turned_rad * std::sqrt(glm::dot(before.r_w, before.r_w));
    if (!(before.depth_m + steepest * way_m > above_m)) continue;
    const near_leaf& leaf = found.leaves()[i];
    const field_body &A = *bodies_->probe, &B = *bodies_->fixed[leaf.body];
    const pose T_ba = inverse(at.T_wb[leaf.body]) * at.T_wa;
    near_leaf one = leaf;
    one.count = 1;
    for (const field_sample& sample : leaf.samples()) {
      one.first = &sample;
      const near_plane now =
          leaf.of_probe
              ? deepest(one, B.field, T_ba, at.T_wb[leaf.body].rotation, at.T_wa, 1.0, c_a_w, above_m)
              : deepest(one, A.field, inverse(T_ba), at.T_wa.rotation, at.T_wb[leaf.body], -1.0, c_a_w, above_m);
      if (now.plane.depth_m > above_m) keep_deepest(now.plane, out);
    }
  }
  return out.dropped() > 0 ? status::capacity_reached : status::ok;
}

std::size_t field_depth::heap_bytes() const noexcept {
  return asperity::heap_bytes(told_) + sizeof(field_watch) + watch_->heap_bytes() + sizeof(field_scene) +
         bodies_->heap_bytes();
}

near_plane field_depth::deepest(const near_leaf& leaf, const body_field& in_y, const pose& T_yx,
                                const quat& rotation_wy, const pose& T_wx, double sign, const vec3& c_a_w,
                                double above_m) const noexcept {
  // Half way through a body no way out is shorter than another: a sample there holds nothing.
  constexpr double least_slope = 0.05;
  near_plane out;
  if (leaf.count > 1) {
    // A smooth distance grows by little more than a metre per metre.
    constexpr double steepest = 1.2;
    const double smooth_m = in_y.coarse(T_yx * leaf.centre_b).value_m;
    if (smooth_m + steepest * leaf.radius_m + in_y.highest_relief_m <= above_m) return out;
  }
  double deepest_m = above_m;
  const field_sample* found = nullptr;
  vec3 slope_y(0.0), point_x(0.0);
  const quat rotation_xy = glm::conjugate(T_yx.rotation);
  for (const field_sample& s : leaf.samples()) {
    const vec3 p_y = T_yx * vec3(s.position_b);
    const coarse_reading smooth = in_y.coarse(p_y);
    if (!(smooth.value_m + in_y.highest_relief_m > deepest_m)) continue;
    const field_reading relief = in_y.relief(p_y, smooth);
    const field_reading d{smooth.value_m + relief.value_m, smooth.slope + relief.slope};
    if (!(d.value_m > deepest_m)) continue;
    const double squared = glm::dot(d.slope, d.slope);
    if (!(squared > least_slope * least_slope)) continue;
    const double facing = glm::dot(vec3(s.axis_b), rotation_xy * d.slope) / std::sqrt(squared);
    const double depth_m = d.value_m - sinking_m_ * (1.0 - facing_share(facing, static_cast<double>(s.cone_rad)));
    if (!(depth_m > deepest_m)) continue;
    out.plane.depth_m = deepest_m = depth_m;
    slope_y = d.slope;
    point_x = vec3(s.position_b);
    found = &s;
  }
  const double steep = std::sqrt(glm::dot(slope_y, slope_y));
  if (!(steep > 0.0)) return out;
  const vec3 slope_w = sign * (rotation_wy * slope_y);
  out.point_w = T_wx * point_x;
  out.plane.body = leaf.body;
  const field_body& of_x = leaf.of_probe ? *bodies_->probe : *bodies_->fixed[leaf.body];
  const auto index = static_cast<std::uint32_t>(found - of_x.samples.samples().data());
  out.plane.sample = 2 * index + (leaf.of_probe ? 1 : 2);
  out.plane.r_w = out.point_w - c_a_w;
  out.plane.gradient = {slope_w, glm::cross(out.plane.r_w, slope_w)};
  out.plane.n_ab_w = slope_w / steep;
  return out;
}

}  // namespace asperity
