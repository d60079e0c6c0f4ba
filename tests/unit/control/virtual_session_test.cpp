#include <bit>
#include <cstring>
#include <gtest/gtest.h>

#include <asperity/control/virtual_session.hpp>
#include <asperity/device/simulated/simulated_device.hpp>

#include "unit/control/analytic_wall.hpp"

namespace {

using namespace asperity;
using test_support::analytic_wall;

// FNV-1a over the bits of every number of every record.
struct digest {
  std::uint64_t value = 0xcbf29ce484222325ULL;
  void add(std::uint64_t bits) noexcept {
    for (int i = 0; i < 8; ++i) {
      value ^= (bits >> (8 * i)) & 0xffU;
      value *= 0x100000001b3ULL;
    }
  }
  void add(double x) noexcept { add(std::bit_cast<std::uint64_t>(x)); }
  void add(const vec3& v) noexcept {
    add(v.x);
    add(v.y);
    add(v.z);
  }
  void operator()(const session_record& r) noexcept {
    add(static_cast<std::uint64_t>(r.time_ns));
    add(r.T_dh.position);
    add(r.T_wa.position);
    add(vec3(r.T_wa.rotation.x, r.T_wa.rotation.y, r.T_wa.rotation.z));
    add(r.on_hand_d.force);
    add(r.on_hand_d.torque);
    add(r.on_probe_w.force);
    add(r.delivered_j);
  }
};

std::uint64_t run(std::uint64_t seed, const virtual_schedule& schedule, motion_kind motion, std::int64_t chunk_ns) {
  simulated_settings hand;
  hand.seed = seed;
  hand.motion = {.kind = motion, .T_dh = {quat(1, 0, 0, 0), {0, 0, 0.002}}, .depth_m = 0.01};
  hand.measurement.delay_ns = 300'000;
  hand.measurement.jitter_ns = 200'000;
  simulated_device dev(hand);
  EXPECT_TRUE(dev.open() && dev.arm());
  analytic_wall wall;
  wall.arm_m = 0.01;
  virtual_session<analytic_wall, simulated_device, digest> session(wall, {{pose{}}, vec3(0.0)}, dev, control_settings{},
                                                                   schedule);
  for (std::int64_t t = 0; t <= 1'500'000'000; t += chunk_ns) static_cast<void>(session.run_until(t));
  return session.device().observer().value;
}

TEST(virtual_session, is_the_same_to_the_bit_for_the_same_seed) {
  for (const motion_kind motion : {motion_kind::press, motion_kind::scrub, motion_kind::twist, motion_kind::free}) {
    const std::uint64_t first = run(1, {}, motion, 1'500'000'000);
    EXPECT_EQ(run(1, {}, motion, 1'500'000'000), first);
    EXPECT_EQ(run(1, {}, motion, 7'500'000), first);  // whatever the pieces it is run in
    EXPECT_NE(run(2, {}, motion, 1'500'000'000), first);
  }
}

TEST(virtual_session, depends_on_its_schedule) {
  const std::uint64_t on_time = run(1, {}, motion_kind::press, 1'500'000'000);
  EXPECT_NE(run(1, {.contact_one_period_late = true}, motion_kind::press, 1'500'000'000), on_time);
  EXPECT_NE(run(1, {.contact_period_ns = 5'000'000}, motion_kind::press, 1'500'000'000), on_time);
}

TEST(virtual_session, runs_the_contact_first_where_both_are_due) {
  simulated_device dev;
  ASSERT_TRUE(dev.open() && dev.arm());
  virtual_session<analytic_wall, simulated_device> session({}, {{pose{}}, vec3(0.0)}, dev, control_settings{},
                                                           {.contact_period_ns = 2'000'000});
  for (std::uint64_t tick = 0; tick < 10; ++tick) {
    EXPECT_EQ(session.contact_ticks(), (tick + 1) / 2);
    static_cast<void>(session.step());
    EXPECT_EQ(session.contact_ticks(), tick / 2 + 1) << tick;
  }
}

TEST(virtual_session, keeps_to_its_periods) {
  simulated_device dev;
  ASSERT_TRUE(dev.open() && dev.arm());
  virtual_session<analytic_wall, simulated_device> session(
      {}, {{pose{}}, vec3(0.0)}, dev, control_settings{},
      {.start_ns = 5, .device_period_ns = 1'000'000, .contact_period_ns = 4'000'000});
  static_cast<void>(session.run_until(5 + 1'000'000'000));
  EXPECT_EQ(session.device_ticks(), 1000U);
  EXPECT_EQ(session.contact_ticks(), 250U);
  EXPECT_EQ(session.now_ns(), 5 + 1'000'000'000);
}

struct ages {
  std::int64_t least = 1LL << 60;
  std::int64_t most = 0;
  std::uint64_t n = 0;
  void operator()(const session_record& r) noexcept {
    if (++n < 100) return;
    least = std::min(least, r.contact_age_ns);
    most = std::max(most, r.contact_age_ns);
  }
};

ages age_of_contact(bool late) {
  simulated_device dev;
  EXPECT_TRUE(dev.open() && dev.arm());
  virtual_session<analytic_wall, simulated_device, ages> session(
      {}, {{pose{}}, vec3(0.0)}, dev, control_settings{},
      {.contact_period_ns = 5'000'000, .contact_one_period_late = late});
  static_cast<void>(session.run_until(1'000'000'000));
  return session.device().observer();
}

TEST(virtual_session, hands_contacts_over_at_once_or_one_period_late) {
  // The pose is that of the device tick before: one millisecond is the least age there is.
  EXPECT_EQ(age_of_contact(false).least, 1'000'000);
  EXPECT_EQ(age_of_contact(false).most, 5'000'000);
  EXPECT_EQ(age_of_contact(true).least, 6'000'000);
  EXPECT_EQ(age_of_contact(true).most, 10'000'000);
}

}  // namespace
