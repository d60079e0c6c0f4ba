// Fits the relief of a depth field to the fine surface.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "asperity/field/body_field.hpp"
#include "asperity/field/fine_surface.hpp"

namespace asperity::detail {

/// Least squares over points of the fine surface: at the foot of each, the relief is what the smooth part lacks there.
///
/// A B-spline with samples as coefficients would smooth the texture away; the fit does not. It goes by simultaneous
/// iteration (SIRT: residuals, averaged at the nodes by their weights, correct the coefficients), with Chebyshev's step
/// lengths for wavelengths from three pitches up. Each point counts above and below the surface along its normal, so
/// that the relief does not change across the surface.
/// @source Gilbert, Iterative methods for the three-dimensional reconstruction of an object from projections, 1972
class relief_fit {
 public:
  relief_fit(relief_bricks& out, const body_field& field) : out_(out), field_(field) {}

  /// Takes a point of the fine surface. What the smooth part has lost or buried (a fold of the texture) is left out.
  void add(const vec3& p_b) {
    const coarse_reading at = field_.coarse(p_b);
    if (!(std::fabs(at.value_m) < 1.25 * field_.smooth.pitch_m)) return;
    const foot_and_fade foot = field_.foot(p_b, at);
    const double length = std::sqrt(glm::dot(at.slope, at.slope));
    if (!(length > 0.05) || !(foot.fade > 0.25)) return;
    lowest_ = std::min(lowest_, static_cast<float>(-at.value_m / foot.fade));
    highest_ = std::max(highest_, static_cast<float>(-at.value_m / foot.fade));
    points_.push_back({glm::vec3(foot.foot_b), glm::vec3(off_surface * out_.pitch_m / length * at.slope),
                       static_cast<float>(-at.value_m / foot.fade)});
  }

  void solve() {
    make_bricks();
    work_.assign(out_.bricks.size() * relief_bricks::nodes_per_brick, {});
    for_each_place([&](const relief_bricks::place& at, float wanted) noexcept {
      relief_bricks::for_each_node(at, [&](std::uint32_t b, std::size_t n, double w) noexcept {
        node& x = work_[b * relief_bricks::nodes_per_brick + n];
        x.weight += static_cast<float>(w);
        x.sum += static_cast<float>(w) * wanted;
      });
    });
    correct(1.816F);
    for (const float step : {1.026F, 2.669F, 1.251F}) {
      for_each_place([&](const relief_bricks::place& at, float wanted) noexcept {
        std::array<node*, 27> nodes;
        std::array<float, 27> weights;
        std::size_t i = 0;
        float rest = wanted;
        relief_bricks::for_each_node(at, [&](std::uint32_t b, std::size_t n, double w) noexcept {
          nodes[i] = &work_[b * relief_bricks::nodes_per_brick + n];
          weights[i] = static_cast<float>(w);
          rest -= weights[i] * nodes[i]->value;
          ++i;
        });
        for (i = 0; i < 27; ++i) nodes[i]->sum += weights[i] * rest;
      });
      correct(step);
    }
    for (std::size_t b = 1; b < out_.bricks.size(); ++b) {
      for (std::size_t n = 0; n < relief_bricks::nodes_per_brick; ++n) {
        // Beside few points, at sharp corners, a coefficient is not well known, and all of them bound the relief.
        const float c = work_[b * relief_bricks::nodes_per_brick + n].value;
        out_.bricks[b][n] = std::min(std::max(1.25F * lowest_, c), 1.25F * highest_);
      }
    }
    work_ = {};
  }

 private:
  static constexpr double off_surface = 0.6;  // pitches: reaches all nodes within two pitches of the surface

  struct point {
    glm::vec3 foot_b, along_n;
    float relief_m;
  };
  struct node {
    float value = 0.0F, weight = 0.0F, sum = 0.0F;
  };

  void correct(float step) noexcept {
    for (node& x : work_) {
      if (x.weight > 0.0F) x.value += step * x.sum / x.weight;
      x.sum = 0.0F;
    }
  }

  template <class Visit>
  void for_each_place(Visit&& visit) const {
    relief_bricks::place at;
    for (const point& p : points_) {
      for (const float side : {-1.0F, 1.0F}) {
        const vec3 q(p.foot_b + side * p.along_n);
        if (out_.find(q, at)) visit(at, p.relief_m);
      }
    }
  }

  void make_bricks() {
    out_.bricks.assign(1, relief_bricks::brick{});
    out_.index.assign(out_.bricks_along[0] * out_.bricks_along[1] * out_.bricks_along[2], 0);
    for (const point& p : points_) {
      for (const float side : {-1.0F, 1.0F}) {
        const vec3 q = (vec3(p.foot_b + side * p.along_n) - out_.low) / out_.pitch_m + 0.5;
        std::size_t first[3], last[3];
        bool known = true;
        for (std::size_t k = 0; k < 3; ++k) {
          const double g = q[static_cast<int>(k)];
          known = known && g >= 1.0 && g < static_cast<double>(relief_bricks::side * out_.bricks_along[k]) - 1.0;
          const std::size_t middle = known ? static_cast<std::size_t>(g) : 1;
          first[k] = (middle - 1) / relief_bricks::side;
          last[k] = (middle + 1) / relief_bricks::side;
        }
        if (!known) continue;
        for (std::size_t z = first[2]; z <= last[2]; ++z) {
          for (std::size_t y = first[1]; y <= last[1]; ++y) {
            for (std::size_t x = first[0]; x <= last[0]; ++x) {
              std::uint32_t& brick = out_.index[(z * out_.bricks_along[1] + y) * out_.bricks_along[0] + x];
              if (brick != 0) continue;
              brick = static_cast<std::uint32_t>(out_.bricks.size());
              out_.bricks.push_back({});
            }
          }
        }
      }
    }
    out_.bricks.shrink_to_fit();
  }

  relief_bricks& out_;
  const body_field& field_;
  std::vector<point> points_;
  std::vector<node> work_;
  float lowest_ = 0.0F, highest_ = 0.0F;  // of the points' relief, and zero
};

}  // namespace asperity::detail
