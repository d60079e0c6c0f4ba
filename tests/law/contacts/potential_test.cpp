// The wrench has a potential, and it is as quiet as the hand (C6, C7 of the acceptance numbers).
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <gtest/gtest.h>
#include <random>

#include "contact_meter.hpp"

namespace {

using namespace asperity;
using namespace asperity::contacts_test;

TEST(Potential, WrenchIsMinusTheGradientOfTheEnergy) {
  for (const contact_scene& s : all_scenes()) {
    SCOPED_TRACE(s.name);
    least_motion_renderer r = make_waved_renderer(s, true, scene_settings());
    const vec3 centre_b = r.scene().probe->mass.centre_of_mass;
    const auto energy = [&](const pose& T_wa) {
      static_cast<void>(wrench_at(r, T_wa));
      return r.force().energy_j();
    };
    double worst = 0.0;
    std::size_t loaded = 0;
    for (const double t : {0.11, 0.29, 0.47, 0.63, 0.81, 0.97}) {
      const pose T_wa = s.path(t);
      const wrench w = wrench_at(r, T_wa);
      if (glm::length(w.force) < 0.01) continue;
      ++loaded;
      wrench numeric;
      const double h = 2e-8;  // m; of the rotation the same at the lever's end
      for (int k = 0; k < 3; ++k) {
        vec3 step(0.0);
        step[k] = h;
        numeric.force[k] =
            (energy(moved(T_wa, centre_b, -step, vec3(0.0))) - energy(moved(T_wa, centre_b, step, vec3(0.0)))) /
            (2.0 * h);
        step[k] = h / s.lever_m;
        numeric.torque[k] =
            (energy(moved(T_wa, centre_b, vec3(0.0), -step)) - energy(moved(T_wa, centre_b, vec3(0.0), step))) /
            (2.0 * step[k]);
      }
      const wrench off = w - numeric;
      const double size = glm::length(w.force) + glm::length(w.torque) / s.lever_m;
      worst = std::max(worst, (glm::length(off.force) + glm::length(off.torque) / s.lever_m) / size);
    }
    std::printf("%-14s gradient against differences of the energy: %.1e (%zu poses)\n", s.name.c_str(), worst, loaded);
    EXPECT_GE(loaded, 3U);
    EXPECT_LE(worst, 1e-6);
  }
}

// A hand that trembles by 0.1 um and 10 urad on a face feels that much through the spring and no more. A hard face that
// lies flat stands up to a turn: by 10 N m per rad here.
TEST(Potential, NoiseOfThePoseIsNotAmplified) {
  const contact_scene s = slide();
  least_motion_renderer r = make_scene_renderer(s, scene_settings());
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise;
  const double shift_m = 1e-7, turn = 1e-5;
  const int count = 200;
  double force = 0.0, force_2 = 0.0, torque = 0.0, torque_2 = 0.0;
  for (int i = 0; i < count; ++i) {
    const vec3 shift = shift_m * vec3(noise(random), noise(random), noise(random));
    const vec3 tilt = turn * vec3(noise(random), noise(random), noise(random));
    pose T_wa = pose_mm({1.3, 0.7, 4.6}, vec3(0, 0, 0.2) + tilt);
    T_wa.position += shift;
    const wrench w = wrench_at(r, T_wa);
    force += w.force.z / count;
    force_2 += w.force.z * w.force.z / count;
    torque += w.torque.y / count;
    torque_2 += w.torque.y * w.torque.y / count;
  }
  const double force_deviation = std::sqrt(std::max(0.0, force_2 - force * force));
  const double torque_deviation = std::sqrt(std::max(0.0, torque_2 - torque * torque));
  std::printf("rest: F_z varies by %.2e N (k x noise %.1e N), T_y by %.2e N m\n", force_deviation,
              stiffness_n_per_m * shift_m, torque_deviation);
  EXPECT_LE(force_deviation, 1.5 * stiffness_n_per_m * shift_m);
  EXPECT_LE(torque_deviation, 15.0 * turn);
  EXPECT_GT(force_deviation, 0.5 * stiffness_n_per_m * shift_m);
}

}  // namespace
