// Fits the relief of a depth field to the fine surface.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "asperity/field/body_field.hpp"
#include "asperity/field/fine_surface.hpp"

namespace asperity::detail {

/// Least squares over points of the fine surface: at the foot of each, the relief is what the smooth part lacks there.
///
/// A B-spline with samples as coefficients would smooth the texture away; the fit does not. It goes by simultaneous
/// iteration (SIRT: residuals, averaged at the nodes by their weights, correct the coefficients). The first pass
/// averages, and counts each point above and below the surface along its normal, so that the relief does not change
/// across the surface. The others correct what is read at the feet, with Chebyshev's step lengths for wavelengths from
/// three pitches up, and go on where residuals are left: beside sharp edges.
///
/// All passes go brick by brick, over a dense copy of a brick with what lies around it.
/// @source Gilbert, Iterative methods for the three-dimensional reconstruction of an object from projections, 1972
class relief_fit {
 public:
  /// @param points  about how many there will be   @param fine_enough_m  residuals that need no further pass
  relief_fit(relief_bricks& out, const body_field& field, double points, double fine_enough_m)
      : out_(out), field_(field), fine_enough_(static_cast<float>(fine_enough_m)) {
    points_.reserve(static_cast<std::size_t>(points));
    out_.index.assign(out_.bricks_along[0] * out_.bricks_along[1] * out_.bricks_along[2], 0);
  }

  /// Takes a point of the fine surface. What the smooth part has lost or buried (a fold of the texture) is left out.
  void add(const vec3& p_b) {
    const coarse_reading at = read_smooth(p_b);
    if (!(std::fabs(at.value_m) < 1.25 * field_.smooth.pitch_m)) return;
    const foot_and_fade foot = field_.foot(p_b, at);
    const double length = std::sqrt(glm::dot(at.slope, at.slope));
    if (!(length > 0.05) || !(foot.fade > 0.25)) return;
    const vec3 q = (foot.foot_b - out_.low) / out_.pitch_m;
    const vec3 along = off_surface / length * at.slope;
    const auto wanted = static_cast<float>(-at.value_m / foot.fade);
    point p{{}, glm::vec3(along), wanted, 0};
    std::array<std::size_t, 3> brick{};
    std::array<std::array<std::size_t, 3>, 2> first{}, last{};  // bricks, by side
    for (std::size_t k = 0; k < 3; ++k) {
      const int axis = static_cast<int>(k);
      // Three nodes around the places above and below.
      if (!(q[axis] >= 3.0 && q[axis] < static_cast<double>(side * out_.bricks_along[k]) - 3.0)) return;
      brick[k] = static_cast<std::size_t>(q[axis] + 0.5) / side;
      p.place[axis] = static_cast<float>(q[axis] - static_cast<double>(side * brick[k]));
      for (std::size_t s = 0; s < 2; ++s) {
        const auto middle = static_cast<std::size_t>(q[axis] + 0.5 + (s == 0 ? -along[axis] : along[axis]));
        first[s][k] = (middle - 1) / side;
        last[s][k] = (middle + 1) / side;
      }
    }
    p.cell = static_cast<std::uint32_t>((brick[2] * out_.bricks_along[1] + brick[1]) * out_.bricks_along[0] + brick[0]);
    for (std::size_t s = 0; s < 2; ++s) mark(first[s], last[s]);
    points_.push_back(p);
    lowest_ = std::min(lowest_, wanted);
    highest_ = std::max(highest_, wanted);
  }

  void solve() {
    sort();
    const std::size_t count = cells_.size();
    out_.bricks.assign(count, {});
    sum_.assign(count, {});
    weight_.assign(count, {});
    residual_.assign(count, 0.0F);
    for (std::size_t b = 1; b < count; ++b) average(b);
    correct(1.0F);
    std::fill(weight_.begin(), weight_.end(), relief_bricks::brick{});
    for (std::size_t b = 1; b < count; ++b) compare(b, true);
    correct(1.816F);
    for (int pass = 0; pass < most_passes; ++pass) {
      const std::vector<float> before = std::exchange(residual_, std::vector<float>(count, 0.0F));
      bool any = false;
      for (std::size_t b = 1; b < count; ++b) {
        if (!unsettled(b, before)) continue;
        any = true;
        compare(b, false);
      }
      if (!any) break;
      constexpr std::array<float, 4> steps{2.669F, 1.251F, 1.026F, 1.816F};
      correct(steps[static_cast<std::size_t>(pass) % 4]);
    }
    finish();
  }

 private:
  static constexpr std::size_t side = relief_bricks::side;
  static constexpr double off_surface = 0.6;  // pitches: reaches all nodes within two pitches of the surface
  static constexpr int most_passes = 2;

  struct point {
    glm::vec3 place;  // of the foot in its brick, in pitches from the brick's first node: -0.5 to 3.5
    glm::vec3 along;  // to the place above, pitches
    float relief_m;
    std::uint32_t cell;  // of its brick in the index
  };

  /// A brick and two nodes around it, and four floats that a row may be read beyond its end.
  static constexpr std::size_t across = side + 4, reach = 2;
  struct alignas(16) dense {
    std::array<float, across * across * across + 4> at{};
  };

  /// Weights of the three nodes around a place.
  struct stencil {
    std::size_t first;  // node of a dense copy
    std::array<float, 4> x;
    std::array<float, 9> yz;

    explicit stencil(const glm::vec3& place) noexcept {
      std::array<std::size_t, 3> from{};
      std::array<std::array<float, 3>, 3> w{};
      for (std::size_t k = 0; k < 3; ++k) {
        const float g = place[static_cast<int>(k)] + (static_cast<float>(reach) + 0.5F);
        const auto middle = static_cast<std::size_t>(static_cast<std::int32_t>(g));
        const float f = g - 0.5F - static_cast<float>(static_cast<std::int32_t>(middle));
        from[k] = middle - 1;
        w[k] = {0.5F * (0.5F - f) * (0.5F - f), 0.75F - f * f, 0.5F * (0.5F + f) * (0.5F + f)};
      }
      first = (from[2] * across + from[1]) * across + from[0];
      x = {w[0][0], w[0][1], w[0][2], 0.0F};
      for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t j = 0; j < 3; ++j) yz[3 * k + j] = w[2][k] * w[1][j];
      }
    }

    [[nodiscard]] std::size_t row(std::size_t n) const noexcept { return first + (n / 3 * across + n % 3) * across; }

    [[nodiscard]] float read(const dense& from) const noexcept {
      std::array<float, 4> sum{};
      for (std::size_t n = 0; n < 9; ++n) {
        const float* const r = from.at.data() + row(n);
        for (std::size_t i = 0; i < 4; ++i) sum[i] += yz[n] * r[i];
      }
      return sum[0] * x[0] + sum[1] * x[1] + sum[2] * x[2];
    }

    /// Adds a number by the weights. Whole rows, so that what one point stores the next can load.
    void add(dense& to, float number) const noexcept {
      const std::size_t in_row = first % across, start = first - in_row;
      std::array<float, across> wide{};
      for (std::size_t i = 0; i < 3; ++i) wide[in_row + i] = number * x[i];
      for (std::size_t n = 0; n < 9; ++n) {
        float* const r = to.at.data() + start + (n / 3 * across + n % 3) * across;
        for (std::size_t i = 0; i < across; ++i) r[i] += yz[n] * wide[i];
      }
    }
  };

  /// Value and slope of the smooth part, in single precision: some 1e-6 pitches.
  [[nodiscard]] coarse_reading read_smooth(const vec3& p_b) const noexcept {
    const coarse_grid& grid = field_.smooth;
    coarse_reading out;
    std::array<std::size_t, 3> first{};
    std::array<std::array<float, 4>, 3> value{}, slope{};
    for (std::size_t k = 0; k < 3; ++k) {
      const int axis = static_cast<int>(k);
      const double g = (p_b[axis] - grid.low[axis]) / grid.pitch_m;
      if (!(g >= 1.0 && g < static_cast<double>(grid.nodes[k]) - 2.0)) {
        out.value_m = -1e30;
        return out;
      }
      first[k] = static_cast<std::size_t>(g) - 1;
      const cubic_weights w(g - 1.0 - static_cast<double>(first[k]));
      for (std::size_t i = 0; i < 4; ++i) {
        value[k][i] = static_cast<float>(w.value[i]);
        slope[k][i] = static_cast<float>(w.slope[i]);
      }
    }
    std::array<float, 4> s{}, sy{}, sz{};
    for (std::size_t k = 0; k < 4; ++k) {
      for (std::size_t j = 0; j < 4; ++j) {
        const float* const row = grid.value.data() + grid.at(first[0], first[1] + j, first[2] + k);
        const float w = value[1][j] * value[2][k], wy = slope[1][j] * value[2][k], wz = value[1][j] * slope[2][k];
        for (std::size_t i = 0; i < 4; ++i) s[i] += w * row[i];
        for (std::size_t i = 0; i < 4; ++i) sy[i] += wy * row[i];
        for (std::size_t i = 0; i < 4; ++i) sz[i] += wz * row[i];
      }
    }
    glm::vec3 by(0.0F);
    float v = 0.0F;
    for (std::size_t i = 0; i < 4; ++i) {
      v += value[0][i] * s[i];
      by += glm::vec3(slope[0][i] * s[i], value[0][i] * sy[i], value[0][i] * sz[i]);
    }
    out.value_m = static_cast<double>(v);
    out.slope = vec3(by) / grid.pitch_m;
    return out;
  }

  /// Numbers the bricks that are asked for.
  void mark(const std::array<std::size_t, 3>& first, const std::array<std::size_t, 3>& last) {
    for (std::size_t z = first[2]; z <= last[2]; ++z) {
      for (std::size_t y = first[1]; y <= last[1]; ++y) {
        for (std::size_t x = first[0]; x <= last[0]; ++x) {
          const std::size_t cell = (z * out_.bricks_along[1] + y) * out_.bricks_along[0] + x;
          if (out_.index[cell] != 0) continue;
          out_.index[cell] = static_cast<std::uint32_t>(cells_.size());
          cells_.push_back(static_cast<std::uint32_t>(cell));
        }
      }
    }
  }

  /// Brings the points in the order of their bricks.
  void sort() {
    first_.assign(cells_.size() + 1, 0);
    for (const point& p : points_) ++first_[out_.index[p.cell] + 1];
    for (std::size_t b = 1; b < first_.size(); ++b) first_[b] += first_[b - 1];
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    std::vector<point> sorted(points_.size());
    for (const point& p : points_) sorted[next[out_.index[p.cell]]++] = p;
    points_ = std::move(sorted);
  }

  /// Calls visit(brick, number) for a brick and the 26 around it; number 0 to 26, x fastest.
  template <class Visit>
  void for_each_beside(std::size_t brick, Visit&& visit) const noexcept {
    const auto [nx, ny, nz] = out_.bricks_along;
    const std::size_t cell = cells_[brick], x = cell % nx, y = cell / nx % ny, z = cell / (nx * ny);
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t j = 0; j < 3; ++j) {
        for (std::size_t i = 0; i < 3; ++i) {
          const bool inside = x + i >= 1 && x + i <= nx && y + j >= 1 && y + j <= ny && z + k >= 1 && z + k <= nz;
          visit(inside ? out_.index[((z + k - 1) * ny + y + j - 1) * nx + x + i - 1] : 0U, (3 * k + j) * 3 + i);
        }
      }
    }
  }

  [[nodiscard]] std::array<std::uint32_t, 27> beside(std::size_t brick) const noexcept {
    std::array<std::uint32_t, 27> out{};
    for_each_beside(brick, [&](std::uint32_t b, std::size_t number) noexcept { out[number] = b; });
    return out;
  }

  /// Calls visit(three bricks, where their rows begin, where the dense row begins) for the rows around a brick.
  template <class Visit>
  static void for_each_row(const std::array<std::uint32_t, 27>& around, std::size_t margin, Visit&& visit) noexcept {
    for (std::size_t z = reach - margin; z < side + reach + margin; ++z) {
      for (std::size_t y = reach - margin; y < side + reach + margin; ++y) {
        const std::size_t bz = (z + side - reach) / side, by = (y + side - reach) / side;
        const std::size_t row = ((z + side - reach) % side * side + (y + side - reach) % side) * side;
        visit(around.data() + (3 * bz + by) * 3, row, (z * across + y) * across);
      }
    }
  }

  static void scatter(const dense& from, const std::array<std::uint32_t, 27>& around, std::size_t margin,
                      std::vector<relief_bricks::brick>& to) noexcept {
    for_each_row(around, margin, [&](const std::uint32_t* bricks, std::size_t row, std::size_t at) noexcept {
      const float* const r = from.at.data() + at;
      float *const low = to[bricks[0]].data() + row, *const own = to[bricks[1]].data() + row;
      float* const high = to[bricks[2]].data() + row;
      for (std::size_t i = 0; i < reach; ++i) low[side - reach + i] += r[i];
      for (std::size_t i = 0; i < side; ++i) own[i] += r[reach + i];
      for (std::size_t i = 0; i < reach; ++i) high[i] += r[reach + side + i];
    });
  }

  /// What the points of a brick want, above and below the surface.
  void average(std::size_t brick) noexcept {
    if (first_[brick] == first_[brick + 1]) return;
    dense sum, weight;
    for (std::size_t i = first_[brick]; i < first_[brick + 1]; ++i) {
      const point& p = points_[i];
      for (const float way : {-1.0F, 1.0F}) {
        const stencil at(p.place + way * p.along);
        at.add(weight, 1.0F);
        at.add(sum, p.relief_m);
      }
    }
    const auto around = beside(brick);
    scatter(sum, around, reach, sum_);
    scatter(weight, around, reach, weight_);
  }

  /// What the points of a brick want, less what is read at their feet.
  void compare(std::size_t brick, bool weigh) noexcept {
    if (first_[brick] == first_[brick + 1]) return;
    const auto around = beside(brick);
    dense value, sum, weight;
    for_each_row(around, 1, [&](const std::uint32_t* bricks, std::size_t row, std::size_t at) noexcept {
      float* const r = value.at.data() + at;
      const float *const own = out_.bricks[bricks[1]].data() + row, *const low = out_.bricks[bricks[0]].data() + row;
      r[reach - 1] = low[side - 1];
      for (std::size_t i = 0; i < side; ++i) r[reach + i] = own[i];
      r[reach + side] = out_.bricks[bricks[2]][row];
    });
    float most = 0.0F;
    for (std::size_t i = first_[brick]; i < first_[brick + 1]; ++i) {
      const point& p = points_[i];
      const stencil at(p.place);
      const float rest = p.relief_m - at.read(value);
      most = std::max(most, std::fabs(rest));
      at.add(sum, rest);
      if (weigh) at.add(weight, 1.0F);
    }
    residual_[brick] = most;
    scatter(sum, around, 1, sum_);
    if (weigh) scatter(weight, around, 1, weight_);
  }

  /// Whether points of a brick or beside it are not met yet. @param residual by brick
  [[nodiscard]] bool unsettled(std::size_t brick, const std::vector<float>& residual) const noexcept {
    if (first_[brick] == first_[brick + 1]) return false;
    bool out = false;
    for_each_beside(brick, [&](std::uint32_t b, std::size_t) noexcept { out = out || residual[b] > fine_enough_; });
    return out;
  }

  void correct(float step) noexcept {
    for (std::size_t b = 1; b < sum_.size(); ++b) {
      for (std::size_t n = 0; n < relief_bricks::nodes_per_brick; ++n) {
        out_.bricks[b][n] += step * sum_[b][n] / (weight_[b][n] + 1e-30F);  // no weight, no sum
        sum_[b][n] = 0.0F;
      }
    }
    // The first one stands for all places without a brick.
    sum_[0] = {};
  }

  void finish() {
    for (std::size_t b = 1; b < out_.bricks.size(); ++b) {
      for (float& c : out_.bricks[b]) {
        // Beside few points, at sharp corners, a coefficient is not well known, and all of them bound the relief.
        c = std::min(std::max(1.25F * lowest_, c), 1.25F * highest_);
      }
    }
    points_ = {};
    sum_ = weight_ = {};
  }

  relief_bricks& out_;
  const body_field& field_;
  float fine_enough_;
  std::vector<point> points_;
  std::vector<std::uint32_t> cells_{0};  // of the bricks, in the index
  std::vector<std::uint32_t> first_;     // of each brick's points
  std::vector<relief_bricks::brick> sum_, weight_;
  std::vector<float> residual_;           // the largest of each brick's points
  float lowest_ = 0.0F, highest_ = 0.0F;  // of the points' relief, and zero
};

}  // namespace asperity::detail
