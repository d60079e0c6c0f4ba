#include "asperity/core/triple_buffer.hpp"

#include <array>
#include <atomic>
#include <cstdint>
#include <gtest/gtest.h>
#include <thread>

namespace {

TEST(triple_buffer, gives_nothing_before_the_first_publish) {
  asperity::triple_buffer<int> b;
  EXPECT_FALSE(b.refresh());
  EXPECT_EQ(b.front(), 0);
}

TEST(triple_buffer, newest_wins_and_is_given_once) {
  asperity::triple_buffer<int> b;
  for (int i = 1; i <= 3; ++i) {
    b.back() = i;
    b.publish();
  }
  ASSERT_TRUE(b.refresh());
  EXPECT_EQ(b.front(), 3);
  EXPECT_FALSE(b.refresh());
  EXPECT_EQ(b.front(), 3);
}

// A payload wide enough that a torn read shows: all words carry the same number.
struct payload {
  std::array<std::uint64_t, 56> words{};
};

TEST(triple_buffer, two_threads_never_see_a_torn_or_an_older_value) {
  constexpr std::uint64_t count = 200'000;
  asperity::triple_buffer<payload> b;
  std::atomic<bool> done = false;
  std::thread producer([&] {
    for (std::uint64_t i = 1; i <= count; ++i) {
      b.back().words.fill(i);
      b.publish();
    }
    done.store(true, std::memory_order_release);
  });
  std::uint64_t last = 0;
  std::uint64_t torn = 0;
  std::uint64_t backwards = 0;
  for (bool finished = false; !finished;) {
    finished = done.load(std::memory_order_acquire);  // read before the last refresh, so that the last value is seen
    if (!b.refresh()) continue;
    const auto& words = b.front().words;
    for (const std::uint64_t w : words) torn += w != words[0];
    backwards += words[0] <= last;
    last = words[0];
  }
  producer.join();
  EXPECT_EQ(torn, 0U);
  EXPECT_EQ(backwards, 0U);
  EXPECT_EQ(last, count);
}

}  // namespace
