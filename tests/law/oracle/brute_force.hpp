// Directional penetration depth of two full-resolution meshes, with no haptic texture, no atlas and none of the
// library's depth code: every triangle of both meshes is drawn into the contact window, and the heights are compared.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "asperity/core/pose.hpp"
#include "asperity/model/coarse_mesh.hpp"
#include "asperity/model/triangle_mesh.hpp"
#include "asperity/render/contact.hpp"

namespace asperity::oracle {

/// One body as the oracle sees it: the original surface, and the coarse patch that says where the contact is.
struct body {
  const triangle_mesh* full;
  const coarse_mesh* coarse;
  std::span<const std::uint32_t> patch;  ///< coarse triangles of the contact
  pose T_w;                              ///< body to world
  double displacement_m;                 ///< largest distance between the original and the coarse surface
};

/// A largest height difference and how steep the two surfaces are there (|dh/du, dh/dv|).
struct deepest_place {
  double depth_m = 0.0;
  double slope_a = 0.0, slope_b = 0.0;
};

struct brute_force_depth {
  deepest_place dense;      ///< on a grid refined `refinement` times
  deepest_place grid;       ///< on the cell centres of the N x N grid itself
  std::size_t samples = 0;  ///< samples of the N x N grid where both surfaces exist
};

/// Depth along window.n_ab_w over the window. A line (u, v) counts where it crosses both coarse patches on a side that
/// faces the other body (N_A . n > 0.1, N_B . n < -0.1); the full-resolution height there is that of the crossing next
/// to the coarse one.
/// @param grid        samples per side, N
/// @param refinement  odd factor, so that the cell centres of the N x N grid are among the dense samples
[[nodiscard]] brute_force_depth measure_brute_force(const body& a, const body& b, const contact_window& window,
                                                    int grid, int refinement);

}  // namespace asperity::oracle
