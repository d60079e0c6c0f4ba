// How much each of several ways out counts: weights that are not negative and add up to 1.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "asperity/core/fixed_vector.hpp"
#include "asperity/core/math.hpp"
#include "least_motion/way_out.hpp"

namespace asperity::exits {

/// Ways out of one pose.
using ways_out = fixed_vector<way_out, 24>;

/// The place y to which the springs of ways out with these weights pull back.
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

/// The weights of a few ways out at which all cost the same, adding up to 1; some may be negative. Where the ways out
/// do not determine them, being more than four or in one line, those that lead to the cheapest mixture. False where a
/// number is not finite.
/// @param cost  each/2 z^2 + bed, in the order of z, N/m times square metres   @rt safe
template <std::size_t N>
[[nodiscard]] bool even_weights(const fixed_vector<vec3, N>& z, const fixed_vector<double, N>& cost, double curvature,
                                std::array<double, N>& weight) noexcept {
  // Rows: curvature z_i . sum w z + slight w_i - nu = -cost_i, and sum w = 1; in units in which the longest way is 1.
  constexpr double slight = 1e-10;
  const std::size_t n = z.size();
  double unit = 1e-30;
  for (const vec3& p : z) unit = std::max(unit, curvature * glm::dot(p, p));
  std::array<std::array<double, N + 2>, N + 1> a{};
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) a[i][j] = curvature * glm::dot(z[i], z[j]) / unit;
    a[i][i] += slight;
    a[i][n] = -1.0;
    a[n][i] = 1.0;
    a[i][n + 1] = -cost[i] / unit;
  }
  a[n][n + 1] = 1.0;
  for (std::size_t k = 0; k <= n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i <= n; ++i) {
      if (std::fabs(a[i][k]) > std::fabs(a[pivot][k])) pivot = i;
    }
    if (!(std::fabs(a[pivot][k]) > 0.0)) return false;
    std::swap(a[k], a[pivot]);
    for (std::size_t i = k + 1; i <= n; ++i) {
      const double f = a[i][k] / a[k][k];
      for (std::size_t j = k; j <= n + 1; ++j) a[i][j] -= f * a[k][j];
    }
  }
  std::array<double, N + 1> x{};
  for (std::size_t k = n + 1; k-- > 0;) {
    double sum = a[k][n + 1];
    for (std::size_t j = k + 1; j <= n; ++j) sum -= a[k][j] * x[j];
    x[k] = sum / a[k][k];
  }
  std::copy_n(x.begin(), n, weight.begin());
  return true;
}

/// Sets the weights to those of the least energy, a convex problem, and returns seen_from() for them.
///
/// By active sets: finds the weights at which all ways out with weight cost the same; drops one whose weight would be
/// negative; adds one that is cheaper. Four are enough in general, since their motions lie in three dimensions.
/// @rt safe: at most 100 sets
inline vec3 mix(ways_out& ways, const exit_springs& k) noexcept {
  constexpr std::size_t most_active = 8;
  const double curvature = k.each * k.each / (k.mixed - k.each);
  const auto own_cost = [&](const way_out& w) { return k.pull_j(w.z_w, vec3(0.0)) + w.bed.energy_j; };
  fixed_vector<way_out*, most_active> active;
  double sum = 0.0;
  for (way_out& w : ways) {
    if (!(w.weight > 0.0) || !active.push_back(&w)) w.weight = 0.0;
    sum += w.weight;
  }
  for (way_out* w : active) w->weight /= sum;
  const auto drop = [&](std::size_t i) {
    active[i]->weight = 0.0;
    std::copy(active.begin() + i + 1, active.end(), active.begin() + i);
    active.truncate(active.size() - 1);
  };
  for (int set = 0; set < 100 && ways.size() > 1; ++set) {
    fixed_vector<vec3, most_active> z;
    fixed_vector<double, most_active> cost;
    for (const way_out* w : active) {
      static_cast<void>(z.push_back(w->z_w));
      static_cast<void>(cost.push_back(own_cost(*w)));
    }
    std::array<double, most_active> even{};
    if (!even_weights(z, cost, curvature, even)) break;
    double share = 1.0;
    std::size_t first = active.size();
    for (std::size_t i = 0; i < active.size(); ++i) {
      if (even[i] >= 0.0) continue;
      const double here = active[i]->weight / (active[i]->weight - even[i]);
      if (here < share) {
        share = here;
        first = i;
      }
    }
    for (std::size_t i = 0; i < active.size(); ++i) active[i]->weight += share * (even[i] - active[i]->weight);
    if (first < active.size()) {
      drop(first);
      continue;
    }
    const vec3 y = seen_from(ways, k);
    const double level = active[0]->cost_j(k, y);
    way_out* cheapest = nullptr;
    double least = level * (1.0 - 1e-12);
    for (way_out& w : ways) {
      if (w.weight > 0.0 || !(w.cost_j(k, y) < least)) continue;
      least = w.cost_j(k, y);
      cheapest = &w;
    }
    if (cheapest == nullptr || !active.push_back(cheapest)) break;
  }
  return seen_from(ways, k);
}

}  // namespace asperity::exits
