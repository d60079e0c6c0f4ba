// Contacts of two baked models in the windows that the library's finder chose, and how far its depths are from those of
// the two originals in the same windows. The poses are the sampler's (approach.hpp); see originals_agree.hpp for what
// needs no word of the finder at all.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "asperity/control/contact_loop.hpp"
#include "asperity/least_motion/least_motion_renderer.hpp"
#include "asperity/model/triangle_mesh.hpp"
#include "asperity/window/window_renderer.hpp"

namespace asperity::oracle {

/// A baked model and the mesh that it was baked from, in metres.
struct original_and_bake {
  std::string name;
  triangle_mesh full;
  model_ptr model;
};

/// The bake reports how far its texels lie from the coarse surface, and how far they may be from the original.
[[nodiscard]] inline double reach(const original_and_bake& b) {
  return b.model->report.max_displacement_m + b.model->report.max_error_m;
}

/// Depth of the deepest contact; minus infinity where nothing touches.
[[nodiscard]] inline double deepest(const tick& t) {
  double d = -std::numeric_limits<double>::infinity();
  for (const penetration& p : t.depths) {
    if (!has(p.flags, depth_flag::no_overlap)) d = std::max(d, p.depth_m);
  }
  return d;
}

/// What a pair of bodies came to.
struct comparison {
  int poses = 0;
  int touching = 0;  ///< poses with a contact that both sides see
  int contacts = 0;
  int beyond = 0;                    ///< further from the true depth than sampling and bakes explain
  int disagreed = 0;                 ///< contacts that one side sees and the other does not
  double worst_share = 0.0;          ///< of the bound
  double rms_error_m = 0.0;          ///< of both bakes
  std::vector<double> errors_m;      ///< from the originals on the finer grid
  std::vector<double> on_grid_m;     ///< from the originals on the same grid: what sampling has no part in
  std::vector<double> untextured_m;  ///< the same of the coarse surfaces alone: what a lost texture would show
};

inline constexpr int comparison_grid = 64;
inline constexpr int comparison_refinement = 5;

/// One contact that both sides see.
struct compared_contact {
  double depth_m = 0.0;      ///< the library's
  double originals_m = 0.0;  ///< on the finer grid
  double on_grid_m = 0.0, untextured_m = 0.0;
  double bound_m = 0.0;  ///< what sampling and bakes explain
  [[nodiscard]] double error_m() const noexcept { return std::fabs(depth_m - originals_m); }
};

/// The paper's renderer with the grid of these comparisons.
[[nodiscard]] window_renderer make_compared(const original_and_bake& a, const original_and_bake& b);

/// Every contact of the paper's renderer at a pose. A bake's error is a distance across the surface; along n a slope
/// makes it longer. A wall, where that has no limit, counts as `steepest` (1: 45 degrees).
/// @param disagreed raised by contacts that one side sees and the other does not
[[nodiscard]] std::vector<compared_contact> compare_contacts(window_renderer& feel, const original_and_bake& a,
                                                             const original_and_bake& b, const pose& T_wa,
                                                             double steepest, int& disagreed);

/// Compares contacts at that many poses of the sampler, pressed on by up to half a millimetre.
[[nodiscard]] comparison compare_with_originals(const original_and_bake& a, const original_and_bake& b, int poses,
                                                std::uint64_t seed, double steepest = 1.0);

[[nodiscard]] double percentile(std::vector<double> values, double share);

/// A line of the table that print_heading() begins.
void print_heading();
void print_row(const original_and_bake& a, const original_and_bake& b, const comparison& c);

}  // namespace asperity::oracle
