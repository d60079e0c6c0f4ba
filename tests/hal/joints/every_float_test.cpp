// Every encoder of a torque, over the bit patterns of a float: never over the limit, never of the wrong sign, not more
// than was asked for and, within the limit, less than one step short of it.
#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <thread>
#include <vector>

#include "asperity/hal/joint/wire_number.hpp"
#include "asperity/hal/mit/mit_codec.hpp"
#include "asperity/hal/moteus/moteus_codec.hpp"

namespace asperity {
namespace {

constexpr std::uint64_t all_floats = std::uint64_t{1} << 32U;
constexpr std::uint64_t sign_bit = std::uint64_t{1} << 31U;

double as_double(std::uint64_t bits) {
  return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
}

// Hands out the patterns in [from, to) in blocks, on all cores. count(begin, end) says how many were refused. No block
// has both signs, or numbers and NaN.
template <class Count>
std::uint64_t in_blocks(std::uint64_t from, std::uint64_t to, const Count& count) {
  constexpr std::uint64_t block = std::uint64_t{1} << 22U;
  std::atomic<std::uint64_t> next{from / block};
  std::atomic<std::uint64_t> bad{0};
  std::vector<std::thread> workers;
  for (unsigned t = 0; t < std::max(1U, std::thread::hardware_concurrency()); ++t) {
    workers.emplace_back([&] {
      for (std::uint64_t at = next++ * block; at < to; at = next++ * block) {
        bad += count(std::max(at, from), std::min(at + block, to));
      }
    });
  }
  for (std::thread& w : workers) w.join();
  return bad;
}

// Encodes every pattern. Within a run of patterns with the same result the size of what was asked for only grows, so
// `fair` is asked about the first and the last of each run, and with them about all.
template <class Encode, class Fair>
std::uint64_t refused(std::uint64_t from, std::uint64_t to, const Encode& encode, const Fair& fair) {
  return in_blocks(from, to, [&](std::uint64_t begin, std::uint64_t end) {
    std::uint64_t bad = 0;
    const auto look = [&](std::uint64_t bits, auto wire) { bad += fair(as_double(bits), wire) ? 0U : 1U; };
    auto wire = encode(as_double(begin));
    look(begin, wire);
    for (std::uint64_t bits = begin + 1; bits < end; ++bits) {
      const auto now = encode(as_double(bits));
      if (now == wire) continue;
      look(bits - 1, wire);
      look(bits, now);
      wire = now;
    }
    look(end - 1, wire);
    return bad;
  });
}

// Both signs of the sizes in which the result changes, from `least` to `most`, and every 997th of all other patterns.
template <class Encode, class Fair>
std::uint64_t refused_around(double least, double most, const Encode& encode, const Fair& fair) {
  const std::uint64_t from = std::bit_cast<std::uint32_t>(static_cast<float>(least));
  const std::uint64_t to = std::bit_cast<std::uint32_t>(static_cast<float>(most));
  std::uint64_t bad = refused(from, to, encode, fair) + refused(sign_bit + from, sign_bit + to, encode, fair);
  for (std::uint64_t bits = 0; bits < all_floats; bits += 997) {
    bad += fair(as_double(bits), encode(as_double(bits))) ? 0U : 1U;
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
                0, all_floats, [&](double t) { return field.encode(t); },
                [](double asked, std::uint16_t wire) { return is_fair_to_mit(asked, wire, mit::ak80_9, 18.0); }),
            0U);
}

// The same code with other constants, and with a limit inside the range.
TEST(EveryFloat, mit_torque_of_the_other_tables) {
  const auto bad = [](const mit::ranges& r, double limit) {
    const mit::symmetric_field field(r.torque_n_m, 12, limit);
    return refused_around(
        r.torque_n_m / 8192.0, r.torque_n_m * 1.01, [&](double t) { return field.encode(t); },
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
  EXPECT_EQ(in_blocks(0, all_floats,
                      [](std::uint64_t begin, std::uint64_t end) {
                        std::uint64_t bad = 0;
                        const auto sign = static_cast<std::uint32_t>(begin & sign_bit);
                        for (std::uint64_t b = begin; b < end; ++b) {
                          const auto bits = static_cast<std::uint32_t>(b);
                          const std::uint32_t size = bits & 0x7fffffffU;
                          const std::uint32_t wanted = size <= limit_bits   ? bits
                                                       : size < 0x7f800000U ? sign | limit_bits
                                                                            : 0U;
                          const float sent = wire_float(as_double(bits), limit);
                          bad += std::bit_cast<std::uint32_t>(sent) == wanted ? 0U : 1U;
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
                  [&](double t) { return moteus::encode_int(t, moteus::quantity::torque_n_m, r, limit); },
                  [&](double asked, std::int32_t wire) {
                    return is_fair(asked, wire * unit, limit, unit * (1.0 + 1e-9), 0.0);
                  }),
              0U);
  }
}

}  // namespace
}  // namespace asperity
