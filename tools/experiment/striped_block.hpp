// The striped block of the paper's Figs. 7 and 8: the benchmark's block, with ridges that run out into the valleys.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "workbench.hpp"

namespace asperity::experiment {

// The ridges of the benchmark's own block end at mid height. On a second block that rim lies on the ends of the other
// one's ridges, on a gear on its crests, and decides where the block rests. These end below everything.

/// Half the block's extents at mid height, m. It is 2 mm longer than the benchmark's: run-outs and all.
inline constexpr std::array<double, 3> block_half_m{21e-3, 0.5 * models::block_size_m[1],
                                                    0.5 * models::block_size_m[2]};

/// Length along x over which a ridge runs out into the valleys beside it, at either end, m.
inline constexpr double ridge_run_out_m = 2e-3;

/// Half the length over which a ridge has its full height, m.
inline constexpr double ridge_half_length_m = block_half_m[0] - ridge_run_out_m;

/// Height of the ridges, valley to crest, m.
inline constexpr double ridge_height_m = 2.0 * models::ridge_amplitude_m;

/// Height of top and bottom over their own mid planes at (x, y), away from the block's middle for the top: both move
/// together, except where ridges run out.
struct ridge_heights {
  double top_m, bottom_m;
};
[[nodiscard]] inline ridge_heights ridges_at(double x_m, double y_m) noexcept {
  const double t = std::clamp((block_half_m[0] - std::abs(x_m)) / ridge_run_out_m, 0.0, 1.0);
  const double share = t * t * (3.0 - 2.0 * t);
  const double wave = std::cos(2.0 * std::numbers::pi / models::ridge_wavelength_m * y_m);
  const double ridge_m = share * models::ridge_amplitude_m * wave;
  const double sunk_m = (1.0 - share) * models::ridge_amplitude_m;
  return {ridge_m - sunk_m, ridge_m + sunk_m};
}

/// Centred at the origin. @return what baking says
[[nodiscard]] result<model_ptr> striped_block(workbench& bench);

}  // namespace asperity::experiment
