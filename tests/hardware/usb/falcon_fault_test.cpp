// What goes wrong between a Falcon and its driver: whatever it is, the motors end at zero and the driver says why.
#include <cstdio>
#include <gtest/gtest.h>
#include <map>
#include <string>

#include "hardware/usb/falcon_rig.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;

constexpr vec3 push{0.5, 1.0, 2.0};
constexpr std::int64_t ms = 1'000'000;

// --- the nth call, in open ---

// Calls that an opening makes, firmware and homing included.
std::uint64_t open_calls(const fake_image& image, falcon_settings settings) {
  falcon_rig rig({.image = image.bytes()}, {}, settings);
  EXPECT_TRUE(rig.device->open());
  return rig.cable.player().calls();
}

TEST(falcon_fault, the_nth_call_of_an_opening_fails) {
  const fake_image image(70);
  falcon_settings settings = quick_settings();
  settings.firmware_path = image.path();
  const std::uint64_t calls = open_calls(image, settings);
  ASSERT_GT(calls, 100U);
  int opened_anyway = 0;
  int refused = 0;
  for (std::uint64_t n = 0; n < calls; ++n) {
    for (const io_status with : {io_status::failed, io_status::gone, io_status::too_short, io_status::busy}) {
      falcon_rig rig({.image = image.bytes()}, {.events = {fail_call(n, with)}}, settings);
      const auto opened = rig.device->open();
      ASSERT_EQ(rig.peer.largest_applied(), 0) << n << ' ' << to_string(with);
      if (opened) {
        ++opened_anyway;
        ASSERT_EQ(rig.device->state(), device_state::ready);
        continue;
      }
      ++refused;
      ASSERT_EQ(rig.device->state(), device_state::closed) << n << ' ' << to_string(with);
      ASSERT_NE(opened.error().message.find("Falcon"), std::string::npos);
      ASSERT_NE(opened.error().message.find(to_string(with)), std::string::npos) << opened.error().message;
      ASSERT_FALSE(rig.device->arm());
      // Nothing is left behind: the next opening, without the fault, is a good one.
      const auto again = rig.device->open();
      ASSERT_TRUE(again) << n << ' ' << to_string(with) << ": " << again.error().message;
    }
  }
  std::printf("%llu calls of an opening, four answers each: %d openings went on, %d stopped with an error\n",
              static_cast<unsigned long long>(calls), opened_anyway, refused);
  EXPECT_GT(refused, 100);
}

// --- the nth call, in a session ---

struct outcome {
  falcon_fault fault = falcon_fault::none;
  device_state state = device_state::active;
  int ticks_to_rest = -1;
};

// A session at 1 kHz with one event at a call of it. The motors' numbers are within the limit throughout.
outcome session_with(link_event event, std::uint64_t n) {
  falcon_rig counting({.awake = true, .homed = true});
  EXPECT_TRUE(counting.device->open());
  const std::uint64_t before = counting.cable.player().calls();
  event.from_call = before + n;
  event.until_call = event.until_call == 0 ? event.from_call + 1 : event.until_call;

  falcon_rig rig({.awake = true, .homed = true}, {.events = {event}});
  EXPECT_TRUE(rig.device->open());
  EXPECT_TRUE(rig.device->arm());
  outcome out;
  for (int i = 0; i < 100; ++i) {
    static_cast<void>(rig.tick(push));
    if (rig.device->state() == device_state::fault) {
      if (out.ticks_to_rest < 0) out.ticks_to_rest = 0;
      if (!rig.peer.at_rest()) {
        ++out.ticks_to_rest;
      }
      EXPECT_FALSE(rig.device->arm());
    }
  }
  EXPECT_LE(rig.peer.largest_applied(), 2500);  // 2.3 N at this place; nothing else was ever asked for
  out.fault = rig.device->fault();
  out.state = rig.device->state();
  if (out.state == device_state::fault) {
    EXPECT_TRUE(rig.peer.at_rest());
    EXPECT_TRUE(rig.device->clear_fault());
    EXPECT_EQ(rig.device->state(), device_state::closed);
    EXPECT_FALSE(rig.device->arm());
  }
  return out;
}

TEST(falcon_fault, the_nth_call_of_a_session_fails) {
  const struct {
    link_event event;
    falcon_fault fault;
  } rows[] = {
      {{.kind = link_fault::answer, .with = io_status::failed}, falcon_fault::link_failed},
      {{.kind = link_fault::answer, .with = io_status::too_short}, falcon_fault::link_failed},
      {{.kind = link_fault::answer, .with = io_status::refused}, falcon_fault::link_failed},
      {{.kind = link_fault::answer, .with = io_status::down}, falcon_fault::link_failed},
      {{.kind = link_fault::answer, .with = io_status::gone}, falcon_fault::unplugged},
      {{.kind = link_fault::unplug}, falcon_fault::unplugged},
      {{.kind = link_fault::lose}, falcon_fault::none},
      {{.kind = link_fault::delay, .amount_ns = 3 * ms}, falcon_fault::none},
      {{.kind = link_fault::reorder}, falcon_fault::none},
      {{.kind = link_fault::duplicate}, falcon_fault::none},
      {{.kind = link_fault::shorten}, falcon_fault::none},
      {{.kind = link_fault::flip_bit, .direction = link_direction::from_device}, falcon_fault::none},
  };
  std::puts("one fault in a session at 1 kHz         fault of the driver                  ticks to rest, at most");
  for (const auto& row : rows) {
    int worst = 0;
    for (std::uint64_t n = 0; n < 150; ++n) {
      link_event event = row.event;
      event.until_call = 0;
      const outcome out = session_with(event, n);
      ASSERT_EQ(out.fault, row.fault) << "event " << static_cast<int>(event.kind) << " at call " << n;
      ASSERT_EQ(out.state, row.fault == falcon_fault::none ? device_state::active : device_state::fault) << n;
      worst = std::max(worst, out.ticks_to_rest);
    }
    std::printf("kind %2d, answer %-32s %-36s %d\n", static_cast<int>(row.event.kind),
                row.event.kind == link_fault::answer ? to_string(row.event.with) : "-", to_string(row.fault), worst);
    EXPECT_LE(worst, 1);
  }
}

// --- faults that last ---

TEST(falcon_fault, a_pipe_that_takes_nothing_is_a_fault_after_three_ticks) {
  const outcome out = session_with({.kind = link_fault::answer,
                                    .direction = link_direction::to_device,
                                    .until_call = ~std::uint64_t{0} - 1,
                                    .with = io_status::busy},
                                   ~std::uint64_t{0} / 2);
  EXPECT_EQ(out.fault, falcon_fault::none);  // a window that never comes, as a control

  falcon_rig rig({.awake = true, .homed = true}, {.events = {{.kind = link_fault::answer,
                                                              .direction = link_direction::to_device,
                                                              .from_ns = 2'000 * ms,
                                                              .until_ns = 2'010 * ms,
                                                              .with = io_status::busy}}});
  ASSERT_TRUE(rig.device->open());
  ASSERT_TRUE(rig.device->arm());
  while (rig.clock.now_ns() < 2'000 * ms) ASSERT_EQ(rig.tick(push), status::ok);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(rig.tick(push), status::ok);
  EXPECT_EQ(rig.tick(push), status::backend_failed);
  EXPECT_EQ(rig.device->fault(), falcon_fault::link_full);
  EXPECT_FALSE(rig.peer.at_rest());  // nothing can be told to it ...
  while (rig.clock.now_ns() < 2'011 * ms) EXPECT_EQ(rig.tick(push), status::not_ready);
  EXPECT_TRUE(rig.peer.at_rest());  // ... until the pipe takes the zero that is owed
}

TEST(falcon_fault, a_device_that_falls_silent_is_told_zero) {
  falcon_rig rig({.awake = true, .homed = true});
  ASSERT_TRUE(rig.device->open());
  ASSERT_TRUE(rig.device->arm());
  for (int i = 0; i < 20; ++i) ASSERT_EQ(rig.tick(push), status::ok);
  rig.peer.fall_silent(true);
  int ticks = 0;
  while (rig.device->state() != device_state::fault && ticks < 100) {
    static_cast<void>(rig.tick(push));
    ++ticks;
  }
  EXPECT_LE(ticks, 24);
  EXPECT_EQ(rig.device->fault(), falcon_fault::silent);
  EXPECT_TRUE(rig.peer.at_rest());
  rig.peer.fall_silent(false);
  for (int i = 0; i < 50; ++i) EXPECT_EQ(rig.tick(push), status::not_ready);
  EXPECT_TRUE(rig.peer.at_rest());
}

TEST(falcon_fault, while_commands_are_lost_the_device_cannot_be_stopped_and_is_as_soon_as_they_arrive) {
  falcon_rig rig({.awake = true, .homed = true}, {.events = {{.kind = link_fault::lose,
                                                              .direction = link_direction::to_device,
                                                              .from_ns = 2'000 * ms,
                                                              .until_ns = 2'100 * ms}}});
  ASSERT_TRUE(rig.device->open());
  ASSERT_TRUE(rig.device->arm());
  while (rig.clock.now_ns() < 2'000 * ms) ASSERT_EQ(rig.tick(push), status::ok);
  while (rig.clock.now_ns() < 2'099 * ms) static_cast<void>(rig.tick(push));
  EXPECT_EQ(rig.device->fault(), falcon_fault::silent);
  EXPECT_FALSE(rig.peer.at_rest());  // it has no watchdog that is known of
  while (rig.clock.now_ns() < 2'102 * ms) static_cast<void>(rig.tick(push));
  EXPECT_TRUE(rig.peer.at_rest());
}

TEST(falcon_fault, encoders_that_cannot_be_true_are_a_fault) {
  const std::array<std::int16_t, 3> lies[] = {{0, 0, 32767}, {-32768, 0, 0}, {1400, 1400, -1400}, {900, -900, 900}};
  for (const auto& lie : lies) {
    falcon_rig rig({.awake = true, .homed = true});
    ASSERT_TRUE(rig.device->open());
    ASSERT_TRUE(rig.device->arm());
    for (int i = 0; i < 20; ++i) ASSERT_EQ(rig.tick(push), status::ok);
    const vec3 before = rig.seen.T_dh.position;
    rig.peer.force_encoders(lie);
    for (int i = 0; i < 20; ++i) {
      static_cast<void>(rig.tick(push));
      EXPECT_LT(glm::length(rig.seen.T_dh.position - before), 1e-9);
    }
    EXPECT_EQ(rig.device->fault(), falcon_fault::not_believable);
    EXPECT_EQ(rig.device->state(), device_state::fault);
    EXPECT_TRUE(rig.peer.at_rest());
  }
}

TEST(falcon_fault, a_leg_that_forgets_its_mark_is_a_fault) {
  falcon_rig rig({.awake = true, .homed = true});
  ASSERT_TRUE(rig.device->open());
  ASSERT_TRUE(rig.device->arm());
  for (int i = 0; i < 20; ++i) ASSERT_EQ(rig.tick(push), status::ok);
  rig.peer.forget_homing();
  for (int i = 0; i < 20; ++i) static_cast<void>(rig.tick(push));
  EXPECT_EQ(rig.device->fault(), falcon_fault::homing_lost);
  EXPECT_TRUE(rig.peer.at_rest());
}

// --- leaving and returning ---

TEST(falcon_fault, unplugged_while_it_pushes_and_back_under_another_path_it_is_never_armed_by_itself) {
  falcon_rig rig({.awake = true, .homed = true});
  ASSERT_TRUE(rig.device->open());
  ASSERT_TRUE(rig.device->arm());
  for (int i = 0; i < 20; ++i) ASSERT_EQ(rig.tick(push), status::ok);
  rig.cable.unplug();
  EXPECT_EQ(rig.tick(push), status::backend_failed);
  EXPECT_EQ(rig.device->state(), device_state::fault);
  EXPECT_EQ(rig.device->fault(), falcon_fault::unplugged);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(rig.tick(push), status::not_ready);

  const auto refused = rig.device->open();
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("it was unplugged"), std::string::npos) << refused.error().message;
  ASSERT_TRUE(rig.device->clear_fault());
  const auto missing = rig.device->open();
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().message.find("not plugged in"), std::string::npos) << missing.error().message;

  rig.cable.plug_in();
  rig.bus.move(rig.cable, "3-1.4");
  for (int i = 0; i < 20; ++i) EXPECT_EQ(rig.tick(push), status::not_ready);
  const auto opened = rig.device->open();
  ASSERT_TRUE(opened) << opened.error().message;
  EXPECT_EQ(rig.device->listing().path, "3-1.4");
  EXPECT_EQ(rig.device->state(), device_state::ready);
  const std::uint64_t commands = rig.peer.commands();
  for (int i = 0; i < 50; ++i) {
    EXPECT_EQ(rig.tick(push), status::ok);
    EXPECT_TRUE(rig.peer.at_rest());
  }
  EXPECT_GT(rig.peer.commands(), commands + 40);
  ASSERT_TRUE(rig.device->arm());
  for (int i = 0; i < 5; ++i) EXPECT_EQ(rig.tick(push), status::ok);
  EXPECT_FALSE(rig.peer.at_rest());
}

TEST(falcon_fault, unplugged_while_it_only_measures_it_is_absent) {
  falcon_rig rig({.awake = true, .homed = true});
  ASSERT_TRUE(rig.device->open());
  ASSERT_EQ(rig.tick(push), status::ok);
  rig.cable.unplug();
  EXPECT_EQ(rig.tick(push), status::backend_failed);
  EXPECT_EQ(rig.device->state(), device_state::absent);
  rig.cable.plug_in();
  ASSERT_TRUE(rig.device->open());
  EXPECT_EQ(rig.device->state(), device_state::ready);
}

// --- received bytes mean harm ---

// Answers with whatever it likes, at any length; the driver has to end, to take no memory for it and to send nothing
// that was not asked for.
TEST(falcon_fault, received_bytes_of_any_kind_change_nothing_but_the_samples) {
  std::map<falcon_fault, int> ends;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    std::mt19937_64 bits(seed);
    falcon_rig rig({.awake = true, .homed = true, .split = seed % 2 == 0, .seed = seed});
    ASSERT_TRUE(rig.device->open());
    ASSERT_TRUE(rig.device->arm());
    rig.peer.fall_silent(seed % 3 == 0);  // nothing but harm is said then
    for (int i = 0; i < 60; ++i) {
      for (std::uint64_t packets = bits() % 4; packets > 0; --packets) {
        std::array<std::uint8_t, 512> harm{};
        const std::size_t size = bits() % (bits() % 8 == 0 ? 513 : 40);
        for (std::size_t k = 0; k < size; ++k) {
          // Mostly bytes of which frames are made, so that many are nearly right.
          constexpr char likely[] = "<>ABCDEFGHIJKLMNOP<>";
          harm[k] =
              static_cast<std::uint8_t>(bits() % 3 == 0 ? bits() : static_cast<std::uint8_t>(likely[bits() % 20]));
        }
        if (bits() % 3 == 0 && size >= 18) {
          falcon_report r;
          for (auto& e : r.encoder_counts) e = static_cast<std::int16_t>(bits() % (bits() % 2 == 0 ? 65536 : 500));
          r.homed = static_cast<std::uint8_t>(bits() % 4 == 0 ? bits() & 7U : 7U);
          const falcon_frame f = encode_falcon_report(r);
          std::copy(f.begin(), f.end(), harm.begin() + 2);
        }
        rig.cable.give(rig.clock.now_ns(), std::span(harm).first(size));
      }
      static_cast<void>(rig.tick({0.0, 0.0, 1.0}));
      ASSERT_TRUE(is_finite(rig.seen.T_dh.position));
      ASSERT_LE(rig.peer.largest_applied(), falcon_counts_limit);
      if (rig.device->state() == device_state::fault) {
        ASSERT_TRUE(rig.peer.at_rest());
      }
    }
    ++ends[rig.device->fault()];
  }
  for (const auto& [fault, count] : ends) std::printf("%3d runs end with: %s\n", count, to_string(fault));
  EXPECT_GT(ends.size(), 1U);  // some are survived, some are not
}

}  // namespace
