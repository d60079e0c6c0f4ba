// asperity::can on a CAN adapter whose other end is in this process, and on an emulated PCI card where there is one.
#include <algorithm>
#include <gtest/gtest.h>
#include <memory>
#include <string>
#include <vector>

#include "asperity/can/socketcan.hpp"
#include "hardware/kernel/can_support.hpp"
#include "hardware/kernel/network.hpp"
#include "hardware/kernel/slcan_adapter.hpp"

namespace asperity::can_kernel_test {
namespace {

class slcan : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string reason = why_not(); !reason.empty()) GTEST_SKIP() << reason;
  }
  void plug_in(int queue_frames = 100) {
    if (const std::string reason = adapter.plug_in(queue_frames); !reason.empty()) GTEST_SKIP() << reason;
    auto opened = can::open_socketcan(adapter.interface());
    ASSERT_TRUE(opened) << opened.error().message;
    bus = std::move(opened).value();
  }
  [[nodiscard]] can_health health() {
    can_frame in;
    static_cast<void>(bus->receive(now_ns(), in));
    return bus->health();
  }
  [[nodiscard]] can::interface_state listed() const {
    for (const can::interface_state& i : can::list_interfaces()) {
      if (i.name == adapter.interface()) return i;
    }
    return {};
  }

  slcan_adapter adapter;
  std::unique_ptr<can_bus> bus;
};

TEST_F(slcan, knows_every_state_of_the_controller_and_comes_back_from_bus_off) {
  plug_in();
  if (!bus) return;
  can_frame in;
  ASSERT_EQ(bus->send(now_ns(), frame_of(0x123, {1, 2, 3})), io_status::ok);
  ASSERT_EQ(receive_soon(*bus, in), io_status::ok) << "through the driver, the line, the adapter, and back";
  EXPECT_EQ(in.id, 0x523U);
  EXPECT_EQ(in.size, 3);
  EXPECT_EQ(in.data[2], 3);

  ASSERT_TRUE(adapter.say("sw100101\r"));
  ASSERT_TRUE(soon([&] { return health().transmit_errors != 0; }));
  EXPECT_FALSE(bus->health().error_passive);
  ASSERT_TRUE(adapter.say("sp130128\r"));
  ASSERT_TRUE(soon([&] { return health().error_passive; }));
  EXPECT_EQ(std::min(bus->health().transmit_errors, bus->health().receive_errors), 128);
  EXPECT_EQ(std::max(bus->health().transmit_errors, bus->health().receive_errors), 130);

  ASSERT_TRUE(adapter.say("sb255000\r"));
  ASSERT_TRUE(soon([&] { return health().bus_off; }));
  EXPECT_EQ(bus->send(now_ns(), frame_of(0x123, {})), io_status::down);
  EXPECT_EQ(bus->receive(now_ns(), in), io_status::down);
  EXPECT_FALSE(listed().running);
  EXPECT_NE(listed().problem.find("bus-off"), std::string::npos) << listed().problem;

  // The way out that every driver has: down and up again.
  ASSERT_EQ(network::set_up(adapter.interface(), false), 0);
  ASSERT_EQ(network::set_up(adapter.interface(), true), 0);
  ASSERT_TRUE(soon([&] { return bus->receive(now_ns(), in) == io_status::nothing; }));
  EXPECT_FALSE(bus->health().bus_off);
  ASSERT_EQ(bus->send(now_ns(), frame_of(0x124, {7})), io_status::ok);
  ASSERT_EQ(receive_soon(*bus, in), io_status::ok);
  EXPECT_EQ(in.id, 0x524U);
}

TEST_F(slcan, is_busy_while_the_adapter_takes_nothing_and_sends_again_after) {
  plug_in(10);
  if (!bus) return;
  adapter.stall(true);
  int taken = 0;
  io_status s = io_status::ok;
  std::int64_t t = now_ns();
  for (; s == io_status::ok && taken < 20'000; ++taken) s = bus->send(t, frame_of(1, {1, 2, 3, 4, 5, 6, 7, 8}));
  EXPECT_EQ(s, io_status::busy) << "after " << taken << " frames";
  EXPECT_EQ(bus->errno_value(), ENOBUFS);
  adapter.stall(false);
  ASSERT_TRUE(soon([&] { return bus->send(now_ns(), frame_of(2, {})) == io_status::ok; }));
}

TEST_F(slcan, is_gone_when_the_adapter_is_pulled_out) {
  plug_in();
  if (!bus) return;
  adapter.unplug();
  can_frame in;
  ASSERT_TRUE(soon([&] { return bus->receive(now_ns(), in) == io_status::gone; }));
  EXPECT_EQ(bus->send(now_ns(), frame_of(1, {})), io_status::gone);
  EXPECT_TRUE(listed().name.empty());
}

TEST_F(slcan, is_gone_when_only_sending) {
  plug_in();
  if (!bus) return;
  adapter.unplug();
  ASSERT_TRUE(soon([&] { return bus->send(now_ns(), frame_of(1, {})) == io_status::gone; }));
}

/// Two channels of an emulated card on one bus, through a driver that is used with real ones. Classic CAN only.
TEST(kvaser_pci, two_ports_of_a_card_talk) {
  if (const std::string reason = why_not(); !reason.empty()) GTEST_SKIP() << reason;
  std::vector<std::string> ports;
  for (const can::interface_state& i : can::list_interfaces()) {
    if (i.driver == "kvaser_pci") ports.push_back(i.name);
  }
  if (ports.size() < 2) GTEST_SKIP() << "there are no two ports of a Kvaser PCI card";
  std::vector<std::unique_ptr<can_bus>> buses;
  for (const std::string& port : {ports.front(), ports.back()}) {
    ASSERT_EQ(network::set_up(port, false), 0);
    ASSERT_EQ(network::set_bit_rate(port, 500'000), 0);
    ASSERT_EQ(network::set_up(port, true), 0);
    EXPECT_FALSE(can::open_socketcan(port, {.fd = true})) << "the card has no FD";
    auto opened = can::open_socketcan(port);
    ASSERT_TRUE(opened) << opened.error().message;
    buses.push_back(std::move(opened).value());
  }
  can_frame in;
  for (std::uint8_t i = 0; i < 50; ++i) {
    ASSERT_EQ(buses[i % 2]->send(now_ns(), frame_of(0x100U + i, {i, 2})), io_status::ok);
    ASSERT_EQ(receive_soon(*buses[1 - i % 2], in), io_status::ok);
    EXPECT_EQ(in.id, 0x100U + i);
    EXPECT_EQ(in.data[0], i);
    EXPECT_EQ(buses[i % 2]->receive(now_ns(), in), io_status::nothing);
  }
  ASSERT_EQ(network::set_up(ports.front(), false), 0);
  EXPECT_EQ(buses[0]->receive(now_ns(), in), io_status::down);
  ASSERT_EQ(network::set_up(ports.front(), true), 0);
  ASSERT_TRUE(soon([&] { return buses[0]->receive(now_ns(), in) == io_status::nothing; }));
  ASSERT_EQ(buses[1]->send(now_ns(), frame_of(0x77, {})), io_status::ok);
  ASSERT_EQ(receive_soon(*buses[0], in), io_status::ok);
  for (const std::string& port : {ports.front(), ports.back()}) EXPECT_EQ(network::set_up(port, false), 0);
}

}  // namespace
}  // namespace asperity::can_kernel_test
