// CANopen frames against bytes written down from the documents, both ways, and against bytes that nobody ever meant.
#include <cmath>
#include <gtest/gtest.h>
#include <initializer_list>
#include <limits>
#include <random>

#include "asperity/drivers/canopen/cia402.hpp"
#include "asperity/drivers/canopen/sdo.hpp"

namespace {

using namespace asperity;
using namespace asperity::canopen;

can_frame bytes(std::uint32_t id, std::initializer_list<int> data) {
  can_frame f;
  f.id = id;
  for (const int b : data) f.data[f.size++] = static_cast<std::uint8_t>(b);
  return f;
}

TEST(canopen_frames, network_management) {
  EXPECT_EQ(encode_nmt(nmt_command::start, 3), bytes(0x000, {0x01, 0x03}));
  EXPECT_EQ(encode_nmt(nmt_command::stop, 3), bytes(0x000, {0x02, 0x03}));
  EXPECT_EQ(encode_nmt(nmt_command::pre_operational, 0), bytes(0x000, {0x80, 0x00}));
  EXPECT_EQ(encode_nmt(nmt_command::reset_node, 127), bytes(0x000, {0x81, 0x7f}));
  EXPECT_EQ(encode_nmt(nmt_command::reset_communication, 3), bytes(0x000, {0x82, 0x03}));
  for (const nmt_command c : {nmt_command::start, nmt_command::stop, nmt_command::pre_operational,
                              nmt_command::reset_node, nmt_command::reset_communication}) {
    const auto order = decode_nmt(encode_nmt(c, 17));
    ASSERT_TRUE(order);
    EXPECT_EQ(order->command, c);
    EXPECT_EQ(order->node, 17);
  }
  EXPECT_FALSE(decode_nmt(bytes(0x000, {0x03, 0x03})));
  EXPECT_FALSE(decode_nmt(bytes(0x000, {0x01})));
}

TEST(canopen_frames, sync_heartbeat_and_emergency) {
  EXPECT_EQ(encode_sync(), bytes(0x080, {}));
  EXPECT_TRUE(is_sync(encode_sync()));
  EXPECT_EQ(encode_heartbeat(3, nmt_state::operational), bytes(0x703, {0x05}));
  EXPECT_EQ(decode_heartbeat(bytes(0x703, {0x00}), 3), nmt_state::boot_up);
  EXPECT_EQ(decode_heartbeat(bytes(0x703, {0x04}), 3), nmt_state::stopped);
  EXPECT_EQ(decode_heartbeat(bytes(0x703, {0x7f}), 3), nmt_state::pre_operational);
  EXPECT_FALSE(decode_heartbeat(bytes(0x703, {0x06}), 3));
  EXPECT_FALSE(decode_heartbeat(bytes(0x704, {0x05}), 3));
  EXPECT_FALSE(decode_heartbeat(bytes(0x703, {}), 3));
  EXPECT_EQ(encode_emergency(3, {0x8130, 0x11}), bytes(0x083, {0x30, 0x81, 0x11, 0, 0, 0, 0, 0}));
  EXPECT_EQ(decode_emergency(bytes(0x083, {0x10, 0x23, 0x03, 9, 9, 9, 9, 9}), 3), (emergency{0x2310, 0x03}));
  EXPECT_FALSE(decode_emergency(bytes(0x083, {0x10, 0x23}), 3));
}

TEST(canopen_frames, service_data) {
  EXPECT_EQ(encode_upload_request(3, {0x6041, 0}), bytes(0x603, {0x40, 0x41, 0x60, 0x00, 0, 0, 0, 0}));
  EXPECT_EQ(encode_download_request(3, {0x6060, 0}, 10, 1), bytes(0x603, {0x2f, 0x60, 0x60, 0x00, 0x0a, 0, 0, 0}));
  EXPECT_EQ(encode_download_request(3, {0x6040, 0}, 6, 2), bytes(0x603, {0x2b, 0x40, 0x60, 0x00, 0x06, 0, 0, 0}));
  EXPECT_EQ(encode_download_request(3, {0x1400, 1}, 0x80000203, 4),
            bytes(0x603, {0x23, 0x00, 0x14, 0x01, 0x03, 0x02, 0x00, 0x80}));
  EXPECT_EQ(encode_written(3, {0x1400, 1}), bytes(0x583, {0x60, 0x00, 0x14, 0x01, 0, 0, 0, 0}));
  EXPECT_EQ(encode_value(3, {0x6041, 0}, 0x0237, 2), bytes(0x583, {0x4b, 0x41, 0x60, 0x00, 0x37, 0x02, 0, 0}));
  EXPECT_EQ(encode_value(3, {0x6061, 0}, 10, 1), bytes(0x583, {0x4f, 0x61, 0x60, 0x00, 0x0a, 0, 0, 0}));
  EXPECT_EQ(encode_value(3, {0x6076, 0}, 400, 4), bytes(0x583, {0x43, 0x76, 0x60, 0x00, 0x90, 0x01, 0, 0}));
  EXPECT_EQ(encode_abort(3, {0x6041, 0}, abort_code::no_object),
            bytes(0x583, {0x80, 0x41, 0x60, 0x00, 0x00, 0x00, 0x02, 0x06}));

  using kind = sdo_response::kind;
  auto r = decode_response(bytes(0x583, {0x4b, 0x41, 0x60, 0x00, 0x37, 0x02, 0xee, 0xee}), 3);
  ASSERT_TRUE(r);
  EXPECT_EQ(r->what, kind::value);
  EXPECT_EQ(r->at, (object_address{0x6041, 0}));
  EXPECT_EQ(r->value, 0x0237U);  // what lies behind the value is left out
  EXPECT_EQ(r->size, 2);
  r = decode_response(bytes(0x583, {0x80, 0x41, 0x60, 0x00, 0x00, 0x00, 0x02, 0x06}), 3);
  ASSERT_TRUE(r);
  EXPECT_EQ(r->what, kind::aborted);
  EXPECT_STREQ(abort_words(r->value), "object does not exist");
  r = decode_response(bytes(0x583, {0x41, 0x08, 0x10, 0x00, 0x20, 0x00, 0x00, 0x00}), 3);  // a longer object
  ASSERT_TRUE(r);
  EXPECT_EQ(r->what, kind::other);
  EXPECT_FALSE(decode_response(bytes(0x583, {0x60}), 3));

  for (const std::uint8_t size : {std::uint8_t{1}, std::uint8_t{2}, std::uint8_t{4}}) {
    const std::uint32_t value = 0xa1b2c3d4U >> (32 - 8 * size);
    const auto request = decode_request(encode_download_request(9, {0x1234, 5}, value, size), 9);
    ASSERT_TRUE(request);
    EXPECT_TRUE(request->write);
    EXPECT_EQ(request->value, value);
    EXPECT_EQ(request->size, size);
    const auto answer = decode_response(encode_value(9, {0x1234, 5}, value, size), 9);
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->value, value);
    EXPECT_EQ(answer->size, size);
  }
  EXPECT_FALSE(decode_request(encode_upload_request(9, {0x1234, 5}), 9)->write);
}

TEST(canopen_frames, process_data) {
  const torque_command c{control::enable_operation, torque_mode, -1000};
  EXPECT_EQ(encode(3, c), bytes(0x203, {0x0f, 0x00, 0x0a, 0x18, 0xfc}));
  EXPECT_EQ(decode_command(encode(3, c), 3), c);
  const torque_status s{0x0237, 10, 321};
  EXPECT_EQ(encode(3, s), bytes(0x183, {0x37, 0x02, 0x0a, 0x41, 0x01}));
  EXPECT_EQ(decode_status_frame(encode(3, s), 3), s);
  const motion_counts m{-2, 0x01020304};
  EXPECT_EQ(encode(3, m), bytes(0x283, {0xfe, 0xff, 0xff, 0xff, 0x04, 0x03, 0x02, 0x01}));
  EXPECT_EQ(decode_motion_frame(encode(3, m), 3), m);
  can_frame cut = encode(3, m);
  cut.size = 7;
  EXPECT_FALSE(decode_motion_frame(cut, 3));
}

TEST(canopen_frames, nothing_but_plain_frames_is_taken) {
  for (int which = 0; which < 4; ++which) {
    can_frame f = encode(3, torque_status{});
    if (which == 0) f.extended = true;
    if (which == 1) f.remote = true;
    if (which == 2) f.fd = true;
    if (which == 3) f.size = 64;
    EXPECT_FALSE(decode_status_frame(f, 3));
  }
}

TEST(canopen_frames, every_status_word_is_one_state_or_none) {
  // Masks and values as CiA 402 lists them.
  struct row {
    std::uint16_t mask;
    std::uint16_t value;
    power_state state;
  };
  constexpr row rows[] = {{0x4f, 0x00, power_state::not_ready},          {0x4f, 0x40, power_state::switch_on_disabled},
                          {0x6f, 0x21, power_state::ready_to_switch_on}, {0x6f, 0x23, power_state::switched_on},
                          {0x6f, 0x27, power_state::operation_enabled},  {0x6f, 0x07, power_state::quick_stop},
                          {0x4f, 0x0f, power_state::fault_reaction},     {0x4f, 0x08, power_state::fault}};
  for (unsigned word = 0; word <= 0xffff; ++word) {
    power_state expected = power_state::unknown;
    int matches = 0;
    for (const row& r : rows) {
      if ((word & r.mask) != r.value) continue;
      expected = r.state;
      ++matches;
    }
    ASSERT_LE(matches, 1) << word;
    ASSERT_EQ(decode_status(static_cast<std::uint16_t>(word)), expected) << word;
  }
}

TEST(canopen_frames, random_bytes_are_decoded_or_refused_and_never_more) {
  std::mt19937_64 bits(5);
  std::uint64_t taken = 0;
  for (int i = 0; i < 200'000; ++i) {
    can_frame f;
    f.id = static_cast<std::uint32_t>(bits() % 0x800);
    f.size = static_cast<std::uint8_t>(bits() % 9);
    for (std::size_t k = 0; k < 8; ++k) f.data[k] = static_cast<std::uint8_t>(bits());
    const auto node = static_cast<std::uint8_t>(f.id & 0x7f);
    const int kinds = decode_nmt(f).has_value() + decode_heartbeat(f, node).has_value() +
                      decode_emergency(f, node).has_value() + decode_request(f, node).has_value() +
                      decode_response(f, node).has_value() + decode_command(f, node).has_value() +
                      decode_status_frame(f, node).has_value() + decode_motion_frame(f, node).has_value();
    taken += static_cast<std::uint64_t>(kinds);
  }
  EXPECT_GT(taken, 1000U);
}

TEST(torque_encoder, golden_and_hostile) {
  EXPECT_EQ(encode_torque(0.2, 0.4, 3000), 500);
  EXPECT_EQ(encode_torque(-0.2, 0.4, 3000), -500);
  EXPECT_EQ(encode_torque(0.00079, 0.4, 3000), 1);  // 1.975, towards zero
  EXPECT_EQ(encode_torque(-0.00079, 0.4, 3000), -1);
  EXPECT_EQ(encode_torque(0.00039, 0.4, 3000), 0);
  EXPECT_EQ(encode_torque(1e300, 0.4, 3000), 3000);
  EXPECT_EQ(encode_torque(-1e300, 0.4, 3000), -3000);
  constexpr double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(encode_torque(inf, 0.4, 3000), 3000);
  EXPECT_EQ(encode_torque(-inf, 0.4, 3000), -3000);
  EXPECT_EQ(encode_torque(std::numeric_limits<double>::quiet_NaN(), 0.4, 3000), 0);
  EXPECT_EQ(encode_torque(1.0, 0.0, 3000), 0);
  EXPECT_EQ(encode_torque(1.0, std::numeric_limits<double>::quiet_NaN(), 3000), 0);
  EXPECT_EQ(encode_torque(1.0, inf, 3000), 0);
  EXPECT_EQ(encode_torque(inf, inf, 3000), 0);
  EXPECT_EQ(encode_torque(1.0, 0.4, 0), 0);
  EXPECT_EQ(encode_torque(1.0, 0.4, -5), 0);
  EXPECT_EQ(encode_torque(1e9, 0.4, 32767), 32767);
  EXPECT_EQ(encode_torque(-1e9, 0.4, 32767), -32767);
}

// Just below and at every thousandth: what it decodes to is never more than what was asked for, though the division
// rounds up to a whole number now and then.
TEST(torque_encoder, never_says_more_than_was_asked_for) {
  for (const double rated_n_m : {0.1, 0.23, 0.4, 1.7, 33.0}) {
    for (int n = 1; n <= 3000; ++n) {
      const double exact = n * rated_n_m / 1000.0;
      for (const double torque : {std::nextafter(exact, 0.0), exact}) {
        ASSERT_LE(decode_torque(encode_torque(torque, rated_n_m, 3000), rated_n_m), torque) << n << " of " << rated_n_m;
        ASSERT_GE(decode_torque(encode_torque(-torque, rated_n_m, 3000), rated_n_m), -torque) << n;
      }
    }
  }
}

}  // namespace
