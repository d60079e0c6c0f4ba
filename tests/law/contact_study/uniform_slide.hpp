// A uniform slide of a textured box over a textured plate, and what it makes of the textures' spectrum.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "law/contact_study/jumps.hpp"
#include "support/small_models.hpp"

namespace asperity::contact_study {

/// The scene: a rough box with a crowned face, pressed on a ridged plate, turned a little so that the lattices of the
/// two bodies never line up, and moved along x at 50 mm/s. Its crown keeps the contact off the box's edges: there the
/// true depth breaks off, and no two methods agree on what that should feel like.
struct uniform_slide {
  static constexpr double speed_m_per_s = 0.05, rate_hz = 8192.0;
  static constexpr std::size_t ticks = 2048;
  static constexpr double box_half_m = 0.006, plate_half_m = 0.025, thickness_m = 0.005;
  static constexpr double yaw_rad = 0.3, pressed_m = 4e-4, crown_m = 1.2e-3;

  /// Heights over the two faces that meet, each in its own body's frame. The crown bends more than both textures
  /// together: there is one deepest place at a time, and it moves smoothly. Nothing else would show a lattice: a true
  /// depth that changes from ridge to ridge has kinks, and kinks have every frequency.
  [[nodiscard]] static double plate_height_m(double x, double y) noexcept {
    return 3e-5 * std::sin(2.0 * std::numbers::pi * x / 6e-3) * std::cos(2.0 * std::numbers::pi * y / 13e-3);
  }
  [[nodiscard]] static double box_height_m(double x, double y) noexcept {
    // Nothing at the rim: the crown meets the box's sides, and the surface is closed.
    const double across = 1.0 - x * x / (box_half_m * box_half_m), along = 1.0 - y * y / (box_half_m * box_half_m);
    return 1e-5 * std::sin(2.0 * std::numbers::pi * x / 5e-3 + 0.4) * std::sin(2.0 * std::numbers::pi * y / 7e-3) +
           crown_m * across * along;
  }

  /// @param box_texture, plate_texture texels per side: they set the lattices that samples lie on
  [[nodiscard]] static scene bodies(std::uint32_t box_texture = 768, std::uint32_t plate_texture = 1536) {
    using test_support::make_textured_box;
    // Each body is rough on the face that meets the other one only.
    const auto box = [](const vec3& p, const vec3& n) { return n.z < -0.5 ? box_height_m(p.x, p.y) : 0.0; };
    const auto plate = [](const vec3& p, const vec3& n) { return n.z > 0.5 ? plate_height_m(p.x, p.y) : 0.0; };
    textured_model crowned = make_textured_box({box_half_m, box_half_m, thickness_m}, box_texture, box);
    crowned.report.max_displacement_m = crown_m + 1e-5;  // how far the paper's finder looks
    return {std::make_shared<const textured_model>(std::move(crowned)),
            {std::make_shared<const textured_model>(
                make_textured_box({plate_half_m, plate_half_m, thickness_m}, plate_texture, plate))}};
  }

  [[nodiscard]] static pose at(std::size_t i) noexcept {
    const double way_m = speed_m_per_s / rate_hz * static_cast<double>(i);
    return {exp_rotation({0.0, 0.0, yaw_rad}), {way_m - 0.0125, 1.3e-3, 2.0 * thickness_m + crown_m - pressed_m}};
  }

  /// Where the surfaces are deepest in each other, by brute force: a dense grid, then ever smaller steps about its best
  /// nodes. No texture, lattice or map is involved.
  [[nodiscard]] static double exact_depth_m(const pose& T_wa) {
    const auto depth = [&](double x, double y) {
      const vec3 p_w = T_wa * vec3(x, y, -thickness_m);
      return plate_height_m(p_w.x, p_w.y) + box_height_m(x, y) + thickness_m - p_w.z;
    };
    struct place {
      double depth, x, y;
    };
    constexpr int nodes = 61;
    constexpr double pitch_m = 2.0 * box_half_m / (nodes - 1);
    std::vector<place> best;
    for (int j = 0; j < nodes; ++j) {
      for (int i = 0; i < nodes; ++i) {
        const double x = pitch_m * i - box_half_m, y = pitch_m * j - box_half_m;
        best.push_back({depth(x, y), x, y});
      }
    }
    constexpr std::size_t kept = 12;
    std::partial_sort(best.begin(), best.begin() + kept, best.end(),
                      [](const place& a, const place& b) { return a.depth > b.depth; });
    double deepest = -1.0;
    for (std::size_t k = 0; k < kept; ++k) {
      place p = best[k];
      for (double step = pitch_m; step > 1e-10;) {
        const double x = p.x, y = p.y;
        for (const vec2 d : {vec2(step, 0.0), vec2(-step, 0.0), vec2(0.0, step), vec2(0.0, -step)}) {
          if (const double there = depth(x + d.x, y + d.y); there > p.depth) p = {there, x + d.x, y + d.y};
        }
        if (p.x == x && p.y == y) step *= 0.5;
      }
      deepest = std::max(deepest, p.depth);
    }
    return deepest;
  }
};

/// Vertical force on the probe at every tick, N.
[[nodiscard]] inline std::vector<double> felt_on_slide(const feel_function& feel) {
  std::vector<double> out;
  for (std::size_t i = 0; i < uniform_slide::ticks; ++i) out.push_back(feel(uniform_slide::at(i)).on_probe_w.force.z);
  return out;
}

/// What one spring makes of the exact depth, N.
[[nodiscard]] inline std::vector<double> exact_on_slide(double stiffness_n_per_m) {
  std::vector<double> out;
  for (std::size_t i = 0; i < uniform_slide::ticks; ++i) {
    out.push_back(stiffness_n_per_m * uniform_slide::exact_depth_m(uniform_slide::at(i)));
  }
  return out;
}

/// Amplitudes of the sines that a signal is made of, from 0 to half the rate in steps of rate / size. The signal's mean
/// is taken off, and a window whose side lobes lie 92 dB down keeps strong lines from hiding weak ones.
/// @source Harris, "On the use of windows for harmonic analysis" (1978): four-term Blackman-Harris
[[nodiscard]] inline std::vector<double> amplitude_spectrum(const std::vector<double>& signal) {
  const std::size_t n = signal.size();
  const double two_pi = 2.0 * std::numbers::pi, size = static_cast<double>(n);
  std::vector<double> windowed(n), out(n / 2 + 1);
  std::vector<std::complex<double>> turn(n);
  double mean = 0.0, gain = 0.0;
  for (const double x : signal) mean += x / size;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = two_pi * static_cast<double>(i) / size;
    const double w = 0.35875 - 0.48829 * std::cos(t) + 0.14128 * std::cos(2.0 * t) - 0.01168 * std::cos(3.0 * t);
    windowed[i] = w * (signal[i] - mean);
    gain += w;
    turn[i] = std::polar(1.0, -t);
  }
  for (std::size_t k = 0; k < out.size(); ++k) {
    std::complex<double> sum = 0.0;
    for (std::size_t i = 0; i < n; ++i) sum += windowed[i] * turn[i * k % n];
    out[k] = 2.0 * std::abs(sum) / gain;
  }
  return out;
}

}  // namespace asperity::contact_study
