// The plane renderer's support planes, the coupling that fits the device, contacts one period late and no guard: hands
// that press, scrub and tap on textured bodies receive no energy. The energy is that of the simulated device's plant.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <gtest/gtest.h>
#include <memory>
#include <string>

#include "asperity/control/virtual_coupling.hpp"
#include "asperity/planes/plane_renderer.hpp"
#include "session/passivity/felt_session.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;

constexpr double no_energy_j = 1e-5;  // the guard's tolerance: rounding and the encoder's steps

/// A session of a drawn case with another coupling and no guard.
felt_result feel_held(const felt_case& c, const ridged_boxes& boxes, const std::shared_ptr<const field_scene>& fields,
                      double times_as_stiff) {
  plane_renderer_settings settings;
  settings.reach_m = reach_for(1e-9 * static_cast<double>(c.schedule.contact_period_ns));
  result<plane_renderer> made = make_plane_renderer({boxes.cube, {boxes.plate}}, fields, settings);
  EXPECT_TRUE(made);
  if (!made) return {};
  felt_case raised = c;
  raised.device.motion.T_dh.position.z += 0.0065;
  control_settings control;
  control.guard.enabled = false;
  control.probe = solid_probe(boxes.cube->mass);
  control.coupling = coupling_for(simulated_capabilities(), 1e9 / static_cast<double>(c.schedule.device_period_ns));
  control.coupling.stiffness_n_per_m *= times_as_stiff;
  const pose T_wb{quat(1.0, 0.0, 0.0, 0.0), {0.0, 0.0, -0.0103}};
  return run_case(raised, std::move(*made), {{T_wb}, boxes.cube->mass.centre_of_mass}, control);
}

TEST(held_probe, receives_no_energy) {
  const int sessions = extent(9, 45);
  const std::uint64_t seed = fresh_seed("held_probe", std::to_string(sessions) + " sessions");
  const ridged_boxes boxes;
  result<field_scene> made = make_field_scene({boxes.cube, {boxes.plate}});
  ASSERT_TRUE(made) << made.error().message;
  const auto fields = std::make_shared<const field_scene>(std::move(made).value());
  constexpr std::array<hand_model, 3> hands{hand_model::soft, hand_model::firm, hand_model::tapping};
  constexpr std::array<std::int64_t, 3> periods_ns{1'000'000, 2'000'000, 5'000'000};
  double largest_j = 0.0, too_stiff_j = 0.0;
  for (int i = 0; i < sessions; ++i) {
    const auto n = static_cast<std::size_t>(i);
    const felt_case c = draw_case(seed_of(seed, "held_probe", n), hands[n % 3], periods_ns[(n / 3) % 3], true, true);
    const felt_result r = feel_held(c, boxes, fields, 1.0);
    EXPECT_GT(r.touching, 0U) << i;
    EXPECT_EQ(r.not_ok, 0U) << i;
    EXPECT_LE(r.largest_surplus_j, no_energy_j) << "session " << i;
    EXPECT_LE(r.largest_surplus_j, r.surplus_bound_j) << "session " << i;
    EXPECT_LE(r.largest_gain_j, r.gain_bound_j) << "session " << i;
    largest_j = std::max(largest_j, r.largest_surplus_j);
    if (n % 3 == 1) too_stiff_j = std::max(too_stiff_j, feel_held(c, boxes, fields, 20.0).largest_surplus_j);
  }
  std::printf("  most energy: %.4f mJ; with a coupling twenty times as stiff %.2f mJ\n", 1e3 * largest_j,
              1e3 * too_stiff_j);
  EXPECT_GT(too_stiff_j, 1e-4);  // what the book is there to see
}

}  // namespace
