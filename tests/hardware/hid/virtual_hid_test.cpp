#include <gtest/gtest.h>

#include <asperity/transport/virtual/virtual_hid.hpp>

namespace {

using namespace asperity;
using bytes = std::vector<std::uint8_t>;

bytes read_one(hid_link& link, std::int64_t now_ns, io_status expected = io_status::ok) {
  std::array<std::uint8_t, 64> room{};
  hid_report r;
  const io_status s = link.read(now_ns, room, r);
  EXPECT_EQ(s, expected) << to_string(s);
  return s == io_status::ok ? bytes(room.begin(), room.begin() + static_cast<std::ptrdiff_t>(r.size)) : bytes{};
}

link_script with(link_event e) { return {.events = {e}}; }

TEST(virtual_hid, carries_reports_both_ways_in_order) {
  virtual_hid device({1, 2, 3});
  const std::unique_ptr<hid_link> host = device.host_end();
  EXPECT_EQ(bytes(host->report_descriptor().begin(), host->report_descriptor().end()), (bytes{1, 2, 3}));
  read_one(*host, 0, io_status::nothing);
  ASSERT_TRUE(device.send(1, bytes{1, 10}));
  ASSERT_TRUE(device.send(1, bytes{1, 11}));
  EXPECT_EQ(read_one(*host, 1), (bytes{1, 10}));
  EXPECT_EQ(read_one(*host, 1), (bytes{1, 11}));
  ASSERT_EQ(host->write(2, bytes{4, 1}), io_status::ok);
  std::array<std::uint8_t, 8> room{};
  std::size_t size = 0;
  ASSERT_TRUE(device.receive(2, room, size));
  EXPECT_EQ(size, 2U);
  EXPECT_EQ(room[1], 1);
  EXPECT_FALSE(device.receive(2, room, size));
  EXPECT_EQ(host->write(2, bytes(65)), io_status::refused);
}

TEST(virtual_hid, keeps_the_oldest_63_reports_as_the_kernel_does) {
  virtual_hid device({});
  const std::unique_ptr<hid_link> host = device.host_end();
  for (std::uint8_t i = 0; i < 100; ++i) device.send(0, bytes{i});
  for (std::uint8_t i = 0; i < 63; ++i) EXPECT_EQ(read_one(*host, 0), bytes{i});
  read_one(*host, 0, io_status::nothing);
  EXPECT_EQ(device.dropped(), 37U);
}

TEST(virtual_hid, is_gone_for_an_open_link_once_unplugged) {
  virtual_hid device({});
  const std::unique_ptr<hid_link> host = device.host_end();
  device.send(0, bytes{1});
  device.unplug();
  EXPECT_FALSE(device.send(0, bytes{1}));
  read_one(*host, 0, io_status::gone);
  device.plug_in();
  device.send(0, bytes{2});
  read_one(*host, 0, io_status::gone);
  EXPECT_EQ(host->write(0, bytes{4}), io_status::gone);
  EXPECT_EQ(read_one(*device.host_end(), 0), bytes{2});
}

TEST(virtual_hid, plays_each_fault_of_its_script) {
  const auto after_two = [](link_script script, std::int64_t read_ns) {
    virtual_hid device({}, std::move(script));
    const std::unique_ptr<hid_link> host = device.host_end();
    device.send(0, bytes{1, 0xaa});
    device.send(0, bytes{2, 0xbb});
    std::vector<bytes> got;
    std::array<std::uint8_t, 64> room{};
    hid_report r;
    while (host->read(read_ns, room, r) == io_status::ok && got.size() < 9) {
      got.emplace_back(room.begin(), room.begin() + static_cast<std::ptrdiff_t>(r.size));
    }
    return got;
  };
  const bytes a{1, 0xaa};
  const bytes b{2, 0xbb};
  EXPECT_EQ(after_two({}, 0), (std::vector{a, b}));
  EXPECT_EQ(after_two({.latency_ns = 5}, 4), std::vector<bytes>{});
  EXPECT_EQ(after_two({.latency_ns = 5}, 5), (std::vector{a, b}));
  EXPECT_EQ(after_two(with({.kind = link_fault::lose}), 0), std::vector<bytes>{});
  EXPECT_EQ(after_two(with({.kind = link_fault::delay, .amount_ns = 9}), 8), std::vector<bytes>{});
  EXPECT_EQ(after_two(with({.kind = link_fault::reorder}), 0), (std::vector{b, a}));
  EXPECT_EQ(after_two(with({.kind = link_fault::duplicate}), 0), (std::vector{a, a, b, b}));
  EXPECT_EQ(after_two(with({.kind = link_fault::shorten}), 0), (std::vector{bytes{1}, bytes{2}}));
  EXPECT_EQ(after_two(with({.kind = link_fault::unplug}), 0), std::vector<bytes>{});
  EXPECT_EQ(after_two(with({.kind = link_fault::lose, .direction = link_direction::to_device}), 0),
            (std::vector{a, b}));
  const std::vector<bytes> flipped = after_two(with({.kind = link_fault::flip_bit}), 0);
  ASSERT_EQ(flipped.size(), 2U);
  int different = 0;
  for (std::size_t i = 0; i < 2; ++i) different += std::popcount(static_cast<unsigned>(flipped[0][i] ^ a[i]));
  EXPECT_EQ(different, 1);
  EXPECT_EQ(after_two(with({.kind = link_fault::flip_bit}), 0), flipped);  // seeded
}

TEST(virtual_hid, fails_the_call_that_the_script_names) {
  for (const io_status s : {io_status::failed, io_status::gone, io_status::too_short, io_status::busy}) {
    virtual_hid device({}, with(fail_call(1, s)));
    const std::unique_ptr<hid_link> host = device.host_end();
    device.send(0, bytes{7});
    ASSERT_EQ(host->write(0, bytes{4, 1}), io_status::ok);
    read_one(*host, 0, s);
    EXPECT_EQ(read_one(*host, 0), bytes{7});
    EXPECT_EQ(device.calls(), 3U);
  }
}

}  // namespace
