// Settings of the depth backends that measure windows.
#pragma once

#include <cstdint>

#include "asperity/core/export.hpp"
#include "asperity/core/status.hpp"

namespace asperity {

/// How the gradient of the directional penetration depth is taken.
enum class gradient_scheme : std::uint8_t {
  central_difference,  ///< the paper's: the depth at 11 poses of the probe (Eq. 7); no curvature
  soft_max,            ///< one pass: exact gradient and curvature of a smooth maximum
};

/// Which fine point stands for a sample of the window.
enum class parallax_mode : std::uint8_t {
  paper_lookup,  ///< the texel that belongs to the coarse hit (Eq. 8); it may lie beside the sample
  exact,         ///< the point of the textured surface that lies over the sample
};

/// Point about which central differences rotate the probe. The result is transported to the centre of mass.
enum class rotation_origin : std::uint8_t {
  contact,         ///< the window's centre: the step at the contact is the step that was asked for
  centre_of_mass,  ///< for experiments: twenty times the error at the same step where the lever arm is long
};

/// Settings of a depth backend. Zero means "choose for me" where a field says so. SI units.
struct window_depth_settings {
  gradient_scheme gradient = gradient_scheme::soft_max;
  parallax_mode parallax = parallax_mode::exact;

  /// Samples per side of the window; 2 to max_grid. 64, not the paper's 50: 50 locks to common ridge pitches.
  std::uint32_t grid = 64;

  /// Softness of the maximum, m. 0: 2 % of the larger peak to valley of the two bodies' reliefs (of the sine with
  /// the same mean square height), and at least 20 millionths of the smaller body's diagonal, so that untextured faces
  /// do not chatter either.
  double tau_m = 0.0;

  /// A0 of the soft maximum, m^2: the contact area at which the soft depth equals the deepest sample. 0: 2 pi tau /
  /// kappa with kappa the sum of both textures' typical peak curvatures. Constant per pair of bodies, never the area of
  /// the moment: the potential would change without any motion.
  double reference_area_m2 = 0.0;

  /// Step of the central differences at the contact, m. 0: max(p/2, min(p, lambda/20)) and at least half a texel, with
  /// p the sample pitch and lambda the textures' typical wavelength.
  double difference_step_m = 0.0;
  rotation_origin origin = rotation_origin::contact;

  /// Distance over which samples fade in from a silhouette or patch boundary, m (soft maximum only).
  /// 0: a tenth of the window's half size.
  double taper_m = 0.0;
  bool taper_silhouettes = true;  ///< without it a silhouette inside the window makes loops gain or lose energy
  /// Fade at the window's border too, so that a window that moves with the contact is smooth.
  bool taper_window = true;
  bool taper_gradient = true;  ///< false leaves out the gradient of the fade, for experiments: energy is not conserved

  /// A triangle takes part where |cosine| between its normal and n is above this and its normal faces the right way.
  double facing_cosine = 0.1;

  /// Fits a parabola around the deepest sample, for measurements: the hard maximum then no longer steps with the grid.
  bool refine_maximum = false;

  static constexpr std::uint32_t max_grid = 512;
};

/// Says which setting is out of range and what would do.
[[nodiscard]] ASPERITY_API result<void> check(const window_depth_settings& s);

}  // namespace asperity
