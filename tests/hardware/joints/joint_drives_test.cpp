// Joint drives against fake peers that speak the protocol: to torque and back, and what must not bring torque.
#include <cmath>
#include <cstdint>

#include "hardware/joints/rig.hpp"
#include "support/counted_news.hpp"

namespace asperity::test_support {
namespace {

TYPED_TEST_SUITE(JointDrives, every_kind);

TYPED_TEST(JointDrives, comes_up_follows_torques_and_goes_down) {
  rig<TypeParam> r;
  EXPECT_EQ(r.drive.state(), drive_state::silent);
  r.run(5 * ms);
  EXPECT_EQ(r.peer.frames(), 0U) << "nothing is sent before start()";
  EXPECT_FALSE(r.drive.enable(r.clock.now_ns()));
  ASSERT_TRUE(r.bring_up()) << r.drive.fault().what;
  EXPECT_FALSE(r.peer.enabled());
  EXPECT_FALSE(r.drive.clear_fault(r.clock.now_ns()));
  ASSERT_TRUE(r.drive.enable(r.clock.now_ns()));
  ASSERT_TRUE(r.run_until(drive_state::enabled)) << r.drive.fault().what;
  EXPECT_TRUE(r.is_limp());
  for (int i = 0; i < 300; ++i) {
    r.wanted_n_m = 15.0 * std::sin(0.05 * i);
    r.peer.position_rad = 3.0 * std::sin(0.01 * i);
    r.tick();
    r.clock.advance_ns(ms / 10);
    EXPECT_NEAR(r.joint_torque(), r.wanted_n_m, r.drive.facts().torque_resolution_n_m * 1.01);
  }
  for (const double over : {21.0, 1e300, -21.0, -1e300}) {
    r.wanted_n_m = over;
    r.run(2 * ms);
    EXPECT_NEAR(std::fabs(r.joint_torque()), 20.0, r.drive.facts().torque_resolution_n_m * 1.01);
    EXPECT_GT(r.joint_torque() * over, 0.0);
  }
  for (const double none : {std::nan(""), HUGE_VAL, -HUGE_VAL, 0.0, -0.0}) {
    r.wanted_n_m = none;
    r.run(2 * ms);
    EXPECT_TRUE(r.is_limp());
  }
  EXPECT_EQ(r.drive.fault().code, 0U) << r.drive.fault().what;
  r.wanted_n_m = 10.0;
  r.run(3 * ms);
  r.drive.disable(r.clock.now_ns());
  EXPECT_NE(r.drive.state(), drive_state::enabled);
  r.run(2 * ms);
  EXPECT_TRUE(r.is_limp()) << "zero torque goes out first";
  ASSERT_TRUE(r.run_until(drive_state::idle)) << r.drive.fault().what;
  EXPECT_FALSE(r.peer.enabled());
  EXPECT_EQ(r.peer.enables(), 1);
}

TYPED_TEST(JointDrives, measures_the_joint_and_not_the_shaft) {
  rig<TypeParam> r;
  ASSERT_TRUE(r.bring_up());
  r.peer.position_rad = 2.4;
  r.peer.velocity_rad_per_s = 3.0;
  r.run(5 * ms);
  const joint_reading& now = r.drive.reading();
  EXPECT_NEAR(now.position_rad, 0.25 - 2.4 / 6.0, r.drive.facts().position_resolution_rad * 2.0);
  ASSERT_TRUE(now.has_velocity);
  EXPECT_NEAR(now.velocity_rad_per_s, -0.5, 0.01);
  EXPECT_LE(r.clock.now_ns() - now.host_time_ns, 2 * ms);
  const std::uint64_t before = now.sequence;
  r.run(10 * ms);
  EXPECT_GE(r.drive.reading().sequence, before + 9);
  ASSERT_TRUE(r.drive.enable(r.clock.now_ns()));
  ASSERT_TRUE(r.run_until(drive_state::enabled));
  r.wanted_n_m = 12.0;
  r.run(5 * ms);
  ASSERT_TRUE(r.drive.reading().has_torque);
  EXPECT_NEAR(r.drive.reading().torque_n_m, 12.0, 0.1);
}

TYPED_TEST(JointDrives, a_silent_host_is_caught_by_the_drives_own_watchdog) {
  rig<TypeParam> r;
  ASSERT_TRUE(r.go(10.0));
  r.run(20 * ms);
  EXPECT_FALSE(r.is_limp());
  r.clock.advance_ns(100 * ms);
  EXPECT_TRUE(r.peer.watchdog_expired());
  EXPECT_TRUE(r.is_limp());
  r.run(40 * ms);
  EXPECT_EQ(r.drive.state(), drive_state::fault);
  EXPECT_TRUE(r.is_limp());
  EXPECT_EQ(r.peer.enables(), 1) << "nothing re-enables";
}

TYPED_TEST(JointDrives, an_application_that_stops_commanding_is_not_covered_up) {
  rig<TypeParam> r;
  ASSERT_TRUE(r.go(10.0));
  r.run(20 * ms);
  r.feeding = false;
  r.run(23 * ms);
  EXPECT_EQ(r.drive.state(), drive_state::fault);
  EXPECT_TRUE(r.why_contains("application") || r.peer.watchdog_expired()) << r.drive.fault().what;
  r.run(3 * ms);
  EXPECT_TRUE(r.is_limp());
}

TYPED_TEST(JointDrives, a_torque_that_was_never_set_needs_no_renewing) {
  rig<TypeParam> r;
  r.feeding = false;
  ASSERT_TRUE(r.go());
  r.run(300 * ms);
  EXPECT_EQ(r.drive.state(), drive_state::enabled) << r.drive.fault().what;
  EXPECT_TRUE(r.is_limp());
}

TYPED_TEST(JointDrives, the_drives_own_fault_is_reported_with_its_code) {
  rig<TypeParam> r;
  ASSERT_TRUE(r.go(10.0));
  r.run(10 * ms);
  r.peer.fail(static_cast<std::uint8_t>(TypeParam::broken.sent));
  if constexpr (requires { r.peer.leave_behind(0.0F); }) r.peer.fail(TypeParam::broken.sent);
  ASSERT_TRUE(r.run_until(drive_state::fault, 50 * ms));
  EXPECT_EQ(r.drive.fault().code, TypeParam::broken.code);
  EXPECT_TRUE(r.why_contains(TypeParam::broken.word)) << r.drive.fault().what;
  r.run(3 * ms);
  EXPECT_TRUE(r.is_limp());
  EXPECT_FALSE(r.drive.enable(r.clock.now_ns())) << "latched";
  r.run(200 * ms);
  EXPECT_EQ(r.drive.state(), drive_state::fault);
  EXPECT_EQ(r.peer.enables(), 1);
}

TYPED_TEST(JointDrives, the_first_cause_of_a_fault_stays) {
  rig<TypeParam> r;
  ASSERT_TRUE(r.go(10.0));
  r.run(10 * ms);
  r.feeding = false;
  ASSERT_TRUE(r.run_until(drive_state::fault, 100 * ms));
  const drive_fault first = r.drive.fault();
  r.peer.fail(static_cast<std::uint8_t>(TypeParam::broken.sent));
  r.run(30 * ms);
  r.peer.position_rad = 6.0;
  r.run(30 * ms);
  EXPECT_STREQ(r.drive.fault().what, first.what);
  EXPECT_EQ(r.drive.fault().code, first.code);
  EXPECT_EQ(r.drive.state(), drive_state::fault);
}

TYPED_TEST(JointDrives, a_cleared_fault_leads_to_idle_and_not_to_torque) {
  rig<TypeParam> r;
  ASSERT_TRUE(r.go(10.0));
  r.run(10 * ms);
  r.feeding = false;
  ASSERT_TRUE(r.run_until(drive_state::fault, 100 * ms));
  r.feeding = true;
  r.run(50 * ms);
  ASSERT_TRUE(r.drive.clear_fault(r.clock.now_ns()));
  EXPECT_STREQ(r.drive.fault().what, "none");
  ASSERT_TRUE(r.run_until(drive_state::idle)) << r.drive.fault().what;
  r.run(200 * ms);
  EXPECT_EQ(r.peer.enables(), 1);
  EXPECT_EQ(r.drive.state(), drive_state::idle);
  ASSERT_TRUE(r.drive.enable(r.clock.now_ns()));
  ASSERT_TRUE(r.run_until(drive_state::enabled));
  EXPECT_EQ(r.peer.enables(), 2);
}

TYPED_TEST(JointDrives, a_torque_from_before_a_fault_does_not_come_back) {
  rig<TypeParam> r;
  ASSERT_TRUE(r.go(10.0));
  r.run(10 * ms);
  ASSERT_FALSE(r.is_limp());
  r.feeding = false;
  ASSERT_TRUE(r.run_until(drive_state::fault, 100 * ms));
  r.run(50 * ms);
  ASSERT_TRUE(r.drive.clear_fault(r.clock.now_ns()));
  ASSERT_TRUE(r.run_until(drive_state::idle)) << r.drive.fault().what;
  ASSERT_TRUE(r.drive.enable(r.clock.now_ns()));
  ASSERT_TRUE(r.run_until(drive_state::enabled));
  for (int i = 0; i < 50; ++i) {
    r.tick();
    ASSERT_TRUE(r.is_limp()) << TypeParam::name << " tick " << i;
  }
  EXPECT_EQ(r.drive.state(), drive_state::enabled) << r.drive.fault().what;
}

TYPED_TEST(JointDrives, a_fault_that_stays_in_the_drive_comes_back) {
  rig<TypeParam> r;
  ASSERT_TRUE(r.bring_up());
  r.peer.mute(true);
  ASSERT_TRUE(r.run_until(drive_state::silent, 200 * ms)) << "idle and silent is no fault";
  ASSERT_FALSE(r.drive.enable(r.clock.now_ns()));
  r.run(300 * ms);
  EXPECT_EQ(r.drive.state(), drive_state::silent);
  r.peer.mute(false);
  ASSERT_TRUE(r.run_until(drive_state::idle)) << r.drive.fault().what;
  EXPECT_EQ(r.peer.enables(), 0) << "a drive that comes back is not enabled";
}

TYPED_TEST(JointDrives, a_drive_that_never_answers_ends_in_a_fault) {
  rig<TypeParam> r;
  r.peer.mute(true);
  r.drive.start(r.clock.now_ns());
  ASSERT_TRUE(r.run_until(drive_state::fault, 600 * ms));
  EXPECT_TRUE(r.why_contains("does not answer")) << r.drive.fault().what;
  r.run(50 * ms);
  r.peer.mute(false);
  r.run(300 * ms);
  EXPECT_EQ(r.drive.state(), drive_state::fault) << "latched";
}

TYPED_TEST(JointDrives, a_drive_that_falls_silent_gets_no_torque) {
  rig<TypeParam> r;
  ASSERT_TRUE(r.go(10.0));
  r.run(10 * ms);
  r.peer.mute(true);
  ASSERT_TRUE(r.run_until(drive_state::fault, 60 * ms));
  EXPECT_TRUE(r.why_contains("silent")) << r.drive.fault().what;
  r.run(3 * ms);
  EXPECT_TRUE(r.is_limp());
  r.peer.mute(false);
  r.run(300 * ms);
  EXPECT_EQ(r.drive.state(), drive_state::fault);
  EXPECT_FALSE(r.peer.enabled());
  EXPECT_EQ(r.peer.enables(), 1);
}

TYPED_TEST(JointDrives, a_drive_that_is_quiet_gets_no_torque_until_it_is_heard_again) {
  const std::int64_t quiet_ns = TypeParam::options(geared()).joint.quiet_ns;
  rig<TypeParam> r;
  ASSERT_TRUE(r.go(10.0));
  r.run(10 * ms);
  r.peer.mute(true);
  r.run(quiet_ns + 2 * ms);
  r.last_on_wire_n_m = 0.0;
  for (int i = 0; i < 5; ++i) {
    r.tick();
    EXPECT_LE(std::fabs(r.last_on_wire_n_m), r.zero_error()) << TypeParam::name << " tick " << i;
  }
  r.peer.mute(false);
  r.run(5 * ms);
  EXPECT_EQ(r.drive.state(), drive_state::enabled) << r.drive.fault().what;
  EXPECT_NEAR(r.last_on_wire_n_m, 10.0, r.drive.facts().torque_resolution_n_m * 1.01);
}

TYPED_TEST(JointDrives, a_drive_that_does_not_enable_ends_in_a_fault) {
  rig<TypeParam> r;
  ASSERT_TRUE(r.bring_up());
  r.peer.mute(true);
  ASSERT_TRUE(r.drive.enable(r.clock.now_ns()));
  ASSERT_TRUE(r.run_until(drive_state::fault, 600 * ms)) << to_string(r.drive.state());
  EXPECT_TRUE(r.why_contains("did not enable in time")) << r.drive.fault().what;
  r.peer.mute(false);
  r.run(300 * ms);
  EXPECT_TRUE(r.is_limp());
  EXPECT_EQ(r.drive.state(), drive_state::fault);
}

// 100 rad/s over a period and 5 ms of jitter: 0.6 rad of the joint, 3.6 rad of the shaft.
TYPED_TEST(JointDrives, a_position_that_jumps_is_a_fault_and_one_that_moves_is_none) {
  for (const double shaft_rad : {3.0, -3.0, 5.0, -5.0}) {
    rig<TypeParam> r;
    ASSERT_TRUE(r.go(10.0));
    r.run(10 * ms);
    r.peer.position_rad = shaft_rad;
    r.run(25 * ms);  // some drives tell their position every few periods
    if (std::fabs(shaft_rad) < 3.6) {
      EXPECT_EQ(r.drive.state(), drive_state::enabled) << r.drive.fault().what;
    } else {
      EXPECT_EQ(r.drive.state(), drive_state::fault) << shaft_rad;
      EXPECT_TRUE(r.why_contains("jumped")) << r.drive.fault().what;
      EXPECT_TRUE(r.is_limp());
    }
  }
}

TYPED_TEST(JointDrives, a_reset_in_the_middle_does_not_bring_torque_back) {
  for (const std::int64_t boot_ns : {15 * ms, 40 * ms, 300 * ms}) {
    rig<TypeParam> r;
    r.peer.position_rad = 4.0;
    ASSERT_TRUE(r.go(10.0)) << r.drive.fault().what;
    r.run(20 * ms);
    r.peer.reset(r.clock.now_ns(), boot_ns);
    for (int i = 0; i < 600; ++i) {
      r.tick();
      ASSERT_TRUE(r.is_limp()) << TypeParam::name << " boot " << boot_ns << " tick " << i;
    }
    EXPECT_EQ(r.drive.state(), drive_state::fault) << boot_ns;
    EXPECT_EQ(r.peer.enables(), 1) << boot_ns;
    EXPECT_FALSE(r.peer.enabled());
  }
}

TYPED_TEST(JointDrives, options_out_of_range_are_a_fault_and_no_torque) {
  const auto refused = [](const joint_drive_settings& joint) {
    rig<TypeParam> r({}, TypeParam::options(joint));
    r.drive.start(r.clock.now_ns());
    r.run(20 * ms);
    return r.drive.state() == drive_state::fault && r.why_contains("settings") && r.peer.frames() == 0;
  };
  joint_drive_settings o = geared();
  for (const double bad : {std::nan(""), 0.0, -1.0, HUGE_VAL}) {
    o = geared();
    o.peak_torque_n_m = bad;
    EXPECT_TRUE(refused(o)) << bad;
    o = geared();
    o.scale.gear_ratio = bad;
    EXPECT_TRUE(refused(o)) << bad;
  }
  o = geared();
  o.hold_ns = 0;
  EXPECT_TRUE(refused(o));
}

TYPED_TEST(JointDrives, nothing_in_a_session_allocates) {
  rig<TypeParam> r;
  ASSERT_TRUE(r.go(10.0));
  std::size_t news = 0;
  can_frame f;
  for (int i = 0; i < 200; ++i) {
    r.clock.advance_ns(ms);
    const std::size_t before = news_in_this_thread();
    const std::int64_t now_ns = r.clock.now_ns();
    while (r.host.receive(now_ns, f) == io_status::ok) r.drive.take(now_ns, f);
    r.drive.set_torque(5.0);
    EXPECT_EQ(r.drive.step(now_ns, r.host), io_status::ok);
    if (i == 150) r.drive.disable(now_ns);
    news += news_in_this_thread() - before;
  }
  EXPECT_EQ(news, 0U);
  EXPECT_EQ(r.drive.state(), drive_state::idle);
}

}  // namespace
}  // namespace asperity::test_support
