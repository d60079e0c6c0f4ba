// The twin of a CAN bus and of time: every fault of a script, both ways.
#include "asperity/transport/virtual/virtual_can.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <gtest/gtest.h>
#include <memory>
#include <vector>

#include "asperity/transport/virtual/manual_clock.hpp"
#include "support/counted_news.hpp"

namespace asperity::virtual_can_test {
namespace {

constexpr std::int64_t ms = 1'000'000;

can_frame numbered(std::uint8_t n) {
  can_frame f;
  f.id = 0x100;
  f.size = 8;
  f.data[0] = n;
  return f;
}

/// The numbers of all frames that have arrived.
std::vector<int> drain(can_bus& bus, std::int64_t now_ns) {
  std::vector<int> out;
  can_frame f;
  while (bus.receive(now_ns, f) == io_status::ok) out.push_back(f.data[0]);
  return out;
}

/// A host with a script, and a device; `cross` sends a frame in the given direction and returns what arrived of it.
struct pair {
  explicit pair(link_direction direction, link_script script) : way(direction), host(bus, std::move(script)) {}

  [[nodiscard]] io_status send(std::int64_t t, const can_frame& f) { return sender().send(t, f); }
  [[nodiscard]] can_bus& sender() { return way == link_direction::to_device ? host : device; }
  [[nodiscard]] can_bus& receiver() { return way == link_direction::to_device ? device : host; }

  link_direction way;
  virtual_can bus;
  virtual_can_node host;
  virtual_can_node device{bus};
};

class virtual_can_faults : public testing::TestWithParam<link_direction> {
 protected:
  [[nodiscard]] pair make(link_event e) const {
    e.direction = GetParam();
    return pair(GetParam(), {.events = {e}});
  }
};

TEST_P(virtual_can_faults, lose) {
  pair p = make({.kind = link_fault::lose, .from_ns = 2, .until_ns = 4});
  std::vector<int> got;
  for (std::uint8_t t = 0; t < 6; ++t) {
    EXPECT_EQ(p.send(t, numbered(t)), io_status::ok);
    for (const int n : drain(p.receiver(), t)) got.push_back(n);
  }
  EXPECT_EQ(got, (std::vector{0, 1, 4, 5}));
}

TEST_P(virtual_can_faults, delay_lets_later_frames_pass) {
  pair p = make({.kind = link_fault::delay, .from_ns = 1, .until_ns = 2, .amount_ns = 5});
  for (std::uint8_t t = 0; t < 4; ++t) {
    EXPECT_EQ(p.send(t, numbered(t)), io_status::ok);
    EXPECT_EQ(drain(p.receiver(), t), t == 1 ? std::vector<int>{} : std::vector<int>{t}) << +t;
  }
  EXPECT_EQ(drain(p.receiver(), 5), std::vector<int>{});
  can_frame late;
  ASSERT_EQ(p.receiver().receive(6, late), io_status::ok);
  EXPECT_EQ(late.data[0], 1);
  EXPECT_EQ(late.host_time_ns, 6);
}

TEST_P(virtual_can_faults, reorder_swaps_neighbours) {
  pair p = make({.kind = link_fault::reorder});
  for (std::uint8_t n = 0; n < 6; ++n) EXPECT_EQ(p.send(0, numbered(n)), io_status::ok);
  EXPECT_EQ(drain(p.receiver(), 0), (std::vector{1, 0, 3, 2, 5, 4}));
  EXPECT_EQ(p.send(1, numbered(9)), io_status::ok);
  EXPECT_EQ(drain(p.receiver(), 1), std::vector<int>{}) << "the next has not come yet";
  EXPECT_EQ(p.send(2, numbered(10)), io_status::ok);
  EXPECT_EQ(drain(p.receiver(), 2), (std::vector{10, 9}));
}

TEST_P(virtual_can_faults, duplicate) {
  pair p = make({.kind = link_fault::duplicate, .from_ns = 1, .until_ns = 2});
  std::vector<int> got;
  for (std::uint8_t t = 0; t < 3; ++t) {
    EXPECT_EQ(p.send(t, numbered(t)), io_status::ok);
    for (const int n : drain(p.receiver(), t)) got.push_back(n);
  }
  EXPECT_EQ(got, (std::vector{0, 1, 1, 2}));
}

TEST_P(virtual_can_faults, shorten_to_the_next_length_there_is) {
  for (const auto& [from, to] :
       {std::pair{8, 7}, std::pair{1, 0}, std::pair{0, 0}, std::pair{64, 48}, std::pair{12, 8}}) {
    pair p = make({.kind = link_fault::shorten});
    can_frame f = numbered(1);
    f.fd = true;
    f.size = static_cast<std::uint8_t>(from);
    EXPECT_EQ(p.send(0, f), io_status::ok);
    ASSERT_EQ(p.receiver().receive(0, f), io_status::ok);
    EXPECT_EQ(+f.size, to) << from;
  }
}

TEST_P(virtual_can_faults, flip_bit_flips_exactly_one) {
  std::vector<int> places;
  for (const std::uint8_t size : {std::uint8_t{8}, std::uint8_t{0}}) {
    pair p = make({.kind = link_fault::flip_bit});
    for (int i = 0; i < 50; ++i) {
      can_frame sent = numbered(7);
      sent.size = size;
      EXPECT_EQ(p.send(0, sent), io_status::ok);
      can_frame f;
      ASSERT_EQ(p.receiver().receive(0, f), io_status::ok);
      int flipped = std::popcount(f.id ^ sent.id);
      EXPECT_EQ(flipped, size == 0 ? 1 : 0);
      for (std::size_t k = 0; k < 64; ++k) {
        const auto changed = static_cast<std::uint8_t>(f.data[k] ^ sent.data[k]);
        flipped += std::popcount(changed);
        if (changed != 0) places.push_back(static_cast<int>(k) * 8 + std::countr_zero(changed));
      }
      EXPECT_EQ(flipped, 1);
    }
  }
  std::sort(places.begin(), places.end());
  EXPECT_GT(std::unique(places.begin(), places.end()) - places.begin(), 20) << "the same bit every time";
}

TEST_P(virtual_can_faults, answer_is_of_the_hosts_end_and_nothing_moves) {
  const bool sending = GetParam() == link_direction::to_device;
  for (const io_status with : {io_status::busy, io_status::failed, io_status::down, io_status::too_short}) {
    pair p = make(fail_call(0, with));
    can_frame f = numbered(1);
    if (sending) {
      EXPECT_EQ(p.host.send(0, f), with);
      EXPECT_EQ(p.bus.frames(), 0U);
      EXPECT_EQ(p.host.send(0, f), io_status::ok);
      EXPECT_EQ(drain(p.device, 0), std::vector{1});
    } else {
      EXPECT_EQ(p.device.send(0, f), io_status::ok);
      EXPECT_EQ(p.host.receive(0, f), with);
      EXPECT_EQ(drain(p.host, 0), std::vector{1});
    }
  }
}

TEST_P(virtual_can_faults, unplug_is_for_ever) {
  pair p = make({.kind = link_fault::unplug, .from_ns = 5, .until_ns = 6});
  can_frame f = numbered(1);
  EXPECT_EQ(p.host.send(4, f), io_status::ok);
  if (GetParam() == link_direction::to_device) {
    EXPECT_EQ(p.host.send(5, f), io_status::gone);
  } else {
    EXPECT_EQ(p.host.receive(5, f), io_status::gone);
  }
  for (int t = 6; t < 9; ++t) {
    EXPECT_EQ(p.host.send(t, f), io_status::gone);
    EXPECT_EQ(p.host.receive(t, f), io_status::gone);
    EXPECT_EQ(p.device.send(t, f), io_status::ok) << "the others stay on the bus";
  }
  EXPECT_EQ(p.host.waiting(), 0U);
}

TEST_P(virtual_can_faults, a_share_of_frames_the_same_with_the_same_seed) {
  const auto run = [&](std::uint64_t seed) {
    link_event e{.kind = link_fault::lose, .direction = GetParam(), .share = 0.3};
    pair p(GetParam(), {.events = {e}, .seed = seed});
    std::vector<int> got;
    for (int i = 0; i < 1000; ++i) {
      EXPECT_EQ(p.send(i, numbered(static_cast<std::uint8_t>(i))), io_status::ok);
      for (const int n : drain(p.receiver(), i)) got.push_back(n);
    }
    return got;
  };
  EXPECT_EQ(run(1), run(1));
  EXPECT_NE(run(1), run(2));
  EXPECT_NEAR(static_cast<double>(run(1).size()), 700.0, 60.0);
}

INSTANTIATE_TEST_SUITE_P(both_ways, virtual_can_faults,
                         testing::Values(link_direction::to_device, link_direction::from_device), [](const auto& p) {
                           return p.param == link_direction::to_device ? "to_device" : "from_device";
                         });

TEST(virtual_can, every_frame_goes_to_all_others) {
  virtual_can bus;
  virtual_can_node host(bus);
  virtual_can_node a(bus);
  auto b = std::make_unique<virtual_can_node>(bus);
  EXPECT_EQ(a.send(0, numbered(1)), io_status::ok);
  EXPECT_EQ(drain(host, 0), std::vector{1});
  EXPECT_EQ(drain(*b, 0), std::vector{1});
  EXPECT_EQ(drain(a, 0), std::vector<int>{}) << "the own frame came back";
  b.reset();
  EXPECT_EQ(a.send(0, numbered(2)), io_status::ok);
  EXPECT_EQ(drain(host, 0), std::vector{2});
}

TEST(virtual_can, latency_is_of_every_frame_each_way) {
  virtual_can bus;
  virtual_can_node host(bus, {.latency_ns = 300});
  virtual_can_node device(bus);
  EXPECT_EQ(host.send(0, numbered(1)), io_status::ok);
  EXPECT_EQ(drain(device, 299), std::vector<int>{});
  EXPECT_EQ(drain(device, 300), std::vector{1});
  EXPECT_EQ(device.send(1000, numbered(2)), io_status::ok);
  can_frame f;
  EXPECT_EQ(host.receive(1299, f), io_status::nothing);
  ASSERT_EQ(host.receive(1500, f), io_status::ok);
  EXPECT_EQ(f.host_time_ns, 1300);
}

TEST(virtual_can, a_classic_bus_refuses_what_is_not_classic) {
  virtual_can classic(false);
  virtual_can_node host(classic);
  EXPECT_FALSE(host.takes_fd());
  can_frame f = numbered(1);
  EXPECT_EQ(host.send(0, f), io_status::ok);
  f.fd = true;
  EXPECT_EQ(host.send(0, f), io_status::refused);
  f = numbered(1);
  f.id = 0x800;
  EXPECT_EQ(host.send(0, f), io_status::refused);
  virtual_can fd;
  virtual_can_node other(fd);
  EXPECT_TRUE(other.takes_fd());
  f = numbered(1);
  f.fd = true;
  f.size = 13;
  EXPECT_EQ(other.send(0, f), io_status::refused);
}

TEST(virtual_can, what_finds_no_room_is_lost_and_counted) {
  virtual_can bus;
  virtual_can_node host(bus, {}, 4);
  virtual_can_node device(bus);
  for (std::uint8_t n = 0; n < 10; ++n) EXPECT_EQ(device.send(0, numbered(n)), io_status::ok);
  EXPECT_EQ(drain(host, 0), (std::vector{0, 1, 2, 3}));
  EXPECT_EQ(host.health().lost, 6U);
}

TEST(virtual_can, bus_off_is_known_from_the_first_receive_on) {
  virtual_can bus;
  virtual_can_node host(bus, {.events = {{.kind = link_fault::bus_off, .from_ns = 10, .until_ns = 20}}});
  virtual_can_node device(bus);
  can_frame f = numbered(1);
  EXPECT_EQ(host.send(10, f), io_status::ok) << "nobody has told us yet";
  EXPECT_EQ(drain(device, 10), std::vector<int>{}) << "and it was lost";
  EXPECT_EQ(device.send(11, f), io_status::ok);
  EXPECT_EQ(host.receive(11, f), io_status::down);
  EXPECT_TRUE(host.health().bus_off);
  EXPECT_EQ(host.send(12, f), io_status::down);
  EXPECT_EQ(host.receive(20, f), io_status::nothing) << "what came meanwhile is lost";
  EXPECT_FALSE(host.health().bus_off);
  EXPECT_EQ(host.send(20, f), io_status::ok);
  EXPECT_EQ(drain(device, 20), std::vector{1});
}

TEST(virtual_can, a_controller_reports_its_state) {
  virtual_can bus;
  virtual_can_node host(bus);
  host.report({.error_passive = true, .transmit_errors = 130, .receive_errors = 4, .lost = 99});
  EXPECT_FALSE(host.health().error_passive) << "known when it is received";
  can_frame f;
  EXPECT_EQ(host.receive(0, f), io_status::nothing);
  EXPECT_EQ(host.health(), (can_health{.error_passive = true, .transmit_errors = 130, .receive_errors = 4}));
  host.report({.bus_off = true});
  EXPECT_EQ(host.receive(0, f), io_status::down);
  host.report({});
  EXPECT_EQ(host.receive(0, f), io_status::nothing);
}

TEST(virtual_can, a_tick_takes_no_memory_whatever_goes_wrong) {
  link_script script;
  for (const link_fault kind : {link_fault::lose, link_fault::delay, link_fault::reorder, link_fault::duplicate,
                                link_fault::shorten, link_fault::flip_bit}) {
    script.events.push_back({.kind = kind, .share = 0.2, .amount_ns = 3 * ms});
  }
  virtual_can bus;
  virtual_can_node host(bus, std::move(script), 16);
  virtual_can_node device(bus, {}, 16);
  const std::size_t before = test_support::news_in_this_thread();
  can_frame f;
  int arrived = 0;
  for (std::int64_t t = 0; t < 2000 * ms; t += ms) {
    static_cast<void>(host.send(t, numbered(1)));
    static_cast<void>(device.send(t, numbered(2)));
    while (device.receive(t, f) == io_status::ok) ++arrived;
    while (host.receive(t, f) == io_status::ok) ++arrived;
  }
  EXPECT_EQ(test_support::news_in_this_thread(), before);
  EXPECT_GT(arrived, 3000);
}

TEST(manual_clock, waiting_lets_peers_act_at_every_step) {
  manual_clock clock(1000, 100);
  std::vector<std::int64_t> first;
  std::vector<std::int64_t> second;
  clock.on_advance([&](std::int64_t t) {
    EXPECT_EQ(clock.now_ns(), t);
    first.push_back(t);
  });
  clock.on_advance([&](std::int64_t t) {
    second.push_back(t);
    EXPECT_EQ(first.size(), second.size()) << "peers act in the order of registration";
  });
  clock.wait_until_ns(1250);
  EXPECT_EQ(first, (std::vector<std::int64_t>{1100, 1200, 1250}));
  clock.wait_until_ns(1250);
  clock.wait_until_ns(7);
  EXPECT_EQ(clock.now_ns(), 1250) << "time never runs back";
  clock.advance_ns(100);
  EXPECT_EQ(second, (std::vector<std::int64_t>{1100, 1200, 1250, 1350}));
}

}  // namespace
}  // namespace asperity::virtual_can_test
