// How much of a body's relief stays as it is at a pose while the smooth part moves.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/exits/field_bounds.hpp"
#include "asperity/field/body_field.hpp"
#include "asperity/field/sample_tree.hpp"

namespace asperity::exits {

/// Relief of the size of the texture, as it is; more than that, which is what a sharp edge rises above the smooth part,
/// no further than the limit; and none where the smooth part is no distance, beside edges and deep behind them.
///
/// A texture has to stay as it is at the pose: if it moved, a way out would snap from valley to valley. An edge must
/// not stay: its relief is a part of the shape, and held beside it where the probe has moved on it would be a wall that
/// is not there. There the shape is the smooth part's, whose edges are round; the samples along the edge itself tell of
/// it in the other body's field. Behind an edge the feet of neighbouring points lie far apart, and relief would change
/// with the place many times as fast as the surface has it.
class kept_relief {
 public:
  kept_relief() = default;
  explicit kept_relief(double limit_m) noexcept : limit_m_(limit_m) {}

  [[nodiscard]] double limit_m() const noexcept { return limit_m_; }

  /// What is kept of a relief, at least up to half the limit as it is. With its sign, and rising with it. @rt safe
  [[nodiscard]] double limited(double relief_m) const noexcept { return limited({relief_m, {}}).value_m; }

  /// The relief at a place of a field, and its slope by the place. @rt safe
  [[nodiscard]] field_reading read(const body_field& field, const vec3& p_b) const noexcept {
    const coarse_reading s = field.coarse(p_b);
    const double x = (glm::dot(s.slope, s.slope) - kept_none) / (kept_full - kept_none);
    if (!(x > 0.0)) return {};
    const field_reading t = limited(field.relief(p_b, s));
    const double share = smoothstep(x), share_slope = smoothstep_slope(x) / (kept_full - kept_none);
    return {share * t.value_m, share * t.slope + (2.0 * t.value_m * share_slope) * (s.hessian_per_m * s.slope)};
  }

 private:
  static constexpr double kept_none = 0.75, kept_full = 0.95;  // |grad S|^2 from which some relief is kept, and all

  // As it is up to half the limit, then less and less; two continuous derivatives.
  [[nodiscard]] field_reading limited(const field_reading& t) const noexcept {
    const double half = 0.5 * limit_m_, more = std::fabs(t.value_m) - half;
    if (!(more > 0.0)) return t;
    const double rise = std::tanh(more / half);
    return {std::copysign(half + half * rise, t.value_m), (1.0 - rise * rise) * t.slope};
  }

  double limit_m_ = 1.0;
};

/// A limit for a body from its own samples, which lie on its fine surface: half of it holds for nine of ten.
/// At most half the pitch of the smooth part, which resolves what is larger. Allocates.
[[nodiscard]] inline kept_relief usual_relief(const body_field& field, std::span<const field_sample> samples) {
  constexpr double least_m = 2e-6;
  std::vector<double> off;
  off.reserve(samples.size());
  for (const field_sample& s : samples) off.push_back(std::fabs(smooth_depth(field.smooth, vec3(s.position_b))));
  if (off.empty()) return kept_relief(least_m);
  const auto most_of_them = off.begin() + static_cast<std::ptrdiff_t>(0.9 * static_cast<double>(off.size() - 1));
  std::nth_element(off.begin(), most_of_them, off.end());
  return kept_relief(std::clamp(2.0 * *most_of_them, least_m, 0.5 * field.smooth.pitch_m));
}

}  // namespace asperity::exits
