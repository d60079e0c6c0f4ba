// Short sessions inside the trap: every policy and path that the long one does not take.
#include <array>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "asperity/control/virtual_session.hpp"
#include "asperity/device/any_device.hpp"
#include "asperity/device/simulated/simulated_device.hpp"
#include "asperity/least_motion/least_motion_renderer.hpp"
#include "asperity/window/window_renderer.hpp"
#include "record_queue.hpp"
#include "session/rt/tick_trap.hpp"
#include "support/small_models.hpp"
#include "unit/control/analytic_wall.hpp"

namespace {

using namespace asperity;
using test_support::analytic_wall;
using test_support::tick_trap;

// Without a trap (under a sanitizer) the sessions still run, for the sanitizer's sake.
TEST(trapped_session, stands_in_a_trap) {
  if (const std::string why = tick_trap::missing(); !why.empty()) GTEST_SKIP() << why;
  if (const std::string why = tick_trap::missing_system_calls(); !why.empty()) GTEST_SKIP() << why;
}

// A step is the contact ticks that are due and one device tick. @return how many steps there were
template <class Session>
std::uint64_t run(Session& session, std::int64_t until_ns) {
  tick_trap trap;
  while (session.now_ns() < until_ns) trap([&] { static_cast<void>(session.step()); });
  return trap.ticks();
}

simulated_settings hand(motion_kind kind) {
  simulated_settings c;
  c.motion = {.kind = kind, .T_dh = {quat(1, 0, 0, 0), {0, 0, 0.004}}, .depth_m = 0.008, .approach_s = 0.2};
  c.measurement.jitter_ns = 500'000;
  return c;
}

constexpr std::int64_t ms = 1'000'000;

TEST(trapped_session, every_motion_with_an_erased_device) {
  for (const motion_kind kind : {motion_kind::press, motion_kind::scrub, motion_kind::twist, motion_kind::free}) {
    any_device dev{simulated_device(hand(kind))};
    ASSERT_TRUE(dev.open() && dev.arm());
    virtual_session<analytic_wall, any_device> session({}, {{pose{}}, vec3(0.0)}, dev, control_settings{});
    EXPECT_EQ(run(session, 1000 * ms), 1000U);
    EXPECT_EQ(session.device().gate().fault(), gate_fault::none);
  }
}

/// Floors of three bodies in one plane.
struct three_floors {
  std::array<support_plane, 3> planes{};

  [[nodiscard]] status step(const scene_pose& at, tick& out) noexcept {
    out = {};
    for (std::uint32_t i = 0; i < planes.size(); ++i) {
      planes[i] = {
          .depth_m = -at.T_wa.position.z, .gradient = {{0, 0, -1}, vec3(0.0)}, .n_ab_w = {0, 0, -1}, .body = i};
    }
    out.centre_of_mass_w = at.T_wa.position;
    out.planes = planes;
    return status::ok;
  }
};

TEST(trapped_session, every_body_with_a_material_of_its_own) {
  control_settings control;
  control.surfaces = {combined(std::nullopt, std::optional(*preset_material("rubber"))), std::nullopt,
                      combined(std::nullopt, std::optional(*preset_material("steel")))};
  for (const motion_kind kind : {motion_kind::press, motion_kind::scrub}) {
    simulated_device dev(hand(kind));
    ASSERT_TRUE(dev.open() && dev.arm());
    virtual_session<three_floors, simulated_device> session({}, {{pose{}, pose{}, pose{}}, vec3(0.0)}, dev, control);
    EXPECT_EQ(run(session, 1000 * ms), 1000U);
    EXPECT_GT(session.device().pressed().lambda_n[0], 0.0);
  }
}

// Rejected samples, a refused command, a shut gate, a device that leaves: the paths that a good session never takes.
TEST(trapped_session, every_fault_of_a_device) {
  const std::vector<device_fault> faults{
      device_fault::nan_pose, device_fault::infinite_pose, device_fault::bad_rotation, device_fault::stale,
      device_fault::drop,     device_fault::jump,          device_fault::refuse_write, device_fault::depart};
  for (const device_fault fault : faults) {
    SCOPED_TRACE(static_cast<int>(fault));
    simulated_settings c = hand(motion_kind::press);
    // Short enough to go by, then long enough to shut the gate.
    c.faults = {{device_fault::drop, 400 * ms, 402 * ms}, {fault, 600 * ms, 700 * ms}};
    simulated_device dev(c);
    ASSERT_TRUE(dev.open() && dev.arm());
    virtual_session<analytic_wall, simulated_device> session({}, {{pose{}}, vec3(0.0)}, dev, control_settings{});
    EXPECT_EQ(run(session, 590 * ms), 590U);
    EXPECT_EQ(session.device().gate().fault(), gate_fault::none);
    run(session, 1000 * ms);
    EXPECT_NE(session.device().gate().fault(), gate_fault::none);
    EXPECT_TRUE(session.device().gate().at_rest());
  }
}

struct variant {
  const char* name;
  gradient_scheme gradient;
  parallax_mode parallax;
};

class trapped_renderer : public testing::TestWithParam<variant> {};

// With the observer of `asperity run`, and contacts handed over one period late as there.
TEST_P(trapped_renderer, textured_boxes) {
  const auto probe = std::make_shared<const textured_model>(
      test_support::make_textured_box({0.01, 0.01, 0.01}, 64, test_support::ridges(0.0002, 0.004)));
  const auto plate = std::make_shared<const textured_model>(
      test_support::make_textured_box({0.05, 0.05, 0.01}, 64, test_support::ridges(0.0002, 0.004)));
  window_renderer_settings settings;
  settings.depth.gradient = GetParam().gradient;
  settings.depth.parallax = GetParam().parallax;
  settings.depth.grid = 32;
  result<window_renderer> feel = make_window_renderer({probe, {plate}}, settings);
  ASSERT_TRUE(feel);
  simulated_settings c = hand(motion_kind::scrub);
  c.motion.T_dh.position.z = 0.022;
  simulated_device dev(c);
  ASSERT_TRUE(dev.open() && dev.arm());
  control_settings control;
  control.probe = solid_probe(probe->mass);
  const auto records = std::make_unique<command::record_queue>();
  virtual_session session(std::move(*feel), {{pose{}}, probe->mass.centre_of_mass}, dev, control,
                          {.contact_period_ns = 4 * ms, .contact_one_period_late = true},
                          command::record_queue::writer{records.get()});
  EXPECT_EQ(run(session, 700 * ms), 700U);

  std::uint64_t in_contact = 0;
  for (session_record r; records->pop(r);) in_contact += r.contacts > 0 ? 1 : 0;
  EXPECT_GT(in_contact, 300U);
}

INSTANTIATE_TEST_SUITE_P(
    every_variant, trapped_renderer,
    testing::Values(variant{"soft_max", gradient_scheme::soft_max, parallax_mode::exact},
                    variant{"soft_max_paper_lookup", gradient_scheme::soft_max, parallax_mode::paper_lookup},
                    variant{"central_difference", gradient_scheme::central_difference, parallax_mode::exact},
                    variant{"central_difference_paper_lookup", gradient_scheme::central_difference,
                            parallax_mode::paper_lookup}),
    [](const auto& each) { return std::string(each.param.name); });

// A pose that is not a pose, and contacts that do not fit: answers of the renderer that no session above asks for.
TEST(trapped_session, a_renderer_that_refuses_or_drops) {
  const auto box = std::make_shared<const textured_model>(
      test_support::make_textured_box({0.01, 0.01, 0.01}, 64, test_support::ridges(0.0002, 0.004)));
  result<window_renderer> feel = make_window_renderer({box, {box}}, {.limits = {.contacts = 1, .triangles = 1}});
  ASSERT_TRUE(feel);
  const pose T_wb;
  tick found;
  tick_trap trap;
  status refused = status::ok;
  trap([&] {
    refused =
        feel->step({{quat(1, 0, 0, 0), vec3(std::numeric_limits<double>::quiet_NaN())}, std::span(&T_wb, 1)}, found);
  });
  EXPECT_EQ(refused, status::invalid_pose);
  trap([&] { refused = feel->step({{quat(1, 0, 0, 0), {0, 0, 0.0199}}, std::span(&T_wb, 1)}, found); });
  EXPECT_EQ(refused, status::capacity_reached);
  EXPECT_GT(found.dropped_contacts, 0U);
}

}  // namespace
