#include "asperity/gl/compute_depth.hpp"

#include <cstring>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <thread>
#include <type_traits>

#include "hardware/gl/seeded_contacts.hpp"
#include "support/counted_news.hpp"
#include "support/gl_context.hpp"

namespace asperity::gl {
namespace {

static_assert(std::is_nothrow_move_constructible_v<compute_depth> && std::is_nothrow_move_assignable_v<compute_depth>,
              "it sits in a renderer");

using test_support::seeded_contacts;

class GlComputeDepth : public test_support::gl_test {
 protected:
  [[nodiscard]] compute_depth make(const scene& s, const window_depth_settings& settings,
                                   const compute_settings& o = {}) {
    auto made = compute_depth::make(context, s, settings, o);
    EXPECT_TRUE(made) << made.error().message;
    return *std::move(made);
  }
  static std::vector<pose_pair> pairs(const seeded_contacts& s) {
    std::vector<pose_pair> out;
    for (std::size_t i = 0; i < s.contacts.size(); ++i) out.push_back({s.T_wa[i], s.T_wb[i]});
    return out;
  }
  /// Contact i of the set alone.
  static contact_set alone(const seeded_contacts& s, std::size_t i) {
    contact_set one({.contacts = 1, .triangles = 1U << 12});
    const contact& c = s.contacts.contacts()[i];
    EXPECT_TRUE(one.add(c, s.contacts.patch_a(c), s.contacts.patch_b(c)));
    return one;
  }
  static void expect_same_bits(const penetration& p, const penetration& q) {
    EXPECT_EQ(p.depth_m, q.depth_m);
    EXPECT_EQ(p.soft_depth_m, q.soft_depth_m);
    EXPECT_EQ(p.witness_w, q.witness_w);
    EXPECT_EQ(p.samples, q.samples);
    EXPECT_EQ(p.flags, q.flags);
    EXPECT_EQ(p.curvature.m, q.curvature.m);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(p.gradient[i], q.gradient[i]);
  }
  static void expect_nothing(const penetration& p) {
    EXPECT_EQ(p.flags, depth_flag::no_overlap);
    EXPECT_EQ(p.depth_m, 0.0);
    EXPECT_EQ(p.samples, 0U);
    EXPECT_EQ(test_support::largest_entry(p), 0.0);
  }
};

const window_depth_settings soft{.grid = 16}, differences{.gradient = gradient_scheme::central_difference, .grid = 16};

TEST_F(GlComputeDepth, ThousandsOfPairsAreOneSubmissionAndTheSameBitsAsOneByOne) {
  const seeded_contacts s = test_support::make_seeded_contacts(5, 1, 1, 64, 4096);
  compute_depth backend = make(s.bodies, {.grid = 8}, {.contacts = 4096, .triangles = 4096 * 24});
  std::vector<penetration> together(s.contacts.size());
  ASSERT_EQ(backend.measure_each(pairs(s), s.contacts, together), status::ok);
  EXPECT_EQ(backend.counters().round_trips, 1U);
  EXPECT_EQ(backend.counters().contacts, 4096U);
  std::size_t overlapping = 0;
  for (std::size_t i = 0; i < together.size(); i += 61) {
    penetration one;
    ASSERT_EQ(backend.measure({s.T_wa[i], std::span(&s.T_wb[i], 1)}, alone(s, i), std::span(&one, 1)), status::ok);
    expect_same_bits(together[i], one);
    overlapping += one.samples > 0 ? 1 : 0;
  }
  EXPECT_GT(overlapping, 40U);
}

TEST_F(GlComputeDepth, ATickTakesNoMemoryAndWaitsOnce) {
  const seeded_contacts s = test_support::make_seeded_contacts(6, 2, 2, 128, 8);
  for (const window_depth_settings& settings : {soft, differences}) {
    compute_depth backend = make(s.bodies, settings);
    std::vector<penetration> out(s.contacts.size());
    const auto at = pairs(s);
    ASSERT_EQ(backend.measure_each(at, s.contacts, out), status::ok);  // the driver compiles for good now
    const std::size_t device = context->device_bytes(), heap = backend.heap_bytes();
    const std::size_t before = test_support::news_in_this_thread();
    status worst = status::ok;
    for (int i = 0; i < 10; ++i) {
      const status now = backend.measure_each(at, s.contacts, out);
      if (now != status::ok) worst = now;
    }
    EXPECT_EQ(test_support::news_in_this_thread(), before);
    EXPECT_EQ(worst, status::ok);
    EXPECT_EQ(backend.counters().ticks, 11U);
    EXPECT_EQ(backend.counters().round_trips, 11U);
    EXPECT_EQ(context->device_bytes(), device);
    EXPECT_EQ(backend.heap_bytes(), heap);
  }
}

TEST_F(GlComputeDepth, WhatDoesNotFitIsRefusedWhole) {
  const seeded_contacts s = test_support::make_seeded_contacts(7, 2, 2, 64, 6);
  std::vector<penetration> out(6, {.depth_m = 1.0});
  compute_depth few = make(s.bodies, soft, {.contacts = 5});
  EXPECT_EQ(few.measure_each(pairs(s), s.contacts, out), status::capacity_reached);
  for (const penetration& p : out) expect_nothing(p);
  compute_depth small = make(s.bodies, soft, {.contacts = 6, .triangles = 2});
  out.assign(6, {.depth_m = 1.0});
  EXPECT_EQ(small.measure_each(pairs(s), s.contacts, out), status::capacity_reached);
  for (const penetration& p : out) expect_nothing(p);
  EXPECT_EQ(small.counters().ticks, 0U);
}

TEST_F(GlComputeDepth, NoMemoryIsAnErrorThatLeavesNothingBehind) {
  const seeded_contacts s = test_support::make_seeded_contacts(8, 1, 1, 64, 1);
  context->limit_memory(200'000);
  const auto none = compute_depth::make(context, s.bodies, soft);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, error_code::limit_exceeded);
  EXPECT_EQ(context->device_bytes(), 0U);
  context->limit_memory(0);
  const auto vast = compute_depth::make(context, s.bodies, {.grid = 512}, {.contacts = 65535});
  ASSERT_FALSE(vast);
  EXPECT_EQ(vast.error().code, error_code::limit_exceeded);
  EXPECT_NE(vast.error().message.find("fewer contacts"), std::string::npos) << vast.error().message;
  EXPECT_EQ(context->device_bytes(), 0U);
}

TEST_F(GlComputeDepth, TwoBackendsShareTheModels) {
  const seeded_contacts s = test_support::make_seeded_contacts(9, 1, 1, 256, 1);
  const compute_depth first = make(s.bodies, soft);
  const std::size_t one = context->device_bytes();
  const compute_depth second = make(s.bodies, soft);
  EXPECT_EQ(context->device_bytes() - one, second.device_bytes());
  EXPECT_GT(one, first.device_bytes() + s.bodies.probe->texture.texels.size() * 16);
}

TEST_F(GlComputeDepth, BadOptionsAreRefused) {
  const seeded_contacts s = test_support::make_seeded_contacts(10, 1, 1, 64, 1);
  const auto refused = [&](const scene& bodies, const window_depth_settings& settings, const compute_settings& o) {
    const auto made = compute_depth::make(context, bodies, settings, o);
    return !made && made.error().code == error_code::invalid_argument;
  };
  EXPECT_TRUE(refused(s.bodies, {.grid = 1}, {}));
  EXPECT_TRUE(refused({}, soft, {}));
  EXPECT_TRUE(refused(s.bodies, soft, {.contacts = 0}));
  EXPECT_TRUE(refused(s.bodies, soft, {.contacts = 70000}));
  EXPECT_TRUE(refused(s.bodies, soft, {.triangles = 0}));
  EXPECT_TRUE(refused(s.bodies, {.refine_maximum = true}, {}));
}

TEST_F(GlComputeDepth, ALostContextIsAFailureAndLeavesZeros) {
  const seeded_contacts s = test_support::make_seeded_contacts(11, 1, 1, 64, 2);
  compute_depth backend = make(s.bodies, soft);
  std::vector<penetration> out(2);
  ASSERT_EQ(backend.measure_each(pairs(s), s.contacts, out), status::ok);
  context->simulate_loss();
  out.assign(2, {.depth_m = 1.0});
  EXPECT_EQ(backend.measure_each(pairs(s), s.contacts, out), status::backend_failed);
  for (const penetration& p : out) expect_nothing(p);
  EXPECT_FALSE(compute_depth::make(context, s.bodies, soft));
}

TEST_F(GlComputeDepth, ADeviceThatDoesNotAnswerInTimeIsAFailure) {
  const seeded_contacts s = test_support::make_seeded_contacts(12, 1, 1, 64, 200);
  compute_depth backend = make(s.bodies, soft, {.contacts = 200, .timeout_ns = 0});
  std::vector<penetration> out(200, {.depth_m = 1.0});
  const status said = backend.measure_each(pairs(s), s.contacts, out);
  context->gl().Finish();
  if (said == status::ok) GTEST_SKIP() << "this driver is done before anybody can ask";
  EXPECT_EQ(said, status::backend_failed);
  for (const penetration& p : out) expect_nothing(p);
}

TEST_F(GlComputeDepth, BelongsToTheThreadThatHasTheContext) {
  const seeded_contacts s = test_support::make_seeded_contacts(13, 1, 1, 64, 1);
  context->release();
  compute_depth backend = make(s.bodies, soft);
  EXPECT_FALSE(context->is_current()) << "making a backend takes the context from nobody";
  penetration here, there, elsewhere{.depth_m = 1.0};
  std::thread([&] { EXPECT_EQ(backend.measure_each(pairs(s), s.contacts, std::span(&there, 1)), status::ok); }).join();
  ASSERT_EQ(backend.measure_each(pairs(s), s.contacts, std::span(&here, 1)), status::ok);
  expect_same_bits(here, there);
  std::thread([&] {
    EXPECT_EQ(backend.measure_each(pairs(s), s.contacts, std::span(&elsewhere, 1)), status::backend_failed);
  }).join();
  expect_nothing(elsewhere);
}

TEST_F(GlComputeDepth, ThreadsWithContextsOfTheirOwnDoNotDisturbEachOther) {
  const seeded_contacts s = test_support::make_seeded_contacts(18, 2, 1, 64, 4);
  const auto at = pairs(s);
  std::array<std::array<penetration, 4>, 3> found;
  std::vector<std::thread> threads;
  for (auto& mine : found) {
    threads.emplace_back([&] {
      const auto own = open_context();
      if (!own) return;
      auto backend = compute_depth::make(*own, s.bodies, soft);
      for (int i = 0; backend && i < 5; ++i) EXPECT_EQ(backend->measure_each(at, s.contacts, mine), status::ok);
    });
  }
  for (std::thread& t : threads) t.join();
  EXPECT_GT(found[0][0].samples + found[0][1].samples, 0U);
  for (std::size_t i = 0; i < 4; ++i) {
    expect_same_bits(found[1][i], found[0][i]);
    expect_same_bits(found[2][i], found[0][i]);
  }
}

TEST_F(GlComputeDepth, BrokenTexelsAreLeftOutAsOnTheCpu) {
  seeded_contacts s = test_support::make_seeded_contacts(14, 2, 1, 64, 24);
  auto probe = std::make_shared<textured_model>(*s.bodies.probe);
  auto fixed = std::make_shared<textured_model>(*s.bodies.fixed[0]);
  for (auto* const m : {probe.get(), fixed.get()}) {
    const std::size_t middle = std::size_t{30} * m->texture.width + 30;
    for (std::size_t i = 0; i < 3; ++i) m->texture.texels[middle + i].z = std::numeric_limits<float>::quiet_NaN();
  }
  s.bodies = {probe, {fixed}};
  for (const window_depth_settings& settings : {soft, differences}) {
    compute_depth backend = make(s.bodies, settings, {.contacts = 24});
    cpu_depth reference(s.bodies, settings);
    std::vector<penetration> found(24);
    ASSERT_EQ(backend.measure_each(pairs(s), s.contacts, found), status::ok);
    const auto wanted = test_support::measure_one_by_one(reference, s);
    std::size_t broken = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].flags, wanted[i].flags) << i;
      EXPECT_EQ(found[i].samples, wanted[i].samples) << i;
      EXPECT_NEAR(found[i].depth_m, wanted[i].depth_m, 1e-8);
      if (has(wanted[i].flags, depth_flag::bad_texel)) ++broken;
    }
    EXPECT_GT(broken, 2U);
  }
}

TEST_F(GlComputeDepth, EverySettingMeansWhatItMeansOnTheCpu) {
  const seeded_contacts s = test_support::make_seeded_contacts(15, 3, 2, 128, 12);
  const std::array<window_depth_settings, 4> all{
      {{.grid = 16, .tau_m = 5e-5, .reference_area_m2 = 1e-7, .taper_m = 1e-3, .facing_cosine = 0.45},
       {.grid = 17, .taper_silhouettes = false, .taper_window = false},
       {.grid = 16, .taper_gradient = false},
       {.gradient = gradient_scheme::central_difference,
        .grid = 16,
        .difference_step_m = 2e-5,
        .origin = rotation_origin::centre_of_mass}}};
  for (const window_depth_settings& settings : all) {
    compute_depth backend = make(s.bodies, settings);
    cpu_depth reference(s.bodies, settings);
    std::vector<penetration> found(12);
    ASSERT_EQ(backend.measure_each(pairs(s), s.contacts, found), status::ok);
    const auto wanted = test_support::measure_one_by_one(reference, s);
    const double bound = backend.arithmetic() == arithmetic::double_precision ? 1e-5 : 1e-2;
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].flags, wanted[i].flags);
      EXPECT_NEAR(found[i].soft_depth_m, wanted[i].soft_depth_m, 1e-8);
      const vec6 d = found[i].gradient - wanted[i].gradient;
      for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(d[k], 0.0, bound);
    }
  }
}

TEST_F(GlComputeDepth, ContactsWithSeveralBodiesFindTheirTextures) {
  const seeded_contacts one = test_support::make_seeded_contacts(16, 1, 1, 64, 1);
  const seeded_contacts two = test_support::make_seeded_contacts(17, 1, 1, 96, 1);
  const scene both{one.bodies.probe, {one.bodies.fixed[0], two.bodies.fixed[0]}};
  // Contacts in an order that is not that of their bodies, at poses that press the probe onto either body.
  contact_set contacts;
  const std::array<pose, 2> T_wb{one.T_wb[0], one.T_wb[0]};
  for (const std::uint32_t body : {1U, 0U, 1U}) {
    contact c = one.contacts.contacts()[0];
    c.body = body;
    ASSERT_TRUE(
        contacts.add(c, test_support::all_triangles(*both.probe), test_support::all_triangles(*both.fixed[body])));
  }
  compute_depth backend = make(both, soft);
  cpu_depth reference(both, soft);
  std::array<penetration, 3> found, wanted;
  ASSERT_EQ(backend.measure({one.T_wa[0], T_wb}, contacts, found), status::ok);
  ASSERT_EQ(reference.measure({one.T_wa[0], T_wb}, contacts, wanted), status::ok);
  EXPECT_NE(wanted[0].depth_m, wanted[1].depth_m);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(found[i].depth_m, wanted[i].depth_m, 1e-8);
  expect_same_bits(found[0], found[2]);
}

}  // namespace
}  // namespace asperity::gl
