// Seeded places where a probe touches a fixed body, and the motions that start there.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <random>
#include <string_view>

#include "support/kept_bodies.hpp"

namespace asperity::contact_study {

using test_support::build_renderer;

/// Numbers that depend on a seed alone, whatever the standard library.
class seeded_numbers {
 public:
  explicit seeded_numbers(std::uint64_t seed) : bits_(seed) {}

  /// Uniform in [-1, 1).
  [[nodiscard]] double symmetric() { return static_cast<double>(bits_() >> 11) * 0x1.0p-52 - 1.0; }
  /// Uniform on the sphere.
  [[nodiscard]] vec3 direction() {
    for (;;) {
      const double x = symmetric(), y = symmetric(), z = symmetric();
      const double squared = x * x + y * y + z * z;
      if (squared > 1e-4 && squared <= 1.0) return vec3(x, y, z) / std::sqrt(squared);
    }
  }
  /// Uniform over all orientations.
  [[nodiscard]] quat orientation() {
    for (;;) {
      const double w = symmetric(), x = symmetric(), y = symmetric(), z = symmetric();
      const double squared = w * w + x * x + y * y + z * z;
      if (squared > 1e-4 && squared <= 1.0) return glm::normalize(quat(w, x, y, z));
    }
  }

 private:
  std::mt19937_64 bits_;
};

/// Length that makes a rotation comparable to a translation.
inline constexpr double lever_m = 0.01;
/// How deep a motion begins, as one spring would have it: sqrt(2 U / k).
inline constexpr double touch_depth_m = 2e-4;

/// A probe that touches the fixed body, whose frame is the world here, and the directions that its motions take.
struct touching_pose {
  pose T_wa;
  vec3 point_w{0.0};  ///< of the contact that holds most of the spring
  vec3 n_ab_w{0.0};   ///< its direction, from the probe into the fixed body
  vec3 tangent_w{0.0};
  vec3 axis_w{0.0};  ///< of the rotation
};

/// Marches the probe, turned at random, towards the fixed body from a random side until it is touch_depth_m deep.
/// @param index which pose: every index has a generator of its own, so that any pose can be repeated alone
/// @return nothing where the probe passes by
[[nodiscard]] inline std::optional<touching_pose> find_touching_pose(least_motion_renderer& feel, std::uint64_t seed,
                                                                     std::uint64_t index) {
  seeded_numbers random(seed * 1'000'003 + index);
  const textured_model &a = *feel.scene().probe, &b = *feel.scene().fixed.front();
  const pose T_wb;
  const vec3 from = random.direction(), c_a = a.mass.centre_of_mass, c_b = b.mass.centre_of_mass;
  touching_pose out;
  out.T_wa.rotation = random.orientation();
  tick found;
  const auto deep_enough = [&](double distance) {
    out.T_wa.position = c_b + distance * from - out.T_wa.rotation * c_a;
    const status s = feel.step({out.T_wa, {&T_wb, 1}}, found);
    const double k = feel.force().settings().stiffness_n_per_m;
    return s == status::ok && std::sqrt(2.0 * feel.force().energy_j() / k) >= touch_depth_m;
  };
  constexpr double step_m = 5e-4;
  double outside = 0.5 * (a.box.diagonal() + b.box.diagonal()) + step_m, inside = outside;
  while (!deep_enough(inside)) {
    outside = inside;
    inside -= step_m;
    if (inside <= 0.0) return std::nullopt;
  }
  while (outside - inside > 1e-8) {
    const double middle = 0.5 * (outside + inside);
    (deep_enough(middle) ? inside : outside) = middle;
  }
  if (!deep_enough(inside) || found.contacts.empty()) return std::nullopt;
  const contact& first = found.contacts.front();
  out.point_w = 0.5 * (first.p_a_w + first.p_b_w);
  out.n_ab_w = first.window.n_ab_w;
  const vec3 u = any_orthogonal(out.n_ab_w), v = glm::cross(out.n_ab_w, u);
  const double angle = 3.14159265358979323846 * random.symmetric();
  out.tangent_w = std::cos(angle) * u + std::sin(angle) * v;
  out.axis_w = random.direction();
  return out;
}

enum class motion : std::uint8_t { slide, rotation, press };
inline constexpr std::array all_motions{motion::slide, motion::rotation, motion::press};

[[nodiscard]] constexpr std::string_view to_string(motion m) noexcept {
  constexpr std::array<std::string_view, 3> names{"slide", "rotation", "press"};
  return names[static_cast<std::size_t>(m)];
}

/// How far a motion goes, m; for a rotation the lever times 0.1 rad.
[[nodiscard]] constexpr double length_m(motion m) noexcept {
  constexpr std::array<double, 3> lengths{3e-3, lever_m * 0.1, 7.5e-4};
  return lengths[static_cast<std::size_t>(m)];
}

/// The probe after `way_m` of a motion.
[[nodiscard]] inline pose along(const touching_pose& start, motion m, double way_m) noexcept {
  pose T = start.T_wa;
  if (m == motion::rotation) {
    const quat turn = exp_rotation(way_m / lever_m * start.axis_w);
    T.rotation = glm::normalize(turn * T.rotation);
    T.position = start.point_w + turn * (T.position - start.point_w);
  } else {
    T.position += way_m * (m == motion::slide ? start.tangent_w : start.n_ab_w);
  }
  return T;
}

/// The probe at a point of a closed loop in all six degrees of freedom, +-0.3 mm and +-0.01 rad, without symmetry.
/// @param turn 0 to 1: once around
[[nodiscard]] inline pose around(const touching_pose& start, double turn) noexcept {
  constexpr double reach_m = 3e-4, reach_rad = 0.01;
  const double t = 2.0 * 3.14159265358979323846 * turn;
  const vec3 shift =
      reach_m * vec3(std::sin(t), std::cos(2.0 * t + 0.4) - std::cos(0.4), 0.6 * (std::sin(t + 1.0) - std::sin(1.0)));
  const quat q =
      exp_rotation(reach_rad * vec3(std::sin(t + 0.3) - std::sin(0.3), std::cos(t) - 1.0, std::sin(2.0 * t)));
  pose T = start.T_wa;
  T.rotation = glm::normalize(q * T.rotation);
  T.position = start.point_w + shift + q * (T.position - start.point_w);
  return T;
}

}  // namespace asperity::contact_study
