// Heights whose differences along the edges of a refined mesh are, as nearly as can be, what slopes say.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "bake/refine.hpp"

namespace asperity::bake {

struct slope_solution {
  std::vector<double> heights_m;  ///< per vertex; area-weighted mean zero on every component
  double slope_rms = 0.0;         ///< of the slopes asked for along edges, weighted with area
  double residual_rms = 0.0;      ///< of what is left of them
  std::size_t iterations = 0;
  bool converged = false;
};

/// Minimises the sum over the edges of every triangle of area / length^2 times the square of (difference of heights -
/// rise), by conjugate gradients in the hierarchical basis of the refinement.
/// @param originals vertices of the mesh that was refined
/// @param rise height that the slopes ask for along edge k of triangle t (from corner k to the next), m
/// @param keep_going asked on the way; false ends it, not converged
[[nodiscard]] slope_solution solve_slopes(const refined_mesh& mesh, std::size_t originals,
                                          const std::function<double(std::size_t t, std::size_t k)>& rise,
                                          const std::function<bool()>& keep_going = {});

}  // namespace asperity::bake
