// Received frames of every kind, in every state: no crash, no allocation, no torque that was not asked for.
#include <cstdint>
#include <random>
#include <string>

#include "hardware/joints/rig.hpp"
#include "support/counted_news.hpp"

namespace asperity::test_support {
namespace {

template <class Kind>
class HostileFrames : public ::testing::Test {};
TYPED_TEST_SUITE(HostileFrames, every_kind);

// Frames that look right at first: the ids of this bus, sizes up to what a byte holds.
can_frame make_hostile(std::mt19937_64& bits) {
  constexpr std::uint32_t ids[] = {
      0,     0,      0,    0, 1, 3U << 5U, 3U << 5U | 1, 3U << 5U | 3, 3U << 5U | 9, 3U << 5U | 0x14, 3U << 5U | 0x1c,
      0x100, 0x8001, 0x7ff};
  can_frame f;
  f.id = bits() % 8 == 0 ? static_cast<std::uint32_t>(bits()) : ids[bits() % std::size(ids)];
  f.extended = bits() % 8 == 0;
  f.remote = bits() % 16 == 0;
  f.fd = bits() % 4 == 0;
  f.size = bits() % 4 == 0 ? static_cast<std::uint8_t>(bits()) : static_cast<std::uint8_t>(bits() % 9);
  for (auto& b : f.data) b = static_cast<std::uint8_t>(bits());
  if (bits() % 2 == 0) f.data[0] = 1;
  if (bits() % 4 == 0) {
    constexpr std::uint8_t reply[] = {0x21, 0x00, 0x0a, 0x2f, 0x01, 0, 0, 0,    0,    0,
                                      0,    0,    0,    0,    0,    0, 0, 0x21, 0x0f, 0x00};
    f.id = 0x100;
    f.fd = true;
    f.size = 20;
    std::copy(std::begin(reply), std::end(reply), f.data.begin());
    f.data[bits() % 20] = static_cast<std::uint8_t>(bits());
  }
  f.host_time_ns = static_cast<std::int64_t>(bits());
  return f;
}

template <class Kind>
void into(rig<Kind>& r, drive_state wanted) {
  switch (wanted) {
    case drive_state::silent:
      break;
    case drive_state::starting:
      r.drive.start(r.clock.now_ns());
      break;
    case drive_state::idle:
      ASSERT_TRUE(r.bring_up());
      break;
    case drive_state::enabled:
      ASSERT_TRUE(r.go(10.0));
      break;
    case drive_state::fault:
      ASSERT_TRUE(r.go(10.0));
      r.feeding = false;
      ASSERT_TRUE(r.run_until(drive_state::fault));
      break;
  }
}

TYPED_TEST(HostileFrames, bring_nothing_about_but_faults) {
  std::uint64_t taken = 0;
  std::size_t news = 0;
  for (const drive_state from :
       {drive_state::silent, drive_state::starting, drive_state::idle, drive_state::enabled, drive_state::fault}) {
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      rig<TypeParam> r;
      into(r, from);
      const int enables = r.peer.enables();
      std::mt19937_64 bits(seed);
      for (int i = 0; i < 300; ++i) {
        const can_frame f = make_hostile(bits);
        const std::size_t before = news_in_this_thread();
        taken += r.drive.take(r.clock.now_ns(), f) ? 1U : 0U;
        news += news_in_this_thread() - before;
        const joint_reading& now = r.drive.reading();
        ASSERT_TRUE(std::isfinite(now.position_rad) && std::isfinite(now.velocity_rad_per_s) &&
                    std::isfinite(now.torque_n_m));
        if (i % 8 == 7) r.tick();
      }
      if (from == drive_state::silent || from == drive_state::fault) {
        EXPECT_EQ(r.drive.state(), from);
      }
      if (from != drive_state::enabled) {
        EXPECT_NE(r.drive.state(), drive_state::enabled);
      }
      if (r.drive.state() == drive_state::fault) {
        EXPECT_STRNE(r.drive.fault().what, "none");
      }
      r.drive.disable(r.clock.now_ns());
      r.run(30 * ms);
      EXPECT_TRUE(r.is_limp()) << TypeParam::name << " seed " << seed;
      EXPECT_EQ(r.peer.enables(), enables);
    }
  }
  EXPECT_GT(taken, 3'000U) << "the frames reach the parsers";
  EXPECT_EQ(news, 0U);
}

}  // namespace
}  // namespace asperity::test_support
