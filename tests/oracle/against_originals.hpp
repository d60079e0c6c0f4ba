// Contacts of two baked models, found by the library, and how far its depths are from those of the two originals in the
// same windows: what the tests of benchmark models and of real meshes have in common.
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
#include "asperity/model/triangle_mesh.hpp"

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

[[nodiscard]] inline double uniform(std::mt19937_64& rng, double low, double high) {
  return low + (high - low) * static_cast<double>(rng() >> 11) * 0x1p-53;
}
[[nodiscard]] vec3 random_direction(std::mt19937_64& rng);
[[nodiscard]] quat random_rotation(std::mt19937_64& rng);

/// A seeded pose at which the probe, coming from outside along a random direction with a random orientation, overlaps
/// by some tenths of a millimetre.
template <contact_renderer Renderer>
bool touching_pose(Renderer& r, std::mt19937_64& rng, pose& T_wa) {
  const textured_model& a = *r.scene().probe;
  const textured_model& b = *r.scene().fixed.front();
  const std::array<pose, 1> fixed{};
  const quat rotation = random_rotation(rng);
  const vec3 from = random_direction(rng);
  const vec3 centre_b = 0.5 * (b.box.low + b.box.high);
  const vec3 aside = glm::cross(from, random_direction(rng));
  const vec3 target = centre_b + 0.3 * uniform(rng, 0.0, 1.0) * b.box.diagonal() * aside;
  const vec3 centre_a = 0.5 * (a.box.low + a.box.high);
  const double wanted = uniform(rng, 0.0, 0.0004);
  const auto at = [&](double distance) { return pose{rotation, target + distance * from - rotation * centre_a}; };

  tick t;
  double outside = 0.5 * (a.box.diagonal() + b.box.diagonal()) + 0.4 * b.box.diagonal();
  const double step = 0.02 * std::min(a.box.diagonal(), b.box.diagonal());
  double inside = outside;
  do {  // march in until the first overlap, so that a thin part is not jumped over
    outside = inside;
    inside -= step;
    if (inside < -outside || r.step({at(inside), fixed}, t) != status::ok) return false;
  } while (!(deepest(t) > wanted));
  for (int i = 0; i < 12; ++i) {
    const double middle = 0.5 * (inside + outside);
    if (r.step({at(middle), fixed}, t) != status::ok) return false;
    (deepest(t) > wanted ? inside : outside) = middle;
  }
  T_wa = at(inside);
  return r.step({T_wa, fixed}, t) == status::ok && deepest(t) > 0.0;
}

/// What a pair of bodies came to.
struct comparison {
  int poses = 0;
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

/// Compares contacts of the paper's renderer in that many seeded poses. A bake's error is a distance across the
/// surface; along n a slope makes it longer. A wall, where that has no limit, counts as `steepest` (1: 45 degrees).
[[nodiscard]] comparison compare_with_originals(const original_and_bake& a, const original_and_bake& b, int poses,
                                                std::uint64_t seed, double steepest = 1.0);

[[nodiscard]] double percentile(std::vector<double> values, double share);

/// A line of the table that print_heading() begins.
void print_heading();
void print_row(const original_and_bake& a, const original_and_bake& b, const comparison& c);

}  // namespace asperity::oracle
