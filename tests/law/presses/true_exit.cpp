#include "law/presses/true_exit.hpp"

#include <cmath>
#include <numbers>

namespace asperity::presses {
namespace {

constexpr int whole_sphere = 400;  // directions, 10 degrees apart
constexpr double first_angle_rad = 0.1;
constexpr double last_angle_rad = 2e-4;
constexpr int round_the_best = 12;
constexpr double gain = 0.9995;  // a direction counts as better from here on, round the best

/// Evenly spread on the sphere.
vec3 spread(int i, int n) {
  const double z = 1.0 - (2.0 * i + 1.0) / n, r = std::sqrt(1.0 - z * z);
  const double a = i * std::numbers::pi * (3.0 - std::sqrt(5.0));
  return {r * std::cos(a), r * std::sin(a), z};
}

double diagonal(const triangle_mesh& mesh) {
  vec3 low = mesh.positions.front(), high = low;
  for (const vec3& p : mesh.positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  return glm::length(high - low);
}

}  // namespace

exit_search::exit_search(const triangle_mesh& probe, const triangle_mesh& fixed)
    : probe_(probe), fixed_(fixed), farthest_m_(diagonal(probe) + diagonal(fixed)) {}

void exit_search::turn(const quat& rotation) {
  if (rotation == rotation_) return;
  rotation_ = rotation;
  probe_.place(rotation, vec3(0.0));
}

bool exit_search::apart_at(const vec3& position) {
  ++trials_;
  return !surfaces_cross(probe_, fixed_, position) && !fixed_.contains(probe_.points().front() + position) &&
         !probe_.contains(fixed_.points().front() - position);
}

bool exit_search::apart(const pose& T_wa) {
  turn(T_wa.rotation);
  return apart_at(T_wa.position);
}

way_out exit_search::true_exit(const pose& T_wa, const vec3& guess_w) {
  if (apart(T_wa)) return {0.0, guess_w};
  way_out best{infinity, guess_w};
  // From a length at which the direction parts them down to the least by halves.
  const auto shorten = [&](const vec3& direction, double parting_m) {
    double low = 0.0, high = parting_m;
    while (high - low > 2e-4 * high) {
      const double middle = 0.5 * (low + high);
      (apart_at(T_wa.position + middle * direction) ? high : low) = middle;
    }
    best = {high, direction};
  };
  const auto try_better = [&](const vec3& direction) {
    const double way = gain * best.way_m;
    if (!apart_at(T_wa.position + way * direction)) return false;
    shorten(direction, way);
    return true;
  };

  for (double way = 1e-4; way < 2.0 * farthest_m_; way *= 1.5) {
    if (!apart_at(T_wa.position + way * guess_w)) continue;
    shorten(guess_w, way);
    break;
  }
  if (!(best.way_m < infinity)) best.way_m = 2.0 * farthest_m_;
  for (int i = 0; i < whole_sphere; ++i) static_cast<void>(try_better(spread(i, whole_sphere)));
  // Where the body is held by several faces the best direction lies in a narrow valley: each ring of trials is turned
  // against the last one, and an angle is given up after two rings without gain.
  double phase = 0.0;
  int without_gain = 0;
  for (double angle = first_angle_rad; angle > last_angle_rad;) {
    const vec3 axis = best.direction_w;
    const vec3 u = any_orthogonal(axis), v = glm::cross(axis, u);
    bool better = false;
    phase += 0.618;
    for (int i = 0; i < round_the_best && !better; ++i) {
      const double a = 2.0 * std::numbers::pi * (i + phase) / round_the_best;
      better = try_better(glm::normalize(axis + std::tan(angle) * (std::cos(a) * u + std::sin(a) * v)));
    }
    without_gain = better ? 0 : without_gain + 1;
    if (without_gain < 2) continue;
    without_gain = 0;
    angle *= 0.5;
  }
  return best;
}

}  // namespace asperity::presses
