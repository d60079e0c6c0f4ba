// How deep the samples of one body lie in another's depth field, and the support planes of those that are deep.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include "asperity/core/pose.hpp"
#include "asperity/field/field_body.hpp"
#include "asperity/planes/near_samples.hpp"
#include "asperity/render/depth_backend.hpp"
#include "field/quick_read.hpp"
#include "model/material_places.hpp"
#include "planes/ball_bound.hpp"
#include "planes/facing.hpp"
#include "planes/patch_slopes.hpp"

namespace asperity {

/// The number by which planes tell whose sample they stand for: support_plane::sample.
struct sample_number {
  bool of_probe = false;
  std::uint32_t index = 0;  ///< of sample_tree::samples()

  [[nodiscard]] constexpr std::uint32_t told() const noexcept { return 2 * index + (of_probe ? 1 : 2); }
  /// @pre told > 0
  [[nodiscard]] static constexpr sample_number from(std::uint32_t told) noexcept {
    return {told % 2 == 1, (told - 1) / 2};
  }
};

/// Reads samples of a body X in the field of a body Y at one pose. What a sample tells is read in double precision with
/// exact slopes. Where many samples are asked about, quick readings with a stated error tell first which of them need that;
/// they change no result.
class leaf_reader {
 public:
  /// @param of_probe whether X is the probe; its motion takes Y's field along otherwise, and the slope's sign turns
  /// @param shallow_m so far in a sample counts by its share, see plane_depth   @param work counts what is read
  /// @param of_x,of_y where which material is; null without a map
  leaf_reader(const field_body& x, const pose& T_wx, const field_body& y, const pose& T_wy, std::uint32_t body,
              bool of_probe, const vec3& c_a_w, double shallow_m, const material_places* of_x,
              const material_places* of_y, depth_work& work) noexcept
      : x_(&x),
        in_y_(&y.field),
        T_wx_(T_wx),
        T_yx_(inverse(T_wy) * T_wx),
        rotation_yx_(glm::mat3_cast(T_yx_.rotation)),
        rotation_wy_(T_wy.rotation),
        body_(body),
        of_probe_(of_probe),
        c_a_w_(c_a_w),
        shallow_m_(shallow_m),
        materials_x_(of_x),
        materials_y_(of_y),
        work_(&work) {}

  /// Of the probe A's samples in B's field, or of B's in A's; the rest as above.
  [[nodiscard]] static leaf_reader between(const field_body& a, const pose& T_wa, const field_body& b, const pose& T_wb,
                                           std::uint32_t body, bool of_probe, const vec3& c_a_w, double shallow_m,
                                           const material_places* of_a, const material_places* of_b,
                                           depth_work& work) noexcept {
    return of_probe ? leaf_reader(a, T_wa, b, T_wb, body, true, c_a_w, shallow_m, of_a, of_b, work)
                    : leaf_reader(b, T_wb, a, T_wa, body, false, c_a_w, shallow_m, of_b, of_a, work);
  }

  [[nodiscard]] bool reads(const near_patch& patch) const noexcept {
    return patch.body == body_ && patch.of_probe == of_probe_;
  }

  /// A point of X in Y's frame.
  [[nodiscard]] vec3 in_field(const vec3& point_x) const noexcept { return T_yx_.position + rotation_yx_ * point_x; }
  /// The slopes of Y's field within far_m of where the middle of a patch was found.
  [[nodiscard]] patch_slopes slopes_about(const near_patch& patch, const vec3& middle_y, double far_m) const noexcept {
    return asperity::slopes_about(*in_y_, middle_y, far_m, patch.in_other);
  }
  /// m, of Y's smooth part.
  [[nodiscard]] double pitch_m() const noexcept { return in_y_->smooth.pitch_m; }

  /// A leaf's bound at this pose; the leaf may have been listed at another.
  [[nodiscard]] depth_bound bound_of(const near_leaf& leaf) const noexcept {
    ++work_->bounded;
    return bound_of_ball(*in_y_, T_yx_, leaf.ball);
  }

  /// A slope of Y's field as the derivative of a depth by the probe's position.
  [[nodiscard]] vec3 by_probe_w(const vec3& slope_y) const noexcept {
    return (of_probe_ ? 1.0 : -1.0) * (rotation_wy_ * slope_y);
  }
  [[nodiscard]] vec3 from_centre_of_mass_w(const vec3& point_x) const noexcept { return T_wx_ * point_x - c_a_w_; }

  /// The plane of the deepest sample that is deeper than above_m; of equals the first.
  /// @param known upper bounds of the samples' depths, m; made sharper by what is read
  [[nodiscard]] near_plane deepest(const near_leaf& leaf, const depth_bound& near, double above_m,
                                   std::span<float> known) const noexcept {
    near_plane out;
    sample_depth best;
    const vec3 centre_y = in_field(leaf.ball.centre_b);
    const double relief_m = std::min(near.relief_m, in_y_->highest_relief_m);
    std::array<candidate, sample_tree::leaf_samples> of;
    const std::span<const field_sample> samples = leaf.samples();
    for (std::size_t first = 0; first < samples.size(); first += of.size()) {
      std::size_t count = 0;
      for (std::size_t i = first; i < std::min(samples.size(), first + of.size()); ++i) {
        const double most_m = i < known.size() ? static_cast<double>(known[i]) : depth_bound::unknown;
        if (most_m > above_m) of[count++] = {i, most_m};
      }
      // The sample that may be the deepest is read first: what it says dismisses most others by what is known of them.
      for (;;) {
        candidate* next = of.data();
        for (std::size_t i = 1; i < count; ++i) {
          if (of[i].most_m > next->most_m) next = &of[i];
        }
        if (count == 0 || !(next->most_m >= above_m)) break;
        const field_sample& sample = samples[next->index];
        const vec3 p_y = in_field(vec3(sample.position_b));
        double most_m = std::min(next->most_m, near.most_at(p_y - centre_y));
        const sample_depth now =
            most_m >= above_m ? read(sample, p_y, above_m, relief_m) : sample_depth{.most_m = most_m};
        most_m = std::min(most_m, now.most_m);
        if (next->index < known.size()) known[next->index] = rounded_up(most_m);
        next->most_m = -std::numeric_limits<double>::infinity();
        const bool first_of_equals = best.sample != nullptr && now.depth_m == best.depth_m && now.sample < best.sample;
        if (!(now.depth_m > above_m) && !first_of_equals) continue;
        best = now;
        above_m = now.depth_m;
      }
    }
    if (best.sample != nullptr) report(best, out);
    return out;
  }

  /// Calls visit(plane) for every sample that is deeper than above_m(), which visit may raise.
  /// @param known upper bounds of the samples' depths, m; made sharper by what is read
  template <class Above, class Visit>
  void each_deeper(const near_leaf& leaf, Above&& above_m, std::span<float> known, Visit&& visit) const noexcept {
    const std::span<const field_sample> samples = leaf.samples();
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double least_m = above_m();
      if (i < known.size() && !(static_cast<double>(known[i]) > least_m)) continue;
      const sample_depth now =
          read(samples[i], in_field(vec3(samples[i].position_b)), least_m, in_y_->highest_relief_m);
      if (i < known.size()) known[i] = rounded_up(now.most_m);
      if (!(now.depth_m > least_m)) continue;
      near_plane out;
      report(now, out);
      visit(out.plane);
    }
  }

  /// The plane of one sample; its depth is -infinity where the field has no direction there.
  [[nodiscard]] support_plane plane_of(std::uint32_t index) const noexcept {
    near_plane out;
    const field_sample& s = x_->samples.samples()[index];
    const sample_depth now =
        read(s, in_field(vec3(s.position_b)), -depth_bound::unknown, in_y_->highest_relief_m, -1.0);
    if (now.sample != nullptr) report(now, out);
    return out.plane;
  }

  /// A bound as it is kept.
  [[nodiscard]] static float rounded_up(double most_m) noexcept {
    constexpr float rounding_m = 1e-9F;
    return static_cast<float>(most_m) + rounding_m;
  }

 private:
  struct candidate {
    std::size_t index;
    double most_m;
  };
  struct sample_depth {
    const field_sample* sample = nullptr;
    double depth_m = -std::numeric_limits<double>::infinity();
    vec3 slope_y{0.0};
    double share = 1.0;                    // of the slope that the depth has
    double whole_m = 0.0;                  // the depth if all of it counted
    double most_m = depth_bound::unknown;  // it is no deeper, whatever it faces
  };

  // How deep a sample is. Where it cannot be deeper than above_m, no more is read than says so.
  // @param p_y its place in Y's frame   @param relief_m no relief at its foot is higher
  // @param least_share one that has no larger share is not told where it is shallow
  [[nodiscard]] sample_depth read(const field_sample& s, const vec3& p_y, double above_m, double relief_m,
                                  double least_share = facing::least_share) const noexcept {
    ++work_->read;
    const detail::quick_reading q = detail::quick_read(in_y_->smooth, p_y);
    sample_depth out{.most_m = q.at.value_m + q.error_m + relief_m};
    if (!(out.most_m >= above_m)) return out;
    const foot_and_fade to = in_y_->foot(p_y, q.at);
    const bool has_relief = q.in_grid && to.fade > 0.0;
    const detail::relief_bricks::reading t =
        has_relief ? in_y_->fine.read(to.foot_b) : detail::relief_bricks::reading{};
    const double depth_m = q.at.value_m + to.fade * t.value;
    // The relief ends with the grid, no closer to the surface than three pitches.
    if (q.at.value_m > -2.0 * in_y_->smooth.pitch_m) out.most_m = std::min(out.most_m, depth_m + 2.0 * q.error_m);
    if (!(depth_m >= above_m)) return out;
    out.slope_y = has_relief ? q.at.slope + body_field::faded(t, to, q.at).slope : q.at.slope;
    const double squared = glm::dot(out.slope_y, out.slope_y);
    if (!(squared > facing::least_slope * facing::least_slope)) return out;
    const double cosine = glm::dot(rotation_yx_ * vec3(s.axis_b), out.slope_y) / std::sqrt(squared);
    const double share = facing_share(cosine, static_cast<double>(s.cone_rad));
    const bool shallow = depth_m < shallow_m_;
    if (shallow && !(share > least_share)) return out;
    out.sample = &s;
    out.whole_m = depth_m;
    out.share = shallow && depth_m > 0.0 ? share : 1.0;
    out.depth_m = facing::counted_m(depth_m, share, shallow_m_);
    return out;
  }

  [[nodiscard]] static double facing_share(double cosine, double cone_rad) noexcept {
    const auto [full, none] = facing::cosines_of(cone_rad);
    return full > none ? smoothstep((cosine - none) / (full - none)) : 1.0;
  }

  void report(const sample_depth& of, near_plane& out) const noexcept {
    const vec3 slope_w = by_probe_w(of.slope_y);
    out.point_w = T_wx_ * vec3(of.sample->position_b);
    out.plane.depth_m = of.depth_m;
    out.plane.body = body_;
    const auto index = static_cast<std::uint32_t>(of.sample - x_->samples.samples().data());
    out.plane.sample = sample_number{of_probe_, index}.told();
    out.plane.r_w = out.point_w - c_a_w_;
    out.plane.gradient = {of.share * slope_w, of.share * glm::cross(out.plane.r_w, slope_w)};
    out.plane.n_ab_w = slope_w / std::sqrt(glm::dot(of.slope_y, of.slope_y));
    if (materials_x_ != nullptr) {
      (of_probe_ ? out.plane.of_probe : out.plane.of_body) = materials_x_->at(vec3(of.sample->position_b));
    }
    if (materials_y_ != nullptr) {
      (of_probe_ ? out.plane.of_body : out.plane.of_probe) = materials_y_->at(foot_y(of));
    }
  }

  // The point of Y's fine surface that a sample has its depth from.
  [[nodiscard]] vec3 foot_y(const sample_depth& of) const noexcept {
    const vec3 p_y = in_field(vec3(of.sample->position_b));
    const vec3 slope = in_y_->coarse(p_y).slope;
    return p_y - of.whole_m / (glm::dot(slope, slope) + 1e-3) * slope;
  }

  const field_body* x_;
  const body_field* in_y_;
  pose T_wx_, T_yx_;
  mat3 rotation_yx_;
  quat rotation_wy_;
  std::uint32_t body_;
  bool of_probe_;
  vec3 c_a_w_;
  double shallow_m_;
  const material_places *materials_x_, *materials_y_;
  depth_work* work_;
};

}  // namespace asperity
