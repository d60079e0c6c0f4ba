// Every float there is becomes counts of a motor: within the limit, never with another sign, never out of order.
#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <thread>
#include <vector>

#include "asperity/hal/falcon/falcon_frame.hpp"

namespace {

using namespace asperity;

// What is wrong with the counts of all floats with these patterns of bits, both signs: 0 where nothing is.
std::uint64_t wrong_between(std::uint32_t first, std::uint32_t last) {
  std::uint64_t wrong = 0;
  int before = falcon_motor_counts(std::bit_cast<float>(first));
  for (std::uint32_t bits = first; bits != last; ++bits) {
    const auto x = static_cast<double>(std::bit_cast<float>(bits));
    const auto minus_x = static_cast<double>(std::bit_cast<float>(bits | 0x8000'0000U));
    const int up = falcon_motor_counts(x);
    const int down = falcon_motor_counts(minus_x);
    if (bits > 0x7f80'0000U) {  // NaN
      wrong += up != 0 || down != 0;
      continue;
    }
    // Patterns of positive floats are in the order of their values, so that each is compared with its neighbour.
    const bool in_range = up >= 0 && up <= 4096;
    const bool ordered = up >= before;
    const bool mirrored = down == -up;
    const bool near = x > 4096.0 ? up == 4096 : std::fabs(up - x) <= 0.5;
    wrong += !(in_range && ordered && mirrored && near);
    before = up;
  }
  return wrong;
}

TEST(falcon_floats, all_of_them) {
  constexpr std::uint32_t blocks = 2048;
  constexpr std::uint32_t per_block = 0x8000'0000U / blocks;
  std::atomic<std::uint32_t> next{0};
  std::atomic<std::uint64_t> wrong{0};
  std::atomic<std::uint64_t> seen{0};
  const auto work = [&] {
    for (std::uint32_t b = next++; b < blocks; b = next++) {
      wrong += wrong_between(b * per_block, (b + 1) * per_block);
      seen += 2ULL * per_block;
    }
  };
  std::vector<std::thread> threads;
  for (unsigned i = 0; i < std::max(1U, std::thread::hardware_concurrency()); ++i) threads.emplace_back(work);
  for (std::thread& t : threads) t.join();
  EXPECT_EQ(seen, 1ULL << 32);
  EXPECT_EQ(wrong, 0U);
}

// From there on there are 65536 numbers: falcon_frame.every_number_saturates_on_every_motor_and_comes_back.

}  // namespace
