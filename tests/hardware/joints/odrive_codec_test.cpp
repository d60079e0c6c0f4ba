// CANSimple frames: bytes of the documents, limits, signs.
#include "asperity/drivers/odrive/odrive_codec.hpp"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>

#include "hardware/joints/hostile_numbers.hpp"

namespace asperity::odrive {
namespace {

can_frame frame(std::uint32_t id, std::initializer_list<int> bytes) {
  can_frame f{.id = id};
  for (const int b : bytes) f.data[f.size++] = static_cast<std::uint8_t>(b);
  return f;
}

double torque_in(const can_frame& f) {
  float t = 0.0F;
  std::memcpy(&t, f.data.data(), 4);
  return static_cast<double>(t);
}

TEST(OdriveCodec, golden_commands) {
  EXPECT_EQ(set_input_torque(3, 1.0, 2.0F), frame(0x06e, {0x00, 0x00, 0x80, 0x3f}));
  EXPECT_EQ(set_input_torque(3, -5.0, 2.0F), frame(0x06e, {0x00, 0x00, 0x00, 0xc0}));
  EXPECT_EQ(set_axis_state(3, axis_closed_loop), frame(0x067, {8, 0, 0, 0}));
  EXPECT_EQ(set_axis_state(0x3f, axis_idle), frame(0x7e7, {1, 0, 0, 0}));
  EXPECT_EQ(set_torque_mode(1), frame(0x02b, {1, 0, 0, 0, 1, 0, 0, 0}));
  EXPECT_EQ(clear_errors(2), frame(0x058, {0}));
  EXPECT_EQ(estop(2), frame(0x042, {}));
  can_frame rtr = frame(0x069, {});
  rtr.remote = true;
  EXPECT_EQ(ask(3, message::encoder_estimates, true), rtr);
  EXPECT_EQ(ask(3, message::version, false), frame(0x060, {}));
  EXPECT_EQ(frame_id(1, static_cast<message>(0x0c)), 0x2cU) << "the example of the document";
}

TEST(OdriveCodec, golden_answers_of_both_firmwares) {
  const can_frame beat = frame(0x061, {0x00, 0x01, 0x00, 0x00, 0x08, 0x01, 0x01, 0x80});
  const heartbeat h5 = decode_heartbeat(beat, firmware::v0_5);
  EXPECT_EQ(h5.axis_error, 0x100U);
  EXPECT_EQ(h5.axis_state, axis_closed_loop);
  EXPECT_TRUE(h5.motor_error);
  EXPECT_TRUE(h5.encoder_error);
  EXPECT_FALSE(h5.controller_error);
  EXPECT_TRUE(h5.trajectory_done);
  EXPECT_EQ(encode_heartbeat(3, h5, firmware::v0_5), beat);
  const can_frame beat6 = frame(0x061, {0x00, 0x00, 0x00, 0x01, 0x01, 0x03, 0x01, 0x00});
  const heartbeat h6 = decode_heartbeat(beat6, firmware::v0_6);
  EXPECT_EQ(h6.axis_error, 0x1000000U);
  EXPECT_EQ(h6.procedure_result, 3);
  EXPECT_FALSE(h6.motor_error);
  EXPECT_TRUE(h6.trajectory_done);
  EXPECT_EQ(encode_heartbeat(3, h6, firmware::v0_6), beat6);

  const can_frame estimates = frame(0x069, {0x00, 0x00, 0x00, 0xbf, 0x00, 0x00, 0x20, 0x40});
  EXPECT_EQ(decode_floats(estimates).first, -0.5F);
  EXPECT_EQ(decode_floats(estimates).second, 2.5F);
  EXPECT_EQ(encode_floats(3, message::encoder_estimates, {-0.5F, 2.5F}), estimates);

  const can_frame v = frame(0x060, {2, 4, 4, 58, 0, 6, 9, 0});
  EXPECT_EQ(decode_version(v).minor, 6);
  EXPECT_EQ(decode_version(v).revision, 9);
  EXPECT_EQ(encode_version(3, decode_version(v)), v);
}

TEST(OdriveCodec, hostile_torques_stay_within_the_limit_and_keep_their_sign) {
  for (const float limit : {0.0F, 1e-30F, 0.1F, 3.7F, 144.0F}) {
    test_support::for_hostile_numbers(static_cast<double>(limit), [&](double t) {
      const double out = torque_in(set_input_torque(5, t, limit));
      ASSERT_LE(std::fabs(out), static_cast<double>(limit)) << t;
      ASSERT_LE(std::fabs(out), std::isfinite(t) ? std::fabs(t) : 0.0) << t;
      ASSERT_GE(out * (std::isfinite(t) ? t : 0.0), 0.0) << t;
      if (std::fabs(t) < static_cast<double>(limit) && std::fabs(t) > 1e-30) {
        ASSERT_NEAR(out / t, 1.0, 1.2e-7) << t;
      }
    });
  }
}

TEST(OdriveCodec, every_error_bit_has_words) {
  for (unsigned bit = 0; bit < 32; ++bit) {
    for (const firmware v : {firmware::v0_5, firmware::v0_6}) {
      EXPECT_NE(std::string(to_string_error(1U << bit, v)).find("drive"), std::string::npos);
    }
  }
  EXPECT_STREQ(to_string_error(0x800, firmware::v0_5), to_string_error(0x1000000, firmware::v0_6));
}

}  // namespace
}  // namespace asperity::odrive
