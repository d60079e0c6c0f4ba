// Six drives and a chain as one device: its life, its limits, and what it puts on the joints.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <memory>
#include <string>
#include <utility>

#include "asperity/device/any_device.hpp"
#include "hardware/arm/arm_rig.hpp"
#include "support/counted_news.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;

const joint_vector& limits() {
  static const joint_vector all{12.0, 12.0, 12.0, 3.0, 3.0, 3.0};
  return all;
}

void expect_near(const joint_vector& a, const joint_vector& b, double tolerance) {
  for (std::size_t i = 0; i < arm_joints; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << "joint " << i + 1;
}

TEST(articulated_device, goes_through_its_life) {
  arm_rig rig({.with_plant = false});
  ASSERT_TRUE(rig.dev);
  articulated_device& dev = *rig.dev;
  EXPECT_EQ(dev.state(), device_state::absent);
  EXPECT_FALSE(dev.arm());
  EXPECT_EQ(dev.read(0, rig.sample), status::not_ready);
  ASSERT_TRUE(dev.open());
  EXPECT_EQ(dev.state(), device_state::ready);
  EXPECT_FALSE(dev.open());
  for (int i = 0; i < 20; ++i) EXPECT_EQ(rig.tick({{5, 5, 5}, {1, 1, 1}}), status::ok);
  EXPECT_TRUE(rig.all_at_zero());
  EXPECT_EQ(rig.enables(), 0);  // not armed: the power sections are off

  ASSERT_TRUE(dev.arm());
  EXPECT_EQ(dev.state(), device_state::armed);
  EXPECT_EQ(rig.tick(), status::ok);
  EXPECT_EQ(dev.state(), device_state::armed);
  EXPECT_EQ(rig.tick({{1, 0, 0}, {}}), status::ok);
  EXPECT_EQ(dev.state(), device_state::active);
  EXPECT_EQ(rig.tick(), status::ok);
  EXPECT_EQ(dev.state(), device_state::armed);

  EXPECT_EQ(rig.tick({{3, 0, 0}, {}}), status::ok);
  rig.clock.advance_ns(tick_ns);
  EXPECT_FALSE(rig.all_at_zero());
  EXPECT_EQ(dev.disarm(), status::ok);
  EXPECT_EQ(dev.state(), device_state::ready);
  rig.clock.advance_ns(tick_ns);
  EXPECT_TRUE(rig.all_at_zero());
  ASSERT_TRUE(dev.arm()) << dev.fault_words();  // at once: it waits for the drives by itself
  dev.close();
  EXPECT_EQ(dev.state(), device_state::closed);
  EXPECT_TRUE(rig.all_at_zero());
  rig.clock.advance_ns(1'000'000'000);
  for (const auto& f : rig.fakes) {  // left in order: nobody found our end to be a fault
    EXPECT_NE(f->power(), canopen::power_state::fault);
    EXPECT_EQ(f->nmt(), canopen::nmt_state::pre_operational);
  }
  EXPECT_TRUE(dev.open());
}

// A controller that has left its bus takes frames and loses them: the arm stops in the same tick, and names the bus.
TEST(articulated_device, a_bus_that_is_off_is_a_fault_at_once) {
  constexpr std::int64_t from_ns = 4'000'000'000;  // bring-up is over by then
  rig_options options{.with_plant = false};
  options.scripts[1].events = {{.kind = link_fault::bus_off, .from_ns = from_ns, .until_ns = from_ns + 100 * tick_ns}};
  arm_rig rig(std::move(options));
  ASSERT_TRUE(rig.dev->open()) << rig.dev->fault_words();
  ASSERT_LT(rig.clock.now_ns(), from_ns);
  ASSERT_TRUE(rig.dev->arm()) << rig.dev->fault_words();
  while (rig.clock.now_ns() < from_ns - 2 * tick_ns)
    ASSERT_EQ(rig.tick({{1, 0, 0}, {}}), status::ok) << rig.dev->fault_words();
  for (int i = 0; i < 4; ++i) static_cast<void>(rig.tick({{1, 0, 0}, {}}));
  EXPECT_EQ(rig.dev->state(), device_state::fault);
  EXPECT_NE(rig.dev->fault_words().find("bus 2"), std::string::npos) << rig.dev->fault_words();
}

TEST(articulated_device, measures_pose_and_velocity_of_the_handle) {
  arm_rig rig;
  ASSERT_TRUE(rig.dev->open());
  ASSERT_TRUE(rig.dev->arm());
  std::uint64_t before = 0;
  for (int i = 0; i < 700; ++i) {
    ASSERT_EQ(rig.tick({{i > 500 ? 4.0 : 0.0, 0, 0}, {}}), status::ok) << rig.dev->fault_words();
    ASSERT_EQ(rig.read_status, status::ok);
    ASSERT_TRUE(i == 0 || rig.sample.sequence == before + 1);
    before = rig.sample.sequence;
    // What it measures is what was a millisecond ago, at most.
    const twist v = rig.plant->velocity_d();
    ASSERT_LT(glm::length(rig.sample.T_dh.position - rig.plant->T_dh().position),
              2e-5 + 2e-3 * glm::length(v.linear) + 1e-3);
    ASSERT_TRUE(i == 0 || rig.clock.now_ns() - rig.sample.host_time_ns <= tick_ns);
    ASSERT_TRUE(is_valid(rig.sample.T_dh));
  }
  const vec3 at = rig.sample.T_dh.position;
  EXPECT_GT(at.x, forward(rig.plant->chain(), arm_start_rad).T_dh.position.x + 0.005);  // it pushed the hand along
  device_sample again = rig.sample;
  EXPECT_EQ(rig.dev->read(rig.clock.now_ns(), again), status::ok);
  EXPECT_EQ(again.sequence, rig.sample.sequence);  // nothing new came
}

TEST(articulated_device, puts_the_wrench_on_the_joints_and_holds_the_links) {
  rig_options still{.with_plant = false};
  still.device.gravity_ramp_ns = 100'000'000;
  arm_rig rig(still);
  ASSERT_TRUE(rig.dev->open());
  ASSERT_TRUE(rig.dev->arm());
  const chain_pose at = forward(rig.plant->chain(), rig.dev->angles_rad());
  const joint_vector weight = torques_against_gravity(rig.plant->chain(), at);
  EXPECT_GT(std::fabs(weight[1]), 1.0);
  rig.tick();
  rig.clock.advance_ns(200'000);
  EXPECT_LT(std::fabs(rig.motor_torques()[1]), 0.1 * std::fabs(weight[1]));  // grows from zero
  for (int i = 0; i < 110; ++i) rig.tick();
  rig.clock.advance_ns(200'000);
  expect_near(rig.motor_torques(), weight, 4e-3 + 1e-9);

  const wrench w{{2.0, -1.0, 1.5}, {0.1, 0.2, -0.1}};
  rig.tick(w);
  rig.clock.advance_ns(200'000);
  joint_vector expected = torques_for(rig.plant->chain(), at, w);
  for (std::size_t i = 0; i < arm_joints; ++i) expected[i] += weight[i];
  expect_near(rig.motor_torques(), expected, 4e-3 + 1e-9);
  EXPECT_EQ(rig.dev->torques().scale, 1.0);

  rig.tick({{200.0, 0.0, 0.0}, {}});  // far too much: scaled, one factor for all
  rig.clock.advance_ns(200'000);
  const double scale = rig.dev->torques().scale;
  EXPECT_GT(scale, 0.0);
  EXPECT_LT(scale, 1.0);
  expected = torques_for(rig.plant->chain(), at, {{200.0 * scale, 0.0, 0.0}, {}});
  for (std::size_t i = 0; i < arm_joints; ++i) expected[i] += weight[i];
  expect_near(rig.motor_torques(), expected, 4e-3 + 1e-9);
  double fullest = 0.0;
  for (std::size_t i = 0; i < arm_joints; ++i) fullest = std::max(fullest, std::fabs(expected[i]) / limits()[i]);
  EXPECT_NEAR(fullest, 1.0, 1e-9);
  EXPECT_GT(rig.dev->room().force_n, rig.dev->capabilities().peak_force_n);
}

TEST(articulated_device, no_wrench_puts_a_joint_over_its_limit) {
  const double sizes[] = {0.0, 1.0, 1e3, 1e100, 1e300, 1.7e308, NAN, INFINITY};
  int refused = 0;
  int over = 0;
  std::mt19937_64 bits(3);
  auto rig = std::make_unique<arm_rig>(rig_options{.with_plant = false});
  ASSERT_TRUE(rig->dev->open() && rig->dev->arm());
  for (int k = 0; k < 400; ++k) {
    wrench w;
    for (int a = 0; a < 3; ++a) {
      w.force[a] = (bits() % 2 == 0 ? -1.0 : 1.0) * sizes[bits() % (k % 10 == 0 ? 8 : 5)];
      w.torque[a] = (bits() % 2 == 0 ? -1.0 : 1.0) * sizes[bits() % (k % 10 == 0 ? 8 : 5)];
    }
    const status s = rig->tick(w);
    rig->clock.advance_ns(200'000);
    const joint_vector t = rig->motor_torques();
    for (std::size_t i = 0; i < arm_joints; ++i) over += std::fabs(t[i]) > limits()[i] * (1 + 1e-12) ? 1 : 0;
    if (s == status::ok) continue;
    ++refused;
    EXPECT_EQ(rig->dev->state(), device_state::fault);
    for (int i = 0; i < 2; ++i) rig->tick(w);
    ASSERT_TRUE(rig->all_at_zero());
    ASSERT_TRUE(rig->dev->clear_fault());
    ASSERT_FALSE(rig->dev->arm());  // a cleared fault arms nothing
    ASSERT_TRUE(rig->dev->open() && rig->dev->arm()) << rig->dev->fault_words();
  }
  EXPECT_EQ(over, 0);
  EXPECT_GT(refused, 10);
}

TEST(articulated_device, a_wrench_runs_out_with_its_time) {
  arm_rig rig({.with_plant = false});
  ASSERT_TRUE(rig.dev->open() && rig.dev->arm());
  for (int i = 0; i < 600; ++i) rig.tick();
  rig.clock.advance_ns(200'000);
  const joint_vector weight = rig.motor_torques();
  rig.tick({{0.0, 0.0, 5.0}, {}}, 3'000'000);
  rig.clock.advance_ns(200'000);
  EXPECT_GT(std::fabs(rig.motor_torques()[1] - weight[1]), 0.5);
  for (int i = 0; i < 5; ++i) {  // the application reads on and writes nothing
    rig.clock.advance_ns(tick_ns);
    ASSERT_EQ(rig.dev->read(rig.clock.now_ns(), rig.sample), status::ok);
  }
  rig.clock.advance_ns(200'000);
  expect_near(rig.motor_torques(), weight, 1e-12);
  rig.tick({{0.0, 0.0, 5.0}, {}}, -1);  // a command that is old already
  rig.clock.advance_ns(200'000);
  expect_near(rig.motor_torques(), weight, 1e-12);
}

TEST(articulated_device, a_stop_pushes_back_before_the_limit_and_a_joint_beyond_it_is_a_fault) {
  rig_options still{.with_plant = false};
  still.device.gravity_compensation = false;
  arm_rig rig(still);
  const auto hold_joint_6_at = [&rig](double angle) {
    const double counts = (angle - 0.5) * arm_counts * arm_gear / (2.0 * std::numbers::pi);  // its zero is at 0.5 rad
    rig.fakes[5]->set_motion(static_cast<std::int32_t>(std::lround(counts)), 0);
    for (int i = 0; i < 3; ++i) rig.tick();
    rig.clock.advance_ns(200'000);
  };
  ASSERT_TRUE(rig.dev->open() && rig.dev->arm());
  hold_joint_6_at(2.74);
  EXPECT_EQ(rig.motor_torques()[5], 0.0);
  hold_joint_6_at(2.79);  // 40 mrad into the zone before 2.8
  EXPECT_NEAR(rig.motor_torques()[5], -20.0 * 0.04, 2e-3);
  hold_joint_6_at(-2.85);
  EXPECT_NEAR(rig.motor_torques()[5], 20.0 * 0.1, 2e-3);
  rig.tick({{}, {-100.0, 0.0, 0.0}});  // a wrench against the stop comes on top, within the limit
  rig.clock.advance_ns(200'000);
  EXPECT_GE(rig.motor_torques()[5], -3.0);
  EXPECT_EQ(rig.dev->state(), device_state::active);
  hold_joint_6_at(-2.91);
  EXPECT_EQ(rig.dev->state(), device_state::fault);
  EXPECT_NE(rig.dev->fault_words().find("joint 6: the joint is beyond its limits"), std::string::npos)
      << rig.dev->fault_words();
  EXPECT_TRUE(rig.all_at_zero());
}

TEST(articulated_device, open_says_which_joint_and_why) {
  arm_rig rig({.with_plant = false});
  rig.clock.advance_ns(tick_ns);
  rig.fakes[3]->refuse({0x6060, 0}, canopen::abort_code::bad_value);
  const result<void> opened = rig.dev->open();
  ASSERT_FALSE(opened);
  EXPECT_NE(opened.error().message.find("joint 4"), std::string::npos) << opened.error().message;
  EXPECT_NE(opened.error().message.find("0x06090030"), std::string::npos) << opened.error().message;
  EXPECT_EQ(rig.dev->state(), device_state::fault);
  EXPECT_EQ(rig.enables(), 0);
  EXPECT_FALSE(rig.dev->open());
  ASSERT_TRUE(rig.dev->clear_fault());
  EXPECT_FALSE(rig.dev->open());  // it refuses still
}

TEST(articulated_device, opens_drives_that_the_last_host_left_in_fault) {
  arm_rig rig({.with_plant = false, .starts_in_fault = true});
  ASSERT_TRUE(rig.dev->open()) << rig.dev->fault_words();
  EXPECT_TRUE(rig.dev->arm());
}

TEST(articulated_device, reads_and_writes_without_taking_memory) {
  arm_rig rig({.with_plant = false});
  ASSERT_TRUE(rig.dev->open() && rig.dev->arm());
  std::size_t taken = 0;
  for (int i = 0; i < 200; ++i) {
    rig.clock.advance_ns(tick_ns);
    if (i == 120) rig.fakes[2]->die();  // the fault takes none either
    const std::size_t before = news_in_this_thread();
    static_cast<void>(rig.dev->read(rig.clock.now_ns(), rig.sample));
    static_cast<void>(rig.dev->write(
        rig.clock.now_ns(),
        {{{1, 2, 3}, {}}, wrench_frame::device_base, rig.clock.now_ns() + tick_ns, static_cast<std::uint64_t>(i)}));
    taken += news_in_this_thread() - before;
  }
  EXPECT_EQ(rig.dev->state(), device_state::fault);
  EXPECT_EQ(taken, 0U);
  EXPECT_GT(news_in_this_thread(), 0U);
}

TEST(articulated_device, is_a_device_behind_any_device_and_leaves_nothing_on) {
  arm_rig rig({.with_plant = false});
  ASSERT_TRUE(rig.dev->open() && rig.dev->arm());
  {
    any_device erased(std::move(*rig.dev));
    for (int i = 0; i < 10; ++i) {
      rig.clock.advance_ns(tick_ns);
      ASSERT_EQ(erased.read(rig.clock.now_ns(), rig.sample), status::ok);
      ASSERT_EQ(erased.write(rig.clock.now_ns(),
                             {{{4, 0, 0}, {}}, wrench_frame::device_base, rig.clock.now_ns() + tick_ns, 1}),
                status::ok);
    }
    EXPECT_FALSE(rig.all_at_zero());
  }
  EXPECT_TRUE(rig.all_at_zero());
  rig.dev.reset();
}

TEST(articulated_device, what_is_no_arm_is_refused) {
  arm_rig rig({.with_plant = false});
  const auto refused = [&rig](auto change) {
    articulated_settings c = rig.dev->settings();
    change(c);
    const auto made = articulated_device::make(std::move(c));
    return made ? std::string() : made.error().message;
  };
  EXPECT_NE(refused([](articulated_settings& c) { c.clock = nullptr; }).find("clock"), std::string::npos);
  EXPECT_NE(refused([](articulated_settings& c) { c.joints.pop_back(); }).find("5 drives"), std::string::npos);
  EXPECT_NE(refused([](articulated_settings& c) { c.joints[2].drive = nullptr; }).find("joint 3"), std::string::npos);
  EXPECT_NE(refused([](articulated_settings& c) { c.joints[2].bus = 7; }).find("not there"), std::string::npos);
  EXPECT_NE(refused([](articulated_settings& c) { c.joints[2].drive = c.joints[1].drive; }).find("same drive"),
            std::string::npos);
  EXPECT_NE(refused([](articulated_settings& c) { c.buses[0].bus = nullptr; }).find("bus 1"), std::string::npos);
  EXPECT_NE(refused([](articulated_settings& c) { c.stop.zone_rad = NAN; }).find("soft stop"), std::string::npos);
  cia402_drive nameless(cia402_settings{.node = 9});
  EXPECT_NE(refused([&](articulated_settings& c) { c.joints[4].drive = &nameless; }).find("torque limit"),
            std::string::npos);
}

}  // namespace
