// moteus frames: the examples of its documents, integer units, hostile numbers and hostile bytes.
#include "asperity/drivers/moteus/moteus_codec.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <random>
#include <span>
#include <vector>

#include "hardware/joints/hostile_numbers.hpp"

namespace asperity::moteus {
namespace {

using q = quantity;
using bytes = std::vector<std::uint8_t>;

bytes finished(frame_writer& w) {
  std::array<std::uint8_t, 64> b{};
  const std::size_t n = w.finish(b);
  return {b.begin(), b.begin() + static_cast<std::ptrdiff_t>(n)};
}

std::vector<item> items_of(const bytes& b, bool& malformed) {
  frame_reader r(b);
  std::vector<item> out;
  for (item i; r.next(i);) out.push_back(i);
  malformed = r.malformed();
  return out;
}

const bytes golden_command{0x01, 0x00, 0x0a, 0x07, 0x20, 0x60, 0x00, 0x20,
                           0x01, 0x50, 0xff, 0x14, 0x04, 0x00, 0x13, 0x0d};
const bytes golden_reply{0x24, 0x04, 0x00, 0x0a, 0x00, 0x50, 0x00, 0x00,
                         0x01, 0x70, 0xff, 0x23, 0x0d, 0x18, 0x14, 0x00};

TEST(MoteusCodec, writes_the_documents_example) {
  frame_writer w;
  w.begin(action::write, resolution::int8, 1, reg::mode);
  w.value(10, q::plain);
  w.begin(action::write, resolution::int16, 3, reg::command_position);
  w.value(96 * 0.0001, q::position_rev);
  w.value(288 * 0.00025, q::velocity_rev_per_s);
  w.value(-176 * 0.01, q::torque_n_m);
  w.begin(action::read, resolution::int16, 4, reg::mode);
  w.begin(action::read, resolution::int8, 3, reg::voltage);
  EXPECT_EQ(finished(w), golden_command);
  EXPECT_EQ(frame_id(0, 1, true), 0x8001U);
  EXPECT_EQ(frame_id(1, 0, false), 0x100U);
}

TEST(MoteusCodec, reads_the_documents_examples) {
  bool bad = true;
  const auto r = items_of(golden_reply, bad);
  EXPECT_FALSE(bad);
  ASSERT_EQ(r.size(), 7U);
  EXPECT_TRUE(r[0].is(reg::mode));
  EXPECT_EQ(r[0].whole, 10);
  EXPECT_DOUBLE_EQ(r[1].value(q::position_rev), 0.008);
  EXPECT_DOUBLE_EQ(r[2].value(q::velocity_rev_per_s), 0.064);
  EXPECT_DOUBLE_EQ(r[3].value(q::torque_n_m), -1.44);
  EXPECT_DOUBLE_EQ(r[4].value(q::voltage_v), 12.0);
  EXPECT_DOUBLE_EQ(r[5].value(q::temperature_c), 20.0);
  EXPECT_TRUE(r[6].is(reg::fault));
  EXPECT_EQ(r[6].whole, 0);

  const auto c = items_of(golden_command, bad);
  EXPECT_FALSE(bad);
  ASSERT_EQ(c.size(), 6U);
  EXPECT_EQ(c[0].what, action::write);
  EXPECT_DOUBLE_EQ(c[3].value(q::torque_n_m), -1.76);
  EXPECT_EQ(c[4].what, action::read);
  EXPECT_EQ(c[4].count, 4U);
  EXPECT_EQ(c[5].count, 3U);
}

TEST(MoteusCodec, the_replys_bytes_can_be_made_too) {
  frame_writer w;
  w.begin(action::reply, resolution::int16, 4, reg::mode);
  w.value(10, q::plain);
  w.value(80 * 0.0001, q::position_rev);
  w.value(0.064, q::velocity_rev_per_s);
  w.value(-1.44, q::torque_n_m);
  w.begin(action::reply, resolution::int8, 3, reg::voltage);
  w.value(12.0, q::voltage_v);
  w.value(20.0, q::temperature_c);
  w.value(0, q::plain);
  EXPECT_EQ(finished(w), golden_reply);
}

TEST(MoteusCodec, none_is_the_most_negative_integer_or_nan) {
  frame_writer w;
  for (const resolution r : {resolution::int8, resolution::int16, resolution::int32, resolution::real}) {
    w.begin(action::write, r, 1, reg::command_position);
    w.none();
  }
  const bytes b = finished(w);
  EXPECT_EQ(bytes(b.begin(), b.begin() + 7), (bytes{0x01, 0x20, 0x80, 0x05, 0x20, 0x00, 0x80}));
  bool bad = true;
  const auto all = items_of(b, bad);
  ASSERT_EQ(all.size(), 4U);
  for (const item& i : all) EXPECT_TRUE(std::isnan(i.value(q::position_rev)));
}

TEST(MoteusCodec, pads_to_lengths_that_can_fd_has) {
  for (std::size_t n = 1; n < 30; ++n) {
    frame_writer w;
    for (std::size_t i = 0; i < n; ++i) w.begin(action::read, resolution::int8, 1, reg::mode);
    const bytes b = finished(w);
    EXPECT_GE(b.size(), 2 * n);
    for (std::size_t i = 2 * n; i < b.size(); ++i) EXPECT_EQ(b[i], 0x50);
    const std::size_t s = b.size();
    EXPECT_TRUE(s <= 8 || s == 12 || s == 16 || s == 20 || s == 24 || s == 32 || s == 48 || s == 64) << s;
  }
}

TEST(MoteusCodec, what_does_not_fit_is_not_sent_in_part) {
  frame_writer w;
  w.begin(action::write, resolution::real, 16, reg::mode);
  for (int i = 0; i < 16; ++i) w.value(1.0, q::plain);
  EXPECT_TRUE(finished(w).empty());
}

TEST(MoteusCodec, hostile_numbers_stay_within_the_limit_and_keep_their_sign) {
  for (const double limit : {0.0, 0.02, 1.0, 20.0, 1e6}) {
    for (const resolution r : {resolution::int8, resolution::int16, resolution::int32, resolution::real}) {
      test_support::for_hostile_numbers(limit, [&](double t) {
        frame_writer w;
        w.begin(action::write, r, 1, reg::feedforward_torque);
        w.value(t, q::torque_n_m, limit);
        const bytes b = finished(w);
        frame_reader reader(b);
        item i;
        ASSERT_TRUE(reader.next(i));
        const double out = i.value(q::torque_n_m);
        ASSERT_LE(std::fabs(out), limit) << t;
        ASSERT_LE(std::fabs(out), std::isfinite(t) ? std::fabs(t) : 0.0) << t;
        ASSERT_GE(out * (std::isfinite(t) ? t : 0.0), 0.0) << t;
      });
    }
  }
}

// The table of the document's register command set, written down again: what is encoded and decoded with one wrong unit
// agrees with itself.
TEST(MoteusCodec, units_are_those_of_the_document) {
  struct row {
    quantity what;
    double in8, in16, in32;
  };
  for (const row& u : {row{q::torque_n_m, 0.5, 0.01, 0.001}, row{q::voltage_v, 0.5, 0.1, 0.001},
                       row{q::temperature_c, 1.0, 0.1, 0.001}, row{q::time_s, 0.01, 0.001, 1e-6},
                       row{q::position_rev, 0.01, 1e-4, 1e-5}, row{q::velocity_rev_per_s, 0.1, 0.00025, 1e-5},
                       row{q::scale, 1.0 / 127.0, 1.0 / 32767.0, 1.0 / 2147483647.0}, row{q::plain, 1.0, 1.0, 1.0}}) {
    EXPECT_EQ(unit_of(u.what, resolution::int8), u.in8) << static_cast<int>(u.what);
    EXPECT_EQ(unit_of(u.what, resolution::int16), u.in16) << static_cast<int>(u.what);
    EXPECT_EQ(unit_of(u.what, resolution::int32), u.in32) << static_cast<int>(u.what);
    EXPECT_EQ(unit_of(u.what, resolution::real), 1.0) << static_cast<int>(u.what);
  }
}

TEST(MoteusCodec, whole_units_survive_the_division) {
  for (const resolution r : {resolution::int8, resolution::int16, resolution::int32}) {
    for (int n = -127; n <= 127; ++n) {
      for (const quantity what : {q::torque_n_m, q::position_rev, q::velocity_rev_per_s, q::time_s, q::scale}) {
        EXPECT_EQ(encode_int(n * unit_of(what, r), what, r, 1e9), n) << static_cast<int>(what);
      }
    }
  }
}

// Just below, at and just above every whole number of units: never more than what was asked for, never a unit less than
// it could be. The quotient rounds up to a whole number now and then.
TEST(MoteusCodec, whole_numbers_of_units_never_say_more) {
  for (const double unit : {0.01, 0.001, 1e-4, 1e-5, 0.1, 0.00025}) {
    for (int n = 1; n <= 20'000; ++n) {
      const double exact = n * unit;
      for (const double wanted : {std::nextafter(exact, 0.0), exact, std::nextafter(exact, 1e9)}) {
        const auto count = static_cast<double>(wire_count(wanted, unit, 1e9));
        ASSERT_LE(count * unit, wanted) << n << " of " << unit;
        ASSERT_GT((count + 1.0) * unit, wanted) << n << " of " << unit;
        ASSERT_EQ(static_cast<double>(wire_count(-wanted, unit, 1e9)), -count) << n << " of " << unit;
      }
    }
  }
}

TEST(MoteusCodec, hostile_bytes_end_the_reading_within_their_length) {
  std::mt19937_64 bits(7);
  std::size_t made_no_sense = 0;
  for (int i = 0; i < 200'000; ++i) {
    std::array<std::uint8_t, 64> b{};
    for (auto& x : b) x = static_cast<std::uint8_t>(bits());
    if (i % 2 == 0) {
      for (std::size_t k = 0; k < golden_reply.size(); ++k) b[k] = golden_reply[k];
      b[bits() % 16] = static_cast<std::uint8_t>(bits());
    }
    const std::size_t size = bits() % 65;
    frame_reader r(std::span<const std::uint8_t>(b).first(size));
    std::size_t n = 0;
    for (item it; r.next(it);) ++n;
    ASSERT_LE(n, size);
    made_no_sense += r.malformed() ? 1U : 0U;
  }
  EXPECT_GT(made_no_sense, 50'000U);
}

TEST(MoteusCodec, a_count_that_is_a_lie_is_malformed) {
  for (const bytes& b :
       {bytes{0x20, 0xff, 0xff, 0xff, 0xff, 0x0f, 0x00, 1, 2}, bytes{0x20, 0xff, 0xff, 0xff, 0xff, 0xff, 0x01},
        bytes{0x2c, 0x02, 0x01, 0, 0, 0, 0}, bytes{0x20, 0x00, 0x00}, bytes{0x21}, bytes{0x31, 0x80}, bytes{0x40}}) {
    bool bad = false;
    EXPECT_LE(items_of(b, bad).size(), b.size());
    EXPECT_TRUE(bad);
  }
}

}  // namespace
}  // namespace asperity::moteus
