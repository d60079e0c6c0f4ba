#include <algorithm>
#include <gtest/gtest.h>
#include <limits>

#include <asperity/device/sample_check.hpp>

namespace {

using namespace asperity;

constexpr std::int64_t ms = 1'000'000;

device_sample good(std::int64_t time_ns, double x = 0.0) {
  device_sample s;
  s.host_time_ns = time_ns;
  s.T_dh.position.x = x;
  s.valid = sample_field::position | sample_field::rotation;
  return s;
}

TEST(sample_check, accepts_a_good_sample) {
  sample_check check;
  EXPECT_EQ(check.judge(0, status::ok, good(0)), sample_verdict::accepted);
  EXPECT_EQ(check.rejected(), 0U);
}

TEST(sample_check, names_what_is_wrong) {
  sample_check check;
  device_sample s = good(0);
  s.T_dh.position.y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(check.judge(0, status::ok, s), sample_verdict::not_finite);
  s = good(0);
  s.T_dh.rotation.w = std::numeric_limits<double>::infinity();
  EXPECT_EQ(check.judge(0, status::ok, s), sample_verdict::not_finite);
  s = good(0);
  s.T_dh.rotation = {0.0, 0.0, 0.0, 0.0};
  EXPECT_EQ(check.judge(0, status::ok, s), sample_verdict::not_unit);
  s = good(0);
  s.valid = sample_field::buttons;
  EXPECT_EQ(check.judge(0, status::ok, s), sample_verdict::not_measured);
  EXPECT_EQ(check.judge(0, status::backend_failed, good(0)), sample_verdict::no_answer);
  EXPECT_EQ(check.rejected(), 5U);
  EXPECT_TRUE(check.exhausted());
}

TEST(sample_check, lets_a_sample_grow_as_old_as_its_limit) {
  sample_check check;
  EXPECT_EQ(check.judge(20 * ms, status::ok, good(0)), sample_verdict::accepted);
  EXPECT_EQ(check.judge(20 * ms + 1, status::ok, good(0)), sample_verdict::stale);
}

// A stamp from ahead would never grow old, and would excuse a jump of any length. Found by simulation.
TEST(sample_check, believes_no_stamp_from_ahead) {
  constexpr std::int64_t least = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t most = std::numeric_limits<std::int64_t>::max();
  sample_check check;
  EXPECT_EQ(check.judge(0, status::ok, good(20 * ms)), sample_verdict::accepted);
  EXPECT_EQ(check.judge(0, status::ok, good(20 * ms + 1)), sample_verdict::stale);
  for (const std::int64_t now_ns : {least, std::int64_t{-1}, std::int64_t{0}, most}) {
    for (const std::int64_t stamp_ns : {least, most}) {
      const sample_verdict v = sample_check().judge(now_ns, status::ok, good(stamp_ns));
      EXPECT_EQ(v, now_ns == stamp_ns ? sample_verdict::accepted : sample_verdict::stale);
    }
  }
}

TEST(sample_check, finds_a_jump_and_a_spin) {
  sample_check check;
  ASSERT_EQ(check.judge(0, status::ok, good(0)), sample_verdict::accepted);
  EXPECT_EQ(check.judge(ms, status::ok, good(ms, 0.0099)), sample_verdict::accepted);
  EXPECT_EQ(check.judge(2 * ms, status::ok, good(2 * ms, 0.5)), sample_verdict::jump);
  device_sample spun = good(3 * ms, 0.0099);
  spun.T_dh.rotation = exp_rotation({0, 0, 1.0});
  EXPECT_EQ(check.judge(3 * ms, status::ok, spun), sample_verdict::jump);
  EXPECT_EQ(check.judge(4 * ms, status::ok, good(4 * ms, 0.01)), sample_verdict::accepted);
  check.restart();
  EXPECT_EQ(check.judge(5 * ms, status::ok, good(5 * ms, 0.5)), sample_verdict::accepted);
}

// 10 m/s and 100 rad/s by default, over the time between two stamps, and never over less than a millisecond.
TEST(sample_check, a_jump_begins_where_a_hand_ends) {
  for (const std::int64_t apart_ns : {std::int64_t{0}, ms / 2, ms, 5 * ms}) {
    const double most_s = std::max(1e-3, static_cast<double>(apart_ns) * 1e-9);
    for (const double share : {0.99, 1.01}) {
      const sample_verdict due = share < 1.0 ? sample_verdict::accepted : sample_verdict::jump;
      sample_check moved;
      ASSERT_EQ(moved.judge(0, status::ok, good(0)), sample_verdict::accepted);
      EXPECT_EQ(moved.judge(apart_ns, status::ok, good(apart_ns, share * 10.0 * most_s)), due) << apart_ns;
      sample_check turned;
      ASSERT_EQ(turned.judge(0, status::ok, good(0)), sample_verdict::accepted);
      device_sample s = good(apart_ns);
      s.T_dh.rotation = exp_rotation({0.0, share * 100.0 * most_s, 0.0});
      EXPECT_EQ(turned.judge(apart_ns, status::ok, s), due) << apart_ns;
    }
  }
}

TEST(sample_check, is_exhausted_by_rejections_in_a_row_only) {
  sample_check check;
  for (int i = 0; i < 4; ++i) static_cast<void>(check.judge(0, status::backend_failed, good(0)));
  EXPECT_FALSE(check.exhausted());
  static_cast<void>(check.judge(0, status::ok, good(0)));
  for (int i = 0; i < 4; ++i) static_cast<void>(check.judge(0, status::backend_failed, good(0)));
  EXPECT_FALSE(check.exhausted());
  static_cast<void>(check.judge(0, status::backend_failed, good(0)));
  EXPECT_TRUE(check.exhausted());
}

}  // namespace
