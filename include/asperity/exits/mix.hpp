// How much each of several ways out counts: weights that are not negative and add up to 1.
#pragma once

#include <algorithm>
#include <cstddef>

#include "asperity/core/fixed_vector.hpp"
#include "asperity/core/math.hpp"
#include "asperity/exits/way_out.hpp"

namespace asperity::exits {

/// Ways out of one pose.
using ways_out = fixed_vector<way_out, 24>;

/// The place that ways out with these weights look from.
[[nodiscard]] inline vec3 seen_from(const ways_out& ways, const exit_springs& k) noexcept {
  vec3 mean(0.0);
  for (const way_out& w : ways) mean += w.weight * w.z_w;
  return k.seen_from(mean);
}

/// Energy of the mixture, J: sum of w (each/2 z^2 + bed) + each^2 / (2 (mixed - each)) (sum of w z)^2.
[[nodiscard]] inline double mixed_energy_j(const ways_out& ways, const exit_springs& k) noexcept {
  vec3 mean(0.0);
  double sum = 0.0;
  for (const way_out& w : ways) {
    mean += w.weight * w.z_w;
    sum += w.weight * (k.pull_j(w.z_w, vec3(0.0)) + w.bed.energy_j);
  }
  return sum + 0.5 * k.each * k.each / (k.mixed - k.each) * glm::dot(mean, mean);
}

/// Sets the weights to those of the least energy: a convex problem. Moves weight from the dearest way out that has
/// some to the cheapest, by as much as lowers the energy most, until none is dearer than another. Returns the place
/// that they look from.
/// @rt safe: at most 2000 moves
inline vec3 mix(ways_out& ways, const exit_springs& k) noexcept {
  vec3 y = seen_from(ways, k);
  for (int i = 0; i < 2000 && ways.size() > 1; ++i) {
    way_out *cheap = nullptr, *dear = nullptr;
    double least = 0.0, most = 0.0;
    for (way_out& w : ways) {
      const double cost = w.cost_j(k, y);
      if (cheap == nullptr || cost < least) {
        cheap = &w;
        least = cost;
      }
      if (w.weight > 0.0 && (dear == nullptr || cost > most)) {
        dear = &w;
        most = cost;
      }
    }
    if (dear == nullptr || most - least < 1e-13 * least + 1e-20) break;
    const vec3 apart = dear->z_w - cheap->z_w;
    const double curvature = k.each * k.each / (k.mixed - k.each) * glm::dot(apart, apart);
    const double moved = std::min(dear->weight, (most - least) / std::max(curvature, 1e-30));
    dear->weight = moved < dear->weight ? dear->weight - moved : 0.0;
    cheap->weight += moved;
    y = seen_from(ways, k);
  }
  return y;
}

}  // namespace asperity::exits
