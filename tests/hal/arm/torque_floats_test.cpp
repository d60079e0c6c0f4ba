// Every float there is, as a torque, through the encoder of object 6071.
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <gtest/gtest.h>

#include "asperity/hal/canopen/cia402.hpp"

namespace {

using namespace asperity::canopen;

TEST(torque_encoder, no_float_is_over_its_limit_or_has_another_sign) {
  constexpr double rated_n_m = 0.37;
  constexpr std::int16_t limit = 2900;
  constexpr double most_n_m = rated_n_m * limit / 1000.0;
  std::uint64_t over = 0;
  std::uint64_t sign = 0;
  std::uint64_t larger = 0;
  std::uint64_t far = 0;
  std::uint64_t not_a_number = 0;
  for (std::uint64_t i = 0; i < (std::uint64_t{1} << 32); ++i) {
    const double x = std::bit_cast<float>(static_cast<std::uint32_t>(i));
    const int n = encode_torque(x, rated_n_m, limit);
    over += static_cast<std::uint64_t>(n > limit) + static_cast<std::uint64_t>(n < -limit);
    if (x != x) {
      not_a_number += static_cast<std::uint64_t>(n != 0);
      continue;
    }
    // Nearly all floats end at 0 or at the limit: there the decoder need not be asked.
    const double back = n == 0                 ? 0.0
                        : std::abs(n) == limit ? std::copysign(most_n_m, n)
                                               : decode_torque(static_cast<std::int16_t>(n), rated_n_m);
    const double asked = std::fabs(x) > most_n_m ? std::copysign(most_n_m, x) : x;
    sign += static_cast<std::uint64_t>(x > 0.0 ? n < 0 : n > 0);
    larger += static_cast<std::uint64_t>(std::fabs(back) > std::fabs(asked));
    far += static_cast<std::uint64_t>(std::fabs(asked - back) > 1.0001 * rated_n_m / 1000.0);
  }
  EXPECT_EQ(over, 0U);
  EXPECT_EQ(sign, 0U);
  EXPECT_EQ(larger, 0U);
  EXPECT_EQ(far, 0U);
  EXPECT_EQ(not_a_number, 0U);
}

}  // namespace
