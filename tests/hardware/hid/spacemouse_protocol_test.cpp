#include <gtest/gtest.h>

#include <asperity/drivers/hid/report_descriptor.hpp>
#include <asperity/drivers/spacemouse/products.hpp>
#include <asperity/drivers/spacemouse/protocol.hpp>

#include "hardware/peers/fake_spacemouse.hpp"
#include "session/rt/tick_trap.hpp"

namespace {

using namespace asperity;
using test_support::fake_spacemouse;
using test_support::spacemouse_kind;
using bytes = std::vector<std::uint8_t>;
using axes = std::array<std::int32_t, 6>;

spacemouse_format format_of(spacemouse_kind kind) {
  return spacemouse_format::from(parse_report_descriptor(fake_spacemouse::descriptor(kind)));
}

struct golden {
  bytes report;
  axes counts;
  axis_mask brought;
};

const std::vector<golden> classic{
    {{0x01, 0, 0, 0, 0, 0, 0}, {}, translation_axes},                                   // recorded, at rest
    {{0x02, 0x00, 0x00, 0xe2, 0xff, 0x00, 0x00}, {0, 0, 0, 0, -30, 0}, rotation_axes},  // recorded, right side down
    {{0x01, 0x0a, 0x00, 0xf6, 0xff, 0x64, 0x00}, {10, -10, 100, 0, 0, 0}, translation_axes},
    {{0x02, 0x5e, 0x01, 0xa2, 0xfe, 0xff, 0xff}, {0, 0, 0, 350, -350, -1}, rotation_axes},
};
const std::vector<golden> combined{
    {{0x01, 0x0a, 0, 0xf6, 0xff, 0x64, 0, 0x5e, 0x01, 0xa2, 0xfe, 0xff, 0xff}, {10, -10, 100, 350, -350, -1}, all_axes},
    {bytes(13, 0x01), {257, 257, 257, 257, 257, 257}, all_axes},
};

TEST(spacemouse_protocol, reads_the_golden_reports_with_and_without_a_descriptor) {
  for (const bool described : {true, false}) {
    for (const auto& [kind, set] :
         {std::pair{spacemouse_kind::classic, classic}, {spacemouse_kind::combined, combined}}) {
      const spacemouse_format f = described ? format_of(kind) : spacemouse_format::by_length();
      EXPECT_EQ(f.described(), described);
      EXPECT_EQ(f.axes(), all_axes);
      for (const golden& g : set) {
        spacemouse_input in;
        ASSERT_EQ(f.decode(g.report, in), spacemouse_decoding::understood);
        EXPECT_EQ(in.counts, g.counts);
        EXPECT_EQ(in.brought, g.brought);
        EXPECT_FALSE(in.has_buttons);
      }
    }
  }
}

TEST(spacemouse_protocol, is_what_the_fake_sends) {
  for (const auto& [kind, set] :
       {std::pair{spacemouse_kind::classic, classic}, {spacemouse_kind::combined, combined}}) {
    for (const golden& g : set) {
      std::vector<bytes> sent;
      fake_spacemouse mouse(
          kind, [&](std::int64_t, std::span<const std::uint8_t> r) { sent.emplace_back(r.begin(), r.end()); });
      std::array<std::int16_t, 6> counts{};
      for (std::size_t i = 0; i < 6; ++i) counts[i] = static_cast<std::int16_t>(g.counts[i]);
      if (counts == std::array<std::int16_t, 6>{}) {
        mouse.push({1, 0, 0, 0, 0, 0});
        mouse.release();
      } else {
        mouse.push(counts);
      }
      mouse.step(0);
      mouse.step(8'000'000);
      EXPECT_NE(std::find(sent.begin(), sent.end(), g.report), sent.end());
    }
  }
}

TEST(spacemouse_protocol, reads_buttons_and_battery) {
  const spacemouse_format navigator = format_of(spacemouse_kind::classic);
  const spacemouse_format wireless = format_of(spacemouse_kind::combined);
  const spacemouse_format by_length = spacemouse_format::by_length();
  for (const spacemouse_format* f : {&navigator, &wireless, &by_length}) {
    for (const auto& [report, buttons] :
         {std::pair{bytes{3, 1, 0}, 1U}, {bytes{3, 2, 0}, 2U}, {bytes{3, 3, 0}, 3U}, {bytes{3, 0, 0}, 0U}}) {
      spacemouse_input in;
      ASSERT_EQ(f->decode(report, in), spacemouse_decoding::understood);
      EXPECT_TRUE(in.has_buttons);
      EXPECT_EQ(in.buttons, buttons);
      EXPECT_EQ(in.brought, no_axes);
    }
  }
  // Bits that the descriptor calls padding are no buttons.
  spacemouse_input in;
  ASSERT_EQ(navigator.decode(bytes{3, 0xfc, 0xff}, in), spacemouse_decoding::understood);
  EXPECT_EQ(in.buttons, 0U);
  // 32 buttons where only the length is known: MENU, FIT, 1, ESC, ALT, SHIFT, CTRL of a Pro.
  ASSERT_EQ(by_length.decode(bytes{3, 0x03, 0x10, 0xc0, 0x03}, in), spacemouse_decoding::understood);
  EXPECT_EQ(in.buttons, 0x03c01003U);
  for (const spacemouse_format* f : {&wireless, &by_length}) {
    ASSERT_EQ(f->decode(bytes{0x17, 100, 1}, in), spacemouse_decoding::understood);
    EXPECT_TRUE(in.has_battery);
    EXPECT_EQ(in.battery_percent, 100);
    EXPECT_TRUE(in.charging);
    ASSERT_EQ(f->decode(bytes{0x17, 0xff, 0}, in), spacemouse_decoding::understood);
    EXPECT_EQ(in.battery_percent, 100);  // not 255 %
    EXPECT_FALSE(in.charging);
  }
  EXPECT_EQ(navigator.decode(bytes{0x17, 100, 1}, in), spacemouse_decoding::unknown);
}

TEST(spacemouse_protocol, takes_nothing_of_a_report_that_ends_early) {
  for (const auto& [kind, set] :
       {std::pair{spacemouse_kind::classic, classic}, {spacemouse_kind::combined, combined}}) {
    const spacemouse_format f = format_of(kind);
    for (std::size_t n = 0; n < set[0].report.size(); ++n) {
      spacemouse_input in;
      in.counts.fill(77);
      EXPECT_EQ(f.decode(std::span(set[0].report).first(n), in), spacemouse_decoding::too_short) << n;
      EXPECT_EQ(in.counts[5], 77);
    }
  }
  spacemouse_input in;
  EXPECT_EQ(spacemouse_format::by_length().decode(bytes{1, 0, 0, 0, 0, 0}, in), spacemouse_decoding::too_short);
  EXPECT_EQ(spacemouse_format::by_length().decode(bytes{3}, in), spacemouse_decoding::too_short);
  EXPECT_EQ(spacemouse_format::by_length().decode(bytes{0x17, 1}, in), spacemouse_decoding::too_short);
  EXPECT_EQ(spacemouse_format::by_length().decode(bytes{0x42, 1, 2, 3}, in), spacemouse_decoding::unknown);
}

TEST(spacemouse_protocol, switches_the_light) {
  std::array<std::uint8_t, 8> room{};
  for (const spacemouse_format& f : {format_of(spacemouse_kind::classic), spacemouse_format::by_length()}) {
    for (const bool on : {true, false}) {
      room.fill(0xff);
      const std::span<const std::uint8_t> r = f.encode_light(on, room);
      ASSERT_EQ(r.size(), 2U);
      EXPECT_EQ(r[0], 4);
      EXPECT_EQ(r[1], on ? 1 : 0);
    }
    EXPECT_TRUE(f.encode_light(true, std::span(room).first(1)).empty());
  }
  // A device without numbers: a zero stands in front.
  test_support::hid_items d;
  d.page(1).usage(8).collection(1).logical(-350, 350).bits(16).count(1).usage(0x30).input(2);
  d.page(8).usage(0x4b).logical(0, 1).bits(1).count(1).output(2).bits(7).output(3).end();
  const spacemouse_format plain = spacemouse_format::from(parse_report_descriptor(d.bytes));
  EXPECT_EQ(plain.axes(), 1);
  const std::span<const std::uint8_t> r = plain.encode_light(true, room);
  ASSERT_EQ(r.size(), 2U);
  EXPECT_EQ(r[0], 0);
  EXPECT_EQ(r[1], 1);
  spacemouse_input in;
  ASSERT_EQ(plain.decode(bytes{0xfe, 0xff}, in), spacemouse_decoding::understood);
  EXPECT_EQ(in.counts[0], -2);
  // One without a light sends nothing.
  test_support::hid_items dark;
  dark.page(1).logical(-350, 350).bits(16).count(1).usage(0x30).input(2);
  EXPECT_TRUE(spacemouse_format::from(parse_report_descriptor(dark.bytes)).encode_light(true, room).empty());
}

TEST(spacemouse_protocol, falls_back_to_lengths_where_the_descriptor_names_no_axis) {
  EXPECT_FALSE(spacemouse_format::from(parse_report_descriptor({})).described());
  const bytes mouse_wheel{0x05, 0x01, 0x09, 0x38, 0x15, 0x81, 0x25, 0x7f, 0x75, 0x08, 0x95, 0x01, 0x81, 0x06};
  EXPECT_FALSE(spacemouse_format::from(parse_report_descriptor(mouse_wheel)).described());
}

TEST(spacemouse_protocol, survives_any_report) {
  test_support::tick_trap trap;
  const bool trapped = test_support::tick_trap::missing().empty();
  const std::array formats{format_of(spacemouse_kind::classic), format_of(spacemouse_kind::combined),
                           spacemouse_format::by_length()};
  std::mt19937_64 bits(3);
  std::array<std::uint8_t, 64> report{};
  std::uint64_t understood = 0;
  for (int n = 0; n < 200'000; ++n) {
    for (std::uint8_t& b : report) b = static_cast<std::uint8_t>(bits());
    if (n % 2 == 0) report[0] = std::array<std::uint8_t, 5>{1, 2, 3, 4, 0x17}[bits() % 5];
    const std::span<const std::uint8_t> in = std::span<const std::uint8_t>(report).first(bits() % 65);
    spacemouse_input got;
    const auto run = [&]() noexcept {
      understood +=
          formats[static_cast<std::size_t>(n) % 3].decode(in, got) == spacemouse_decoding::understood ? 1U : 0U;
    };
    if (trapped) {
      trap(run);
    } else {
      run();
    }
    for (const std::int32_t c : got.counts) ASSERT_TRUE(c >= -32768 && c <= 32767);
    ASSERT_LE(got.battery_percent, 100);
  }
  EXPECT_GT(understood, 50'000U);
}

TEST(spacemouse_products, are_found_by_their_numbers) {
  ASSERT_NE(find_spacemouse(0x046d, 0xc626), nullptr);
  EXPECT_EQ(find_spacemouse(0x046d, 0xc626)->name, "SpaceNavigator");
  EXPECT_EQ(find_spacemouse(0x256f, 0xc626), nullptr);  // the number belongs to the other vendor
  EXPECT_EQ(find_spacemouse(0x256f, 0xc650), nullptr);  // a CadMouse
  for (std::size_t i = 0; i < spacemouse_products.size(); ++i) {
    const spacemouse_product& p = spacemouse_products[i];
    EXPECT_EQ(find_spacemouse(p.vendor_id, p.product_id), &p) << p.name;  // none is there twice
  }
}

}  // namespace
