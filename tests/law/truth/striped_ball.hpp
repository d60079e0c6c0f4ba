// A ball with stripes, as the library bakes it, and a small ball that is slid over it: what is exact about it.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "asperity/core/pose.hpp"
#include "asperity/model/textured_model.hpp"
#include "asperity/model/triangle_mesh.hpp"
#include "law/truth/truth_bodies.hpp"

namespace asperity::truth {

/// Its surface lies radius + height sin(waves latitude) from its middle.
struct striped_ball {
  double radius_m = 0.02, height_m = 20e-6;
  double waves = 64.0;  ///< around a meridian: 1.96 mm each

  [[nodiscard]] double radius_at(double latitude_rad) const noexcept;
  /// Its fine mesh: 24 rows a wave.
  [[nodiscard]] triangle_mesh fine_mesh() const;
};

/// The ball as bake() makes it of its fine mesh, with this many coarse triangles and 1024 texels a side. A bake that is
/// newer than this program is read from where the benchmark models are kept.
[[nodiscard]] model_ptr baked_ball(const striped_ball& ball, std::size_t triangles);

/// The small ball, by formula. @param radius_m of it
[[nodiscard]] model_ptr formula_ball(double radius_m);

/// Where the small ball is: over a latitude, on a meridian, its deepest point this deep below the ball's mean radius.
struct ball_slide {
  double probe_radius_m = 1e-3;
  double meridian_rad = 0.0, from_rad = 0.0;  ///< latitude where the slide begins
  double pressed_m = 0.0;
  static constexpr std::size_t steps = 96;
  static constexpr double waves = 3.0;  ///< how far it goes

  [[nodiscard]] double latitude(const striped_ball& ball, std::size_t step) const noexcept;
  [[nodiscard]] pose at(const striped_ball& ball, std::size_t step) const noexcept;
  [[nodiscard]] vec3 north_w(const striped_ball& ball, std::size_t step) const noexcept;  ///< along the slide, unit
};

/// Which way the depth of a point of the small ball is counted.
enum class depth_along : std::uint8_t {
  radius,   ///< to the stripes over it: what a press along the radius is, by the least motion that clears a smooth ball
  nearest,  ///< to the nearest point of the striped surface: along the depth's own direction
};

/// Depth of the small ball in the striped one: the largest of all its points, by search.
[[nodiscard]] double exact_depth_m(const striped_ball& ball, const ball_slide& slide, double latitude_rad,
                                   depth_along by);
/// Its derivative by the way along the slide of the small ball's middle, m/m.
[[nodiscard]] double exact_slope(const striped_ball& ball, const ball_slide& slide, double latitude_rad,
                                 depth_along by);

/// What a number does at the stripes' wavelength over a slide: amplitude and phase.
[[nodiscard]] std::complex<double> at_the_wavelength(const std::vector<double>& over_slide);

}  // namespace asperity::truth
