// Left-handed engines: a vector is mirrored, what turns is mirrored and gets the other sign.
#include "asperity/c/axes.h"

#include <array>

#include "c/entry.hpp"

namespace {

using three = std::array<double, 3>;

/// The mirrored axes of an engine, and how many of its units make one of ours.
struct unity {
  static constexpr double length = 1.0, force = 1.0, torque = 1.0;
  static three to(const three& v) { return {-v[1], v[2], v[0]}; }
  static three from(const three& v) { return {v[2], -v[0], v[1]}; }
};
struct unreal {
  static constexpr double length = 100.0, force = 100.0, torque = 10'000.0;
  static three to(const three& v) { return {v[0], -v[1], v[2]}; }
  static three from(const three& v) { return to(v); }
};

three three_of(const double* n) { return {n[0], n[1], n[2]}; }
void put_three(const three& v, double scale, double* out) {
  for (std::size_t i = 0; i < 3; ++i) out[i] = scale * v[i];
}

template <class Engine>
std::int32_t pose_to(const double* pose, double* out) noexcept {
  if (pose == nullptr || out == nullptr) return ASPERITY_ERROR_INVALID_ARGUMENT;
  const three position = Engine::to(three_of(pose)), axis = Engine::to(three_of(pose + 3));
  const double w = pose[6];
  put_three(position, Engine::length, out);
  put_three(axis, -1.0, out + 3);
  out[6] = w;
  return ASPERITY_STATUS_OK;
}

template <class Engine>
std::int32_t pose_from(const double* engine, double* out) noexcept {
  if (engine == nullptr || out == nullptr) return ASPERITY_ERROR_INVALID_ARGUMENT;
  const three position = Engine::from(three_of(engine)), axis = Engine::from(three_of(engine + 3));
  const double w = engine[6];
  put_three(position, 1.0 / Engine::length, out);
  put_three(axis, -1.0, out + 3);
  out[6] = w;
  return ASPERITY_STATUS_OK;
}

/// A vector and what turns, with the units of each.
template <class Engine>
std::int32_t pair_to(const double* six, double linear, double angular, double* out) noexcept {
  if (six == nullptr || out == nullptr) return ASPERITY_ERROR_INVALID_ARGUMENT;
  const three first = Engine::to(three_of(six)), second = Engine::to(three_of(six + 3));
  put_three(first, linear, out);
  put_three(second, -angular, out + 3);
  return ASPERITY_STATUS_OK;
}

template <class Engine>
std::int32_t pair_from(const double* six, double linear, double angular, double* out) noexcept {
  if (six == nullptr || out == nullptr) return ASPERITY_ERROR_INVALID_ARGUMENT;
  const three first = Engine::from(three_of(six)), second = Engine::from(three_of(six + 3));
  put_three(first, 1.0 / linear, out);
  put_three(second, -1.0 / angular, out + 3);
  return ASPERITY_STATUS_OK;
}

}  // namespace

std::int32_t asperity_pose_from_unity(const double* unity_pose, double* pose) {
  return pose_from<unity>(unity_pose, pose);
}
std::int32_t asperity_pose_to_unity(const double* pose, double* unity_pose) { return pose_to<unity>(pose, unity_pose); }
std::int32_t asperity_pose_from_unreal(const double* unreal_pose, double* pose) {
  return pose_from<unreal>(unreal_pose, pose);
}
std::int32_t asperity_pose_to_unreal(const double* pose, double* unreal_pose) {
  return pose_to<unreal>(pose, unreal_pose);
}

std::int32_t asperity_wrench_from_unity(const double* theirs, double* wrench) {
  return pair_from<unity>(theirs, unity::force, unity::torque, wrench);
}
std::int32_t asperity_wrench_to_unity(const double* wrench, double* theirs) {
  return pair_to<unity>(wrench, unity::force, unity::torque, theirs);
}
std::int32_t asperity_wrench_from_unreal(const double* theirs, double* wrench) {
  return pair_from<unreal>(theirs, unreal::force, unreal::torque, wrench);
}
std::int32_t asperity_wrench_to_unreal(const double* wrench, double* theirs) {
  return pair_to<unreal>(wrench, unreal::force, unreal::torque, theirs);
}

std::int32_t asperity_twist_from_unity(const double* theirs, double* twist) {
  return pair_from<unity>(theirs, unity::length, 1.0, twist);
}
std::int32_t asperity_twist_to_unity(const double* twist, double* theirs) {
  return pair_to<unity>(twist, unity::length, 1.0, theirs);
}
std::int32_t asperity_twist_from_unreal(const double* theirs, double* twist) {
  return pair_from<unreal>(theirs, unreal::length, 1.0, twist);
}
std::int32_t asperity_twist_to_unreal(const double* twist, double* theirs) {
  return pair_to<unreal>(twist, unreal::length, 1.0, theirs);
}
