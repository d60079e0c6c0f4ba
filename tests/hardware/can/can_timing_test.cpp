// How long frames hold the bus.
#include "asperity/transport/can_timing.hpp"

#include <cstdint>
#include <gtest/gtest.h>

#include "asperity/transport/can_length.hpp"

namespace asperity::can_timing_test {
namespace {

constexpr can_bit_rates rates{.nominal_per_s = 1'000'000, .data_per_s = 5'000'000};

can_frame sized(std::uint8_t size, bool extended, bool fd = false) {
  can_frame f;
  f.size = size;
  f.extended = extended;
  f.fd = f.bit_rate_switch = fd;
  return f;
}

TEST(can_timing, classic_frames_have_the_published_bounds) {
  // 55 to 135 bits with short identifiers, 80 to 160 with long ones.
  EXPECT_EQ(longest_time_ns(sized(0, false), rates), 55'000);
  EXPECT_EQ(longest_time_ns(sized(8, false), rates), 135'000);
  EXPECT_EQ(longest_time_ns(sized(0, true), rates), 80'000);
  EXPECT_EQ(longest_time_ns(sized(8, true), rates), 160'000);
  EXPECT_EQ(longest_time_ns(sized(8, false), {.nominal_per_s = 500'000}), 270'000);
  can_frame remote = sized(8, false);
  remote.remote = true;
  EXPECT_EQ(longest_time_ns(remote, rates), 55'000);
}

// An FD frame counted bit by bit from the worst pattern for stuffing: five equal bits, then four of the other value
// after each stuff bit, from the first bit to the last of the data.
std::int64_t counted_ns(const can_frame& f) {
  const int head = f.extended ? 36 : 17;
  const int stuffed_over = head + 5 + 8 * f.size;
  std::int64_t ns = 0;
  int run = 0;
  for (int bit = 0; bit < stuffed_over; ++bit) {
    const std::int64_t bit_ns = bit < head ? 1000 : 200;
    ns += bit_ns;
    if (++run == 5) {
      if (bit + 1 < stuffed_over) ns += bit + 1 < head ? 1000 : 200;
      run = 1;
    }
  }
  const int check = f.size <= 16 ? 21 : 25;
  for (int bit = 0; bit < check; ++bit) ns += bit % 4 == 0 ? 400 : 200;  // a fixed stuff bit before every four
  return ns + 13 * 1000;
}

TEST(can_timing, fd_frames_are_bounded_by_the_worst_pattern_and_not_far_above_it) {
  for (const bool extended : {false, true}) {
    std::int64_t before = 0;
    for (std::uint8_t size = 0; size <= 64; ++size) {
      if (can_fd_length(size) != size) continue;
      const can_frame f = sized(size, extended, true);
      const std::int64_t t = longest_time_ns(f, rates);
      EXPECT_GE(t, counted_ns(f)) << +size;
      EXPECT_LE(t, counted_ns(f) + 1200) << +size;
      EXPECT_GT(t, before);
      before = t;
    }
  }
  can_frame slow = sized(8, false, true);
  slow.bit_rate_switch = false;
  EXPECT_EQ(longest_time_ns(slow, rates), longest_time_ns(slow, {.nominal_per_s = 1'000'000, .data_per_s = 1}));
  EXPECT_GT(longest_time_ns(slow, rates), longest_time_ns(sized(8, false, true), rates));
}

}  // namespace
}  // namespace asperity::can_timing_test
