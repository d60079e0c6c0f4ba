#include "asperity/core/triple_buffer.hpp"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <gtest/gtest.h>
#include <iostream>
#include <thread>

#include "unit/core/hand_over_variants.hpp"

namespace {

using asperity::test_support::relaxed_word;
using asperity::test_support::two_slot_buffer;
using asperity::test_support::wide_payload;

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

struct seen {
  std::uint64_t values = 0;     ///< taken by the consumer
  std::uint64_t torn = 0;       ///< words that differ from the first of their value
  std::uint64_t backwards = 0;  ///< values not newer than the one before
  std::uint64_t last = 0;
};

/// A producer publishes 1 to `count`, every word of a value the same, and runs at most `lead` values ahead, so that
/// both threads stay at work however they are scheduled. Now and then the consumer stops in the middle of reading until
/// the producer has gone on by four values: a slot that is not the consumer's own is torn for certain, not by luck.
/// What the threads tell each other for this is relaxed, or it would order what the buffer has to order.
template <class Buffer>
seen stress(std::uint64_t count) {
  constexpr std::uint64_t lead = 1024;
  static Buffer buffer;  // not a local: the sanitizer of Clang 14 takes those for the thread's own
  std::atomic<std::uint64_t> published = 0;
  std::atomic<std::uint64_t> taken = 0;
  std::thread producer([&] {
    for (std::uint64_t i = 1; i <= count; ++i) {
      while (i > taken.load(std::memory_order_relaxed) + lead) std::this_thread::yield();
      for (auto& word : buffer.back().words) word = i;
      buffer.publish();
      published.store(i, std::memory_order_relaxed);
    }
  });
  seen out;
  std::uint64_t idle = 0;
  for (bool finished = false; !finished;) {
    finished = published.load(std::memory_order_relaxed) == count;  // before refresh(), so that the last value is seen
    if (!buffer.refresh()) {
      // Where both threads share a core, polling alone would use up the time that the producer needs.
      if (++idle % 1024 == 0) std::this_thread::yield();
      continue;
    }
    const auto& words = buffer.front().words;
    const std::uint64_t first = words[0];
    taken.store(first, std::memory_order_relaxed);
    if (out.values % 1024 == 0) {
      const std::uint64_t later = std::min(first + 4, count);
      while (published.load(std::memory_order_relaxed) < later) std::this_thread::yield();
    }
    for (const std::uint64_t word : words) out.torn += word != first;
    out.backwards += first <= out.last;
    out.last = first;
    ++out.values;
  }
  producer.join();
  return out;
}

TEST(triple_buffer, two_threads_never_see_a_torn_or_an_older_value) {
  constexpr std::uint64_t count = 1'000'000;
  const seen out = stress<asperity::triple_buffer<wide_payload<std::uint64_t>>>(count);
  std::cout << out.values << " of " << count << " values taken\n";
  EXPECT_EQ(out.torn, 0U);
  EXPECT_EQ(out.backwards, 0U);
  EXPECT_EQ(out.last, count);
}

TEST(triple_buffer, the_same_threads_see_two_slots_tear) {
  EXPECT_GT((stress<two_slot_buffer<wide_payload<relaxed_word>>>(5000).torn), 0U);
}

}  // namespace
