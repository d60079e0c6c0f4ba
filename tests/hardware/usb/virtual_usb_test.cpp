// The cable that exists in this process only does what its script says.
#include "asperity/transport/virtual/virtual_usb.hpp"

#include <array>
#include <cstdint>
#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace {

using namespace asperity;

std::vector<std::uint8_t> taken(virtual_usb& device, std::int64_t now_ns) {
  std::vector<std::uint8_t> all;
  std::array<std::uint8_t, 512> buffer{};
  while (const std::size_t n = device.take(now_ns, buffer)) all.insert(all.end(), buffer.begin(), buffer.begin() + n);
  return all;
}

std::vector<std::uint8_t> read_all(usb_link& link, std::int64_t now_ns) {
  std::vector<std::uint8_t> all;
  std::array<std::uint8_t, 512> buffer{};
  usb_packet p;
  while (link.read(now_ns, buffer, p) == io_status::ok) {
    all.insert(all.end(), buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(p.size));
  }
  return all;
}

io_status put(usb_link& link, std::int64_t now_ns, std::uint8_t byte) {
  const std::array<std::uint8_t, 2> bytes = {byte, 0xee};
  return link.write(now_ns, bytes);
}

using bytes = std::vector<std::uint8_t>;

TEST(virtual_usb, carries_both_ways_with_its_latency) {
  virtual_usb device({.latency_ns = 100});
  auto link = device.open();
  ASSERT_TRUE(link);
  EXPECT_EQ(put(*link, 1000, 1), io_status::ok);
  EXPECT_EQ(taken(device, 1099), bytes{});
  EXPECT_EQ(taken(device, 1100), (bytes{1, 0xee}));
  EXPECT_TRUE(device.give(2000, bytes{7, 8, 9}));
  std::array<std::uint8_t, 8> buffer{};
  usb_packet p;
  EXPECT_EQ(link->read(2099, buffer, p), io_status::nothing);
  EXPECT_EQ(link->read(2150, buffer, p), io_status::ok);
  EXPECT_EQ(p.size, 3U);
  EXPECT_EQ(p.host_time_ns, 2100);
  EXPECT_TRUE(device.give(3000, bytes(9, 1)));
  EXPECT_EQ(link->read(3100, buffer, p), io_status::too_short);
  EXPECT_EQ(link->read(3100, buffer, p), io_status::nothing);
}

TEST(virtual_usb, is_busy_while_nobody_takes) {
  virtual_usb device({}, 2);
  auto link = device.open();
  EXPECT_EQ(put(*link, 0, 1), io_status::ok);
  EXPECT_EQ(put(*link, 0, 2), io_status::ok);
  EXPECT_EQ(put(*link, 0, 3), io_status::busy);
  EXPECT_EQ(taken(device, 0), (bytes{1, 0xee, 2, 0xee}));
  EXPECT_EQ(put(*link, 0, 3), io_status::ok);
  EXPECT_EQ(link->write(0, bytes(513, 0)), io_status::refused);
}

TEST(virtual_usb, asks_the_device_for_control) {
  virtual_usb device;
  auto link = device.open();
  std::array<std::uint8_t, 4> data{};
  std::size_t done = 0;
  EXPECT_EQ(link->control({.request = 1}, data, done, 1), io_status::refused);
  device.on_control([](const usb_setup& s, std::span<std::uint8_t> d, std::size_t& n) {
    d[0] = s.request;
    n = 1;
    return io_status::ok;
  });
  EXPECT_EQ(link->control({.request = 9}, data, done, 1), io_status::ok);
  EXPECT_EQ(done, 1U);
  EXPECT_EQ(data[0], 9);
}

// What arrives when the second of four transfers each way has a fault.
struct arrivals {
  bytes at_device;
  bytes at_host;
};
arrivals with_fault(link_fault kind, std::int64_t amount_ns = 0) {
  virtual_usb device({.events = {{.kind = kind, .from_call = 1, .until_call = 2, .amount_ns = amount_ns}}}, 8);
  auto link = device.open();
  arrivals out;
  for (std::uint8_t i = 1; i <= 4; ++i) EXPECT_EQ(put(*link, 10 * i, i), io_status::ok);
  out.at_device = taken(device, 1000);

  virtual_usb other({.events = {{.kind = kind, .from_call = 1, .until_call = 2, .amount_ns = amount_ns}}});
  link = other.open();
  for (std::uint8_t i = 1; i <= 4; ++i) EXPECT_TRUE(other.give(10 * i, bytes{i, 0xee}));
  std::array<std::uint8_t, 8> buffer{};
  for (const std::int64_t now_ns : {10, 20}) {  // the first one, and a call for the second
    usb_packet p;
    if (link->read(now_ns, buffer, p) != io_status::ok) continue;
    out.at_host.insert(out.at_host.end(), buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(p.size));
  }
  const bytes rest = read_all(*link, 1000);
  out.at_host.insert(out.at_host.end(), rest.begin(), rest.end());
  return out;
}

TEST(virtual_usb, plays_every_fault_both_ways) {
  const bytes lost{1, 0xee, 3, 0xee, 4, 0xee};
  EXPECT_EQ(with_fault(link_fault::lose).at_device, lost);
  EXPECT_EQ(with_fault(link_fault::lose).at_host, lost);
  const bytes swapped{1, 0xee, 3, 0xee, 2, 0xee, 4, 0xee};
  EXPECT_EQ(with_fault(link_fault::reorder).at_device, swapped);
  EXPECT_EQ(with_fault(link_fault::reorder).at_host, swapped);
  EXPECT_EQ(with_fault(link_fault::delay, 15).at_device, swapped);
  EXPECT_EQ(with_fault(link_fault::delay, 15).at_host, swapped);
  const bytes twice{1, 0xee, 2, 0xee, 2, 0xee, 3, 0xee, 4, 0xee};
  EXPECT_EQ(with_fault(link_fault::duplicate).at_device, twice);
  EXPECT_EQ(with_fault(link_fault::duplicate).at_host, twice);
  const bytes shorter{1, 0xee, 2, 3, 0xee, 4, 0xee};
  EXPECT_EQ(with_fault(link_fault::shorten).at_device, shorter);
  EXPECT_EQ(with_fault(link_fault::shorten).at_host, shorter);
  for (const bytes& got : {with_fault(link_fault::flip_bit).at_device, with_fault(link_fault::flip_bit).at_host}) {
    ASSERT_EQ(got.size(), 8U);
    EXPECT_EQ(std::popcount(static_cast<unsigned>((got[2] ^ 2) | ((got[3] ^ 0xee) << 8))), 1);
  }
}

TEST(virtual_usb, answers_what_the_script_says_and_unplugs_for_ever) {
  virtual_usb device({.events = {fail_call(1, io_status::busy), {.kind = link_fault::unplug, .from_call = 3}}});
  auto link = device.open();
  EXPECT_EQ(device.open(), nullptr);  // one host at a time
  EXPECT_EQ(put(*link, 0, 1), io_status::ok);
  EXPECT_EQ(put(*link, 0, 2), io_status::busy);
  EXPECT_EQ(put(*link, 0, 3), io_status::ok);
  EXPECT_EQ(taken(device, 0), (bytes{1, 0xee, 3, 0xee}));
  EXPECT_EQ(put(*link, 0, 4), io_status::gone);
  EXPECT_FALSE(device.plugged());
  EXPECT_EQ(device.open(), nullptr);
  device.plug_in();
  std::array<std::uint8_t, 8> buffer{};
  usb_packet p;
  EXPECT_EQ(link->read(0, buffer, p), io_status::gone);  // the old link stays dead
  EXPECT_FALSE(device.give(0, bytes{1}));
}

TEST(virtual_usb, a_link_that_was_pulled_does_not_close_the_next_one) {
  virtual_usb device;
  auto old = device.open();
  device.unplug();
  device.plug_in();
  auto link = device.open();
  ASSERT_TRUE(link);
  old.reset();
  EXPECT_TRUE(device.is_open());
  EXPECT_TRUE(device.give(0, bytes{5}));
  EXPECT_EQ(read_all(*link, 0), bytes{5});
}

}  // namespace
