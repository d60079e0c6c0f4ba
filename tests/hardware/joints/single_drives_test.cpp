// What is each joint drive's own: its wire, its versions, its watchdog.
#include <cstdint>

#include "hardware/joints/rig.hpp"

namespace asperity::test_support {
namespace {

TEST(MitDrive, unwraps_a_position_beyond_the_range) {
  rig<mit_kind> r;
  ASSERT_TRUE(r.bring_up());
  for (int i = 0; i <= 4000; ++i) {
    r.peer.position_rad = 0.01 * i;
    r.tick();
  }
  r.run(2 * ms);
  EXPECT_EQ(r.drive.state(), drive_state::idle) << r.drive.fault().what;
  EXPECT_NEAR(r.drive.reading().position_rad, 0.25 - 40.0 / 6.0, 0.01);
}

TEST(MitDrive, an_answer_of_another_form_is_no_answer) {
  rig<mit_kind> r;
  r.peer.answer_size(5);
  r.drive.start(r.clock.now_ns());
  ASSERT_TRUE(r.run_until(drive_state::fault, 600 * ms));
  EXPECT_TRUE(r.why_contains("protocol")) << r.drive.fault().what;
  for (const std::uint8_t size : {std::uint8_t{6}, std::uint8_t{7}, std::uint8_t{8}}) {
    rig<mit_kind> other;
    other.peer.answer_size(size);
    EXPECT_TRUE(other.go(5.0)) << int{size};
  }
}

TEST(MitDrive, a_reset_too_short_to_be_a_silence_shows_in_the_torque) {
  rig<mit_kind> r;
  ASSERT_TRUE(r.go(10.0));
  r.run(20 * ms);
  r.peer.reset(r.clock.now_ns(), 0);
  ASSERT_TRUE(r.run_until(drive_state::fault, 110 * ms));
  EXPECT_TRUE(r.why_contains("no torque")) << r.drive.fault().what;
  EXPECT_EQ(r.peer.enables(), 1);
}

TEST(MitDrive, feeds_the_drives_watchdog_with_the_applications_commands_only) {
  rig<mit_kind> r;
  ASSERT_TRUE(r.go(10.0));
  r.run(20 * ms);
  const std::uint64_t before = r.peer.frames();
  r.feeding = false;
  r.run(10 * ms);
  EXPECT_LE(r.peer.frames(), before + 2);
}

TEST(MitDrive, a_limit_below_the_zero_of_the_wire_is_refused) {
  joint_drive_settings o = geared();
  o.peak_torque_n_m = 0.02;  // 15 N m / 4095 * 6 is more
  rig<mit_kind> r({}, mit_kind::options(o));
  r.drive.start(r.clock.now_ns());
  EXPECT_EQ(r.drive.state(), drive_state::fault);
}

TEST(OdriveDrive, picks_the_table_by_the_version) {
  rig<odrive_0_5_kind> old;
  ASSERT_TRUE(old.bring_up());
  EXPECT_EQ(old.drive.firmware(), odrive::firmware::v0_5);
  EXPECT_GT(old.peer.remote_frames(), 0U) << "getters of 0.5 are remote frames";
  rig<odrive_0_6_kind> current;
  ASSERT_TRUE(current.bring_up());
  EXPECT_EQ(current.drive.firmware(), odrive::firmware::v0_6);
}

TEST(OdriveDrive, another_firmware_is_refused) {
  fake_odrive::settings c;
  c.version = {2, 5, 0, 0, 0, 7, 1, 0};
  rig<odrive_0_6_kind> r({}, odrive_0_6_kind::options(geared()), c);
  r.drive.start(r.clock.now_ns());
  ASSERT_TRUE(r.run_until(drive_state::fault));
  EXPECT_TRUE(r.why_contains("0.5 nor 0.6")) << r.drive.fault().what;
  EXPECT_EQ(r.drive.fault().code, 0x000701U);
}

TEST(OdriveDrive, what_another_program_left_running_is_stopped_first) {
  fake_odrive::settings c;
  c.watchdog_ns = 0;
  rig<odrive_0_6_kind> r({}, odrive_0_6_kind::options(geared()), c);
  r.peer.leave_behind(2.0F);
  EXPECT_FALSE(r.is_limp());
  ASSERT_TRUE(r.bring_up()) << r.drive.fault().what;
  EXPECT_FALSE(r.peer.enabled());
}

TEST(OdriveDrive, an_axis_that_does_not_obey_is_stopped_harder) {
  fake_odrive::settings c;
  c.watchdog_ns = 0;
  rig<odrive_0_6_kind> r({}, odrive_0_6_kind::options(geared()), c);
  ASSERT_TRUE(r.go(10.0));
  r.peer.stick();
  r.drive.disable(r.clock.now_ns());
  r.run(2 * ms);
  EXPECT_TRUE(r.is_limp());
  r.run(600 * ms);
  EXPECT_TRUE(r.peer.stopped_hard());
  EXPECT_FALSE(r.peer.enabled());
}

TEST(OdriveDrive, feeds_the_drives_watchdog_with_the_applications_commands_only) {
  for (const auto v : {odrive::firmware::v0_5, odrive::firmware::v0_6}) {
    fake_odrive::settings c;
    c.firmware = v;
    c.watchdog_ns = 5 * ms;
    rig<odrive_0_6_kind> r({}, odrive_0_6_kind::options(geared()), c);
    ASSERT_TRUE(r.go(10.0)) << r.drive.fault().what;
    r.run(20 * ms);
    const std::uint64_t before = r.peer.frames();
    r.feeding = false;
    r.run(10 * ms);
    EXPECT_TRUE(r.peer.watchdog_expired());
    EXPECT_LE(r.peer.frames(), before + 2);
    EXPECT_TRUE(r.is_limp());
  }
}

TEST(OdriveDrive, heartbeats_that_stop_are_a_fault_though_estimates_come) {
  fake_odrive::settings c;
  rig<odrive_0_6_kind> r({}, odrive_0_6_kind::options(geared()), c);
  ASSERT_TRUE(r.go(10.0));
  r.run(10 * ms);
  // Heartbeats are not heard; everything else is.
  for (int i = 0; i < 400 && r.drive.state() != drive_state::fault; ++i) {
    r.clock.advance_ns(ms);
    can_frame f;
    while (r.host.receive(r.clock.now_ns(), f) == io_status::ok) {
      if ((f.id & 0x1fU) != 1) r.drive.take(r.clock.now_ns(), f);
    }
    r.drive.set_torque(10.0);
    static_cast<void>(r.drive.step(r.clock.now_ns(), r.watched));
  }
  EXPECT_EQ(r.drive.state(), drive_state::fault);
  EXPECT_TRUE(r.why_contains("heartbeat")) << r.drive.fault().what;
}

TEST(MoteusDrive, another_version_of_the_registers_is_refused) {
  fake_moteus::settings c;
  c.register_map = 4;
  rig<moteus_kind> r({}, moteus_kind::options(geared()), c);
  r.drive.start(r.clock.now_ns());
  ASSERT_TRUE(r.run_until(drive_state::fault));
  EXPECT_EQ(r.drive.fault().code, 4U);
  EXPECT_TRUE(r.why_contains("version")) << r.drive.fault().what;
}

TEST(MoteusDrive, a_refused_register_is_a_fault) {
  rig<moteus_kind> r;
  ASSERT_TRUE(r.go(10.0));
  r.peer.refuse_next_read();
  ASSERT_TRUE(r.run_until(drive_state::fault, 10 * ms));
  EXPECT_TRUE(r.why_contains("refused")) << r.drive.fault().what;
}

TEST(MoteusDrive, every_command_carries_its_watchdog_and_its_limit) {
  rig<moteus_kind> r;
  ASSERT_TRUE(r.go(10.0));
  r.run(5 * ms);
  EXPECT_DOUBLE_EQ(r.peer.watchdog_s(), 0.02);
  EXPECT_LE(r.peer.most_torque_n_m() * 6.0, 20.0);
  EXPECT_NEAR(r.peer.most_torque_n_m() * 6.0, 20.0, 1e-5);
}

// Silent for longer than the drive's watchdog and shorter than the driver's own limits: the drive's word is passed on.
TEST(MoteusDrive, an_expired_watchdog_is_reported) {
  joint_drive_settings joint = geared();
  joint.quiet_ns = joint.hold_ns = joint.silence_ns = 500 * ms;
  rig<moteus_kind> r({}, moteus_kind::options(joint));
  ASSERT_TRUE(r.go(10.0));
  r.run(10 * ms);
  r.clock.advance_ns(30 * ms);
  ASSERT_TRUE(r.peer.watchdog_expired());
  ASSERT_TRUE(r.run_until(drive_state::fault, 10 * ms));
  EXPECT_TRUE(r.why_contains("watchdog expired")) << r.drive.fault().what;
}

TEST(MoteusDrive, the_drives_own_fault_is_not_wiped_out_before_it_is_cleared) {
  rig<moteus_kind> r;
  ASSERT_TRUE(r.go(10.0));
  r.peer.fail(34);
  r.run(100 * ms);
  EXPECT_EQ(r.peer.mode(), 1);
  EXPECT_EQ(r.drive.fault().code, 34U);
  ASSERT_TRUE(r.drive.clear_fault(r.clock.now_ns()));
  ASSERT_TRUE(r.run_until(drive_state::idle)) << r.drive.fault().what;
  EXPECT_EQ(r.peer.mode(), 0);
}

TEST(MoteusDrive, a_classic_bus_is_refused) {
  virtual_can classic(false);
  virtual_can_node host(classic);
  moteus_drive drive(moteus_kind::options(geared()));
  drive.start(0);
  EXPECT_EQ(drive.step(ms, host), io_status::refused);
  EXPECT_EQ(drive.state(), drive_state::fault);
  EXPECT_EQ(classic.frames(), 0U);
}

}  // namespace
}  // namespace asperity::test_support
