#include "pattern_plate.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace asperity::experiment {
namespace {

constexpr double full_turn = 2.0 * std::numbers::pi;
constexpr double bump_height_m = 0.2e-3;
constexpr double bump_radius_m = 0.6e-3;
constexpr double random_rms_m = 0.06e-3;
constexpr double longest_wave = 4.0;    // of the random texture, times the shortest
constexpr double edge_fade_m = 0.3e-3;  // over which a lane ends: neither it nor the ball sees its neighbour

// The same numbers with every standard library: no distribution of <random> promises that.
double unit_random(std::mt19937_64& bits) { return static_cast<double>(bits() >> 11) * 0x1p-53; }

double bump(double distance_m) {
  const double r = distance_m / bump_radius_m;
  return r < 1.0 ? bump_height_m * 0.5 * (1.0 + std::cos(std::numbers::pi * r)) : 0.0;
}

double lane_fade(double inside_m) { return smoothstep(inside_m / edge_fade_m); }

}  // namespace

const std::vector<texture_class>& texture_classes() {
  static const std::vector<texture_class> all{{"flat", texture_kind::flat, 0.0},
                                              {"stripes 2.0 mm", texture_kind::stripes, 2.0e-3},
                                              {"stripes 2.5 mm", texture_kind::stripes, 2.5e-3},
                                              {"dots 3.0 mm", texture_kind::dots, 3.0e-3},
                                              {"dots 3.75 mm", texture_kind::dots, 3.75e-3},
                                              {"scattered 2.0 mm", texture_kind::scattered_dots, 2.0e-3},
                                              {"scattered 2.5 mm", texture_kind::scattered_dots, 2.5e-3},
                                              {"random 1.0 mm", texture_kind::random, 1.0e-3},
                                              {"random 1.25 mm", texture_kind::random, 1.25e-3}};
  return all;
}

pattern_plate::pattern_plate(std::uint64_t seed) {
  std::mt19937_64 bits(seed);
  for (const texture_class& c : texture_classes()) {
    for (std::size_t l = 0; l < lanes_per_class; ++l) {
      lane_texture made;
      const double half = 0.5 * length_m - bump_radius_m, wide = 0.5 * lane_width_m;
      if (c.kind == texture_kind::stripes) {
        for (double x = -half + c.scale_m * unit_random(bits); x < half; x += c.scale_m) made.stripes_m.push_back(x);
      }
      if (c.kind == texture_kind::dots) {
        const double aside = 0.3e-3 * (2.0 * unit_random(bits) - 1.0);
        for (double x = -half + c.scale_m * unit_random(bits); x < half; x += c.scale_m)
          made.dots_m.emplace_back(x, aside);
      }
      if (c.kind == texture_kind::scattered_dots) {
        // As many per area as in a square lattice, none nearer to another one than six tenths of its pitch.
        const auto wanted = static_cast<std::size_t>(2.0 * half * lane_width_m / (c.scale_m * c.scale_m));
        for (int tries = 0; tries < 20'000 && made.dots_m.size() < wanted; ++tries) {
          const double x = half * (2.0 * unit_random(bits) - 1.0);
          const vec2 at(x, wide * (2.0 * unit_random(bits) - 1.0));
          const bool room = std::all_of(made.dots_m.begin(), made.dots_m.end(),
                                        [&](const vec2& q) { return glm::length(q - at) >= 0.6 * c.scale_m; });
          if (room) made.dots_m.push_back(at);
        }
      }
      if (c.kind == texture_kind::random) {
        constexpr std::size_t count = 60;
        for (std::size_t i = 0; i < count; ++i) {
          const double share = (static_cast<double>(i) + unit_random(bits)) / static_cast<double>(count);
          const double wavelength = c.scale_m * std::pow(longest_wave, share);
          const double turn = full_turn * unit_random(bits);
          made.waves.push_back({full_turn / wavelength * vec2(std::cos(turn), std::sin(turn)),
                                full_turn * unit_random(bits),
                                random_rms_m * std::sqrt(2.0 / static_cast<double>(count))});
        }
      }
      lanes_.push_back(std::move(made));
    }
  }
}

vec2 pattern_plate::size_m() const {
  return {length_m + 12e-3, lane_width_m * static_cast<double>(lanes_.size()) + 8e-3};
}

double pattern_plate::lane_y_m(std::size_t texture, std::size_t lane) const {
  const auto number = static_cast<double>(texture * lanes_per_class + lane);
  return lane_width_m * (number - 0.5 * static_cast<double>(lanes_.size() - 1));
}

double pattern_plate::height_m(const vec2& p) const {
  const double across = p.y / lane_width_m + 0.5 * static_cast<double>(lanes_.size());
  if (!(across >= 0.0 && across < static_cast<double>(lanes_.size()))) return 0.0;
  const double number = std::floor(across);
  const lane_texture& l = lanes_[static_cast<std::size_t>(number)];
  const vec2 at(p.x, (across - number - 0.5) * lane_width_m);
  double height = 0.0;
  for (const double x : l.stripes_m) height = std::max(height, bump(std::fabs(at.x - x)));
  for (const vec2& q : l.dots_m) height = std::max(height, bump(glm::length(at - q)));
  for (const wave& w : l.waves) height += w.height_m * std::cos(glm::dot(w.k_rad_per_m, at) + w.phase_rad);
  return height * lane_fade(0.5 * length_m - std::fabs(at.x)) * lane_fade(0.5 * lane_width_m - std::fabs(at.y));
}

}  // namespace asperity::experiment
