// Bytes of a Falcon: published vectors both ways, every number, and bytes that mean harm.
#include "asperity/drivers/falcon/falcon_frame.hpp"

#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <string>
#include <string_view>

#include "asperity/drivers/falcon/ftdi_line.hpp"

namespace {

using namespace asperity;

falcon_frame frame_of(std::string_view text) {
  falcon_frame f{};
  std::copy_n(text.begin(), f.size(), f.begin());
  return f;
}

std::string text_of(const falcon_frame& f) { return {f.begin(), f.end()}; }

TEST(falcon_frame, commands_are_the_published_bytes) {
  // 'J' 'F' 'K' 'P' is 0xfa59, lowest four bits first.
  const auto word = static_cast<std::int16_t>(0xfa59);
  EXPECT_EQ(text_of(encode_falcon({.motor_counts = {word, 0, 0}})), "<JFKPAAAAAAAAAA>");
  EXPECT_EQ(text_of(encode_falcon({})), "<AAAAAAAAAAAAAA>");
  EXPECT_EQ(text_of(encode_falcon({.motor_counts = {1, -1, 4096}, .light = falcon_light::blue})), "<BAAAPPPPAAABEA>");
  EXPECT_EQ(text_of(encode_falcon({.light = falcon_light::red, .home = true})), "<AAAAAAAAAAAAJA>");
  EXPECT_EQ(text_of(encode_falcon({.light = falcon_light::green})), "<AAAAAAAAAAAACA>");
}

TEST(falcon_frame, reports_are_the_published_bytes) {
  const auto r =
      decode_falcon_report(frame_of("<JFKPAAAABAAA\xb6"
                                    "A>"));
  ASSERT_TRUE(r);
  EXPECT_EQ(r->encoder_counts[0], static_cast<std::int16_t>(0xfa59));
  EXPECT_EQ(r->encoder_counts[1], 0);
  EXPECT_EQ(r->encoder_counts[2], 1);
  EXPECT_EQ(r->buttons, 5);  // 0xb6 - 0x41 = 0x75
  EXPECT_EQ(r->homed, falcon_all_homed);
  EXPECT_EQ(encode_falcon_report(*r), frame_of("<JFKPAAAABAAA\xb6"
                                               "A>"));
}

TEST(falcon_frame, every_number_saturates_on_every_motor_and_comes_back) {
  for (std::size_t motor = 0; motor < 3; ++motor) {
    for (int n = -32768; n <= 32767; ++n) {
      falcon_command c;
      c.motor_counts[motor] = static_cast<std::int16_t>(n);
      const auto back = decode_falcon_command(encode_falcon(c));
      ASSERT_TRUE(back);
      ASSERT_EQ(back->motor_counts[motor], std::clamp(n, -4096, 4096));
      ASSERT_EQ(back->motor_counts[(motor + 1) % 3], 0);
      falcon_report r;
      r.encoder_counts[motor] = static_cast<std::int16_t>(n);
      ASSERT_EQ(decode_falcon_report(encode_falcon_report(r)), r);
    }
  }
}

TEST(falcon_frame, a_number_becomes_counts_without_wrapping) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(falcon_motor_counts(std::numeric_limits<double>::quiet_NaN()), 0);
  EXPECT_EQ(falcon_motor_counts(inf), 4096);
  EXPECT_EQ(falcon_motor_counts(-inf), -4096);
  EXPECT_EQ(falcon_motor_counts(1e300), 4096);
  EXPECT_EQ(falcon_motor_counts(-1e300), -4096);
  EXPECT_EQ(falcon_motor_counts(32768.0), 4096);
  EXPECT_EQ(falcon_motor_counts(-62e3), -4096);
  EXPECT_EQ(falcon_motor_counts(0.49), 0);
  EXPECT_EQ(falcon_motor_counts(-0.51), -1);
  EXPECT_EQ(falcon_motor_counts(4095.6), 4096);
}

TEST(falcon_frame, one_wrong_byte_is_no_frame_or_another_valid_one) {
  const falcon_frame good = encode_falcon_report({.encoder_counts = {100, -200, 300}, .buttons = 3, .homed = 7});
  int refused = 0;
  for (std::size_t i = 0; i < good.size(); ++i) {
    for (int b = 0; b < 256; ++b) {
      falcon_frame f = good;
      f[i] = static_cast<std::uint8_t>(b);
      const auto r = decode_falcon_report(f);
      if (!r) ++refused;
      if (r && i != 14) {
        EXPECT_EQ(encode_falcon_report(*r)[i], b);
      }
    }
  }
  // Both brackets, 12 bytes of 16 values, one of 128, one of at least 0x41.
  EXPECT_EQ(refused, 2 * 255 + 12 * 240 + 128 + 0x41);
}

TEST(falcon_deframer, finds_frames_behind_any_rubbish) {
  std::mt19937_64 bits(7);
  for (int run = 0; run < 2000; ++run) {
    falcon_deframer d;
    for (std::uint64_t i = bits() % 40; i > 0; --i) {
      auto byte = static_cast<std::uint8_t>(bits());
      static_cast<void>(d.push(byte));
    }
    const falcon_frame good = encode_falcon_report({.encoder_counts = {static_cast<std::int16_t>(run), -7, 9}});
    std::optional<falcon_frame> found;
    for (const std::uint8_t byte : good) found = d.push(byte);
    ASSERT_TRUE(found) << run;
    EXPECT_EQ(*found, good);
  }
}

TEST(falcon_deframer, loses_the_frame_with_the_missing_byte_and_no_other) {
  const falcon_frame good = encode_falcon_report({.encoder_counts = {1, 2, 3}});
  for (std::size_t missing = 0; missing < good.size(); ++missing) {
    falcon_deframer d;
    int found = 0;
    for (int copy = 0; copy < 3; ++copy) {
      for (std::size_t i = 0; i < good.size(); ++i) {
        if (copy == 1 && i == missing) continue;
        if (const auto f = d.push(good[i])) {
          ++found;
          EXPECT_EQ(*f, good);
        }
      }
    }
    EXPECT_EQ(found, 2) << missing;
    EXPECT_EQ(d.broken(), missing == 0 ? 0U : 1U) << missing;
  }
}

TEST(ftdi, takes_two_bytes_of_status_out_of_every_packet) {
  for (std::size_t payload = 0; payload <= 200; ++payload) {
    std::vector<std::uint8_t> transfer;
    std::vector<std::uint8_t> sent;
    do {
      transfer.insert(transfer.end(), {0x01, 0x60});
      for (std::size_t i = 0; i < ftdi_payload_size && sent.size() < payload; ++i) {
        sent.push_back(static_cast<std::uint8_t>(sent.size()));
        transfer.push_back(sent.back());
      }
    } while (sent.size() < payload);
    std::vector<std::uint8_t> got;
    EXPECT_EQ(for_each_ftdi_byte(transfer, [&](std::uint8_t b) { got.push_back(b); }), 0U);
    EXPECT_EQ(got, sent);
  }
}

TEST(ftdi, counts_packets_with_errors_and_survives_short_ones) {
  std::vector<std::uint8_t> got;
  const auto take = [&](std::uint8_t b) { got.push_back(b); };
  EXPECT_EQ(for_each_ftdi_byte(std::vector<std::uint8_t>{0x01, 0x62, 5}, take), 1U);  // overrun
  EXPECT_EQ(for_each_ftdi_byte(std::vector<std::uint8_t>{0x01, 0x68, 6}, take), 1U);  // framing
  EXPECT_EQ(for_each_ftdi_byte(std::vector<std::uint8_t>{0x01}, take), 0U);
  EXPECT_EQ(for_each_ftdi_byte(std::vector<std::uint8_t>{}, take), 0U);
  EXPECT_EQ(for_each_ftdi_byte(std::vector<std::uint8_t>(65, 1), take), 0U);
  EXPECT_EQ(got.size(), 2U + 62U);
}

}  // namespace
