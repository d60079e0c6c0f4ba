// Fine relief: seeded band-limited noise, and its displacement of a surface along its normals.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "asperity/core/math.hpp"
#include "asperity/model/triangle_mesh.hpp"

namespace asperity::models {

/// Smooth noise in space with values in (-peak, peak): a sum of sine waves in random directions whose wavelengths all
/// lie in a band. Band limited, so that a mesh of known edge length can resolve it.
class band_noise {
 public:
  /// @pre 0 < shortest_m <= longest_m
  band_noise(std::uint64_t seed, double shortest_m, double longest_m, double peak_m);

  [[nodiscard]] double operator()(const vec3& p) const noexcept;

 private:
  struct wave {
    vec3 k_rad_per_m;
    double phase_rad;
  };
  std::vector<wave> waves_;
  double peak_m_;
};

/// Moves every vertex along its normal by height(position). The relief fades out within fade_m of every sharp edge:
/// an edge keeps its place, and what moves on either side of it is a height field over a smooth surface.
void displace(triangle_mesh& mesh, double fade_m, const std::function<double(const vec3&)>& height_m);

}  // namespace asperity::models
