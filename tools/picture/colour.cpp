#include "picture/colour.hpp"

#include <algorithm>
#include <cmath>

namespace asperity::picture {
namespace {

constexpr double degree = 0.017453292519943295;

struct lightness_chroma_hue {
  double lightness, chroma, hue_deg;
};

// Between points that are equally far apart the table is linear in the rectangular coordinates of OKLab.
template <std::size_t N>
colour between(const std::array<lightness_chroma_hue, N>& points, double value) {
  const double at = value * (N - 1);
  const auto i = std::min(static_cast<std::size_t>(at), N - 2);
  const double s = at - static_cast<double>(i);
  const auto a_of = [](const lightness_chroma_hue& p) { return p.chroma * std::cos(p.hue_deg * degree); };
  const auto b_of = [](const lightness_chroma_hue& p) { return p.chroma * std::sin(p.hue_deg * degree); };
  const double a = (1.0 - s) * a_of(points[i]) + s * a_of(points[i + 1]);
  const double b = (1.0 - s) * b_of(points[i]) + s * b_of(points[i + 1]);
  const double lightness = (1.0 - s) * points[i].lightness + s * points[i + 1].lightness;
  return oklch(lightness, std::hypot(a, b), std::atan2(b, a) / degree);
}

}  // namespace

std::uint8_t to_srgb8(float linear) noexcept {
  const double x = std::clamp(static_cast<double>(linear), 0.0, 1.0);
  const double encoded = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(encoded * 255.0));
}

colour oklch(double lightness, double chroma, double hue_deg) noexcept {
  const double a = chroma * std::cos(hue_deg * degree);
  const double b = chroma * std::sin(hue_deg * degree);
  const auto cube = [](double x) { return x * x * x; };
  const double l = cube(lightness + 0.3963377774 * a + 0.2158037573 * b);
  const double m = cube(lightness - 0.1055613458 * a - 0.0638541728 * b);
  const double s = cube(lightness - 0.0894841775 * a - 1.2914855480 * b);
  const auto shown = [](double x) { return static_cast<float>(std::clamp(x, 0.0, 1.0)); };
  return {shown(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
          shown(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
          shown(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s)};
}

template <class Make>
colour_scale::colour_scale(const Make& make) noexcept {
  for (std::size_t i = 0; i <= steps; ++i) table_[i] = make(static_cast<double>(i) / steps);
}

const colour_scale& colour_scale::from_zero() noexcept {
  static const colour_scale scale([](double value) {
    constexpr std::array<lightness_chroma_hue, 5> points{
        {{0.42, 0.13, 266.0}, {0.54, 0.16, 312.0}, {0.66, 0.17, 12.0}, {0.78, 0.14, 62.0}, {0.92, 0.12, 100.0}}};
    return between(points, value);
  });
  return scale;
}

const colour_scale& colour_scale::about_zero() noexcept {
  static const colour_scale scale([](double value) {
    constexpr std::array<lightness_chroma_hue, 5> points{
        {{0.42, 0.13, 258.0}, {0.66, 0.10, 248.0}, {0.965, 0.0, 250.0}, {0.68, 0.13, 55.0}, {0.45, 0.12, 42.0}}};
    return between(points, value);
  });
  return scale;
}

colour colour_scale::at(double value) const noexcept {
  const double x = std::clamp(value, 0.0, 1.0) * steps;
  const auto i = std::min(static_cast<std::size_t>(x), steps - 1);
  return mix(table_[i], table_[i + 1], static_cast<float>(x - static_cast<double>(i)));
}

}  // namespace asperity::picture
