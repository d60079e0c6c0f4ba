// One way out: where a spring that pulls back and the bed that pushes out are in balance.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "asperity/core/fixed_vector.hpp"
#include "asperity/core/math.hpp"
#include "asperity/exits/bed.hpp"
#include "asperity/exits/posed_samples.hpp"

namespace asperity::exits {

/// Springs of the law, N/m: see exit_rule.
struct exit_springs {
  double one = 0.0;    ///< to the pose, where there is one way out
  double each = 0.0;   ///< to the place that several ways out look from
  double mixed = 0.0;  ///< bound of the force's slope where several are mixed

  /// What each way out costs at y besides the bed's energy, and where ways out with this mean are looked at from.
  [[nodiscard]] double pull_j(const vec3& z, const vec3& y) const noexcept {
    return 0.5 * each * glm::dot(z - y, z - y);
  }
  [[nodiscard]] vec3 seen_from(const vec3& mean_z) const noexcept { return (-each / (mixed - each)) * mean_z; }
};

/// A motion of the probe that clears the bodies, but for what the bed gives way.
struct way_out {
  vec3 z_w{0.0};
  bed_sum bed;
  double weight = 0.0;
  bool settled = true;             ///< false: the iteration ended before it came to rest
  fixed_vector<mark, 8> touching;  ///< the deepest samples there

  /// Cost as seen from y, J.
  [[nodiscard]] double cost_j(const exit_springs& k, const vec3& y) const noexcept {
    return k.pull_j(z_w, y) + bed.energy_j;
  }
};

/// Keeps the deepest of what it is shown. @rt safe
template <std::size_t N>
void keep_deepest(fixed_vector<mark, N>& among, const mark& m) noexcept {
  if (among.push_back(m)) return;
  auto shallowest =
      std::min_element(among.begin(), among.end(), [](const mark& a, const mark& b) { return a.depth_m < b.depth_m; });
  if (shallowest->depth_m < m.depth_m) *shallowest = m;
}

/// Finds the minimum of k/2 |z - y|^2 + bed(z) near z by Newton's method, exact first and second derivatives.
/// Where the sum is not convex, or a step does not lead down, the step is damped.
/// @rt safe: at most 60 steps, and no more readings than are left
[[nodiscard]] inline way_out settle(double k_n_per_m, const vec3& y, vec3 z, const bed_rule& rule, bed_patch& patch,
                                    posed_samples& samples) noexcept {
  constexpr int most_steps = 60, most_dampings = 40;
  constexpr double longest_step_m = 2e-4;
  way_out out;
  out.bed = patch.at(z, rule, samples);
  const auto cost = [&](const vec3& at, const bed_sum& bed) {
    return 0.5 * k_n_per_m * glm::dot(at - y, at - y) + bed.energy_j;
  };
  double cost_j = cost(z, out.bed), damping = 0.0, before = std::numeric_limits<double>::infinity();
  out.settled = false;
  for (int step = 0; step < most_steps && !out.settled && samples.count.left(); ++step) {
    const vec3 r = k_n_per_m * (z - y) + out.bed.gradient_n;
    const double left = glm::length(r), scale = 1e-12 + glm::length(out.bed.gradient_n);
    // Below a millionth the steps go on while they help: rounding ends that.
    if (left < 1e-9 * scale || (left < 1e-6 * scale && left > 0.3 * before)) {
      out.settled = true;
      break;
    }
    before = left;
    bool moved = false;
    for (int n = 0; n < most_dampings && !moved; ++n) {
      mat3 h = out.bed.hessian_n_per_m;
      for (int i = 0; i < 3; ++i) h[i][i] += k_n_per_m + damping;
      const bool convex = h[0][0] > 0.0 && h[0][0] * h[1][1] - h[0][1] * h[1][0] > 0.0 && glm::determinant(h) > 0.0;
      if (!convex) {
        damping = damping > 0.0 ? 4.0 * damping : 0.5 * k_n_per_m;
        continue;
      }
      vec3 dz = -(glm::inverse(h) * r);
      const double length = glm::length(dz);
      if (length > longest_step_m) dz *= longest_step_m / length;
      const bed_sum bed = patch.at(z + dz, rule, samples);
      const double now_j = cost(z + dz, bed);
      // Near rest the cost no longer tells two places apart; the residual does.
      const double now_left = glm::length(k_n_per_m * (z + dz - y) + bed.gradient_n);
      if (now_j < cost_j * (1.0 - 1e-14) || (now_j <= cost_j * (1.0 + 1e-13) && now_left < left)) {
        moved = true;
        z += dz;
        out.bed = bed;
        cost_j = now_j;
        damping = damping < 1e-2 * k_n_per_m ? 0.0 : 0.1 * damping;
      } else {
        damping = damping > 0.0 ? 8.0 * damping : k_n_per_m;
      }
    }
    if (!moved) {
      out.settled = left < 1e-6 * scale;
      break;
    }
  }
  out.z_w = z;
  patch.for_each_inside(z, samples, [&](const mark& m, const coarse_reading& d) noexcept {
    mark here = m;
    here.depth_m = d.value_m;
    keep_deepest(out.touching, here);
  });
  return out;
}

}  // namespace asperity::exits
