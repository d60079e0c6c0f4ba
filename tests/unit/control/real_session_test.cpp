// Threads start, tick, stop and leave nothing behind. How late they are is the machine's affair and is not asserted.
#include <chrono>
#include <gtest/gtest.h>
#include <thread>

#include <asperity/control/real_session.hpp>
#include <asperity/hal/simulated/simulated_device.hpp>

#include "unit/control/analytic_wall.hpp"

namespace {

using namespace asperity;
using test_support::analytic_wall;

simulated_config touching_hand() {
  simulated_config c;
  c.motion = {.depth_m = 0.01, .approach_s = 0.05};
  return c;
}

struct counting {
  std::uint64_t* ticks;
  void operator()(const session_record&) noexcept { ++*ticks; }
};

TEST(real_session, runs_both_threads_and_comes_to_rest) {
  simulated_device dev(touching_hand());
  ASSERT_TRUE(dev.open() && dev.arm());
  std::uint64_t watched = 0;
  real_session<analytic_wall, simulated_device, counting> session({}, {{pose{}}, vec3(0.0)}, dev, {}, {},
                                                                  counting{&watched});
  session.start();
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  session.stop();

  const tick_timing& device = session.device_timing();
  EXPECT_GT(device.ticks, 0U);
  EXPECT_GT(session.contact_timing().ticks, 0U);
  EXPECT_GT(session.contact().computed(), 0U);
  EXPECT_EQ(device.durations_ns.size(), device.ticks);
  EXPECT_GE(watched, device.ticks);  // winding down ticks too
  EXPECT_TRUE(session.device().gate().at_rest());
  EXPECT_EQ(session.device().gate().fault(), gate_fault::stopped);
  EXPECT_EQ(dev.state(), device_state::ready);
}

TEST(real_session, stops_when_it_is_destroyed_and_when_it_never_ran) {
  simulated_device dev(touching_hand());
  ASSERT_TRUE(dev.open() && dev.arm());
  {
    real_session<analytic_wall, simulated_device> idle({}, {{pose{}}, vec3(0.0)}, dev, control_config{});
    idle.stop();
  }
  {
    real_session<analytic_wall, simulated_device> session({}, {{pose{}}, vec3(0.0)}, dev, control_config{});
    session.start();
    session.start();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  EXPECT_EQ(dev.state(), device_state::ready);
}

TEST(real_session, tells_the_gate_why_it_stops) {
  simulated_device dev(touching_hand());
  ASSERT_TRUE(dev.open() && dev.arm());
  real_session<analytic_wall, simulated_device> session({}, {{pose{}}, vec3(0.0)}, dev, control_config{});
  for (const gate_fault cause : {gate_fault::interrupted, gate_fault::stopped}) {
    session.start();
    session.stop(cause);
    session.stop(gate_fault::watchdog);  // it does not run any more
    EXPECT_EQ(session.device().gate().fault(), cause);
    ASSERT_TRUE(session.device().clear_fault());
  }
}

std::atomic<int> threads_set_up{0};

TEST(real_session, lets_each_thread_be_set_up_once) {
  simulated_device dev(touching_hand());
  ASSERT_TRUE(dev.open() && dev.arm());
  threads_set_up = 0;
  real_schedule schedule;
  schedule.timed_ticks = 4;
  schedule.set_up_thread = [](session_thread) { ++threads_set_up; };
  real_session<analytic_wall, simulated_device> session({}, {{pose{}}, vec3(0.0)}, dev, control_config{}, schedule);
  session.start();
  std::this_thread::sleep_for(std::chrono::milliseconds(60));
  session.stop();
  EXPECT_EQ(threads_set_up.load(), 2);
  EXPECT_LE(session.device_timing().durations_ns.size(), 4U);
}

}  // namespace
