// Relief by formula, for a mesh without any: stripes, dots, roughness. Component asperity::bake.
#pragma once

#include <cstdint>

#include "asperity/bake/relief.hpp"
#include "asperity/core/status.hpp"
#include "asperity/model/triangle_mesh.hpp"

namespace asperity::bake {

/// Sine waves of one direction in space: where the surface follows that direction, their wavelength is the pitch.
struct stripes {
  double pitch_m = 0.002;
  double height_m = 0.0002;       ///< peak to valley, half of it above the mesh
  vec3 direction{1.0, 0.0, 0.0};  ///< across the stripes, body frame, any length but zero
};

/// Rounded bumps on the mesh, spread evenly at random: no two centres are closer than the pitch, and no room is left
/// for another one (Poisson disc sampling).
struct dots {
  double pitch_m = 0.002;
  double height_m = 0.0002;    ///< of a bump's top above the mesh
  double diameter_m = 0.0012;  ///< at a bump's foot; at most the pitch
  std::uint64_t seed = 1;
};

/// Gaussian roughness as a profilometer sees it: along any straight line on a flat face, in any direction, the power
/// spectral density falls as f^-spectral_slope between the wavelengths long_m and short_m, is flat below and reaches
/// zero at 1 / short_m. A self-affine surface of Hurst exponent H has the slope 2 H + 1.
struct roughness {
  double rms_m = 1e-5;          ///< Rq over the whole mesh; met exactly
  double spectral_slope = 2.0;  ///< 0 to 6
  double short_m = 0.0005;
  double long_m = 0.01;
  std::uint64_t seed = 1;
};

/// The relief is a function of the place in space (of the surface, for dots): it has no seams.
/// @return invalid_argument where a length is not positive, or out of order; limit_exceeded (more than a million dots)
[[nodiscard]] result<relief> make_stripes(const stripes& s);
[[nodiscard]] result<relief> make_dots(const dots& s, const triangle_mesh& mesh);
/// @source Nayak 1971 (the spectrum of a profile from that of an isotropic random field)
[[nodiscard]] result<relief> make_roughness(const roughness& s, const triangle_mesh& mesh);

}  // namespace asperity::bake
