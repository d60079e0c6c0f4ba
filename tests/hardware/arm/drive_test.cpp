// One CiA 402 drive against a fake one on a virtual bus: the way up, the way down, and everything that can go wrong.
#include <gtest/gtest.h>
#include <string>

#include "asperity/drivers/canopen/canopen_master.hpp"
#include "asperity/drivers/canopen/cia402_drive.hpp"
#include "asperity/transport/virtual/manual_clock.hpp"
#include "asperity/transport/virtual/virtual_can.hpp"
#include "hardware/peers/fake_cia402.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;

cia402_settings motor() {
  cia402_settings c;
  c.node = 5;
  c.rated_torque_n_m = 0.4;
  c.peak_torque_n_m = 8.0;
  c.counts_per_turn = 65536.0;
  c.gear_ratio = 10.0;
  return c;
}

/// What an application does with one drive.
struct bench {
  explicit bench(cia402_settings settings = motor(), fake_cia402_settings peer = {.node = 5}, link_script script = {})
      : host(bus, std::move(script)), node(bus), fake(peer, node), drive(settings) {
    clock.on_advance([this](std::int64_t now) {
      fake.step(now);
      largest = std::max(largest, std::abs(fake.torque_permille()));
    });
  }
  void tick() {
    clock.advance_ns(1'000'000);
    can_frame f;
    while (host.receive(clock.now_ns(), f) == io_status::ok) static_cast<void>(drive.take(clock.now_ns(), f));
    worst = drive.step(clock.now_ns(), host);
    if (ticks_master) static_cast<void>(master.step(clock.now_ns(), host));
  }
  /// @return ticks until that state, or -1
  int until(drive_state s, int most = 6000) {
    for (int i = 0; i < most; ++i) {
      if (drive.state() == s) return i;
      tick();
    }
    return -1;
  }
  bool up() {
    drive.start(clock.now_ns());
    return until(drive_state::idle) >= 0;
  }
  bool enabled() { return up() && drive.enable(clock.now_ns()) && until(drive_state::enabled) >= 0; }
  std::string why() { return drive.fault().what; }

  manual_clock clock{};
  virtual_can bus{false};
  virtual_can_node host;
  virtual_can_node node;
  fake_cia402 fake;
  canopen_master master{};
  cia402_drive drive;
  io_status worst = io_status::ok;
  int largest = 0;
  bool ticks_master = true;
};

TEST(cia402_drive, comes_up_configured_and_puts_out_the_commanded_torque) {
  bench b;
  EXPECT_EQ(b.drive.state(), drive_state::silent);
  EXPECT_FALSE(b.drive.enable(0));
  ASSERT_TRUE(b.up()) << b.why();
  EXPECT_EQ(b.fake.power(), canopen::power_state::ready_to_switch_on);
  EXPECT_EQ(b.fake.value(0x1016, 1), 0x007f0014U);  // node 127, 20 ms
  EXPECT_EQ(b.fake.value(0x1017, 0), 10U);
  EXPECT_EQ(b.fake.value(0x1400, 1), 0x205U);
  EXPECT_EQ(b.fake.value(0x1400, 2), 1U);
  EXPECT_EQ(b.fake.value(0x1600, 0), 3U);
  EXPECT_EQ(b.fake.value(0x1600, 3), 0x60710010U);
  EXPECT_EQ(b.fake.value(0x1801, 2), 1U);
  EXPECT_EQ(b.fake.value(0x1a01, 1), 0x60640020U);
  EXPECT_EQ(b.fake.value(0x6060, 0), 10U);
  EXPECT_EQ(b.fake.value(0x6071, 0), 0U);  // what was left over is gone
  EXPECT_EQ(b.fake.value(0x6072, 0), 2000U);
  EXPECT_EQ(b.fake.value(0x1402, 1) >> 31, 1U);
  b.drive.set_torque(3.0);  // idle: nothing of it reaches the motor
  for (int i = 0; i < 20; ++i) b.tick();
  EXPECT_EQ(b.largest, 0);

  b.fake.set_motion(65536, -6553600);
  b.tick();
  b.tick();
  EXPECT_NEAR(b.drive.reading().position_rad, 0.6283185307179586, 1e-12);
  EXPECT_NEAR(b.drive.reading().velocity_rad_per_s, -62.83185307179586, 1e-9);
  const std::uint64_t before = b.drive.reading().sequence;
  b.tick();
  EXPECT_EQ(b.drive.reading().sequence, before + 1);

  ASSERT_TRUE(b.drive.enable(b.clock.now_ns()));
  ASSERT_GE(b.until(drive_state::enabled), 0) << b.why();
  EXPECT_EQ(b.largest, 0);  // what was set before enable() is forgotten
  b.drive.set_torque(2.0);
  for (int i = 0; i < 3; ++i) b.tick();
  EXPECT_EQ(b.fake.torque_permille(), 500);
  EXPECT_NEAR(b.drive.reading().torque_n_m, 2.0, 1e-12);
  b.drive.set_torque(-1e300);
  for (int i = 0; i < 2; ++i) b.tick();
  EXPECT_EQ(b.fake.torque_permille(), -2000);
  b.drive.set_torque(std::nan(""));
  for (int i = 0; i < 2; ++i) b.tick();
  EXPECT_EQ(b.fake.torque_permille(), 0);

  b.drive.set_torque(2.0);
  for (int i = 0; i < 2; ++i) b.tick();
  b.drive.disable(b.clock.now_ns());
  b.tick();
  b.tick();
  EXPECT_EQ(b.fake.torque_permille(), 0);
  EXPECT_EQ(b.fake.power(), canopen::power_state::operation_enabled);  // zero first, off afterwards
  ASSERT_GE(b.until(drive_state::idle), 0);
  EXPECT_EQ(b.fake.power(), canopen::power_state::ready_to_switch_on);
}

TEST(cia402_drive, reversed_turns_angle_and_torque) {
  cia402_settings c = motor();
  c.reversed = true;
  c.zero_offset_rad = 1.0;
  bench b(c);
  ASSERT_TRUE(b.enabled());
  b.fake.set_motion(65536, 65536);
  b.drive.set_torque(2.0);
  for (int i = 0; i < 3; ++i) b.tick();
  EXPECT_EQ(b.fake.torque_permille(), -500);
  EXPECT_NEAR(b.drive.reading().position_rad, 1.0 - 0.6283185307179586, 1e-12);
  EXPECT_LT(b.drive.reading().velocity_rad_per_s, 0.0);
  EXPECT_NEAR(b.drive.reading().torque_n_m, 2.0, 1e-12);
}

TEST(cia402_drive, start_resets_a_fault_once_and_by_a_rising_edge) {
  bench b(motor(), {.node = 5, .starts_in_fault = true});
  ASSERT_TRUE(b.up()) << b.why();
  EXPECT_EQ(b.fake.fault_resets(), 1);

  bench stuck(motor(), {.node = 5, .starts_in_fault = true});
  stuck.fake.holds_fault = true;
  EXPECT_FALSE(stuck.up());
  EXPECT_EQ(stuck.drive.state(), drive_state::fault);
  EXPECT_NE(stuck.why().find("cannot be reset"), std::string::npos) << stuck.why();
  EXPECT_EQ(stuck.fake.fault_resets(), 1);
}

TEST(cia402_drive, a_cleared_fault_leads_to_idle_and_no_further) {
  bench b;
  ASSERT_TRUE(b.enabled());
  EXPECT_FALSE(b.drive.clear_fault(b.clock.now_ns()));
  b.fake.trip(0x2310);
  ASSERT_GE(b.until(drive_state::fault, 5), 0);
  EXPECT_EQ(b.drive.fault().code, 0x2310U);
  const int enables = b.fake.enables();
  for (int i = 0; i < 500; ++i) b.tick();
  EXPECT_EQ(b.drive.state(), drive_state::fault);  // nothing clears by itself
  EXPECT_FALSE(b.drive.enable(b.clock.now_ns()));
  b.drive.start(b.clock.now_ns());
  EXPECT_EQ(b.drive.state(), drive_state::fault);
  EXPECT_EQ(b.fake.fault_resets(), 0);
  ASSERT_TRUE(b.drive.clear_fault(b.clock.now_ns()));
  ASSERT_GE(b.until(drive_state::idle), 0) << b.why();
  for (int i = 0; i < 500; ++i) b.tick();
  EXPECT_EQ(b.drive.state(), drive_state::idle);
  EXPECT_EQ(b.fake.enables(), enables);
}

struct bring_up_case {
  const char* name;
  void (*spoil)(bench&);
  const char* words;
  std::uint32_t code;
};

TEST(cia402_drive, bring_up_ends_in_time_and_says_why) {
  const bring_up_case cases[] = {
      {"no boot-up", [](bench& b) { b.fake.mute_boot_up = true; }, "boot-up", 0},
      {"dead", [](bench& b) { b.fake.die(); }, "boot-up", 0},
      {"no answers", [](bench& b) { b.fake.mute_sdo = true; }, "does not answer a request", 0x6502},
      {"mapping refused",
       [](bench& b) {
         b.fake.refuse({0x1600, 3}, 0x06040041);
       },
       "SDO abort", 0x06040041},
      {"no such object", [](bench& b) { b.fake.forget_object(0x6072, 0); }, "SDO abort", 0x06020000},
      {"forgets 1016", [](bench& b) { b.fake.ignore_object(0x1016, 1); }, "did not keep a value", 0x1016},
      {"no process data", [](bench& b) { b.fake.mute_process_data = true; }, "did not start", 0},
      {"no heartbeat", [](bench& b) { b.fake.mute_heartbeat = true; }, "did not start", 0},
      {"no SYNC", [](bench& b) { b.ticks_master = false; }, "did not start", 0},
  };
  for (const bring_up_case& c : cases) {
    bench b;
    b.tick();
    c.spoil(b);
    b.drive.start(b.clock.now_ns());
    const int ticks = b.until(drive_state::fault);
    EXPECT_GE(ticks, 0) << c.name;
    EXPECT_LT(ticks, 3100) << c.name;
    EXPECT_NE(b.why().find(c.words), std::string::npos) << c.name << ": " << b.why();
    if (c.code != 0) {
      EXPECT_EQ(b.drive.fault().code, c.code) << c.name;
    }
    EXPECT_EQ(b.largest, 0) << c.name;
  }
}

TEST(cia402_drive, refuses_a_motor_that_is_not_the_configured_one) {
  bench other(motor(), {.node = 5, .rated_torque_m_n_m = 4000});
  EXPECT_FALSE(other.up());
  EXPECT_EQ(other.drive.fault().code, 4000U);
  bench no_torque_mode(motor(), {.node = 5, .supported_modes = 0x1ad});
  EXPECT_FALSE(no_torque_mode.up());
  EXPECT_NE(no_torque_mode.why().find("6502"), std::string::npos);
}

TEST(cia402_drive, does_without_objects_that_drives_need_not_have) {
  bench b;
  b.fake.forget_object(0x60b2, 0);
  b.fake.forget_object(0x1403, 1);
  b.fake.forget_object(0x1803, 1);
  EXPECT_TRUE(b.enabled()) << b.why();
}

struct session_case {
  const char* name;
  void (*spoil)(bench&);
  const char* words;
};

TEST(cia402_drive, what_nobody_asked_for_is_a_fault_in_session) {
  const session_case cases[] = {
      {"emergency", [](bench& b) { b.fake.trip(0x4310); }, "emergency"},
      {"silent trip",
       [](bench& b) {
         b.fake.sends_emergency = false;
         b.fake.trip(0x4310);
       },
       "reports a fault"},
      {"restart", [](bench& b) { b.fake.restart(); }, "started anew"},
      {"restart without a word",
       [](bench& b) {
         b.fake.mute_boot_up = true;
         b.fake.restart();
       },
       "stopped"},
      {"stopped", [](bench& b) { b.fake.leave_operational(); }, "NMT"},
      {"no heartbeat", [](bench& b) { b.fake.mute_heartbeat = true; }, "heartbeat stopped"},
      {"no data", [](bench& b) { b.fake.mute_process_data = true; }, "process data stopped"},
      {"dead", [](bench& b) { b.fake.die(); }, "stopped"},
      {"another mode", [](bench& b) { b.fake.set_mode_shown(8); }, "torque mode"},
      {"main supply gone", [](bench& b) { b.fake.drop_to(canopen::power_state::switch_on_disabled); },
       "operation enabled"},
  };
  for (const session_case& c : cases) {
    bench b;
    ASSERT_TRUE(b.enabled()) << b.why();
    b.drive.set_torque(2.0);
    for (int i = 0; i < 5; ++i) b.tick();
    ASSERT_EQ(b.fake.torque_permille(), 500);
    c.spoil(b);
    const int ticks = b.until(drive_state::fault, 100);
    EXPECT_GE(ticks, 0) << c.name;
    EXPECT_LE(ticks, 62) << c.name;
    EXPECT_NE(b.why().find(c.words), std::string::npos) << c.name << ": " << b.why();
    b.drive.set_torque(2.0);
    for (int i = 0; i < 50; ++i) b.tick();
    EXPECT_EQ(b.fake.torque_permille(), 0) << c.name;
    EXPECT_EQ(b.drive.state(), drive_state::fault) << c.name;
  }
}

TEST(cia402_drive, stops_by_itself_when_the_host_falls_silent) {
  bench b;
  ASSERT_TRUE(b.enabled());
  b.drive.set_torque(2.0);
  for (int i = 0; i < 5; ++i) b.tick();
  ASSERT_EQ(b.fake.torque_permille(), 500);
  b.clock.advance_ns(27'000'000);  // 20 ms of silence, and the age of the last heartbeat; nobody ticks
  EXPECT_EQ(b.fake.torque_permille(), 0);
  EXPECT_EQ(b.fake.power(), canopen::power_state::fault);
  b.tick();
  b.tick();
  EXPECT_EQ(b.drive.state(), drive_state::fault);
  EXPECT_EQ(b.drive.fault().code, 0x8130U);
}

TEST(cia402_drive, a_queue_that_stays_full_is_a_fault_and_one_that_was_full_is_not) {
  link_script brief;
  brief.events.push_back({.kind = link_fault::answer,
                          .direction = link_direction::to_device,
                          .from_ns = 200'000'000,
                          .until_ns = 202'500'000,
                          .with = io_status::busy});
  bench one(motor(), {.node = 5}, brief);
  ASSERT_TRUE(one.enabled()) << one.why();
  while (one.clock.now_ns() < 300'000'000) one.tick();
  EXPECT_EQ(one.drive.state(), drive_state::enabled) << one.why();

  link_script lasting = brief;
  lasting.events[0].until_ns = 300'000'000;
  bench two(motor(), {.node = 5}, lasting);
  ASSERT_TRUE(two.enabled()) << two.why();
  while (two.clock.now_ns() < 220'000'000) two.tick();
  EXPECT_EQ(two.drive.state(), drive_state::fault);
  EXPECT_NE(two.why().find("queue"), std::string::npos);
}

TEST(cia402_drive, survives_a_lossy_bus_while_it_is_configured) {
  int up = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    link_script s{.seed = seed};
    s.events.push_back({.kind = link_fault::lose, .until_ns = 1'000'000'000, .share = 0.02});
    s.events.push_back({.kind = link_fault::duplicate, .share = 0.02});
    bench b(motor(), {.node = 5}, s);
    up += b.up() ? 1 : 0;
    EXPECT_EQ(b.largest, 0);
    EXPECT_TRUE(b.drive.state() == drive_state::idle || b.drive.state() == drive_state::fault) << seed;
  }
  EXPECT_GE(up, 45);
}

TEST(cia402_drive, hostile_frames_change_nothing_but_its_own_fault) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    bench b;
    std::mt19937_64 bits(seed);
    ASSERT_TRUE(b.enabled());
    for (int i = 0; i < 200; ++i) {
      can_frame f;
      const std::uint32_t ids[] = {0x085, 0x185, 0x285, 0x585, 0x705, static_cast<std::uint32_t>(bits() % 0x800)};
      f.id = ids[bits() % 6];
      f.size = static_cast<std::uint8_t>(bits() % 9);
      f.host_time_ns = b.clock.now_ns();
      for (std::size_t k = 0; k < 8; ++k) f.data[k] = static_cast<std::uint8_t>(bits());
      static_cast<void>(b.drive.take(b.clock.now_ns(), f));
      b.drive.set_torque(1e6);
      b.tick();
      ASSERT_LE(std::abs(b.fake.torque_permille()), 2000);
      ASSERT_TRUE(std::isfinite(b.drive.reading().position_rad));
      ASSERT_TRUE(b.drive.state() == drive_state::enabled || b.drive.state() == drive_state::fault);
      ASSERT_EQ(b.drive.state() == drive_state::fault, b.why() != "none");
    }
  }
}

}  // namespace
