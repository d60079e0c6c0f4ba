// How much of a body's relief stays as it is at a pose while the smooth part moves.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/field/body_field.hpp"
#include "asperity/field/sample_tree.hpp"

namespace asperity::exits {

/// Keeps relief of the size of a texture as it is. Keeps larger relief, which is how far a sharp edge rises above the
/// smooth part, up to the limit; and none where the smooth part is not a distance, beside edges and deep behind them.
///
/// A texture has to stay as it is at the pose, because a way out would jump from valley to valley if it moved. The
/// relief of an edge must not stay, because it is part of the shape: kept at its place after the probe has moved on, it
/// would be a wall that does not exist. In a notch the relief moves with the smooth part, see moving_m(). Over a sharp
/// edge the moving shape is the smooth part, which is a little rounder; the samples along the edge are measured in the
/// other body's field. Behind an edge the feet of neighbouring points lie far apart, so relief would change with the
/// place many times as fast as on the surface.
class kept_relief {
 public:
  kept_relief() = default;
  explicit kept_relief(double limit_m) noexcept : limit_m_(limit_m) {}

  [[nodiscard]] double limit_m() const noexcept { return limit_m_; }

  /// The part of a relief that is kept: all up to half the limit, less beyond; monotonic, of the same sign. @rt safe
  [[nodiscard]] double limited(double relief_m) const noexcept { return limited({relief_m, {}}).value_m; }

  /// The relief at a place of a field, and its slope by the place. @rt safe
  [[nodiscard]] field_reading read(const body_field& field, const vec3& p_b) const noexcept {
    const coarse_reading s = field.coarse(p_b);
    const kept_share share(s);
    if (!(share.value > 0.0)) return {};
    const field_reading t = limited(field.relief(p_b, s));
    return {share.value * t.value_m, share.value * t.slope + t.value_m * share.slope};
  }

  /// The part of the relief that moves with the smooth part, m. In notches, which the smooth part fills, and next to
  /// the surface: the negative relief that is not kept. Zero elsewhere. @rt safe
  [[nodiscard]] double moving_m(const body_field& field, const vec3& p_b) const noexcept {
    const coarse_reading s = field.coarse(p_b);
    const kept_share share(s);
    const double off = std::fabs(s.value_m) / field.smooth.pitch_m;
    if (!(share.value < 1.0) || !(off < layer_none)) return 0.0;
    const double in_notch = smoothstep((bend_of(s, field.smooth.pitch_m) - notch_none) / (notch_full - notch_none));
    if (!(in_notch > 0.0)) return 0.0;
    const double all_m = field.relief(p_b, s).value_m, more_m = all_m - share.value * limited(all_m);
    // All of it where little of the relief is kept, none where all is.
    const double squared = share.value * share.value, moves = 1.0 - squared * squared;
    return in_notch * moves * smoothstep((layer_none - off) / (layer_none - layer_full)) * std::min(0.0, more_m);
  }
  /// Whether a place with this reading lies beside no edge: relief up to half the limit is kept as it is.
  [[nodiscard]] static bool keeps_all(const coarse_reading& s) noexcept {
    return glm::dot(s.slope, s.slope) >= kept_full;
  }
  /// Whether some of the relief may move near a place with this reading.
  [[nodiscard]] static bool may_move(const coarse_reading& s, double pitch_m) noexcept {
    return !keeps_all(s) && std::fabs(s.value_m) < layer_none * pitch_m && bend_of(s, pitch_m) > 0.0;
  }

  /// Whether some of the relief may move at a place where S and its derivatives were read with an error of up to
  /// `error`, in pitches: |S|, |grad S|^2 and the trace of its second derivatives.
  [[nodiscard]] static bool may_move(double off, double slope_squared, double bend, double error) noexcept {
    return slope_squared < kept_full + error && off < layer_none + error && bend > notch_none - error;
  }

  static constexpr double layer_full = 0.8, layer_none = 1.4;  ///< pitches: |S| of what moves in full, and not

 private:
  static constexpr double kept_none = 0.75, kept_full = 0.95;  // |grad S|^2 from which some relief is kept, and all

  static constexpr double notch_none = 0.05, notch_full = 0.25;  // bend from which some relief moves, and all

  // In a notch the smooth part bends towards the solid: the trace of its second derivatives, per pitch.
  [[nodiscard]] static double bend_of(const coarse_reading& s, double pitch_m) noexcept {
    const mat3& h = s.hessian_per_m;
    return pitch_m * (h[0][0] + h[1][1] + h[2][2]);
  }

  // How much of the relief is kept at a place, and its slope.
  struct kept_share {
    double value;
    vec3 slope;

    explicit kept_share(const coarse_reading& s) noexcept {
      const double x = (glm::dot(s.slope, s.slope) - kept_none) / (kept_full - kept_none);
      value = smoothstep(x);
      slope = (2.0 * smoothstep_slope(x) / (kept_full - kept_none)) * (s.hessian_per_m * s.slope);
    }
  };

  // The identity up to half the limit, then less and less; two continuous derivatives.
  [[nodiscard]] field_reading limited(const field_reading& t) const noexcept {
    const double half = 0.5 * limit_m_, more = std::fabs(t.value_m) - half;
    if (!(more > 0.0)) return t;
    const double rise = std::tanh(more / half);
    return {std::copysign(half + half * rise, t.value_m), (1.0 - rise * rise) * t.slope};
  }

  double limit_m_ = 1.0;
};

/// A limit for a body from its own samples, which lie on its fine surface: half of it holds for nine of ten of those
/// that lie beside no edge, where all relief is texture. At most half the pitch of the smooth part, which resolves what
/// is larger. Allocates.
[[nodiscard]] inline kept_relief usual_relief(const body_field& field, std::span<const field_sample> samples) {
  constexpr double least_m = 2e-6;
  std::vector<double> off;
  off.reserve(samples.size());
  for (const field_sample& sample : samples) {
    const coarse_reading s = field.coarse(vec3(sample.position_b));
    if (kept_relief::keeps_all(s)) off.push_back(std::fabs(s.value_m));
  }
  if (off.empty()) return kept_relief(least_m);
  const auto most_of_them = off.begin() + static_cast<std::ptrdiff_t>(0.9 * static_cast<double>(off.size() - 1));
  std::nth_element(off.begin(), most_of_them, off.end());
  return kept_relief(std::clamp(2.0 * *most_of_them, least_m, 0.5 * field.smooth.pitch_m));
}

}  // namespace asperity::exits
