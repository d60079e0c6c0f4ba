// Structs of older and newer programs, sentences, what lives as long as something needs it, and two threads.
#include <cstring>
#include <gtest/gtest.h>
#include <thread>
#include <vector>

#include "asperity/version.hpp"
#include "contract/c_interface/saved_models.hpp"
#include "support/sanitizers.hpp"

namespace {

using namespace asperity::test_support;

// A program that was compiled with a version whose structs ended earlier: nothing behind its end is read or written.
TEST(c_lives, a_shorter_struct_is_an_older_programs) {
  const all_handles h;
  const double T[7] = {0, 0, 0.0195, 0, 0, 0, 1};
  asperity_touch whole = sized<asperity_touch>();
  ASSERT_EQ(asperity_renderer_step(h.renderer.get(), T, &whole), 0);
  ASSERT_GT(whole.on_probe[2], 0.1);
  for (std::uint32_t size = 8; size <= sizeof(asperity_touch); size += 8) {
    asperity_touch shorter;
    std::memset(&shorter, 0xa5, sizeof shorter);
    shorter.size = size;
    ASSERT_EQ(asperity_renderer_step(h.renderer.get(), T, &shorter), 0);
    EXPECT_EQ(shorter.size, size);
    EXPECT_EQ(std::memcmp(&shorter.flags, &whole.flags, size - 4), 0);
    for (std::size_t i = size; i < sizeof shorter; ++i)
      ASSERT_EQ(reinterpret_cast<const unsigned char*>(&shorter)[i], 0xa5) << "byte " << i << " of " << size;
  }
  // Settings that end before the friction have none; what lies behind them is not read.
  asperity_tool_settings settings;
  std::memset(&settings, 0xff, sizeof settings);
  settings.size = offsetof(asperity_tool_settings, static_friction);
  settings.substeps = 0;
  settings.period_s = settings.mass_kg = settings.coupling_n_per_m = settings.coupling_n_m_per_rad = 0.0;
  settings.stiffness_n_per_m = settings.dissipation_s_per_m = 0.0;
  const owned_tool older = h.models.tool(&settings);
  asperity_felt a = sized<asperity_felt>(), b = a;
  const double above[7] = {0, 0, 0.0205, 0, 0, 0, 1}, hand[7] = {0.002, 0, 0.012, 0, 0, 0, 1};
  ASSERT_EQ(asperity_tool_place(older.get(), above), 0);
  ASSERT_EQ(asperity_tool_place(h.tool.get(), above), 0);
  for (int i = 0; i < 50; ++i) {
    ASSERT_EQ(asperity_tool_follow(older.get(), hand, 1e-3, &a), 0);
    ASSERT_EQ(asperity_tool_follow(h.tool.get(), hand, 1e-3, &b), 0);
  }
  EXPECT_EQ(std::memcmp(&a, &b, sizeof a), 0);
  // A short error has room for a short sentence.
  asperity_error why;
  std::memset(&why, 'x', sizeof why);
  why.size = 24;
  asperity_model* model = nullptr;
  EXPECT_EQ(asperity_model_load("nowhere.glb", &model, &why), ASPERITY_ERROR_IO_FAILED);
  EXPECT_EQ(why.code, ASPERITY_ERROR_IO_FAILED);
  EXPECT_EQ(std::strlen(why.message), 15U);
  EXPECT_EQ(why.message[16], 'x');
}

// One that was compiled with a later version: fine as long as it asks for nothing that is not known here.
TEST(c_lives, a_longer_struct_is_a_newer_programs) {
  const all_handles h;
  struct {
    asperity_touch known;
    double later[3];
  } out{};
  std::memset(&out, 0xa5, sizeof out);
  out.known.size = sizeof out;
  const double T[7] = {0, 0, 0.0195, 0, 0, 0, 1};
  ASSERT_EQ(asperity_renderer_step(h.renderer.get(), T, &out.known), 0);
  EXPECT_GT(out.known.on_probe[2], 0.1);
  EXPECT_EQ(out.known.size, sizeof out);
  for (const double x : out.later) EXPECT_EQ(x, 0.0);
  struct {
    asperity_renderer_settings known;
    double later[2];
  } in{};
  in.known.size = sizeof in;
  asperity_renderer* made = nullptr;
  asperity_error why = no_error();
  EXPECT_EQ(asperity_renderer_make(h.models.c_probe.get(), &h.models.fixed, 1, &in.known, &made, &why), 0);
  EXPECT_EQ(asperity_renderer_free(made), 0);
  in.later[1] = 1.0;
  EXPECT_EQ(asperity_renderer_make(h.models.c_probe.get(), &h.models.fixed, 1, &in.known, &made, &why),
            ASPERITY_ERROR_UNSUPPORTED);
  EXPECT_EQ(made, nullptr);
}

// A sentence that is longer than its place ends with a whole character.
TEST(c_lives, sentences_are_cut_between_characters) {
  asperity_model* model = nullptr;
  for (int extra = 0; extra < 4; ++extra) {
    std::string name(static_cast<std::size_t>(extra), 'x');
    while (name.size() < 600) name += "\xc3\xa4";
    asperity_error why = no_error();
    EXPECT_NE(asperity_model_load(name.c_str(), &model, &why), 0);
    const std::string said = why.message;
    ASSERT_LT(said.size(), sizeof why.message);
    std::size_t open = 0;
    for (std::size_t i = 0; i < said.size(); ++i) {
      const auto byte = static_cast<unsigned char>(said[i]);
      if (byte == 0xc3) ++open;
      if (byte == 0xa4) --open;
    }
    EXPECT_EQ(open, 0U) << said;
  }
}

TEST(c_lives, what_others_need_lives_on) {
  asperity_renderer* renderer = nullptr;
  asperity_session* session = nullptr;
  {
    const owned_model probe = shared_models().load("probe.glb"), plate = shared_models().load("plate.glb");
    const asperity_model* const fixed = plate.get();
    ASSERT_EQ(asperity_renderer_make(probe.get(), &fixed, 1, nullptr, &renderer, nullptr), 0);
    const owned_device d = simulated();
    ASSERT_EQ(asperity_session_make(probe.get(), &fixed, nullptr, 1, d.get(), nullptr, &session, nullptr), 0);
  }
  const owned_renderer kept(renderer);
  const owned_session kept_session(session);
  asperity_touch touch = sized<asperity_touch>();
  const double T[7] = {0, 0, 0.0195, 0, 0, 0, 1};
  EXPECT_EQ(asperity_renderer_step(renderer, T, &touch), 0);
  EXPECT_GT(touch.on_probe[2], 0.1);
  asperity_session_tick tick = sized<asperity_session_tick>();
  EXPECT_EQ(asperity_session_step(session, 600, &tick), 0);
  EXPECT_GT(tick.on_hand[2], 0.1);
}

TEST(c_lives, one_session_has_a_device) {
  const all_handles h;
  asperity_session* second = nullptr;
  asperity_error why = no_error();
  EXPECT_EQ(asperity_session_make(h.models.c_probe.get(), &h.models.fixed, nullptr, 1, h.device.get(), nullptr, &second,
                                  &why),
            ASPERITY_ERROR_BUSY);
  asperity_measurement sample = sized<asperity_measurement>();
  const double push[6] = {};
  EXPECT_EQ(asperity_device_open(h.device.get(), &why), ASPERITY_ERROR_BUSY);
  EXPECT_EQ(asperity_device_arm(h.device.get(), &why), ASPERITY_ERROR_BUSY);
  EXPECT_EQ(asperity_device_disarm(h.device.get()), ASPERITY_ERROR_BUSY);
  EXPECT_EQ(asperity_device_read(h.device.get(), 0, &sample), ASPERITY_ERROR_BUSY);
  EXPECT_EQ(asperity_device_write(h.device.get(), 0, push, 0), ASPERITY_ERROR_BUSY);
  asperity_device_limits limits = sized<asperity_device_limits>();
  EXPECT_EQ(asperity_device_get_limits(h.device.get(), &limits), 0);
  EXPECT_GT(limits.peak_force_n, 1.0);
  EXPECT_EQ(limits.sensed, 0x3fU);
}

TEST(c_lives, versions_and_words) {
  EXPECT_STREQ(asperity_version(), ASPERITY_VERSION_STRING);
  EXPECT_EQ(asperity_version_number(), ASPERITY_VERSION_MAJOR * 10000U + ASPERITY_VERSION_MINOR * 100U);
  std::vector<std::string> words;
  for (std::int32_t a = -1; a < 200; ++a) words.emplace_back(asperity_describe(a));
  std::size_t known = 0;
  for (const std::string& w : words) known += w == "unknown answer" ? 0U : 1U;
  EXPECT_EQ(known, 8U + 9U + 2U);
}

// Two threads with handles of their own, and models that both use: each answers as it does alone.
TEST(c_lives, two_threads_do_not_meet) {
  const two_models& m = shared_models();
  // ThreadSanitizer sees in a few steps what it sees in many, and makes each twenty times as long.
  constexpr int steps = ASPERITY_THREAD_SANITIZER ? 30 : 300;
  const auto walk = [&](std::vector<double>& out) {
    const owned_renderer renderer = m.renderer();
    const owned_tool tool = m.tool();
    const owned_device device = simulated();
    const owned_session session = m.session(device.get());
    double T[7] = {0, 0, 0.0205, 0, 0, 0, 1};
    ASSERT_EQ(asperity_tool_place(tool.get(), T), 0);
    asperity_touch touch = sized<asperity_touch>();
    asperity_felt felt = sized<asperity_felt>();
    asperity_session_tick tick = sized<asperity_session_tick>();
    for (int i = 0; i < steps; ++i) {
      T[0] = 0.00002 * i;
      T[2] = 0.0198;
      ASSERT_EQ(asperity_renderer_step(renderer.get(), T, &touch), 0);
      T[2] = 0.015;
      ASSERT_EQ(asperity_tool_follow(tool.get(), T, 1e-3, &felt), 0);
      ASSERT_EQ(asperity_session_step(session.get(), 1, &tick), 0);
      out.insert(out.end(), touch.on_probe, touch.on_probe + 6);
      out.insert(out.end(), felt.on_hand, felt.on_hand + 6);
      out.insert(out.end(), tick.on_hand, tick.on_hand + 6);
      asperity_model* none = nullptr;
      asperity_error why = no_error();
      if (i % (steps / 3) != 0) continue;
      ASSERT_EQ(asperity_model_load("nowhere.glb", &none, &why), ASPERITY_ERROR_IO_FAILED);
    }
  };
  std::vector<double> alone, first, second;
  walk(alone);
  std::thread a([&] { walk(first); }), b([&] { walk(second); });
  a.join();
  b.join();
  ASSERT_EQ(alone.size(), 18U * static_cast<std::size_t>(steps));
  EXPECT_EQ(alone, first);
  EXPECT_EQ(alone, second);
}

}  // namespace
