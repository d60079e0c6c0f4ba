// What the C interface marks as safe in a tick, inside the trap: with good input and with what it refuses.
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>

#include "contract/c_interface/saved_models.hpp"
#include "session/rt/tick_trap.hpp"

namespace {

using namespace asperity::test_support;

TEST(c_ticks, stand_in_a_trap) {
  if (const std::string why = tick_trap::missing(); !why.empty()) GTEST_SKIP() << why;
  if (const std::string why = tick_trap::missing_system_calls(); !why.empty()) GTEST_SKIP() << why;
}

// A control: what is no function for a tick is caught in the library as it is in a program.
TEST(c_ticks, loading_in_a_tick_is_caught) {
  if (const std::string why = tick_trap::missing(); !why.empty()) GTEST_SKIP() << why;
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        tick_trap trap;
        asperity_model* model = nullptr;
        trap([&] { static_cast<void>(asperity_model_load("nowhere.glb", &model, nullptr)); });
      },
      testing::ExitedWithCode(tick_trap::exit_status), "tick trap");
}

TEST(c_ticks, steps_of_every_formulation) {
  const two_models& m = shared_models();
  for (const std::uint32_t f :
       {ASPERITY_FORMULATION_LEAST_MOTION, ASPERITY_FORMULATION_PLANES, ASPERITY_FORMULATION_WINDOW}) {
    asperity_renderer_settings settings = sized<asperity_renderer_settings>();
    settings.formulation = f;
    const owned_renderer r = m.renderer(&settings);
    asperity_touch touch = sized<asperity_touch>();
    asperity_contact contact = sized<asperity_contact>();
    double on_body[6];
    tick_trap trap;
    std::uint32_t touched = 0;
    for (int i = 0; i < 200; ++i) {
      const double T[7] = {1e-4 * i, 0, 0.0203 - 5e-6 * i, 0, 0, 0, 1};
      const double T_wb[7] = {0, 1e-5 * i, 0, 0, 0, 0, 1};
      trap([&] {
        static_cast<void>(asperity_renderer_place_body(r.get(), 0, T_wb));
        static_cast<void>(asperity_renderer_step(r.get(), T, &touch));
        static_cast<void>(asperity_renderer_body_wrench(r.get(), 0, on_body));
        for (std::uint32_t c = 0; c <= touch.contacts; ++c)
          static_cast<void>(asperity_renderer_contact(r.get(), c, &contact));
      });
      touched += touch.deepest_m > 0.0 ? 1U : 0U;
    }
    EXPECT_GT(touched, 50U);
  }
}

TEST(c_ticks, a_tool_that_follows_a_hand) {
  const two_models& m = shared_models();
  asperity_tool_settings settings = sized<asperity_tool_settings>();
  settings.static_friction = settings.dynamic_friction = 0.5;
  settings.most_force_n = 3.0;
  const owned_tool tool = m.tool(&settings);
  asperity_felt felt = sized<asperity_felt>();
  tick_trap trap;
  for (int i = 0; i < 600; ++i) {
    const double hand[7] = {2e-5 * i, 0, 0.0205 - 2e-5 * i, 0, 0, 0, 1};
    const double plate[7] = {0, 0, 0, 0, 0, 0, 1}, moving[6] = {0.01, 0, 0, 0, 0, 0.1};
    trap([&] {
      if (i == 0) static_cast<void>(asperity_tool_place(tool.get(), hand));
      if (i % 100 == 50)
        static_cast<void>(asperity_tool_move_body(tool.get(), 0, plate, i % 200 == 50 ? moving : nullptr));
      static_cast<void>(asperity_tool_follow(tool.get(), hand, 1e-3, &felt));
    });
  }
  EXPECT_GT(felt.on_hand[2], 2.0);
}

TEST(c_ticks, a_session_and_its_end) {
  const two_models& m = shared_models();
  const owned_device device = simulated();
  const owned_session session = m.session(device.get());
  asperity_session_tick tick = sized<asperity_session_tick>();
  tick_trap trap;
  for (int i = 0; i < 100; ++i) trap([&] { static_cast<void>(asperity_session_step(session.get(), 7, &tick)); });
  EXPECT_GT(tick.on_hand[2], 0.1);
  trap([&] {
    static_cast<void>(asperity_session_stop(session.get()));
    static_cast<void>(asperity_session_step(session.get(), 7, &tick));
  });
  EXPECT_EQ(tick.ticks, 0U);
}

TEST(c_ticks, a_device_of_ones_own_loop) {
  const owned_device device = simulated();
  ASSERT_EQ(asperity_device_open(device.get(), nullptr), 0);
  ASSERT_EQ(asperity_device_arm(device.get(), nullptr), 0);
  asperity_measurement sample = sized<asperity_measurement>();
  asperity_device_limits limits = sized<asperity_device_limits>();
  tick_trap trap;
  for (std::int64_t t = 0; t < 300'000'000; t += 1'000'000) {
    trap([&] {
      static_cast<void>(asperity_device_read(device.get(), t, &sample));
      const double push[6] = {0, 0, -100.0 * sample.pose[2], 0, 0, 0};
      static_cast<void>(asperity_device_write(device.get(), t, push, t + 20'000'000));
      static_cast<void>(asperity_device_get_limits(device.get(), &limits));
      static_cast<void>(asperity_device_state(device.get()));
    });
  }
  trap([&] { static_cast<void>(asperity_device_disarm(device.get())); });
}

TEST(c_ticks, whatever_is_refused) {
  const two_models& m = shared_models();
  const owned_renderer renderer = m.renderer();
  const owned_tool tool = m.tool();
  const owned_device device = simulated();
  const owned_session session = m.session(device.get());
  asperity_touch touch = sized<asperity_touch>();
  asperity_felt felt = sized<asperity_felt>();
  asperity_session_tick tick = sized<asperity_session_tick>();
  asperity_measurement sample = sized<asperity_measurement>();
  asperity_model_facts facts = sized<asperity_model_facts>();
  const double none[7] = {0, 0, std::numeric_limits<double>::quiet_NaN(), 0, 0, 0, 1};
  double six[6] = {};
  int answers = 0;
  tick_trap trap;
  trap([&] {
    for (const std::int32_t a :
         {asperity_renderer_step(nullptr, none, &touch), asperity_renderer_step(renderer.get(), none, &touch),
          asperity_renderer_step(renderer.get(), none, nullptr),
          asperity_renderer_step(reinterpret_cast<asperity_renderer*>(tool.get()), none, &touch),
          asperity_renderer_place_body(renderer.get(), 9, none), asperity_tool_place(tool.get(), none),
          asperity_tool_follow(tool.get(), none, 1e-3, &felt), asperity_tool_follow(tool.get(), none, -1.0, &felt),
          asperity_tool_move_body(tool.get(), 0, none, six), asperity_session_step(nullptr, 1, &tick),
          asperity_device_read(device.get(), 0, &sample), asperity_device_write(device.get(), 0, six, 0),
          asperity_device_disarm(device.get())}) {
      answers += a != 0 ? 1 : 0;
    }
    answers += asperity_model_get_facts(m.c_probe.get(), &facts) == 0 ? 1 : 0;
    answers += asperity_describe(ASPERITY_ERROR_BUSY) != nullptr && asperity_version() != nullptr ? 1 : 0;
    answers += asperity_wrench_to_unity(six, six) == 0 ? 1 : 0;
  });
  EXPECT_EQ(answers, 16);
}

}  // namespace
