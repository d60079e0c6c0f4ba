// asperity::can on the kernel's virtual CAN interface.
#include <algorithm>
#include <array>
#include <gtest/gtest.h>
#include <linux/can/error.h>
#include <memory>
#include <set>
#include <string>

#include "asperity/can/socketcan.hpp"
#include "hardware/kernel/can_support.hpp"
#include "hardware/kernel/network.hpp"
#include "support/counted_news.hpp"

namespace asperity::can_kernel_test {
namespace {

constexpr const char* name = "vcanasp0";

class vcan : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string reason = why_not(); !reason.empty()) GTEST_SKIP() << reason;
    network::remove(name);
    if (!add()) GTEST_SKIP() << "this kernel has no virtual CAN interface (modprobe vcan)";
  }
  void TearDown() override { network::remove(name); }

  [[nodiscard]] static bool add() {
    return network::add_vcan(name) == 0 && network::set_mtu(name, 72) == 0 && network::set_up(name, true) == 0;
  }

  [[nodiscard]] static std::unique_ptr<can_bus> open(const can::socketcan_settings& options = {}) {
    auto bus = can::open_socketcan(name, options);
    EXPECT_TRUE(bus) << (bus ? "" : bus.error().message);
    return bus ? std::move(bus).value() : nullptr;
  }
};

TEST_F(vcan, carries_classic_frames_both_ways_and_never_ones_own) {
  const auto host = open();
  const auto drive = open();
  ASSERT_TRUE(host && drive);
  EXPECT_FALSE(host->takes_fd());
  for (const bool extended : {false, true}) {
    can_frame out = frame_of(extended ? 0x12345678 : 0x7FF, {1, 2, 3, 4, 5, 6, 7, 8});
    out.extended = extended;
    const std::int64_t before_ns = now_ns();
    ASSERT_EQ(host->send(before_ns, out), io_status::ok);
    can_frame in;
    ASSERT_EQ(receive_soon(*drive, in), io_status::ok);
    // The kernel had it after it was sent and before it was read; the clocks' difference is known to microseconds.
    EXPECT_GE(in.host_time_ns, before_ns - 1'000'000);
    EXPECT_LE(in.host_time_ns, now_ns());
    in.host_time_ns = 0;
    EXPECT_EQ(in, out);
    EXPECT_EQ(host->receive(now_ns(), in), io_status::nothing) << "the own frame came back";

    ASSERT_EQ(drive->send(now_ns(), out), io_status::ok);
    ASSERT_EQ(receive_soon(*host, in), io_status::ok);
  }
  can_frame ask = frame_of(0x123, {});
  ask.remote = true;
  ask.size = 4;
  ASSERT_EQ(host->send(now_ns(), ask), io_status::ok);
  can_frame in;
  ASSERT_EQ(receive_soon(*drive, in), io_status::ok);
  in.host_time_ns = 0;
  EXPECT_EQ(in, ask);
}

TEST_F(vcan, stamps_frames_when_they_arrive_and_not_when_they_are_read) {
  const auto host = open();
  const auto drive = open();
  ASSERT_TRUE(host && drive);
  const std::int64_t before_ns = now_ns();
  ASSERT_EQ(drive->send(before_ns, frame_of(1, {})), io_status::ok);
  const std::int64_t after_ns = now_ns();
  sleep_ms(20);
  can_frame in;
  ASSERT_EQ(receive_soon(*host, in), io_status::ok);
  EXPECT_GE(in.host_time_ns, before_ns - 1'000'000);
  EXPECT_LE(in.host_time_ns, after_ns + 10'000'000);
}

TEST_F(vcan, carries_fd_frames_of_every_length) {
  const auto host = open({.fd = true});
  const auto drive = open({.fd = true});
  const auto classic = open();
  ASSERT_TRUE(host && drive && classic);
  EXPECT_TRUE(host->takes_fd());
  for (const std::uint8_t size : std::array<std::uint8_t, 10>{0, 1, 8, 12, 16, 20, 24, 32, 48, 64}) {
    can_frame out;
    out.id = 0x8001;
    out.extended = true;
    out.fd = true;
    out.bit_rate_switch = size % 8 == 0;
    out.size = size;
    for (std::uint8_t i = 0; i < size; ++i) out.data[i] = static_cast<std::uint8_t>(200 - i);
    ASSERT_EQ(host->send(now_ns(), out), io_status::ok);
    can_frame in;
    ASSERT_EQ(receive_soon(*drive, in), io_status::ok);
    in.host_time_ns = 0;
    EXPECT_EQ(in, out) << +size;
    EXPECT_EQ(classic->receive(now_ns(), in), io_status::nothing) << "FD reached a bus that was not opened for it";
  }
  can_frame refused;
  refused.fd = true;
  EXPECT_EQ(classic->send(now_ns(), refused), io_status::refused);
}

TEST_F(vcan, says_why_an_interface_cannot_be_opened) {
  const auto message = [](const char* interface, bool fd) {
    const auto bus = can::open_socketcan(interface, {.fd = fd});
    return bus ? std::string("opened") : bus.error().message;
  };
  EXPECT_NE(message("vcanasp9", false).find("no network interface \"vcanasp9\""), std::string::npos);
  EXPECT_NE(message("lo", false).find("lo is a network interface, but not CAN"), std::string::npos);
  ASSERT_EQ(network::set_up(name, false), 0);
  EXPECT_NE(message(name, false).find("ip link set vcanasp0 up"), std::string::npos) << message(name, false);
  ASSERT_EQ(network::set_mtu(name, 16), 0);
  ASSERT_EQ(network::set_up(name, true), 0);
  EXPECT_NE(message(name, true).find("set up for classic CAN"), std::string::npos) << message(name, true);
  EXPECT_EQ(message(name, false), "opened");
}

TEST_F(vcan, is_listed_with_what_keeps_it_from_use) {
  const auto find = [] {
    const auto all = can::list_interfaces();
    const auto it = std::find_if(all.begin(), all.end(), [](const auto& i) { return i.name == name; });
    return it == all.end() ? can::interface_state{} : *it;
  };
  can::interface_state s = find();
  EXPECT_EQ(s.name, name);
  EXPECT_TRUE(s.up && s.running && s.fd);
  EXPECT_EQ(s.problem, "");
  ASSERT_EQ(network::set_up(name, false), 0);
  s = find();
  EXPECT_FALSE(s.up);
  EXPECT_NE(s.problem.find("ip link set vcanasp0"), std::string::npos) << s.problem;
}

TEST_F(vcan, lets_through_what_the_filters_name) {
  const auto host = open({.filters = {{.id = 0x200, .mask = 0x7F0}, {.id = 5, .mask = 0x1FFFFFFF, .extended = true}}});
  const auto drive = open();
  ASSERT_TRUE(host && drive);
  can_frame out;
  for (const std::uint32_t id : {0x1FFU, 0x200U, 0x20FU, 0x210U, 5U}) {
    for (const bool extended : {false, true}) {
      out.id = id;
      out.extended = extended;
      ASSERT_EQ(drive->send(now_ns(), out), io_status::ok);
    }
  }
  std::multiset<std::pair<std::uint32_t, bool>> got;
  can_frame in;
  while (got.size() < 3 && receive_soon(*host, in) == io_status::ok) got.emplace(in.id, in.extended);
  EXPECT_EQ(got, (std::multiset<std::pair<std::uint32_t, bool>>{{0x200, false}, {0x20F, false}, {5, true}}));
  EXPECT_EQ(host->receive(now_ns(), in), io_status::nothing);
}

TEST_F(vcan, turns_error_frames_into_health) {
  const auto host = open();
  const raw_socket controller(name);
  ASSERT_TRUE(host);
  can_frame in;
  const auto health = [&] {
    static_cast<void>(host->receive(now_ns(), in));
    return host->health();
  };

  ASSERT_TRUE(controller.put(CAN_ERR_FLAG | CAN_ERR_CRTL | 0x200, {0, CAN_ERR_CRTL_TX_PASSIVE, 0, 0, 0, 0, 130, 7}));
  ASSERT_TRUE(soon([&] { return health().error_passive; }));
  EXPECT_EQ(host->health().transmit_errors, 130);
  EXPECT_EQ(host->health().receive_errors, 7);
  EXPECT_EQ(host->send(now_ns(), frame_of(1, {})), io_status::ok);

  ASSERT_TRUE(controller.put(CAN_ERR_FLAG | CAN_ERR_BUSOFF, {0, 0, 0, 0, 0, 0, 0, 0}));
  ASSERT_TRUE(soon([&] { return health().bus_off; }));
  EXPECT_EQ(host->send(now_ns(), frame_of(1, {})), io_status::down);
  EXPECT_EQ(host->receive(now_ns(), in), io_status::down);

  ASSERT_TRUE(controller.put(CAN_ERR_FLAG | CAN_ERR_RESTARTED, {0, 0, 0, 0, 0, 0, 0, 0}));
  ASSERT_TRUE(soon([&] { return !health().bus_off; }));
  EXPECT_FALSE(host->health().error_passive);
  EXPECT_EQ(host->send(now_ns(), frame_of(1, {})), io_status::ok);
}

TEST_F(vcan, is_down_while_the_link_is_and_comes_back_by_itself) {
  const auto host = open();
  const auto drive = open();
  ASSERT_TRUE(host && drive);
  can_frame in;
  ASSERT_EQ(network::set_up(name, false), 0);
  EXPECT_EQ(host->receive(now_ns(), in), io_status::down);
  EXPECT_EQ(host->receive(now_ns(), in), io_status::down) << "the kernel says it once, the bus until it is over";
  EXPECT_EQ(host->send(now_ns(), frame_of(1, {9})), io_status::down);
  EXPECT_EQ(drive->send(now_ns(), frame_of(1, {9})), io_status::down) << "it was the first to be told by send()";
  ASSERT_EQ(network::set_up(name, true), 0);
  ASSERT_TRUE(soon([&] { return host->receive(now_ns(), in) == io_status::nothing; }));
  ASSERT_EQ(drive->send(now_ns(), frame_of(1, {9})), io_status::ok);
  ASSERT_EQ(receive_soon(*host, in), io_status::ok);
  EXPECT_EQ(in.data[0], 9);
}

TEST_F(vcan, is_gone_for_ever_when_the_interface_is_deleted) {
  const auto host = open();
  const auto silent = open();
  ASSERT_TRUE(host && silent);
  ASSERT_EQ(network::remove(name), 0);
  can_frame in;
  EXPECT_EQ(host->receive(now_ns(), in), io_status::gone);
  EXPECT_EQ(host->send(now_ns(), frame_of(1, {})), io_status::gone);
  EXPECT_EQ(silent->send(now_ns(), frame_of(1, {})), io_status::gone);
  ASSERT_TRUE(add()) << "another interface of the same name";
  EXPECT_EQ(host->send(now_ns(), frame_of(1, {})), io_status::gone);
  EXPECT_EQ(host->receive(now_ns(), in), io_status::gone);
  EXPECT_TRUE(open());
}

TEST_F(vcan, counts_every_frame_of_a_burst_that_nobody_read) {
  const auto host = open({.receive_buffer_bytes = 20'000});
  const auto drive = open();
  ASSERT_TRUE(host && drive);
  constexpr int burst = 5000;
  for (int i = 0; i < burst; ++i) ASSERT_EQ(drive->send(now_ns(), frame_of(0x10, {1})), io_status::ok);
  std::uint64_t received = 0;
  can_frame in;
  while (host->receive(now_ns(), in) == io_status::ok) ++received;
  EXPECT_LT(received, burst) << "the buffer was larger than the burst: nothing was tried";
  ASSERT_EQ(drive->send(now_ns(), frame_of(0x11, {1})), io_status::ok);
  ASSERT_EQ(receive_soon(*host, in), io_status::ok);
  EXPECT_EQ(in.id, 0x11U);
  EXPECT_EQ(host->health().lost + received, burst);

  // What is asked for by default holds it all.
  const auto roomy = open();
  ASSERT_TRUE(roomy);
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(drive->send(now_ns(), frame_of(0x10, {1})), io_status::ok);
  int all = 0;
  while (roomy->receive(now_ns(), in) == io_status::ok) ++all;
  EXPECT_EQ(all, 1000);
}

TEST_F(vcan, a_tick_takes_no_memory) {
  const auto host = open({.fd = true});
  const auto drive = open({.fd = true});
  ASSERT_TRUE(host && drive);
  const std::size_t before = test_support::news_in_this_thread();
  int carried = 0;
  can_frame in;
  for (int tick = 0; tick < 500; ++tick) {
    if (drive->send(now_ns(), frame_of(2, {1, 2})) == io_status::ok) ++carried;
    static_cast<void>(host->send(now_ns(), frame_of(1, {1, 2})));
    while (host->receive(now_ns(), in) == io_status::ok) --carried;
    while (drive->receive(now_ns(), in) == io_status::ok) continue;
  }
  EXPECT_EQ(test_support::news_in_this_thread() - before, 0U);
  EXPECT_EQ(carried, 0);
}

}  // namespace
}  // namespace asperity::can_kernel_test
