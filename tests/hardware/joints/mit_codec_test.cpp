// The MIT frames: bytes of the reference implementation, limits, signs.
#include "asperity/drivers/mit/mit_codec.hpp"

#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>
#include <span>
#include <string>

#include "hardware/joints/hostile_numbers.hpp"

namespace asperity::mit {
namespace {

using bytes = command_bytes;

symmetric_field torque_of(const ranges& r) { return {r.torque_n_m, 12, r.torque_n_m}; }

TEST(MitCodec, golden_commands) {
  // Computed with the formula of motorcontrol's float_to_uint.
  EXPECT_EQ(encode_torque(0.0, ak80_9, torque_of(ak80_9)), (bytes{0x7f, 0xff, 0x7f, 0xf0, 0, 0, 0x07, 0xff}));
  EXPECT_EQ(encode_torque(1.0, ak80_9, torque_of(ak80_9)), (bytes{0x7f, 0xff, 0x7f, 0xf0, 0, 0, 0x08, 0x71}));
  EXPECT_EQ(encode_torque(18.0, ak80_9, torque_of(ak80_9)), (bytes{0x7f, 0xff, 0x7f, 0xf0, 0, 0, 0x0f, 0xff}));
  EXPECT_EQ(encode_torque(-18.0, ak80_9, torque_of(ak80_9)), (bytes{0x7f, 0xff, 0x7f, 0xf0, 0, 0, 0x00, 0x00}));
  const command all{12.5, 50.0, 500.0, 5.0, -18.0};
  EXPECT_EQ(encode(all, ak80_9, torque_of(ak80_9)), (bytes{0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xf0, 0x00}));
}

TEST(MitCodec, golden_commands_are_read_back) {
  const command c = decode_command({0x7f, 0xff, 0x7f, 0xf0, 0, 0, 0x08, 0x71}, ak80_9);
  EXPECT_NEAR(c.torque_n_m, 0.9978, 1e-4);
  EXPECT_EQ(c.stiffness_n_m_per_rad, 0.0);
  EXPECT_EQ(c.damping_n_m_s_per_rad, 0.0);
  EXPECT_NEAR(c.position_rad, 0.0, 2e-4);
  EXPECT_NEAR(c.velocity_rad_per_s, 0.0, 0.02);
}

TEST(MitCodec, the_error_of_zero_is_known) {
  const symmetric_field t = torque_of(ak80_9);
  EXPECT_NEAR(t.decode(t.encode(0.0)), -18.0 / 4095.0, 1e-15);
  EXPECT_EQ(t.encode(0.0), t.encode(-0.0));
  EXPECT_EQ(t.encode(0.0), t.encode(std::nan("")));
  EXPECT_EQ(t.encode(0.0), t.encode(std::numeric_limits<double>::infinity()));
}

TEST(MitCodec, hostile_torques_stay_within_the_limit_and_keep_their_sign) {
  for (const ranges& r : {ak80_9, ak10_9, ak60_6, ak70_10, ak80_6, ak80_64, ranges{.torque_n_m = 3.7}}) {
    for (const double share : {1.0, 0.5, 0.123, 0.001}) {
      const double limit = r.torque_n_m * share;
      const symmetric_field field(r.torque_n_m, 12, limit);
      test_support::for_hostile_numbers(r.torque_n_m, [&](double t) {
        const double out = decode_command(encode_torque(t, r, field), r).torque_n_m;
        ASSERT_LE(std::fabs(out), limit) << t;
        if (!std::isfinite(t) || t == 0.0) {
          ASSERT_NEAR(out, -field.half_step(), 1e-12) << t;
          return;
        }
        ASSERT_EQ(std::signbit(out), std::signbit(t)) << t << " became " << out;
        if (std::fabs(t) > field.half_step()) {
          ASSERT_LE(std::fabs(out), std::fabs(t) * (1.0 + 1e-15)) << t;
        }
        if (std::fabs(t) <= limit && limit > 4.0 * field.half_step()) {
          ASSERT_GE(std::fabs(out), std::fabs(t) - 2.0001 * field.half_step()) << t;
        }
      });
    }
  }
}

TEST(MitCodec, gains_are_never_more_than_asked_for) {
  test_support::for_hostile_numbers(500.0, [](double k) {
    const double out = encode_gain(k, 500.0) * 500.0 / 4095.0;
    ASSERT_GE(out, 0.0);
    ASSERT_LE(out, std::isfinite(k) && k > 0.0 ? std::fmin(k, 500.0) * (1.0 + 1e-15) : 0.0) << k;
  });
}

TEST(MitCodec, no_command_reads_as_a_special_frame) {
  const command all{12.5, 50.0, 500.0, 5.0, 18.0};
  const bytes b = encode(all, ak80_9, torque_of(ak80_9));
  EXPECT_NE(b, enter_motor_mode);
  EXPECT_LT(b[7], 0xfc);
  EXPECT_LT(decode_command(b, ak80_9).torque_n_m, 18.0);
  EXPECT_EQ(enter_motor_mode[7], 0xfc);
  EXPECT_EQ(exit_motor_mode[7], 0xfd);
  EXPECT_EQ(set_zero_position[7], 0xfe);
}

TEST(MitCodec, golden_replies_of_every_length) {
  const std::array<std::uint8_t, 8> b{0x01, 0x80, 0x00, 0x80, 0x08, 0x71, 0x1e, 0x02};
  reply r;
  ASSERT_TRUE(decode_reply(std::span(b).first(8), ak80_9, r));
  EXPECT_EQ(r.id, 1);
  EXPECT_EQ(r.position_counts, 0x8000);
  EXPECT_NEAR(r.velocity_rad_per_s, 50.0 / 4095.0, 1e-12);
  EXPECT_NEAR(r.torque_n_m, 0.9978, 1e-4);
  EXPECT_EQ(r.temperature_c, 30);
  EXPECT_EQ(r.error, 2);
  ASSERT_TRUE(decode_reply(std::span(b).first(7), ak80_9, r));
  EXPECT_EQ(r.voltage_counts, 0x1e);
  EXPECT_EQ(r.error, 0) << "the seventh byte of motorcontrol is no error";
  ASSERT_TRUE(decode_reply(std::span(b).first(6), ak80_9, r));
  EXPECT_EQ(r.error, 0);
  for (std::size_t n = 0; n < 6; ++n) EXPECT_FALSE(decode_reply(std::span(b).first(n), ak80_9, r)) << n;

  bytes out{};
  const reply sent{.id = 1,
                   .position_counts = 0x8000,
                   .velocity_rad_per_s = 0.02,
                   .torque_n_m = 1.0,
                   .size = 8,
                   .error = 2,
                   .temperature_c = 30};
  ASSERT_EQ(encode_reply(sent, ak80_9, out), 8U);
  EXPECT_EQ(out, b);
}

TEST(MitCodec, error_codes_are_words) {
  EXPECT_NE(std::string(to_string_error(1)).find("over-temperature"), std::string::npos);
  EXPECT_NE(std::string(to_string_error(5)).find("encoder"), std::string::npos);
  for (int code = 0; code < 256; ++code) EXPECT_NE(to_string_error(static_cast<std::uint8_t>(code)), nullptr);
}

// Everything is constexpr.
static_assert(encode_torque(1.0, ak80_9, symmetric_field(18.0, 12, 18.0))[7] == 0x71);

}  // namespace
}  // namespace asperity::mit
