#include "touching_path.hpp"

#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <numbers>
#include <random>

namespace asperity::rivals {
namespace {

vec3 middle_of(const triangle_mesh& mesh) {
  vec3 low = mesh.positions.front(), high = low;
  for (const vec3& p : mesh.positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  return 0.5 * (low + high);
}

}  // namespace

std::vector<pressed_pose> make_touching_path(originals& bodies, const triangle_mesh& probe, const triangle_mesh& fixed,
                                             std::size_t poses, std::uint64_t seed) {
  constexpr double circle_m = 0.01, tilt_rad = 0.05, least_press = 0.01;
  constexpr std::array<double, 6> rounds{1.0, 0.7, 1.3, 0.9, 0.4, 5.0};  // per path; of x, y, tilts, turn, press
  std::mt19937_64 bits(seed);
  std::array<double, rounds.size()> phase{};
  for (double& p : phase) p = 2.0 * std::numbers::pi * static_cast<double>(bits() >> 11U) * 0x1p-53;
  const vec3 middle = middle_of(fixed) - middle_of(probe);
  std::vector<pressed_pose> out;
  for (std::size_t i = 0; i < poses; ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(poses);
    const auto wave = [&](std::size_t k) { return std::sin(2.0 * std::numbers::pi * rounds[k] * t + phase[k]); };
    pressed_pose at;
    at.T_wa.rotation = exp_rotation(tilt_rad * vec3(wave(2), wave(3), wave(4)));
    at.T_wa.position = middle + circle_m * vec3(wave(0), wave(1), 0.0);
    at.press_m = most_press_m * (least_press + (1.0 - least_press) * (0.5 - 0.5 * wave(5)));
    const double way_m = bodies.way_down_m(at.T_wa);
    if (!std::isfinite(way_m)) continue;
    at.T_wa.position.z -= way_m + at.press_m;
    out.push_back(at);
  }
  return out;
}

}  // namespace asperity::rivals
