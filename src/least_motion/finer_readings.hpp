// Where the relief may move among the finer nodes of a brick, by sums along one axis after the other.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "asperity/field/bspline.hpp"
#include "asperity/field/coarse_grid.hpp"
#include "least_motion/kept_relief.hpp"
#include "least_motion/moving_shape.hpp"

namespace asperity::exits {

/// Readings of S at the nodes of one brick of a moving shape that no other brick has, as floats: a tenth of the cost of
/// coarse_grid::read() at each, because neighbours share the sums along the axes before. They only tell at which nodes
/// the exact reading is worth its cost.
class finer_readings {
 public:
  /// @param first node of S at the brick's first node
  finer_readings(const detail::coarse_grid& grid, const std::array<std::size_t, 3>& first) noexcept {
    for (std::size_t k = 0; k < 3; ++k) {
      // Beside the grid's rim, readings are of other kinds.
      if (first[k] < 2 || first[k] + across + 1 > grid.nodes[k]) return;
    }
    read(grid, first);
    known_ = true;
  }

  /// Whether some of the relief may move at a node, x fastest.
  [[nodiscard]] bool may_move(std::size_t node) const noexcept {
    if (!known_) return true;
    const float square = x_[node] * x_[node] + y_[node] * y_[node] + z_[node] * z_[node];
    // Sums of 125 floats that are a few pitches, times weights of which none exceeds 2.
    constexpr double error = 1e-3;
    return kept_relief::may_move(static_cast<double>(std::fabs(s_[node])), static_cast<double>(square),
                                 static_cast<double>(bend_[node]), error);
  }

 private:
  static constexpr std::size_t finer = moving_shape::finer, cells = moving_shape::cells, own = cells * finer;
  static constexpr std::size_t across = cells + 3;  // nodes of S that are read along an axis, from one before the brick

  // What each node of S gives to each node of a row: to S and to its first two derivatives, per pitch.
  struct row_weights {
    std::array<std::array<float, own>, across> value{}, slope{}, bend{};

    row_weights() noexcept {
      for (std::size_t n = 0; n < own; ++n) {
        const detail::cubic_weights w(static_cast<double>(n % finer) / static_cast<double>(finer));
        for (std::size_t q = 0; q < 4; ++q) {
          value[n / finer + q][n] = static_cast<float>(w.value[q]);
          slope[n / finer + q][n] = static_cast<float>(w.slope[q]);
          bend[n / finer + q][n] = static_cast<float>(w.bend[q]);
        }
      }
    }
  };

  void read(const detail::coarse_grid& grid, const std::array<std::size_t, 3>& first) noexcept {
    static const row_weights w;
    const auto per_pitch = static_cast<float>(1.0 / grid.pitch_m);
    for (std::size_t k = 0; k < across; ++k) {
      // Of one layer of nodes: sums along x, then along y too.
      std::array<float, own * own> s{}, x{}, y{}, xx_yy{};
      for (std::size_t j = 0; j < across; ++j) {
        const float* const row = grid.value.data() + grid.at(first[0] - 1, first[1] - 1 + j, first[2] - 1 + k);
        std::array<float, own> v{}, vx{}, vxx{};
        for (std::size_t q = 0; q < across; ++q) {
          const float c = per_pitch * row[q];
          for (std::size_t n = 0; n < own; ++n) {
            v[n] += w.value[q][n] * c;
            vx[n] += w.slope[q][n] * c;
            vxx[n] += w.bend[q][n] * c;
          }
        }
        for (std::size_t m = 0; m < own; ++m) {
          const float value = w.value[j][m], slope = w.slope[j][m], bend = w.bend[j][m];
          for (std::size_t n = 0; n < own; ++n) {
            s[m * own + n] += value * v[n];
            x[m * own + n] += value * vx[n];
            y[m * own + n] += slope * v[n];
            xx_yy[m * own + n] += value * vxx[n] + bend * v[n];
          }
        }
      }
      for (std::size_t l = 0; l < own; ++l) {
        const float value = w.value[k][l], slope = w.slope[k][l], bend = w.bend[k][l];
        if (value == 0.0F && slope == 0.0F && bend == 0.0F) continue;
        float *const to_s = s_.data() + l * own * own, *const to_x = x_.data() + l * own * own;
        float *const to_y = y_.data() + l * own * own, *const to_z = z_.data() + l * own * own;
        float* const to_bend = bend_.data() + l * own * own;
        for (std::size_t n = 0; n < own * own; ++n) {
          to_s[n] += value * s[n];
          to_x[n] += value * x[n];
          to_y[n] += value * y[n];
          to_z[n] += slope * s[n];
          to_bend[n] += value * xx_yy[n] + bend * s[n];
        }
      }
    }
  }

  bool known_ = false;
  std::array<float, own * own * own> s_{}, x_{}, y_{}, z_{}, bend_{};
};

}  // namespace asperity::exits
