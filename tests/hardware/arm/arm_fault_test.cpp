// Everything that can go wrong with an arm, at every call and at random ticks: all six motors at zero in a bounded
// number of ticks, a cause that is named, and nothing that goes on by itself.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <gtest/gtest.h>
#include <random>
#include <string>

#include "hardware/arm/arm_rig.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;

constexpr std::array<io_status, 4> hard_answers{io_status::failed, io_status::gone, io_status::down,
                                                io_status::too_short};
const wrench push{{3.0, -2.0, 4.0}, {0.2, 0.1, -0.1}};

bool stopped(const articulated_device& dev) {
  return dev.state() == device_state::fault || dev.state() == device_state::absent;
}

int over_limit(const arm_rig& rig) {
  int over = 0;
  for (std::size_t i = 0; i < arm_joints; ++i) {
    over += std::abs(rig.fakes[i]->torque_permille()) > (i < 3 ? 3000 : 2000) ? 1 : 0;
  }
  return over;
}

/// Ticks until every motor is at zero, and it stays so. @return -1 where it does not come to that
int ticks_to_zero(arm_rig& rig, int most) {
  int last = 0;
  for (int i = 1; i <= most; ++i) {
    static_cast<void>(rig.tick(push));
    EXPECT_EQ(over_limit(rig), 0);
    if (!rig.all_at_zero()) last = i;
  }
  return last < most ? last : -1;
}

/// After a fault: it is latched, named, and nothing arms or enables any more.
void expect_latched(arm_rig& rig, const std::string& where) {
  EXPECT_TRUE(stopped(*rig.dev)) << where;
  EXPECT_STRNE(rig.dev->fault().what, "none") << where;
  const int enables = rig.enables();
  const std::string words = rig.dev->fault_words();
  for (int i = 0; i < 30; ++i) static_cast<void>(rig.tick(push));
  EXPECT_FALSE(rig.dev->arm()) << where;
  EXPECT_TRUE(rig.all_at_zero()) << where;
  EXPECT_EQ(rig.enables(), enables) << where;
  EXPECT_EQ(rig.dev->fault_words(), words) << where;
}

TEST(arm_faults, every_call_of_bring_up_fails_once) {
  std::uint64_t calls = 0;
  {
    arm_rig whole({.with_plant = false});
    ASSERT_TRUE(whole.dev->open() && whole.dev->arm());
    calls = whole.hosts[0]->player().calls();
  }
  ASSERT_GT(calls, 300U);
  int failed = 0;
  for (std::uint64_t n = 0; n < calls; ++n) {
    rig_options o{.with_plant = false};
    o.scripts[0].events = {fail_call(n, hard_answers[n % hard_answers.size()])};
    arm_rig rig(o);
    const bool up = rig.dev->open() && rig.dev->arm();
    const std::string where = "call " + std::to_string(n);
    ASSERT_FALSE(up) << where;
    ++failed;
    EXPECT_TRUE(stopped(*rig.dev)) << where;
    EXPECT_EQ(rig.dev->fault().bus, 0) << where << ": " << rig.dev->fault_words();
    EXPECT_EQ(rig.dev->fault().code, static_cast<std::uint32_t>(hard_answers[n % hard_answers.size()])) << where;
    EXPECT_GE(ticks_to_zero(rig, 30), 0) << where;
    if (n % 16 == 0) expect_latched(rig, where);
    if (HasFailure()) break;
  }
  std::printf("%d calls of bring-up on one bus of three, each failing once\n", failed);
}

TEST(arm_faults, a_queue_that_is_full_once_stops_nothing) {
  int up = 0;
  for (std::uint64_t n = 0; n < 600; n += 7) {
    rig_options o{.with_plant = false};
    // receive() never answers busy: only sends are made to.
    o.scripts[0].events = {fail_call(n, io_status::busy)};
    o.scripts[0].events[0].direction = link_direction::to_device;
    arm_rig rig(o);
    up += rig.dev->open() && rig.dev->arm() ? 1 : 0;
    EXPECT_EQ(rig.dev->state(), device_state::armed) << n << ": " << rig.dev->fault_words();
  }
  EXPECT_EQ(up, 86);
}

TEST(arm_faults, every_call_of_a_session_fails_once) {
  std::uint64_t first = 0;
  std::uint64_t last = 0;
  {
    arm_rig whole({.with_plant = false});
    ASSERT_TRUE(whole.dev->open() && whole.dev->arm());
    for (int i = 0; i < 5; ++i) whole.tick(push);
    first = whole.hosts[1]->player().calls();
    for (int i = 0; i < 10; ++i) whole.tick(push);
    last = whole.hosts[1]->player().calls();
  }
  ASSERT_GT(last - first, 80U);
  int worst_hard = 0;
  int survived = 0;
  for (std::uint64_t n = first; n < last; ++n) {
    for (std::size_t k = 0; k < hard_answers.size(); ++k) {
      rig_options o{.with_plant = false};
      o.scripts[1].events = {fail_call(n, hard_answers[k])};
      arm_rig rig(o);
      ASSERT_TRUE(rig.dev->open() && rig.dev->arm());
      const std::string where = "call " + std::to_string(n) + ", " + to_string(hard_answers[k]);
      while (!stopped(*rig.dev) && rig.clock.now_ns() < 200'000'000) rig.tick(push);
      ASSERT_TRUE(stopped(*rig.dev)) << where;
      const int ticks = ticks_to_zero(rig, 40);
      ASSERT_GE(ticks, 0) << where;
      worst_hard = std::max(worst_hard, ticks);
      EXPECT_EQ(rig.dev->fault().bus, 1) << where << ": " << rig.dev->fault_words();
      if (n % 8 == 0) expect_latched(rig, where);
    }
    // One frame lost, late, twice, cut short or with a wrong bit is no reason to stop; and nothing is ever over a
    // limit.
    for (const link_fault kind :
         {link_fault::lose, link_fault::duplicate, link_fault::delay, link_fault::reorder, link_fault::shorten}) {
      rig_options o{.with_plant = false};
      o.scripts[1].events = {{.kind = kind, .from_call = n, .until_call = n + 1, .amount_ns = 1'500'000}};
      arm_rig rig(o);
      ASSERT_TRUE(rig.dev->open() && rig.dev->arm());
      for (int i = 0; i < 40; ++i) {
        rig.tick(push);
        ASSERT_EQ(over_limit(rig), 0);
      }
      if (rig.dev->state() == device_state::active) {
        ++survived;
        continue;
      }
      EXPECT_TRUE(stopped(*rig.dev));
      EXPECT_TRUE(rig.all_at_zero()) << n << " " << static_cast<int>(kind) << " " << rig.dev->fault_words();
    }
  }
  const auto spoiled = static_cast<int>(5 * (last - first));
  std::printf(
      "%d calls of a session, four hard answers each: zero after %d ticks at most; of %d spoiled frames %d "
      "were survived\n",
      static_cast<int>(last - first), worst_hard, spoiled, survived);
  EXPECT_LE(worst_hard, 26);
  EXPECT_GT(survived, spoiled * 9 / 10);
}

struct scripted {
  const char* name;
  void (*spoil)(arm_rig&, std::size_t joint);
  int most_ticks;     ///< until all motors are at zero
  const char* words;  ///< part of the cause
};

// The limits: 2 where the fault is seen at once, 52 where a silence of 50 ms has to pass, 12 by the age of a reading.
const scripted table[] = {
    {"emergency message", [](arm_rig& r, std::size_t i) { r.fakes[i]->trip(0x2310); }, 3, "emergency"},
    {"fault in the status word",
     [](arm_rig& r, std::size_t i) {
       r.fakes[i]->sends_emergency = false;
       r.fakes[i]->trip(0x2310);
     },
     3, "reports a fault"},
    {"drive dead", [](arm_rig& r, std::size_t i) { r.fakes[i]->die(); }, 13, "too old"},
    {"drive restarts", [](arm_rig& r, std::size_t i) { r.fakes[i]->restart(); }, 12, "started anew"},
    {"NMT stopped", [](arm_rig& r, std::size_t i) { r.fakes[i]->leave_operational(); }, 14, "NMT"},
    {"heartbeat stops", [](arm_rig& r, std::size_t i) { r.fakes[i]->mute_heartbeat = true; }, 54, "heartbeat stopped"},
    {"process data stop", [](arm_rig& r, std::size_t i) { r.fakes[i]->mute_process_data = true; }, 13, "too old"},
    {"another mode", [](arm_rig& r, std::size_t i) { r.fakes[i]->set_mode_shown(8); }, 3, "torque mode"},
    {"power section drops",
     [](arm_rig& r, std::size_t i) { r.fakes[i]->drop_to(canopen::power_state::switch_on_disabled); }, 3,
     "operation enabled"},
    {"joint jumps beyond its limit", [](arm_rig& r, std::size_t i) { r.fakes[i]->set_motion(400'000, 0); }, 3,
     "beyond its limits"},
    {"joint too fast", [](arm_rig& r, std::size_t i) { r.fakes[i]->set_motion(0, 2'000'000); }, 3, "faster"},
    {"command is NaN",
     [](arm_rig& r, std::size_t) {
       static_cast<void>(r.tick({{NAN, 0.0, 0.0}, {}}));
     },
     2, "not finite"},
    {"emergency on a second drive as well",
     [](arm_rig& r, std::size_t i) {
       r.fakes[i]->trip(0x2310);
       r.fakes[(i + 3) % arm_joints]->trip(0x3210);
     },
     3, "emergency"},
};

TEST(arm_faults, every_fault_at_a_random_tick_stops_all_six_motors) {
  std::printf("| fault | sessions | ticks to zero, worst | named |\n|---|---|---|---|\n");
  std::mt19937_64 bits(17);
  for (const scripted& s : table) {
    int worst = 0;
    std::string named;
    constexpr int sessions = 25;
    for (int k = 0; k < sessions; ++k) {
      rig_options o{.with_plant = false};
      o.drive.drive_heartbeat_ms = 8;  // below the age of a reading: which of two causes comes first is fixed
      arm_rig rig(o);
      ASSERT_TRUE(rig.dev->open() && rig.dev->arm());
      const int before = 5 + static_cast<int>(bits() % 60);
      for (int i = 0; i < before; ++i) ASSERT_EQ(rig.tick(push), status::ok);
      rig.clock.advance_ns(static_cast<std::int64_t>(bits() % 10) * 100'000);
      ASSERT_FALSE(rig.all_at_zero());
      s.spoil(rig, bits() % arm_joints);
      const int ticks = ticks_to_zero(rig, 70);
      ASSERT_GE(ticks, 0) << s.name;
      ASSERT_LE(ticks, s.most_ticks) << s.name << ": " << rig.dev->fault_words();
      worst = std::max(worst, ticks);
      named = rig.dev->fault_words();
      ASSERT_NE(named.find(s.words), std::string::npos) << s.name << ": " << named;
      expect_latched(rig, s.name);
    }
    std::printf("| %s | %d | %d | %s |\n", s.name, sessions, worst, named.c_str());
  }
}

TEST(arm_faults, a_bus_that_leaves_stops_the_motors_on_it_by_their_own_watchdog) {
  for (const link_fault kind : {link_fault::unplug, link_fault::bus_off}) {
    int worst = 0;
    for (int k = 0; k < 30; ++k) {
      const std::int64_t at_ns = 90'000'000 + 1'370'000 * k;
      rig_options o{.with_plant = false};
      o.scripts[static_cast<std::size_t>(k % 3)].events = {{.kind = kind, .from_ns = at_ns}};
      arm_rig rig(o);
      ASSERT_TRUE(rig.dev->open() && rig.dev->arm());
      while (rig.clock.now_ns() + tick_ns < at_ns) ASSERT_EQ(rig.tick(push), status::ok);
      const int ticks = ticks_to_zero(rig, 60);
      ASSERT_GE(ticks, 0);
      worst = std::max(worst, ticks);
      EXPECT_EQ(rig.dev->fault().bus, k % 3) << rig.dev->fault_words();
      expect_latched(rig, "bus");
    }
    std::printf("%s: zero after %d ticks at most\n", kind == link_fault::unplug ? "unplugged" : "bus-off", worst);
    EXPECT_LE(worst, 27);  // 20 ms of silence, and the age of our last heartbeat
  }
}

TEST(arm_faults, an_application_that_stops_ticking_is_stopped) {
  int worst = 0;
  for (int k = 0; k < 20; ++k) {
    arm_rig rig({.with_plant = false});
    ASSERT_TRUE(rig.dev->open() && rig.dev->arm());
    for (int i = 0; i < 20 + k; ++i) ASSERT_EQ(rig.tick(push), status::ok);
    int ticks = 0;
    while (!rig.all_at_zero() && ticks < 100) {
      rig.clock.advance_ns(tick_ns);
      ++ticks;
    }
    worst = std::max(worst, ticks);
    EXPECT_NE(rig.tick(push), status::ok);  // and it finds out when it comes back
    expect_latched(rig, "stall");
  }
  std::printf("application silent: zero after %d ms at most\n", worst);
  EXPECT_LE(worst, 26);
}

}  // namespace
