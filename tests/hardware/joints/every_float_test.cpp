// Every encoder of a torque, over the bit patterns of a float: never over the limit, never of the wrong sign, not more
// than was asked for and, within the limit, less than one step short of it.
#include "support/every_float.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <gtest/gtest.h>

#include "asperity/drivers/canopen/cia402.hpp"
#include "asperity/drivers/falcon/falcon_frame.hpp"
#include "asperity/drivers/joint/wire_number.hpp"
#include "asperity/drivers/mit/mit_codec.hpp"
#include "asperity/drivers/moteus/moteus_codec.hpp"

namespace asperity {
namespace {

using namespace test_support;

// Both signs of the sizes in which the result changes, from `least` to `most`, and every 997th of all other patterns.
template <class Encode, class Fair>
std::uint64_t refused_around(double least, double most, const Encode& encode, const Fair& fair) {
  const std::uint64_t from = std::bit_cast<std::uint32_t>(static_cast<float>(least));
  const std::uint64_t to = std::bit_cast<std::uint32_t>(static_cast<float>(most));
  std::uint64_t bad = refused(from, to, encode, fair) + refused(float_sign + from, float_sign + to, encode, fair);
  for (std::uint64_t bits = 0; bits < all_floats; bits += 997) {
    bad += fair(float_of(bits), encode(float_of(bits))) ? 0U : 1U;
  }
  return bad;
}

// `loss`: how much less may be sent; `least`: what may be sent though less was asked for.
bool is_fair(double asked, double sent, double limit, double loss, double least) {
  if (!(std::fabs(sent) <= limit)) return false;
  if (!std::isfinite(asked) || asked == 0.0) return std::fabs(sent) <= least;
  const bool sign = sent == 0.0 || (sent > 0.0) == (asked > 0.0);
  const double most = std::fmin(std::fabs(asked), limit);
  return sign && std::fabs(sent) <= std::fmax(std::fabs(asked), least) && most - std::fabs(sent) <= loss;
}

// The torque of one integer, in float as motorcontrol computes it.
double drive_torque(std::uint16_t wire, const mit::ranges& r) {
  const auto low = static_cast<float>(-r.torque_n_m);
  const float span = static_cast<float>(r.torque_n_m) - low;
  return static_cast<double>(static_cast<float>(wire) * span / 4095.0F + low);
}

// In exact numbers, what the document says; as the drive's float has it, the limit and the sign.
bool is_fair_to_mit(double asked, std::uint16_t wire, const mit::ranges& r, double limit) {
  if (asked == 0.0 || !std::isfinite(asked)) return wire == 2047;
  const double half_step = r.torque_n_m / 4095.0;
  const double exact = (2.0 * wire - 4095.0) * half_step;
  const double in_drive = drive_torque(wire, r);
  return wire <= 4095 && std::fabs(in_drive) <= limit && (in_drive > 0.0) == (asked > 0.0) &&
         is_fair(asked, exact / (1.0 + 1e-15), limit, 2.0 * half_step * (1.0 + 1e-9), half_step);
}

TEST(EveryFloat, mit_torque) {
  const mit::symmetric_field field(mit::ak80_9.torque_n_m, 12, 18.0);
  EXPECT_EQ(refused(
                0, all_floats, [field](double t) { return field.encode(t); },
                [](double asked, std::uint16_t wire) { return is_fair_to_mit(asked, wire, mit::ak80_9, 18.0); }),
            0U);
}

// The same code with other constants, and with a limit inside the range.
TEST(EveryFloat, mit_torque_of_the_other_tables) {
  const auto bad = [](const mit::ranges& r, double limit) {
    const mit::symmetric_field field(r.torque_n_m, 12, limit);
    return refused_around(
        r.torque_n_m / 8192.0, r.torque_n_m * 1.01, [field](double t) { return field.encode(t); },
        [&](double asked, std::uint16_t wire) { return is_fair_to_mit(asked, wire, r, limit); });
  };
  EXPECT_EQ(bad(mit::ak10_9, 65.0), 0U);
  EXPECT_EQ(bad(mit::ak60_6, 15.0), 0U);
  EXPECT_EQ(bad(mit::ak70_10, 25.0), 0U);
  EXPECT_EQ(bad(mit::ak80_6, 12.0), 0U);
  EXPECT_EQ(bad(mit::ak80_64, 144.0), 0U);
  EXPECT_EQ(bad(mit::ak60_6, 20.0 / 6.0), 0U);
}

// What ODrive's set_input_torque and moteus' float registers put on the wire: the float itself, or the limit.
TEST(EveryFloat, float_torque) {
  constexpr float limit = 3.3333333F;
  constexpr auto limit_bits = std::bit_cast<std::uint32_t>(limit);
  const auto encode = [](double t) { return std::bit_cast<std::uint32_t>(wire_float(t, limit)); };
  EXPECT_EQ(in_blocks(0, all_floats,
                      [&](std::uint64_t begin, std::uint64_t end) {
                        std::uint64_t bad = 0;
                        encoded_floats<decltype(encode)> sent;
                        for (std::uint64_t at = begin; at < end; at += floats_at_once) {
                          const auto first = static_cast<std::uint32_t>(at);
                          encode_floats(encode, first, sent);
                          std::uint32_t wrong = 0;
                          for (std::uint32_t i = 0; i < floats_at_once; ++i) {
                            const std::uint32_t bits = first + i;
                            const std::uint32_t size = bits & 0x7fffffffU;
                            const std::uint32_t wanted = size <= limit_bits   ? bits
                                                         : size < 0x7f800000U ? (bits & 0x80000000U) | limit_bits
                                                                              : 0U;
                            wrong += sent[i] == wanted ? 0U : 1U;
                          }
                          bad += wrong;
                        }
                        return bad;
                      }),
            0U);
}

// The integer registers of moteus.
TEST(EveryFloat, integer_torque) {
  constexpr double limit = 3.3333333;
  for (const auto r : {moteus::resolution::int8, moteus::resolution::int16, moteus::resolution::int32}) {
    const double unit = moteus::unit_of(moteus::quantity::torque_n_m, r);
    EXPECT_EQ(refused_around(
                  unit / 4.0, limit * 1.01,
                  [r](double t) { return moteus::encode_int(t, moteus::quantity::torque_n_m, r, limit); },
                  [&](double asked, std::int32_t wire) {
                    return is_fair(asked, wire * unit, limit, unit * (1.0 + 1e-9), 0.0);
                  }),
              0U);
  }
}

// Object 6071 of a CiA 402 drive, in thousandths of the rated torque.
TEST(EveryFloat, cia402_torque) {
  constexpr double rated_n_m = 0.37;
  constexpr std::int16_t limit = 2900;
  constexpr double most_n_m = rated_n_m * limit / 1000.0;
  EXPECT_EQ(refused(
                0, all_floats, [](double t) { return canopen::encode_torque(t, rated_n_m, limit); },
                [](double asked, std::int16_t n) {
                  if (asked != asked) return n == 0;
                  const double back =
                      std::abs(n) == limit ? std::copysign(most_n_m, n) : canopen::decode_torque(n, rated_n_m);
                  const double wanted = std::fabs(asked) > most_n_m ? std::copysign(most_n_m, asked) : asked;
                  return std::abs(n) <= limit && (asked > 0.0 ? n >= 0 : n <= 0) &&
                         std::fabs(back) <= std::fabs(wanted) &&
                         std::fabs(wanted - back) <= 1.0001 * rated_n_m / 1000.0;
                }),
            0U);
}

// Counts of a Falcon's motor. Counts are to the nearest, so that they are in order, and the same both ways.
// What becomes of them on the wire: falcon_frame.every_number_saturates_on_every_motor_and_comes_back.
TEST(EveryFloat, falcon_counts) {
  EXPECT_EQ(refused(
                0, all_floats, [](double counts) { return falcon_motor_counts(counts); },
                [](double asked, std::int16_t n) {
                  if (asked != asked) return n == 0;
                  const bool near = std::fabs(asked) > 4096.0 ? std::abs(n) == 4096 : std::fabs(n - asked) <= 0.5;
                  return std::abs(n) <= 4096 && (asked > 0.0 ? n >= 0 : n <= 0) && near &&
                         falcon_motor_counts(-asked) == -n;
                }),
            0U);
}

}  // namespace
}  // namespace asperity
