// A session's ticks take nothing from the heap, from the first one on.
#include <gtest/gtest.h>
#include <memory>
#include <new>

#include <asperity/asperity.hpp>

#include "rt/allocation_guard.hpp"
#include "support/small_models.hpp"
#include "unit/control/analytic_wall.hpp"

namespace {

using namespace asperity;
using test_support::allocation_guard;
using test_support::analytic_wall;

simulated_config hand(motion_kind kind) {
  simulated_config c;
  c.motion = {.kind = kind, .T_dh = {quat(1, 0, 0, 0), {0, 0, 0.004}}, .depth_m = 0.008, .approach_s = 0.2};
  c.measurement.jitter_ns = 500'000;
  // Faults take the rarer paths: rejected samples, a shut gate, a device that leaves.
  c.faults = {{device_fault::drop, 900'000'000, 902'000'000},
              {device_fault::nan_pose, 1'200'000'000, 1'300'000'000},
              {device_fault::depart, 1'600'000'000, 1'700'000'000}};
  return c;
}

TEST(tick_allocation, the_guard_sees_an_allocation) {
  const allocation_guard guard;
  // A call of the function, because a compiler may leave out a new-expression together with its delete.
  void* const memory = ::operator new(100);
  EXPECT_EQ(guard.allocations(), 1U);
  ::operator delete(memory);
  EXPECT_EQ(guard.releases(), 1U);
}

TEST(tick_allocation, both_loops_with_an_erased_device) {
  for (const motion_kind kind : {motion_kind::press, motion_kind::scrub, motion_kind::twist, motion_kind::free}) {
    any_device dev{simulated_device(hand(kind))};
    ASSERT_TRUE(dev.open() && dev.arm());
    virtual_session<analytic_wall, any_device> session({}, {{pose{}}, vec3(0.0)}, dev, control_config{});
    const allocation_guard guard;
    static_cast<void>(session.run_until(2'000'000'000));
    EXPECT_EQ(guard.allocations(), 0U);
    EXPECT_EQ(guard.releases(), 0U);
    EXPECT_EQ(session.device().gate().fault(), gate_fault::bad_samples);
  }
}

struct seen_contact {
  std::uint32_t most = 0;
  void operator()(const session_record& r) noexcept { most = std::max(most, r.contacts); }
};

TEST(tick_allocation, a_session_with_the_default_renderer_and_textured_models) {
  const auto probe = std::make_shared<const textured_model>(
      test_support::make_textured_box({0.01, 0.01, 0.01}, 64, test_support::ridges(0.0002, 0.004)));
  const auto plate = std::make_shared<const textured_model>(
      test_support::make_textured_box({0.05, 0.05, 0.01}, 64, test_support::ridges(0.0002, 0.004)));
  result<renderer> feel = make_renderer({probe, {plate}});
  ASSERT_TRUE(feel);
  simulated_config c = hand(motion_kind::scrub);
  c.motion.T_dh.position.z = 0.022;
  c.faults.clear();
  simulated_device dev(c);
  ASSERT_TRUE(dev.open() && dev.arm());
  control_config control;
  control.probe = solid_probe(probe->mass);
  virtual_session session(std::move(*feel), {{pose{}}, probe->mass.centre_of_mass}, dev, control, {}, seen_contact{});
  const allocation_guard guard;
  static_cast<void>(session.run_until(700'000'000));
  EXPECT_EQ(guard.allocations(), 0U);
  EXPECT_EQ(guard.releases(), 0U);
  EXPECT_GT(session.device().observer().most, 0U);
}

}  // namespace
