// Colours of a picture: light that adds up, and scales that everybody can read.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace asperity::picture {

/// Linear light, sRGB primaries, 0 to 1: what may be shaded, mixed and averaged.
struct colour {
  float r = 0.0F;
  float g = 0.0F;
  float b = 0.0F;

  friend constexpr colour operator+(const colour& x, const colour& y) noexcept {
    return {x.r + y.r, x.g + y.g, x.b + y.b};
  }
  friend constexpr colour operator*(float s, const colour& x) noexcept { return {s * x.r, s * x.g, s * x.b}; }
};

[[nodiscard]] constexpr colour mix(const colour& x, const colour& y, float share_of_y) noexcept {
  return (1.0F - share_of_y) * x + share_of_y * y;
}

/// A channel of linear light as sRGB, 0 to 255; what is out of range is cut.
[[nodiscard]] std::uint8_t to_srgb8(float linear) noexcept;

/// Colour of a lightness (0 black, 1 white), chroma and hue (degrees) in OKLab, a space in which equal steps look
/// equally large. Cut to what a screen can show.   @source B. Ottosson, A perceptual colour space, 2020
[[nodiscard]] colour oklch(double lightness, double chroma, double hue_deg) noexcept;

/// A colour for each value of [0, 1]. Both scales change evenly in OKLab, and no two values of one differ only in
/// what people with a colour deficiency cannot see: lightness tells them apart, or blue against orange.
class colour_scale {
 public:
  /// For what has no sign: dark blue at 0, over violet and orange to light yellow at 1. Lightness grows evenly.
  [[nodiscard]] static const colour_scale& from_zero() noexcept;
  /// For what has one: blue at 0, light grey at 1/2, orange at 1.
  [[nodiscard]] static const colour_scale& about_zero() noexcept;

  /// Values outside [0, 1] take the colour of the nearer end.
  [[nodiscard]] colour at(double value) const noexcept;

 private:
  template <class Make>
  explicit colour_scale(const Make& make) noexcept;

  static constexpr std::size_t steps = 512;
  std::array<colour, steps + 1> table_{};
};

}  // namespace asperity::picture
