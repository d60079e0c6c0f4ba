// Poses that the library's own finder calls touching: where a test compares parts of the library with each other.
// Against the originals such poses would leave out what the finder does not see; approach.hpp draws without asking it.
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "law/oracle/against_originals.hpp"

namespace asperity::oracle {

[[nodiscard]] inline double uniform(std::mt19937_64& rng, double low, double high) {
  return low + (high - low) * static_cast<double>(rng() >> 11) * 0x1p-53;
}

[[nodiscard]] inline vec3 random_direction(std::mt19937_64& rng) {
  const double z = uniform(rng, -1.0, 1.0);
  const double a = uniform(rng, 0.0, 2.0 * std::numbers::pi);
  const double r = std::sqrt(1.0 - z * z);
  return {r * std::cos(a), r * std::sin(a), z};
}

[[nodiscard]] inline quat random_rotation(std::mt19937_64& rng) {
  const double u = uniform(rng, 0.0, 1.0);
  const double a = uniform(rng, 0.0, 2.0 * std::numbers::pi);
  const double b = uniform(rng, 0.0, 2.0 * std::numbers::pi);
  const double r = std::sqrt(1.0 - u);
  const double s = std::sqrt(u);
  return {s * std::cos(b), r * std::sin(a), r * std::cos(a), s * std::sin(b)};
}

/// A seeded pose at which the probe, coming from outside along a random direction with a random orientation, overlaps
/// by some tenths of a millimetre.
template <contact_renderer Renderer>
bool touching_pose(Renderer& r, std::mt19937_64& rng, pose& T_wa) {
  const textured_model& a = *r.scene().probe;
  const textured_model& b = *r.scene().fixed.front();
  const std::array<pose, 1> fixed{};
  const quat rotation = random_rotation(rng);
  const vec3 from = random_direction(rng);
  const vec3 centre_b = 0.5 * (b.box.low + b.box.high);
  const vec3 aside = glm::cross(from, random_direction(rng));
  const vec3 target = centre_b + 0.3 * uniform(rng, 0.0, 1.0) * b.box.diagonal() * aside;
  const vec3 centre_a = 0.5 * (a.box.low + a.box.high);
  const double wanted = uniform(rng, 0.0, 0.0004);
  const auto at = [&](double distance) { return pose{rotation, target + distance * from - rotation * centre_a}; };

  tick t;
  double outside = 0.5 * (a.box.diagonal() + b.box.diagonal()) + 0.4 * b.box.diagonal();
  const double step = 0.02 * std::min(a.box.diagonal(), b.box.diagonal());
  double inside = outside;
  do {  // march in until the first overlap, so that a thin part is not jumped over
    outside = inside;
    inside -= step;
    if (inside < -outside || r.step({at(inside), fixed}, t) != status::ok) return false;
  } while (!(deepest(t) > wanted));
  for (int i = 0; i < 12; ++i) {
    const double middle = 0.5 * (inside + outside);
    if (r.step({at(middle), fixed}, t) != status::ok) return false;
    (deepest(t) > wanted ? inside : outside) = middle;
  }
  T_wa = at(inside);
  return r.step({T_wa, fixed}, t) == status::ok && deepest(t) > 0.0;
}

}  // namespace asperity::oracle
