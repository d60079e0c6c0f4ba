// Every encoder of a torque, over all 2^32 bit patterns of a float: never over the limit, never of the wrong sign, not
// more than was asked for and, within the limit, less than one step short of it.
#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <gtest/gtest.h>
#include <thread>
#include <vector>

#include "asperity/hal/mit/mit_codec.hpp"
#include "asperity/hal/moteus/moteus_codec.hpp"
#include "asperity/hal/odrive/odrive_codec.hpp"

namespace asperity {
namespace {

constexpr std::uint64_t all_floats = std::uint64_t{1} << 32U;

// Calls check(bits) for every pattern in [from, to), on all cores. @return the patterns that it refused
template <class Check>
std::uint64_t refused(std::uint64_t from, std::uint64_t to, const Check& check) {
  const unsigned threads = std::max(1U, std::thread::hardware_concurrency());
  constexpr std::uint64_t block = std::uint64_t{1} << 22U;
  std::atomic<std::uint64_t> next{from};
  std::atomic<std::uint64_t> bad{0};
  std::vector<std::thread> workers;
  for (unsigned t = 0; t < threads; ++t) {
    workers.emplace_back([&] {
      for (std::uint64_t at = next.fetch_add(block); at < to; at = next.fetch_add(block)) {
        const std::uint64_t end = std::min(at + block, to);
        std::uint64_t here = 0;
        for (std::uint64_t bits = at; bits < end; ++bits) here += check(static_cast<std::uint32_t>(bits)) ? 0U : 1U;
        bad += here;
      }
    });
  }
  for (std::thread& w : workers) w.join();
  return bad;
}

// A number on the wire against what was asked for. `step`: how much may be lost; `least`: what a value of the right
// sign may be though less was asked for.
bool is_fair(double asked, double sent, double limit, double step, double least) {
  if (!(std::fabs(sent) <= limit)) return false;
  if (!std::isfinite(asked) || asked == 0.0) return std::fabs(sent) <= least;
  const bool sign = sent == 0.0 || (sent > 0.0) == (asked > 0.0);
  const double size = std::fabs(asked);
  const double most = std::fmin(size, limit);
  return sign && std::fabs(sent) <= std::fmax(size, least) && most - std::fabs(sent) <= step;
}

// The wire's 4096 torques as motorcontrol reads them, in float.
std::vector<double> drive_table(const mit::ranges& r) {
  std::vector<double> table(4096);
  const auto low = static_cast<float>(-r.torque_n_m);
  const float span = static_cast<float>(r.torque_n_m) - low;
  for (std::size_t u = 0; u < table.size(); ++u) {
    table[u] = static_cast<double>(static_cast<float>(u) * span / 4095.0F + low);
  }
  return table;
}

std::uint64_t refused_by_mit(const mit::ranges& r, double limit, std::uint64_t from, std::uint64_t to) {
  const mit::symmetric_field field(r.torque_n_m, 12, limit);
  const std::vector<double> table = drive_table(r);
  const double step = 2.0 * field.half_step() * (1.0 + 1e-6);
  const double least = field.half_step() * (1.0 + 1e-3);  // the drive's float is that far off near zero
  return refused(from, to, [&](std::uint32_t bits) {
    const auto asked = static_cast<double>(std::bit_cast<float>(bits));
    const std::uint16_t wire = field.encode(asked);
    if (wire > 4095) return false;
    if (asked == 0.0 || !std::isfinite(asked)) return wire == 2047;
    const double sent = table[wire];
    const double size = std::fabs(asked);
    // One ulp of the drive's float, which no integer on the wire can do anything about, except at the limit.
    const double rounded = size * (1.0 + 1e-6) + 2e-6 * r.torque_n_m;
    return std::fabs(sent) <= limit && (sent > 0.0) == (asked > 0.0) && std::fabs(sent) <= std::fmax(rounded, least) &&
           std::fmin(size, limit) - std::fabs(sent) <= step;
  });
}

TEST(EveryFloat, mit_torque_of_a_whole_range) { EXPECT_EQ(refused_by_mit(mit::ak80_9, 18.0, 0, all_floats), 0U); }

// The other tables and a limit inside the range: every float between 2^-20 and 2^10, where the answer changes.
TEST(EveryFloat, mit_torque_of_the_other_tables) {
  const auto octaves = [](const mit::ranges& r, double limit) {
    const std::uint32_t from = std::bit_cast<std::uint32_t>(static_cast<float>(r.torque_n_m / 8192.0));
    const std::uint32_t to = std::bit_cast<std::uint32_t>(static_cast<float>(r.torque_n_m * 1.01));
    constexpr std::uint64_t sign = std::uint64_t{1} << 31U;
    return refused_by_mit(r, limit, from, to) + refused_by_mit(r, limit, sign + from, sign + to);
  };
  EXPECT_EQ(octaves(mit::ak10_9, 65.0), 0U);
  EXPECT_EQ(octaves(mit::ak60_6, 15.0), 0U);
  EXPECT_EQ(octaves(mit::ak70_10, 25.0), 0U);
  EXPECT_EQ(octaves(mit::ak80_6, 12.0), 0U);
  EXPECT_EQ(octaves(mit::ak80_64, 144.0), 0U);
  EXPECT_EQ(octaves(mit::ak60_6, 20.0 / 6.0), 0U);
}

// ODrive and the float registers of moteus share one encoder; the bytes are looked at in ODrive's frame.
TEST(EveryFloat, odrive_torque) {
  for (const float limit : {3.3333333F}) {
    EXPECT_EQ(refused(0, all_floats,
                      [&](std::uint32_t bits) {
                        const auto asked = static_cast<double>(std::bit_cast<float>(bits));
                        const can_frame f = odrive::set_input_torque(1, asked, limit);
                        float sent = 0.0F;
                        std::memcpy(&sent, f.data.data(), 4);
                        return is_fair(asked, static_cast<double>(sent), static_cast<double>(limit), 0.0, 0.0);
                      }),
              0U);
  }
}

TEST(EveryFloat, moteus_torque) {
  const double limit = 3.3333333;
  constexpr std::array whole{moteus::resolution::int8, moteus::resolution::int16, moteus::resolution::int32};
  EXPECT_EQ(refused(0, all_floats,
                    [&](std::uint32_t bits) {
                      const auto asked = static_cast<double>(std::bit_cast<float>(bits));
                      bool fair = is_fair(asked, static_cast<double>(float_toward_zero(saturated(asked, limit))), limit,
                                          limit * 0x1.0p-23, 0.0);
                      for (const auto r : whole) {
                        const double unit = moteus::unit_of(moteus::quantity::torque_n_m, r);
                        const double sent = moteus::encode_int(asked, moteus::quantity::torque_n_m, r, limit) * unit;
                        fair = fair && is_fair(asked, sent, limit, unit * (1.0 + 1e-9), 0.0);
                      }
                      return fair;
                    }),
            0U);
}

}  // namespace
}  // namespace asperity
