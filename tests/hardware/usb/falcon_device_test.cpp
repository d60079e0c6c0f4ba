// The real driver and a fake Falcon, from the power plug to a session at 1 kHz.
#include <gtest/gtest.h>
#include <string>

#include "asperity/drivers/falcon/falcon_driver.hpp"
#include "hardware/usb/falcon_rig.hpp"
#include "support/counted_news.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;

fake_falcon_settings awake_and_homed() { return {.awake = true, .homed = true}; }

bool mentions(const error& e, const std::string& word) { return e.message.find(word) != std::string::npos; }

TEST(falcon_device, sleeps_until_it_is_given_its_firmware) {
  falcon_rig rig;
  const auto opened = rig.device->open();
  ASSERT_FALSE(opened);
  EXPECT_TRUE(mentions(opened.error(), "no image was given")) << opened.error().message;
  EXPECT_TRUE(mentions(opened.error(), "licence"));
  EXPECT_EQ(rig.device->state(), device_state::closed);
  EXPECT_EQ(rig.peer.boots(), 0);
}

TEST(falcon_device, is_woken_homed_and_ready) {
  const fake_image image;
  falcon_settings settings = quick_settings();
  settings.firmware_path = image.path();
  falcon_rig rig({.image = image.bytes()}, {}, settings);
  const auto opened = rig.device->open();
  ASSERT_TRUE(opened) << opened.error().message;
  EXPECT_EQ(rig.device->state(), device_state::ready);
  EXPECT_TRUE(rig.peer.running());
  EXPECT_EQ(rig.peer.boots(), 1);
  EXPECT_EQ(rig.peer.light(), falcon_light::blue);
  EXPECT_EQ(rig.peer.largest_applied(), 0);
}

TEST(falcon_device, is_woken_through_split_and_melted_packets) {
  const fake_image image(1000);
  falcon_settings settings = quick_settings();
  settings.firmware_path = image.path();
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    falcon_rig rig({.image = image.bytes(), .split = true, .seed = seed}, {}, settings);
    const auto opened = rig.device->open();
    ASSERT_TRUE(opened) << seed << ": " << opened.error().message;
    ASSERT_TRUE(rig.device->arm());
    for (int i = 0; i < 200; ++i) ASSERT_EQ(rig.tick({0.0, 0.0, 1.0}), status::ok) << seed << ' ' << i;
    EXPECT_EQ(rig.seen.lost, 0U);
    EXPECT_GT(rig.seen.sequence, 50U);
  }
}

TEST(falcon_device, an_echo_that_differs_is_found_and_tried_again) {
  const fake_image image;
  falcon_settings settings = quick_settings();
  settings.firmware_path = image.path();
  falcon_rig twice({.image = image.bytes(), .wrong_echo_at = 100, .wrong_echoes = 2}, {}, settings);
  const auto opened = twice.device->open();
  ASSERT_TRUE(opened) << opened.error().message;
  EXPECT_EQ(twice.peer.boots(), 3);

  falcon_rig always({.image = image.bytes(), .wrong_echo_at = 100, .wrong_echoes = 100}, {}, settings);
  const auto failed = always.device->open();
  ASSERT_FALSE(failed);
  EXPECT_TRUE(mentions(failed.error(), "byte 100")) << failed.error().message;
}

TEST(falcon_device, says_what_is_wrong_with_the_image) {
  falcon_settings settings = quick_settings();
  settings.firmware_path = "no/such/image.bin";
  falcon_rig missing({}, {}, settings);
  auto opened = missing.device->open();
  ASSERT_FALSE(opened);
  EXPECT_TRUE(mentions(opened.error(), "no/such/image.bin"));

  const fake_image empty(0);
  settings.firmware_path = empty.path();
  falcon_rig with_empty({}, {}, settings);
  opened = with_empty.device->open();
  ASSERT_FALSE(opened);
  EXPECT_TRUE(mentions(opened.error(), "no bytes"));

  const fake_image other(90);
  const fake_image right(150);
  settings.firmware_path = other.path();
  falcon_rig with_other({.image = right.bytes()}, {}, settings);
  opened = with_other.device->open();
  ASSERT_FALSE(opened);
  EXPECT_TRUE(mentions(opened.error(), "is it the right image?")) << opened.error().message;
}

TEST(falcon_device, waits_for_a_person_to_home_it_and_not_for_ever) {
  falcon_rig rig({.awake = true, .frames_to_home = 1 << 30});
  const auto opened = rig.device->open();
  ASSERT_FALSE(opened);
  EXPECT_TRUE(mentions(opened.error(), "push the grip")) << opened.error().message;
  EXPECT_EQ(rig.peer.light(), falcon_light::none);  // the last word is a zero
  EXPECT_TRUE(rig.peer.at_rest());
}

TEST(falcon_device, measures_position_and_buttons) {
  falcon_rig rig(awake_and_homed());
  ASSERT_TRUE(rig.device->open());
  std::uint64_t sequence = 0;
  for (int i = 0; i < 500; ++i) {
    const vec3 p{0.02 * std::sin(0.02 * i), 0.01, 0.1 + 0.00005 * i};
    rig.peer.set_position(p);
    rig.peer.set_buttons(static_cast<std::uint8_t>(i % 16));
    ASSERT_EQ(rig.tick(vec3(0.0)), status::ok);
    if (i < 5) continue;  // from where it was opened to here is a step that is not believed at once
    ASSERT_LT(glm::length(rig.seen.T_dh.position - p), 6e-4) << i;
    EXPECT_GE(rig.seen.sequence, sequence);
    sequence = rig.seen.sequence;
    EXPECT_TRUE(has_all(rig.seen.valid, sample_field::position | sample_field::buttons));
    EXPECT_FALSE(has_all(rig.seen.valid, sample_field::rotation));
    EXPECT_LE(rig.clock.now_ns() - rig.seen.host_time_ns, 3'000'000);
  }
}

TEST(falcon_device, a_pause_of_the_program_is_no_fault_and_leaves_no_old_position) {
  falcon_rig rig(awake_and_homed());
  ASSERT_TRUE(rig.device->open());
  for (int i = 0; i < 10; ++i) ASSERT_EQ(rig.tick(vec3(0.0)), status::ok);
  const vec3 before = rig.seen.T_dh.position;
  const std::uint64_t sequence = rig.seen.sequence;
  rig.peer.set_position({0.03, -0.02, 0.15});  // a hand's width away; nobody asks in the meantime
  rig.clock.advance_ns(3'000'000'000);
  ASSERT_EQ(rig.tick(vec3(0.0)), status::ok);
  EXPECT_EQ(rig.seen.sequence, sequence);  // the answer that has waited is older than it looks
  EXPECT_EQ(rig.seen.T_dh.position, before);
  for (int i = 0; i < 3; ++i) ASSERT_EQ(rig.tick(vec3(0.0)), status::ok);
  EXPECT_LT(glm::length(rig.seen.T_dh.position - vec3(0.03, -0.02, 0.15)), 1e-3);
  EXPECT_EQ(rig.device->state(), device_state::ready);
}

TEST(falcon_device, puts_out_the_force_that_is_asked_for_and_only_when_armed) {
  falcon_rig rig(awake_and_homed());
  ASSERT_TRUE(rig.device->open());
  const vec3 wanted{0.5, -1.0, 2.0};
  for (int i = 0; i < 20; ++i) ASSERT_EQ(rig.tick(wanted), status::ok);
  EXPECT_EQ(rig.peer.largest_applied(), 0);
  EXPECT_EQ(rig.peer.light(), falcon_light::blue);  // green is for a device that may push

  ASSERT_TRUE(rig.device->arm());
  EXPECT_FALSE(rig.device->arm());
  for (int i = 0; i < 20; ++i) ASSERT_EQ(rig.tick(wanted), status::ok);
  EXPECT_EQ(rig.device->state(), device_state::active);
  EXPECT_LT(glm::length(rig.peer.force_d() - wanted), 0.02);
  EXPECT_EQ(rig.peer.light(), falcon_light::green);

  EXPECT_EQ(rig.tick(vec3(0.0)), status::ok);
  EXPECT_EQ(rig.device->state(), device_state::armed);
  EXPECT_TRUE(rig.peer.at_rest());
  EXPECT_EQ(rig.tick(wanted), status::ok);
  EXPECT_EQ(rig.device->disarm(), status::ok);
  rig.clock.advance_ns(1'000'000);
  EXPECT_TRUE(rig.peer.at_rest());
  EXPECT_EQ(rig.device->state(), device_state::ready);
}

// Written to and never read: where the grip is now is not known, and the same force would take other torques there.
TEST(falcon_device, puts_out_nothing_for_a_position_that_is_old) {
  falcon_rig rig(awake_and_homed());
  ASSERT_TRUE(rig.device->open());
  ASSERT_TRUE(rig.device->arm());
  const vec3 wanted{0.5, -1.0, 2.0};
  for (int i = 0; i < 20; ++i) ASSERT_EQ(rig.tick(wanted), status::ok);
  ASSERT_FALSE(rig.peer.at_rest());
  const std::int64_t most_ns = falcon_settings{}.silent_after_ns;
  for (std::int64_t t = 0; t <= most_ns + 5'000'000; t += 1'000'000) {
    rig.clock.advance_ns(1'000'000);
    static_cast<void>(rig.device->write(rig.clock.now_ns(), rig.command(wanted)));
  }
  rig.clock.advance_ns(1'000'000);
  EXPECT_TRUE(rig.peer.at_rest());
}

TEST(falcon_device, a_command_ends_when_its_time_is_over) {
  falcon_rig rig(awake_and_homed());
  ASSERT_TRUE(rig.device->open());
  ASSERT_TRUE(rig.device->arm());
  device_command once = rig.command({0.0, 0.0, 2.0});
  once.valid_until_ns = rig.clock.now_ns() + 5'000'000;
  ASSERT_EQ(rig.device->write(rig.clock.now_ns(), once), status::ok);
  rig.clock.advance_ns(1'000'000);
  EXPECT_FALSE(rig.peer.at_rest());
  for (int i = 0; i < 8; ++i) {  // only read from here on
    ASSERT_EQ(rig.device->read(rig.clock.now_ns(), rig.seen), status::ok);
    rig.clock.advance_ns(1'000'000);
  }
  EXPECT_TRUE(rig.peer.at_rest());
  EXPECT_EQ(rig.device->write(rig.clock.now_ns(), once), status::ok);  // too late
  rig.clock.advance_ns(1'000'000);
  EXPECT_TRUE(rig.peer.at_rest());
}

TEST(falcon_device, torque_is_dropped_and_a_huge_force_keeps_its_direction) {
  falcon_rig rig(awake_and_homed());
  ASSERT_TRUE(rig.device->open());
  ASSERT_TRUE(rig.device->arm());
  EXPECT_EQ(rig.device->capabilities().actuated, translation_axes);
  EXPECT_EQ(rig.device->capabilities().peak_torque_n_m, 0.0);
  device_command c = rig.command(vec3(0.0));
  c.on_hand.torque = {5.0, 5.0, 5.0};
  ASSERT_EQ(rig.device->write(rig.clock.now_ns(), c), status::ok);
  rig.clock.advance_ns(1'000'000);
  EXPECT_TRUE(rig.peer.at_rest());

  const vec3 huge{3e5, -2e5, 1e5};  // the sign of 16 bits wraps at 62 N
  ASSERT_EQ(rig.tick(huge), status::ok);
  EXPECT_EQ(rig.peer.largest_applied(), falcon_counts_limit);
  EXPECT_GT(glm::dot(glm::normalize(rig.peer.force_d()), glm::normalize(huge)), 0.999);
}

TEST(falcon_device, a_lower_limit_is_obeyed) {
  falcon_settings settings = quick_settings();
  settings.limit_counts = 700;
  falcon_rig rig(awake_and_homed(), {}, settings);
  ASSERT_TRUE(rig.device->open());
  ASSERT_TRUE(rig.device->arm());
  for (int i = 0; i < 10; ++i) ASSERT_EQ(rig.tick({100.0, 0.0, 0.0}), status::ok);
  EXPECT_EQ(rig.peer.largest_applied(), 700);
}

TEST(falcon_device, a_command_that_is_no_wrench_is_a_fault) {
  const auto spoil = [](auto&& change) {
    falcon_rig rig(awake_and_homed());
    ASSERT_TRUE(rig.device->open());
    ASSERT_TRUE(rig.device->arm());
    ASSERT_EQ(rig.tick({0.0, 0.0, 2.0}), status::ok);
    device_command c = rig.command({0.0, 0.0, 2.0});
    change(c);
    EXPECT_EQ(rig.device->write(rig.clock.now_ns(), c), status::not_finite);
    EXPECT_EQ(rig.device->state(), device_state::fault);
    EXPECT_EQ(rig.device->fault(), falcon_fault::bad_command);
    rig.clock.advance_ns(1'000'000);
    EXPECT_TRUE(rig.peer.at_rest());
  };
  spoil([](device_command& c) { c.on_hand.force.x = NAN; });
  spoil([](device_command& c) { c.on_hand.force.z = INFINITY; });
  spoil([](device_command& c) { c.on_hand.torque.y = -INFINITY; });
  spoil([](device_command& c) { c.frame = wrench_frame::world; });
  spoil([](device_command& c) { c.frame = wrench_frame::unset; });
}

TEST(falcon_device, zero_is_the_last_word_of_every_ending) {
  for (const int ending : {0, 1, 2}) {
    falcon_rig rig(awake_and_homed());
    ASSERT_TRUE(rig.device->open());
    ASSERT_TRUE(rig.device->arm());
    for (int i = 0; i < 5; ++i) ASSERT_EQ(rig.tick({0.0, 0.0, 2.0}), status::ok);
    ASSERT_FALSE(rig.peer.at_rest());
    if (ending == 0) rig.device->close();
    if (ending == 1) rig.device.reset();
    if (ending == 2) {
      any_device erased(std::move(*rig.device));
      EXPECT_EQ(erased.state(), device_state::active);
    }
    rig.clock.advance_ns(2'000'000);
    EXPECT_TRUE(rig.peer.at_rest()) << ending;
  }
}

TEST(falcon_device, a_tick_takes_no_memory) {
  falcon_rig rig({.awake = true, .homed = true, .split = true});
  ASSERT_TRUE(rig.device->open());
  ASSERT_TRUE(rig.device->arm());
  std::size_t news = 0;
  for (int i = 0; i < 300; ++i) {
    const std::int64_t now_ns = rig.clock.now_ns();
    const device_command c = rig.command({0.0, 1.0, 2.0});
    const std::size_t before = news_in_this_thread();
    ASSERT_EQ(rig.device->read(now_ns, rig.seen), status::ok);
    ASSERT_EQ(rig.device->write(now_ns, c), status::ok);
    news += news_in_this_thread() - before;
    rig.clock.advance_ns(1'000'000);
  }
  EXPECT_EQ(news, 0U);
}

TEST(falcon_wire, says_why_a_report_is_not_believed) {
  virtual_usb cable;
  falcon_wire wire;
  wire.attach(cable.open());
  wire.demand_homing(true);
  std::int64_t now_ns = 1'000'000'000;
  const auto hear = [&](std::array<std::int16_t, 3> encoders, std::uint8_t homed = falcon_all_homed) {
    now_ns += 1'000'000;
    EXPECT_EQ(wire.send(now_ns, {}), io_status::ok);
    std::array<std::uint8_t, 18> packet{};
    const falcon_frame f = encode_falcon_report({.encoder_counts = encoders, .homed = homed});
    std::copy(f.begin(), f.end(), packet.begin() + 2);
    cable.give(now_ns, packet);
    EXPECT_EQ(wire.receive(now_ns), io_status::ok);
    std::array<std::uint8_t, 16> sent{};
    while (cable.take(now_ns, sent) != 0) continue;
    return wire.fresh() ? falcon_doubt::none : wire.doubt();
  };
  EXPECT_EQ(hear({2601, 0, 0}), falcon_doubt::out_of_range);
  EXPECT_EQ(hear({0, -2601, 0}), falcon_doubt::out_of_range);
  EXPECT_EQ(hear({0, 0, 0}, 3), falcon_doubt::not_homed);
  EXPECT_EQ(hear({2600, -2600, 2600}), falcon_doubt::no_position);
  wire.forget_encoders();
  EXPECT_EQ(hear({0, 0, 0}), falcon_doubt::none);
  EXPECT_EQ(hear({0, 0, 151}), falcon_doubt::jump);
  EXPECT_EQ(hear({0, 0, 151}), falcon_doubt::none);  // 2 ms after the last that was believed
  EXPECT_EQ(hear({150, 150, 301}), falcon_doubt::none);
  EXPECT_EQ(wire.positions(), 3U);
  EXPECT_EQ(wire.doubted_in_a_row(), 0);
  EXPECT_EQ(wire.lost(), 5U);
}

TEST(falcon_driver, lists_and_makes_two_at_once) {
  manual_clock clock(1'000'000'000, 250'000);
  virtual_usb first;
  virtual_usb second;
  virtual_usb_bus bus;
  usb_listing a = falcon_rig::listing();
  usb_listing b = a;
  b.serial = "F2";
  b.path = "1-3";
  b.not_openable = "no permission";
  bus.attach(first, a);
  bus.attach(second, b);
  falcon_driver driver(bus, clock);
  auto found = driver.list();
  ASSERT_TRUE(found);
  ASSERT_EQ(found->size(), 2U);
  EXPECT_EQ((*found)[0].identity, "usb:0403:cb48:F1");
  EXPECT_EQ((*found)[0].maturity, driver_maturity::protocol_tested);
  EXPECT_EQ((*found)[1].not_openable, "no permission");
  auto device = driver.make((*found)[0]);
  ASSERT_TRUE(device);
  EXPECT_EQ(device->state(), device_state::absent);
  auto refused = driver.make((*found)[1]);
  ASSERT_TRUE(refused);
  const auto opened = refused->open();
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().message, "no permission");
  first.unplug();
  EXPECT_EQ(driver.list()->size(), 1U);
  EXPECT_FALSE(driver.make((*found)[0]));
}

}  // namespace
