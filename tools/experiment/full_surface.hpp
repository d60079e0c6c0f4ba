// How deep two full-resolution meshes lie in each other along world z: a measure that shares no code with the renderer.
#pragma once

#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/core/pose.hpp"
#include "asperity/model/triangle_mesh.hpp"

namespace asperity::experiment {

/// The upper side of a body at rest, as the highest point of its triangles over a square lattice.
class surface_from_above {
 public:
  /// @param T_wb      pose of the body
  /// @param middle_m, half_m  square that is of interest, world x and y
  /// @param step_m    lattice constant; heights are interpolated in between
  surface_from_above(const triangle_mesh& full, const pose& T_wb, const vec3& middle_m, double half_m, double step_m);

  /// World z of the surface; minus infinity where there is none.
  [[nodiscard]] double height(double x_m, double y_m) const noexcept;

 private:
  void draw(const vec3& a, const vec3& b, const vec3& c);
  [[nodiscard]] double& at(long i, long j) noexcept { return z_[static_cast<std::size_t>(j * n_ + i)]; }
  [[nodiscard]] double at(long i, long j) const noexcept { return z_[static_cast<std::size_t>(j * n_ + i)]; }

  double x0_, y0_, step_;
  long n_;
  std::vector<double> z_;
};

/// Deepest point of `points_a` under the surface, along world z; negative: the gap. Minus infinity where no point is
/// over it.
[[nodiscard]] double depth_along_z(const surface_from_above& fixed, const std::vector<vec3>& points_a,
                                   const pose& T_wa) noexcept;

}  // namespace asperity::experiment
