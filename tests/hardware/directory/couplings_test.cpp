// The coupling that a session takes by default keeps to the limits that each driver states of its device, and what a
// device with these limits is felt with gives no hand energy.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include <asperity/drivers/falcon/falcon_settings.hpp>
#include <asperity/drivers/spacemouse/spacemouse_device.hpp>
#include <asperity/planes/plane_renderer.hpp>

#include "../../../hal/sample/source/spring_handle.hpp"
#include "hardware/arm/arm_rig.hpp"
#include "support/fresh_seed.hpp"
#include "unit/control/plane_session.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;

struct driven {
  std::string driver;
  device_capabilities can{};
};

device_capabilities capabilities_of_an_arm() {
  arm_rig rig;
  return rig.dev->capabilities();
}

/// Every driver of this library, and the sample.
std::vector<driven> all_drivers() {
  device_capabilities shown;  // a SpaceMouse has no motors; what it shows is a force on the screen
  const spacemouse_settings s;
  shown.peak_force_n = shown.continuous_force_n = s.shown_force_n;
  shown.peak_torque_n_m = shown.continuous_torque_n_m = s.shown_torque_n_m;
  return {{"simulated", simulated_capabilities()},
          {"falcon", falcon_capabilities()},
          {"spacemouse", shown},
          {"articulated", capabilities_of_an_arm()},
          {"sample", sample::spring_handle_capabilities()}};
}

TEST(couplings, keep_to_the_limits_of_every_driver) {
  for (const driven& d : all_drivers()) {
    for (const double rate_hz : {100.0, 500.0, 1000.0, 4000.0, 10'000.0}) {
      for (const double scale : {0.2, 1.0, 5.0}) {
        const coupling_settings c = coupling_for(d.can, rate_hz, scale);
        const double on_device = scale * scale * c.stiffness_n_per_m;
        EXPECT_GT(on_device, 0.0) << d.driver;
        EXPECT_GT(c.stiffness_n_m_per_rad, 0.0) << d.driver;
        const double slower =
            d.can.max_stiffness_rate_hz > 0.0 ? std::min(1.0, rate_hz / d.can.max_stiffness_rate_hz) : 1.0;
        const double room = 1.0 + 1e-12;
        if (d.can.max_stiffness_n_per_m > 0.0) {
          EXPECT_LE(on_device, 0.5 * slower * d.can.max_stiffness_n_per_m * room) << d.driver << rate_hz;
        } else {
          EXPECT_LE(on_device, 500.0 * room) << d.driver << rate_hz;
        }
        if (d.can.max_stiffness_n_m_per_rad > 0.0) {
          EXPECT_LE(c.stiffness_n_m_per_rad, 0.5 * slower * d.can.max_stiffness_n_m_per_rad * room) << d.driver;
        } else {
          EXPECT_LE(c.stiffness_n_m_per_rad, 3.0 * room) << d.driver;
        }
        if (d.can.peak_force_n > 0.0) {
          EXPECT_LE(0.002 * on_device, d.can.peak_force_n * room) << d.driver;
        }
        if (d.can.peak_torque_n_m > 0.0) {
          EXPECT_LE(0.05 * c.stiffness_n_m_per_rad, d.can.peak_torque_n_m * room) << d.driver;
        }
        EXPECT_NEAR(scale * scale * c.max_damping_n_s_per_m, coupling_settings{}.max_damping_n_s_per_m, 1e-12);
      }
    }
    const coupling_settings c = coupling_for(d.can, 1000.0);
    std::printf("| %s | %.0f N/m | %.2f N m/rad | %.1f N | %.2f N m |\n", d.driver.c_str(), c.stiffness_n_per_m,
                c.stiffness_n_m_per_rad, d.can.peak_force_n, d.can.peak_torque_n_m);
  }
}

// A plant with the mass, the encoder and the limits that the driver states, at its own rate, without the guard.
TEST(couplings, give_no_hand_energy_on_a_device_with_these_limits) {
  drawn draw(seed_of(fresh_seed("couplings", "12 sessions"), "hands"));
  for (const driven& d : all_drivers()) {
    if (!(d.can.peak_force_n > 0.0) || d.can.actuated == no_axes) continue;
    const double rate_hz = d.can.nominal_rate_hz > 0.0 ? d.can.nominal_rate_hz : 1000.0;
    for (int kind = 0; kind < hand_kinds; ++kind) {
      plane_case c;
      c.body = block_on_plate(0.02);
      c.schedule = {.device_period_ns = std::llround(1e9 / rate_hz), .contact_one_period_late = true};
      c.body.reported_gap_m = reach_for(1e-3, 1.0 / rate_hz);
      c.control.guard.enabled = false;
      c.control.coupling = coupling_for(d.can, rate_hz);
      // The encoder's steps of some are 0.1 mm: by a window they are no blows.
      c.control.velocity = velocity_source::window;
      draw_hand(c.hand, kind, draw);
      c.hand.capabilities = d.can;
      if (d.can.moving_mass_kg > 0.0) c.hand.plant.mass_kg = d.can.moving_mass_kg;
      if (d.can.moving_inertia_kg_m2 > 0.0) c.hand.plant.inertia_kg_m2 = d.can.moving_inertia_kg_m2;
      const plane_outcome o = run(c);
      EXPECT_EQ(o.not_ok, 0U) << d.driver;
      EXPECT_LE(o.surplus_j, 1e-5) << d.driver << " hand " << kind;
      EXPECT_LE(o.step_n_per_ms, 1e-3 * d.can.force_slew_n_per_s * 1.001) << d.driver;
      EXPECT_LE(o.torque_n_m, d.can.peak_torque_n_m * 1.0001) << d.driver;
    }
  }
}

}  // namespace
