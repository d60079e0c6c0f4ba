// Backends chosen at run time, and what happens in the tick in which one fails.
#include "asperity/window/any_depth.hpp"

#include <gtest/gtest.h>
#include <vector>

#include "asperity/window/cpu_depth.hpp"
#include "asperity/window/fallback_depth.hpp"
#include "support/height_models.hpp"

namespace asperity {
namespace {

using namespace test_support;

scene two_plates() {
  plate_spec a, b;
  a.half_x = a.half_y = 0.005;
  a.texels = b.texels = 64;
  a.height = [](double x, double y) { return 1e-4 * std::cos(2000.0 * x) * std::cos(1500.0 * y); };
  return {make_plate(a), {make_plate(b)}};
}

const pose pressed{face_down(), {1e-4, 0.0, -2e-4}};

template <class Backend>
penetration press(Backend& backend, const scene& s, status expected = status::ok) {
  const contact_set contacts = whole_contact(s, window_downwards(4e-3));
  const pose T_wb;
  penetration out;
  EXPECT_EQ(backend.measure({pressed, std::span(&T_wb, 1)}, contacts, std::span(&out, 1)), expected);
  return out;
}

void expect_same_bits(const penetration& a, const penetration& b) {
  EXPECT_EQ(a.depth_m, b.depth_m);
  EXPECT_EQ(a.samples, b.samples);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(a.gradient[i], b.gradient[i]);
}

/// Answers what the script says, one status per call, the last one for ever. Leaves a depth of its own behind.
struct scripted_depth {
  using policy_tag = depth_tag;
  std::vector<status> script{status::ok};
  std::size_t calls = 0;
  [[nodiscard]] status measure(const scene_pose&, const contact_set&, std::span<penetration> out) noexcept {
    const status s = script[std::min(calls++, script.size() - 1)];
    for (penetration& p : out) p = {.depth_m = s == status::ok ? 1.0 : 666.0};
    return s;
  }
};

TEST(AnyDepth, AnswersAsTheBackendInside) {
  const scene s = two_plates();
  cpu_depth plain(s);
  any_depth erased{cpu_depth(s)};
  expect_same_bits(press(erased, s), press(plain, s));
  EXPECT_GT(press(plain, s).depth_m, 1e-4);
  any_depth failing{scripted_depth{{status::backend_failed}}};
  static_cast<void>(press(failing, s, status::backend_failed));
}

TEST(AnyDepth, MovesWithWhatItOwnsAndCanBeReplaced) {
  const scene s = two_plates();
  any_depth first{scripted_depth{}};
  any_depth second = std::move(first);
  EXPECT_EQ(press(second, s).depth_m, 1.0);
  second = any_depth{cpu_depth(s)};
  cpu_depth plain(s);
  expect_same_bits(press(second, s), press(plain, s));
}

TEST(AnyDepth, CountsWhatItHolds) {
  const scene s = two_plates();
  const cpu_depth plain(s);
  EXPECT_EQ(any_depth{cpu_depth(s)}.heap_bytes(), sizeof(cpu_depth) + plain.heap_bytes());
  EXPECT_EQ(any_depth{scripted_depth{}}.heap_bytes(), sizeof(scripted_depth));
}

TEST(FallbackDepth, TheSecondBackendAnswersInTheTickInWhichTheFirstFails) {
  const scene s = two_plates();
  cpu_depth plain(s);
  for (const status failure : {status::backend_failed, status::capacity_reached}) {
    fallback_depth backend(scripted_depth{{status::ok, failure, status::ok}}, cpu_depth(s));
    EXPECT_EQ(press(backend, s).depth_m, 1.0);
    expect_same_bits(press(backend, s), press(plain, s));
    EXPECT_EQ(press(backend, s).depth_m, 1.0);
    EXPECT_EQ(backend.counted().ticks, 3U);
    EXPECT_EQ(backend.counted().fallbacks, 1U);
    EXPECT_FALSE(backend.counted().gave_up);
  }
}

TEST(FallbackDepth, WhatNoBackendCanMeasureIsNotAskedTwice) {
  const scene s = two_plates();
  for (const status fault : {status::not_ready, status::not_finite, status::invalid_pose}) {
    fallback_depth backend(scripted_depth{{fault}}, scripted_depth{});
    static_cast<void>(press(backend, s, fault));
    EXPECT_EQ(backend.second().calls, 0U);
    EXPECT_EQ(backend.counted().fallbacks, 0U);
  }
}

TEST(FallbackDepth, ABackendThatIsGoneIsGivenUpUntilSomebodyRetries) {
  const scene s = two_plates();
  fallback_depth backend(scripted_depth{{status::backend_failed}}, scripted_depth{});
  using type = decltype(backend);
  for (std::uint32_t i = 0; i < type::give_up_after + 5; ++i) EXPECT_EQ(press(backend, s).depth_m, 1.0);
  EXPECT_EQ(backend.first().calls, type::give_up_after);
  EXPECT_EQ(backend.counted().fallbacks, type::give_up_after + 5);
  EXPECT_TRUE(backend.counted().gave_up);
  backend.first().script = {status::ok};
  backend.retry();
  static_cast<void>(press(backend, s));
  EXPECT_EQ(backend.first().calls, type::give_up_after + 1);
  EXPECT_FALSE(backend.counted().gave_up);
}

TEST(FallbackDepth, TooManyContactsDoNotMakeItGiveUp) {
  const scene s = two_plates();
  fallback_depth backend(scripted_depth{{status::capacity_reached}}, scripted_depth{});
  for (int i = 0; i < 20; ++i) static_cast<void>(press(backend, s));
  EXPECT_EQ(backend.first().calls, 20U);
  EXPECT_FALSE(backend.counted().gave_up);
}

TEST(FallbackDepth, WhereBothFailTheTickFails) {
  const scene s = two_plates();
  fallback_depth backend(scripted_depth{{status::backend_failed}}, scripted_depth{{status::backend_failed}});
  static_cast<void>(press(backend, s, status::backend_failed));
}

}  // namespace
}  // namespace asperity
