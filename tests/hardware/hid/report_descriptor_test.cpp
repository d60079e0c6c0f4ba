#include <array>
#include <cstdint>
#include <gtest/gtest.h>
#include <random>
#include <span>
#include <vector>

#include <asperity/drivers/hid/report_descriptor.hpp>

#include "hardware/peers/hid_items.hpp"
#include "session/rt/tick_trap.hpp"

namespace {

using namespace asperity;
using test_support::hid_items;

report_descriptor parse(const hid_items& d) { return parse_report_descriptor(d.bytes); }

TEST(report_descriptor, is_read_from_a_space_navigator) {
  const std::vector<std::uint8_t> bytes = test_support::space_navigator_descriptor();
  ASSERT_EQ(bytes.size(), 217U);  // as recorded
  const report_descriptor d = parse_report_descriptor(bytes);
  ASSERT_EQ(d.status, descriptor_status::ok);
  EXPECT_TRUE(d.numbered);
  for (std::uint16_t i = 0; i < 6; ++i) {
    const hid_field* f = d.find(hid_report_kind::input, 1, static_cast<std::uint16_t>(0x30 + i));
    ASSERT_NE(f, nullptr) << i;
    EXPECT_EQ(f->report_id, i < 3 ? 1 : 2);
    EXPECT_EQ(f->bit_offset, 16U * (i % 3U));
    EXPECT_EQ(f->bit_size, 16U);
    EXPECT_EQ(f->logical_min, -350);
    EXPECT_EQ(f->logical_max, 350);
    EXPECT_EQ(f->physical_min, -1400);
    EXPECT_EQ(f->physical_max, 1400);
    EXPECT_EQ(f->unit_exponent, -4);
    EXPECT_EQ(f->unit, 0x11U);
    EXPECT_TRUE(f->relative);
    EXPECT_EQ(f->top_page, 1);
    EXPECT_EQ(f->top_usage, 8);
  }
  const hid_field* second = d.find(hid_report_kind::input, 9, 2);
  ASSERT_NE(second, nullptr);
  EXPECT_EQ(second->report_id, 3);
  EXPECT_EQ(second->bit_offset, 1U);
  const hid_field* light = d.find(hid_report_kind::output, 8, 0x4b);
  ASSERT_NE(light, nullptr);
  EXPECT_EQ(light->report_id, 4);
  EXPECT_EQ(d.report_bytes(hid_report_kind::input, 1), 7U);
  EXPECT_EQ(d.report_bytes(hid_report_kind::input, 2), 7U);
  EXPECT_EQ(d.report_bytes(hid_report_kind::input, 3), 3U);
  EXPECT_EQ(d.report_bytes(hid_report_kind::output, 4), 2U);
  EXPECT_EQ(d.report_bytes(hid_report_kind::feature, 8), 8U);
  EXPECT_EQ(d.report_bytes(hid_report_kind::input, 9), 0U);
}

TEST(report_descriptor, is_read_from_a_spacemouse_wireless) {
  const std::vector<std::uint8_t> bytes = test_support::spacemouse_wireless_descriptor();
  ASSERT_EQ(bytes.size(), 270U);  // as recorded
  const report_descriptor d = parse_report_descriptor(bytes);
  ASSERT_EQ(d.status, descriptor_status::ok);
  for (std::uint16_t i = 0; i < 6; ++i) {
    const hid_field* f = d.find(hid_report_kind::input, 1, static_cast<std::uint16_t>(0x30 + i));
    ASSERT_NE(f, nullptr) << i;
    EXPECT_EQ(f->report_id, 1);
    EXPECT_EQ(f->bit_offset, 16U * i);
    EXPECT_FALSE(f->relative);
  }
  EXPECT_EQ(d.report_bytes(hid_report_kind::input, 1), 13U);
  const hid_field* battery = d.find(hid_report_kind::input, 6, 0x20);
  ASSERT_NE(battery, nullptr);
  EXPECT_EQ(battery->report_id, 0x17);
  EXPECT_EQ(battery->logical_max, 100);
}

TEST(report_descriptor, gives_a_maximum_a_sign_with_its_minimum_only) {
  // 25 ff: 255 beside a minimum of 0, -1 beside a negative one.
  const std::vector<std::uint8_t> plain{0x15, 0x00, 0x25, 0xff, 0x75, 0x08, 0x95, 0x01, 0x09, 0x01, 0x81, 0x02};
  const std::vector<std::uint8_t> below{0x15, 0x80, 0x25, 0xff, 0x75, 0x08, 0x95, 0x01, 0x09, 0x01, 0x81, 0x02};
  EXPECT_EQ(parse_report_descriptor(plain).fields[0].logical_max, 255);
  EXPECT_EQ(parse_report_descriptor(below).fields[0].logical_max, -1);
  // A physical range that is not given is the logical one.
  EXPECT_EQ(parse_report_descriptor(plain).fields[0].physical_max, 255);
}

TEST(report_descriptor, keeps_usages_to_their_main_item_and_globals_on_a_stack) {
  hid_items d;
  d.page(1).logical(0, 127).bits(8).count(3).usage(0x30).usage(0x31).input(2);  // three fields, two usages
  d.bytes.push_back(0xa4);                                                      // push
  d.page(9).bits(1).count(1).usage(0x000c0001).input(2);                        // a usage with a page of its own
  d.bytes.push_back(0xb4);                                                      // pop
  d.count(1).input(2);                                                          // no usage is left
  const report_descriptor r = parse(d);
  ASSERT_EQ(r.status, descriptor_status::ok);
  ASSERT_EQ(r.fields.size(), 5U);
  EXPECT_EQ(r.fields[1].usage, 0x31);
  EXPECT_EQ(r.fields[2].usage, 0x31);  // the last one repeats
  EXPECT_EQ(r.fields[3].usage_page, 0x0c);
  EXPECT_EQ(r.fields[3].usage, 1);
  EXPECT_EQ(r.fields[4].usage_page, 1);
  EXPECT_EQ(r.fields[4].usage, 0);
  EXPECT_EQ(r.fields[4].bit_size, 8U);
  EXPECT_EQ(r.fields[4].bit_offset, 25U);
}

TEST(report_descriptor, says_what_is_wrong_and_keeps_nothing) {
  const auto status_of = [](std::vector<std::uint8_t> bytes) {
    const report_descriptor d = parse_report_descriptor(bytes);
    if (d.status != descriptor_status::ok) {
      EXPECT_TRUE(d.fields.empty() && d.reports.empty());
    }
    return d.status;
  };
  EXPECT_EQ(status_of({}), descriptor_status::empty);
  EXPECT_EQ(status_of({0x05}), descriptor_status::cut_off);
  EXPECT_EQ(status_of({0xfe, 0x05, 0x00, 0x01}), descriptor_status::cut_off);
  EXPECT_EQ(status_of({0xfe, 0x01, 0x00, 0x01}), descriptor_status::ok);  // a long item is passed over
  EXPECT_EQ(status_of({0xa1, 0x01}), descriptor_status::unbalanced);
  EXPECT_EQ(status_of({0xc0}), descriptor_status::unbalanced);
  EXPECT_EQ(status_of({0xb4}), descriptor_status::unbalanced);
  EXPECT_EQ(status_of({0xb4, 0xa4}), descriptor_status::unbalanced);
  EXPECT_EQ(status_of({0xa4}), descriptor_status::unbalanced);
  EXPECT_EQ(status_of({0x85, 0x00}), descriptor_status::bad_item);
  EXPECT_EQ(status_of({0x19, 0x05, 0x29, 0x02}), descriptor_status::bad_item);
  EXPECT_EQ(status_of({0x0c}), descriptor_status::bad_item);
  EXPECT_EQ(status_of({0x77, 0xff, 0xff, 0xff, 0xff}), descriptor_status::too_large);
  EXPECT_EQ(status_of({0x75, 0x20, 0x96, 0xff, 0xff, 0x81, 0x02}), descriptor_status::too_large);
  EXPECT_EQ(status_of(std::vector<std::uint8_t>(4097, 0x04)), descriptor_status::too_large);
  std::vector<std::uint8_t> deep;
  for (int i = 0; i < 40; ++i) deep.insert(deep.end(), {0xa1, 0x00});
  EXPECT_EQ(status_of(deep), descriptor_status::too_large);
}

TEST(report_descriptor, counts_what_does_not_fit) {
  hid_items d;
  d.page(9).usages(1, 0xffff).logical(0, 1).bits(1).count(1000).input(2);
  const report_descriptor r = parse(d);
  EXPECT_EQ(r.status, descriptor_status::capacity);
  EXPECT_EQ(r.fields.size(), report_descriptor::max_fields);
  EXPECT_EQ(r.fields.dropped(), 1000U - report_descriptor::max_fields);
  EXPECT_EQ(r.report_bytes(hid_report_kind::input, 0), 125U);
}

TEST(report_fields, come_out_as_they_went_in) {
  std::mt19937_64 bits(7);
  for (int n = 0; n < 20'000; ++n) {
    hid_field f;
    f.bit_size = 1 + static_cast<std::uint32_t>(bits() % 32);
    f.bit_offset = static_cast<std::uint32_t>(bits() % 64);
    f.logical_min = bits() % 2 == 0 ? -1 : 0;
    const bool numbered = bits() % 2 == 0;
    std::array<std::uint8_t, 16> report{};
    for (std::uint8_t& b : report) b = static_cast<std::uint8_t>(bits());
    const std::array<std::uint8_t, 16> before = report;
    const auto mask = static_cast<std::uint32_t>((std::uint64_t{1} << f.bit_size) - 1);
    const std::uint32_t raw = static_cast<std::uint32_t>(bits()) & mask;
    const bool minus = f.logical_min < 0 && (raw >> (f.bit_size - 1)) != 0;
    const auto value = static_cast<std::int32_t>(minus ? raw | ~mask : raw);
    ASSERT_TRUE(write_field(report, numbered, f, value));
    std::int32_t back = 0;
    ASSERT_TRUE(read_field(report, numbered, f, back));
    ASSERT_EQ(back, value) << f.bit_size << " bits at " << f.bit_offset;
    const std::size_t first = f.bit_offset + (numbered ? 8U : 0U);
    for (std::size_t i = 0; i < 8 * report.size(); ++i) {  // its neighbours are as they were
      if (i >= first && i < first + f.bit_size) continue;
      ASSERT_EQ((report[i / 8] >> (i % 8)) & 1, (before[i / 8] >> (i % 8)) & 1);
    }
    const std::size_t needed = (first + f.bit_size + 7) / 8;
    EXPECT_FALSE(read_field(std::span<const std::uint8_t>(report).first(needed - 1), numbered, f, back));
  }
}

// What every parsed descriptor promises, whatever its bytes were.
void expect_sound(const report_descriptor& d) {
  for (const hid_field& f : d.fields) {
    ASSERT_GE(f.bit_size, 1U);
    ASSERT_LE(f.bit_size, 32U);
    ASSERT_LE(f.bit_offset + f.bit_size, report_descriptor::max_report_bits);
    const std::size_t bytes = d.report_bytes(f.kind, f.report_id);
    ASSERT_LE(f.bit_offset + f.bit_size + (d.numbered ? 8U : 0U), 8 * bytes);
  }
  if (d.status != descriptor_status::ok && d.status != descriptor_status::capacity) {
    ASSERT_TRUE(d.fields.empty());
  }
}

TEST(report_descriptor, survives_any_bytes_in_bounded_memory) {
  const std::vector<std::vector<std::uint8_t>> corpus{
      test_support::space_navigator_descriptor(),
      test_support::spacemouse_wireless_descriptor(),
      {0xfe, 0xff, 0x00},
      {0x95, 0xff, 0x75, 0xff, 0x81, 0x00},
      {0x1b, 0x00, 0x00, 0x09, 0x00, 0x2b, 0xff, 0xff, 0xff, 0xff, 0x95, 0xff, 0x75, 0x01, 0x81, 0x02},
      {0xa9, 0x01, 0x09, 0x30, 0x09, 0x31, 0xa9, 0x00, 0x75, 0x08, 0x95, 0x02, 0x81, 0x02},
  };
  test_support::tick_trap trap;
  const bool trapped = test_support::tick_trap::missing().empty();
  std::mt19937_64 bits(11);
  std::array<std::uint8_t, 512> bytes{};
  int understood = 0;
  for (int n = 0; n < 30'000; ++n) {
    std::size_t size = 0;
    if (n % 4 == 0) {
      size = bits() % bytes.size();
      for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::uint8_t>(bits());
    } else {
      const std::vector<std::uint8_t>& seed = corpus[bits() % corpus.size()];
      size = seed.size();
      std::copy(seed.begin(), seed.end(), bytes.begin());
      const int changes = 1 + static_cast<int>(bits() % 4);
      for (int c = 0; c < changes; ++c) {
        const std::size_t at = bits() % size;
        const std::uint64_t kind = bits() % 8;
        if (kind == 0) {
          size = std::max<std::size_t>(1, at);
        } else if (kind < 4) {
          bytes[at] = static_cast<std::uint8_t>(bits());
        } else {
          bytes[at] = static_cast<std::uint8_t>(bytes[at] ^ (1U << (bits() % 8)));
        }
      }
    }
    const std::span<const std::uint8_t> in = std::span<const std::uint8_t>(bytes).first(size);
    report_descriptor d;
    const auto run = [&]() noexcept { d = parse_report_descriptor(in); };
    if (trapped) {
      trap(run);
    } else {
      run();
    }
    expect_sound(d);
    if (HasFatalFailure()) return;
    understood += d.status == descriptor_status::ok && !d.fields.empty() ? 1 : 0;
  }
  EXPECT_GT(understood, 2'000);  // otherwise the fuzz never got past the door
  std::printf("%d of 30000 hostile descriptors were understood; allocations %s\n", understood,
              trapped ? "trapped" : "not looked at in this build");
}

}  // namespace
