// asperity::can against a kernel in this process: every answer of every call.
#include <cstdint>
#include <gtest/gtest.h>
#include <linux/can/error.h>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <utility>

#include "asperity/can/socketcan_bus.hpp"
#include "asperity/transport/can_length.hpp"
#include "hardware/can/fake_kernel.hpp"
#include "support/counted_news.hpp"

namespace asperity::can_test {
namespace {

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t start_ns = 50'000 * ms;

asperity::can_frame frame_of(std::uint32_t id, std::uint8_t size = 8) {
  asperity::can_frame f;
  f.id = id;
  f.size = size;
  return f;
}

class socketcan : public testing::Test {
 protected:
  void open(const can::socketcan_settings& options = {}) {
    auto opened = can::open_socketcan("can0", options, *kernel);
    ASSERT_TRUE(opened) << opened.error().message;
    bus = std::move(opened).value();
  }
  void fresh() {
    bus.reset();
    kernel.emplace();
    open();
  }
  [[nodiscard]] static std::string refusal(fake_kernel& k, error_code code, bool fd = false) {
    const auto opened = can::open_socketcan("can0", {.fd = fd}, k);
    if (opened) return "opened";
    EXPECT_EQ(opened.error().code, code) << opened.error().message;
    EXPECT_EQ(k.open_descriptors, 0) << "a descriptor was left open";
    return opened.error().message;
  }

  std::optional<fake_kernel> kernel{std::in_place};
  std::unique_ptr<can_bus> bus;
  asperity::can_frame in;
};

TEST_F(socketcan, each_way_of_not_opening_has_its_sentence) {
  const auto has = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  std::string said;
  {
    fake_kernel k;
    k.set_always(call_kind::open, -EAFNOSUPPORT);
    said = refusal(k, error_code::unsupported);
    EXPECT_TRUE(has(said, "no raw CAN sockets") && has(said, "modprobe can-raw")) << said;
  }
  {
    fake_kernel k;
    k.set_always(call_kind::open, -EPERM);
    said = refusal(k, error_code::unsupported);
    EXPECT_TRUE(has(said, "may not open CAN sockets")) << said;
  }
  {
    fake_kernel k;
    k.set_always(call_kind::open, -EMFILE);
    said = refusal(k, error_code::io_failed);
    EXPECT_TRUE(has(said, "Too many open files")) << said;
  }
  {
    fake_kernel k;
    k.name = "can1";
    said = refusal(k, error_code::invalid_argument);
    EXPECT_TRUE(has(said, "no network interface \"can0\"") && has(said, "asperity devices")) << said;
  }
  {
    fake_kernel k;
    k.kind = ARPHRD_ETHER;
    said = refusal(k, error_code::invalid_argument);
    EXPECT_TRUE(has(said, "can0 is a network interface, but not CAN")) << said;
  }
  {
    fake_kernel k;
    k.flags = 0;
    said = refusal(k, error_code::invalid_argument);
    EXPECT_TRUE(has(said, "can0 is down") && has(said, "ip link set can0 up type can bitrate 1000000")) << said;
  }
  {
    fake_kernel k;
    k.mtu = 16;
    said = refusal(k, error_code::unsupported, true);
    EXPECT_TRUE(has(said, "set up for classic CAN") && has(said, "dbitrate 5000000 fd on")) << said;
    EXPECT_EQ(refusal(k, error_code::unsupported, false), "opened");
  }
  for (const std::string& name : {std::string(), std::string(16, 'x'), std::string("can0\0x", 6)}) {
    fake_kernel k;
    EXPECT_FALSE(can::open_socketcan(name, {}, k)) << name;
    EXPECT_EQ(k.open_descriptors, 0);
  }
}

// For every n, the n-th call of opening fails in every way: an error with a sentence and no descriptor left open, or,
// where only a bigger buffer was refused, a bus.
TEST_F(socketcan, opening_survives_the_failure_of_every_call) {
  fake_kernel untroubled;
  const can::socketcan_settings options{.fd = true, .filters = {{.id = 1, .mask = 0x7FF}}};
  ASSERT_TRUE(can::open_socketcan("can0", options, untroubled));
  EXPECT_EQ(untroubled.open_descriptors, 0) << "the bus closes its descriptor";
  int opened_after_all = 0;
  for (std::uint64_t n = 0; n < untroubled.calls; ++n) {
    for (const int wrong : {EPERM, EACCES, ENODEV, ENXIO, ENOPROTOOPT, EINVAL, EIO, ENOMEM, EMFILE, EAFNOSUPPORT}) {
      fake_kernel k;
      k.fail_call = n;
      k.fail_with = -wrong;
      const auto opened = can::open_socketcan("can0", options, k);
      ASSERT_TRUE(k.failed_kind.has_value());
      if (opened) {
        ++opened_after_all;
        EXPECT_EQ(k.failed_kind, call_kind::set_option);
        EXPECT_TRUE(k.bound);
        EXPECT_EQ(k.open_descriptors, 1);
      } else {
        EXPECT_GT(opened.error().message.size(), 20U);
        EXPECT_EQ(k.open_descriptors, 0) << "call " << n << ", " << wrong;
      }
    }
  }
  EXPECT_EQ(opened_after_all, 10) << "exactly one call, the buffer beyond the system's maximum, may fail";
}

// What send() and receive() make of each errno value. What is not listed is `failed`.
TEST_F(socketcan, every_errno_of_every_call_has_its_answer) {
  const std::map<int, io_status> sending{{ENOBUFS, io_status::busy},   {EAGAIN, io_status::busy},
                                         {EINTR, io_status::busy},     {ENETDOWN, io_status::down},
                                         {ENXIO, io_status::gone},     {ENODEV, io_status::gone},
                                         {EINVAL, io_status::refused}, {EMSGSIZE, io_status::refused}};
  const std::map<int, io_status> receiving{{EAGAIN, io_status::nothing},
                                           {EINTR, io_status::nothing},
                                           {ENETDOWN, io_status::down},
                                           {ENXIO, io_status::gone},
                                           {ENODEV, io_status::gone}};
  const auto expected = [](const std::map<int, io_status>& known, int wrong) {
    const auto it = known.find(wrong);
    return it == known.end() ? io_status::failed : it->second;
  };
  for (int wrong = 1; wrong < 134; ++wrong) {
    fresh();
    kernel->set_always(call_kind::send, -wrong);
    kernel->flags = wrong == ENETDOWN ? 0 : unsigned{IFF_UP};
    EXPECT_EQ(bus->send(start_ns, frame_of(1)), expected(sending, wrong)) << "send, errno " << wrong;
    EXPECT_EQ(bus->errno_value(), wrong);
    fresh();
    in = frame_of(0x55);
    const auto before = in;
    kernel->set_always(call_kind::receive, -wrong);
    kernel->flags = wrong == ENETDOWN ? 0 : unsigned{IFF_UP};
    EXPECT_EQ(bus->receive(start_ns, in), expected(receiving, wrong)) << "receive, errno " << wrong;
    EXPECT_EQ(in, before) << "the frame changed though the answer is not ok";
  }
}

// A session of 20 ticks in which, for every n, the n-th call fails in each of the ways. It answers as the table above
// says, once; gone stays gone, and everything else is over when the kernel is well again. Nothing takes memory.
TEST_F(socketcan, a_session_survives_the_failure_of_every_call) {
  const auto run = [&](bool& ended) {
    int sent = 0;
    int got = 0;
    ended = false;
    for (std::int64_t t = start_ns; t < start_ns + 20 * ms; t += ms) {
      kernel->deliver_frame(0x20, kernel->wall_ahead_ns + t - ms / 2);
      const io_status s = bus->send(t, frame_of(0x10));
      if (s == io_status::ok) ++sent;
      io_status r = bus->receive(t, in);
      for (; r == io_status::ok; r = bus->receive(t, in)) ++got;
      ended = s == io_status::gone || r == io_status::gone;
    }
    return std::pair(sent, got);
  };
  bool ended = false;
  open();
  const std::uint64_t opening = kernel->calls;
  EXPECT_EQ(run(ended), std::pair(20, 20));
  const std::uint64_t all = kernel->calls - opening;
  EXPECT_EQ(all, 60U);
  for (std::uint64_t n = 0; n < all; ++n) {
    for (const int wrong : {EIO, ENOBUFS, EAGAIN, EINTR, ENETDOWN, ENODEV, ENXIO, EINVAL, ENOMEM}) {
      fresh();
      kernel->fail_call = opening + n;
      kernel->fail_with = -wrong;
      const std::size_t news = test_support::news_in_this_thread();
      const auto [sent, got] = run(ended);
      ASSERT_EQ(test_support::news_in_this_thread(), news);
      const bool for_ever = wrong == ENODEV || wrong == ENXIO;
      EXPECT_EQ(ended, for_ever) << "call " << n << ", errno " << wrong;
      if (for_ever) {
        EXPECT_EQ(sent, static_cast<int>((n + 2) / 3)) << "sent after it was gone";
      } else {
        EXPECT_GE(sent, 19) << "call " << n << ", errno " << wrong;
        EXPECT_GE(got + static_cast<int>(kernel->waiting()), 19) << "call " << n << ", errno " << wrong;
      }
    }
  }
}

TEST_F(socketcan, frames_are_on_the_wire_what_linux_defines) {
  open({.fd = true});
  asperity::can_frame f = frame_of(0x123, 2);
  f.data[0] = 0xAB;
  f.data[7] = 0xFF;  // beyond its size: does not leave
  ASSERT_EQ(bus->send(start_ns, f), io_status::ok);
  EXPECT_EQ(kernel->last_size, 16U);
  EXPECT_EQ(kernel->last_sent.can_id, 0x123U);
  EXPECT_EQ(kernel->last_sent.len, 2);
  EXPECT_EQ(kernel->last_sent.data[0], 0xAB);
  EXPECT_EQ(kernel->last_sent.data[7], 0);
  EXPECT_EQ(kernel->last_sent.flags, 0);
  f.extended = true;
  f.remote = true;
  ASSERT_EQ(bus->send(start_ns, f), io_status::ok);
  EXPECT_EQ(kernel->last_sent.can_id, 0x123U | CAN_EFF_FLAG | CAN_RTR_FLAG);
  EXPECT_EQ(kernel->last_sent.data[0], 0) << "a remote frame carries no data";
  f.remote = false;
  f.fd = f.bit_rate_switch = true;
  f.size = 64;
  ASSERT_EQ(bus->send(start_ns, f), io_status::ok);
  EXPECT_EQ(kernel->last_size, 72U);
  EXPECT_EQ(kernel->last_sent.flags, CANFD_BRS);

  // What leaves comes back as the same frame.
  std::mt19937_64 bits(7);
  for (int i = 0; i < 2000; ++i) {
    asperity::can_frame out;
    out.extended = bits() % 2 == 0;
    out.id = static_cast<std::uint32_t>(bits()) & (out.extended ? 0x1FFFFFFFU : 0x7FFU);
    out.fd = bits() % 2 == 0;
    out.bit_rate_switch = out.fd && bits() % 2 == 0;
    out.size = out.fd ? can_fd_length(bits() % 65) : static_cast<std::uint8_t>(bits() % 9);
    for (std::size_t k = 0; k < out.size; ++k) out.data[k] = static_cast<std::uint8_t>(bits());
    ASSERT_EQ(bus->send(start_ns, out), io_status::ok);
    kernel->deliver({.frame = kernel->last_sent, .size = kernel->last_size});
    ASSERT_EQ(bus->receive(start_ns, in), io_status::ok);
    out.host_time_ns = start_ns;
    ASSERT_EQ(in, out);
  }
}

TEST_F(socketcan, filters_tell_short_identifiers_from_long_ones) {
  open({.filters = {{.id = 0x205, .mask = 0xFFFFFFF0}, {.id = 5, .mask = 0x1FFFFFFF, .extended = true}}});
  ASSERT_EQ(kernel->filter_count, 2U);
  EXPECT_EQ(kernel->filters[0].can_id, 0x205U);
  EXPECT_EQ(kernel->filters[0].can_mask, 0x7F0U | CAN_EFF_FLAG);
  EXPECT_EQ(kernel->filters[1].can_id, 5U | CAN_EFF_FLAG);
  EXPECT_EQ(kernel->filters[1].can_mask, 0x1FFFFFFFU | CAN_EFF_FLAG);
}

TEST_F(socketcan, what_cannot_be_a_frame_is_refused_before_the_kernel_sees_it) {
  open();
  asperity::can_frame f = frame_of(0x800);
  EXPECT_EQ(bus->send(start_ns, f), io_status::refused) << "12 bits";
  f = frame_of(0x20000000);
  f.extended = true;
  EXPECT_EQ(bus->send(start_ns, f), io_status::refused) << "30 bits";
  EXPECT_EQ(bus->send(start_ns, frame_of(1, 9)), io_status::refused);
  f = frame_of(1);
  f.fd = true;
  EXPECT_EQ(bus->send(start_ns, f), io_status::refused) << "FD on a classic bus";
  f.fd = false;
  f.bit_rate_switch = true;
  EXPECT_EQ(bus->send(start_ns, f), io_status::refused);
  open({.fd = true});
  f = frame_of(1, 13);
  f.fd = true;
  EXPECT_EQ(bus->send(start_ns, f), io_status::refused) << "13 bytes have no length code";
  f = frame_of(1, 8);
  f.fd = f.remote = true;
  EXPECT_EQ(bus->send(start_ns, f), io_status::refused);
  EXPECT_EQ(kernel->sends, 0U);
}

TEST_F(socketcan, short_and_malformed_messages_are_no_frames) {
  open({.fd = true});
  kernel->set_always(call_kind::send, 15);
  EXPECT_EQ(bus->send(start_ns, frame_of(1)), io_status::too_short);
  for (const std::size_t size : {0UL, 1UL, 15UL, 17UL, 71UL}) {
    kernel->deliver({.size = size});
    EXPECT_EQ(bus->receive(start_ns, in), io_status::too_short) << size;
  }
  kernel->deliver({.size = 72, .flags = MSG_TRUNC});
  EXPECT_EQ(bus->receive(start_ns, in), io_status::too_short);
  message m;
  m.frame.len = 9;
  kernel->deliver(m);
  EXPECT_EQ(bus->receive(start_ns, in), io_status::failed) << "nine bytes of data in a frame of eight";
  m.size = 72;
  m.frame.len = 65;
  kernel->deliver(m);
  EXPECT_EQ(bus->receive(start_ns, in), io_status::failed);
  EXPECT_EQ(bus->receive(start_ns, in), io_status::nothing);
}

TEST_F(socketcan, a_full_queue_is_left_alone_for_a_while) {
  open({.busy_back_off_ns = 2 * ms});
  kernel->set_always(call_kind::send, -ENOBUFS);
  EXPECT_EQ(bus->send(start_ns, frame_of(1)), io_status::busy);
  const std::uint64_t calls = kernel->calls;
  for (std::int64_t t = start_ns; t < start_ns + 2 * ms; t += ms / 4) {
    EXPECT_EQ(bus->send(t, frame_of(1)), io_status::busy);
  }
  EXPECT_EQ(kernel->calls, calls) << "the kernel was asked before the time was over";
  kernel->set_always(call_kind::send, 0);
  EXPECT_EQ(bus->send(start_ns + 2 * ms, frame_of(1)), io_status::ok);
}

TEST_F(socketcan, error_frames_change_health_and_are_not_handed_out) {
  open();
  const auto error = [&](std::uint32_t kind, std::uint8_t controller, std::uint8_t tx = 0, std::uint8_t rx = 0) {
    message m;
    m.frame.can_id = CAN_ERR_FLAG | kind;
    m.frame.len = 8;
    m.frame.data[1] = controller;
    m.frame.data[6] = tx;
    m.frame.data[7] = rx;
    kernel->deliver(m);
    const io_status s = bus->receive(start_ns, in);
    EXPECT_EQ(s, bus->health().bus_off ? io_status::down : io_status::nothing);
    return bus->health();
  };
  can_health h = error(CAN_ERR_CRTL | 0x200, CAN_ERR_CRTL_RX_WARNING, 10, 97);
  EXPECT_FALSE(h.error_passive);
  EXPECT_EQ(h.transmit_errors, 10);
  EXPECT_EQ(h.receive_errors, 97);
  h = error(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE, 99, 99);
  EXPECT_TRUE(h.error_passive);
  EXPECT_EQ(h.transmit_errors, 10) << "counters that were not marked as such were believed";
  EXPECT_TRUE(error(CAN_ERR_PROT | CAN_ERR_ACK, 0).error_passive) << "another kind of error ended it";
  EXPECT_FALSE(error(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_WARNING).error_passive);
  EXPECT_EQ(error(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_OVERFLOW).lost, 1U);

  EXPECT_TRUE(error(CAN_ERR_BUSOFF, 0).bus_off);
  const std::uint64_t sends = kernel->sends;
  EXPECT_EQ(bus->send(start_ns, frame_of(1)), io_status::down);
  EXPECT_EQ(kernel->sends, sends) << "the controller is off the bus: what it is given would be lost";
  EXPECT_TRUE(error(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE).bus_off) << "a late frame does not end bus-off";
  h = error(CAN_ERR_RESTARTED, 0);
  EXPECT_FALSE(h.bus_off || h.error_passive);
  EXPECT_EQ(bus->send(start_ns, frame_of(1)), io_status::ok);
  EXPECT_TRUE(error(CAN_ERR_BUSOFF | CAN_ERR_RESTARTED, 0).bus_off) << "of two meanings, the worse";
  EXPECT_FALSE(error(CAN_ERR_CRTL, CAN_ERR_CRTL_ACTIVE).bus_off);

  // A storm holds one call no longer than most_error_frames, and what is behind it comes later.
  for (int i = 0; i < 100; ++i) {
    message m;
    m.frame.can_id = CAN_ERR_FLAG | CAN_ERR_ACK;
    m.frame.len = 8;
    kernel->deliver(m);
  }
  kernel->deliver_frame(0x42);
  EXPECT_EQ(bus->receive(start_ns, in), io_status::nothing);
  EXPECT_EQ(kernel->waiting(), 101U - can::socketcan_bus::most_error_frames);
  EXPECT_EQ(bus->receive(start_ns, in), io_status::ok);
  EXPECT_EQ(in.id, 0x42U);
}

TEST_F(socketcan, lost_frames_are_counted_over_the_wrap_of_the_kernels_counter) {
  open();
  const auto receive_with = [&](std::uint32_t dropped) {
    kernel->deliver({.dropped = dropped});
    EXPECT_EQ(bus->receive(start_ns, in), io_status::ok);
    return bus->health().lost;
  };
  EXPECT_EQ(receive_with(0), 0U);
  EXPECT_EQ(receive_with(5), 5U);
  EXPECT_EQ(receive_with(5), 5U);
  EXPECT_EQ(receive_with(0xFFFFFFFE), 0xFFFFFFFEULL);
  EXPECT_EQ(receive_with(3), 0x100000003ULL);
}

TEST_F(socketcan, a_link_that_is_down_is_asked_about_now_and_then_and_comes_back) {
  open();
  kernel->flags = 0;
  kernel->set_always(call_kind::receive, -ENETDOWN);
  EXPECT_EQ(bus->receive(start_ns, in), io_status::down);
  kernel->set_always(call_kind::receive, 0);  // the kernel says it once
  const std::uint64_t asked = kernel->calls_of[static_cast<std::size_t>(call_kind::ask)];
  for (std::int64_t t = start_ns + ms; t < start_ns + 101 * ms; t += ms) {
    EXPECT_EQ(bus->receive(t, in), io_status::down);
  }
  EXPECT_EQ(kernel->calls_of[static_cast<std::size_t>(call_kind::ask)] - asked, 20U) << "two questions each 10 ms";
  // Frames from before the link went down do not make it look up.
  kernel->deliver_frame(0x9);
  EXPECT_EQ(bus->receive(start_ns + 101 * ms, in), io_status::ok);
  EXPECT_EQ(bus->receive(start_ns + 101 * ms, in), io_status::down);
  kernel->flags = IFF_UP;
  EXPECT_EQ(bus->receive(start_ns + 120 * ms, in), io_status::nothing);

  // Bus-off ends when the interface was switched off and on.
  message m;
  m.frame.can_id = CAN_ERR_FLAG | CAN_ERR_BUSOFF;
  m.frame.len = 8;
  kernel->deliver(m);
  EXPECT_EQ(bus->receive(start_ns + 130 * ms, in), io_status::down);
  kernel->flags = 0;
  EXPECT_EQ(bus->receive(start_ns + 140 * ms, in), io_status::down);
  kernel->flags = IFF_UP;
  EXPECT_EQ(bus->receive(start_ns + 150 * ms, in), io_status::nothing);
  EXPECT_FALSE(bus->health().bus_off);
}

TEST_F(socketcan, a_new_interface_of_the_old_name_is_not_ours) {
  open();
  kernel->set_always(call_kind::receive, -ENETDOWN);
  kernel->index = 4;
  EXPECT_EQ(bus->receive(start_ns, in), io_status::gone);
  kernel->index = 3;
  kernel->set_always(call_kind::receive, 0);
  EXPECT_EQ(bus->receive(start_ns + 50 * ms, in), io_status::gone) << "gone is for ever";
  EXPECT_EQ(bus->send(start_ns + 50 * ms, frame_of(1)), io_status::gone);
}

TEST_F(socketcan, stamps_become_session_time_and_follow_a_wall_clock_that_is_set) {
  open();
  // Frames arrive at seeded times; we read once in each millisecond. In the middle somebody sets the wall clock.
  for (const std::int64_t step_ns : {std::int64_t{0}, 3600'000 * ms, -3600'000 * ms, 20 * ms, -20 * ms, ms, -ms}) {
    fresh();
    std::mt19937_64 bits(5);
    std::int64_t wall_ns = kernel->wall_ahead_ns;
    std::int64_t worst_ns = 0;
    std::int64_t worst_before_ns = 0;
    for (int tick = 0; tick < 400; ++tick) {
      const std::int64_t t = start_ns + tick * ms;
      if (tick == 200) {
        wall_ns += step_ns;
        worst_before_ns = std::exchange(worst_ns, 0);
      }
      const std::int64_t arrived_ns = t - static_cast<std::int64_t>(bits() % std::uint64_t{ms});
      kernel->deliver_frame(1, arrived_ns + wall_ns);
      ASSERT_EQ(bus->receive(t, in), io_status::ok);
      EXPECT_LE(in.host_time_ns, t);
      worst_ns = std::max(worst_ns, std::abs(in.host_time_ns - arrived_ns));
      ASSERT_EQ(bus->receive(t, in), io_status::nothing);
    }
    EXPECT_EQ(worst_before_ns, 0);
    if (step_ns == 0) {
      EXPECT_EQ(worst_ns, 0);
    } else {
      EXPECT_LE(worst_ns, 3 * ms) << "2 ms and the time between two reads; step " << step_ns;
    }
  }

  // After the correction, frames that waited are told apart again; without it each would seem to come when it is read.
  fresh();
  const std::int64_t ahead_ns = kernel->wall_ahead_ns + 3600'000 * ms;
  kernel->deliver_frame(1, start_ns - ms / 10 + ahead_ns);
  ASSERT_EQ(bus->receive(start_ns, in), io_status::ok);
  EXPECT_EQ(in.host_time_ns, start_ns);
  kernel->deliver_frame(1, start_ns + ms - ms * 9 / 10 + ahead_ns);
  ASSERT_EQ(bus->receive(start_ns + ms, in), io_status::ok);
  EXPECT_EQ(in.host_time_ns, start_ns + ms - ms * 8 / 10);

  fresh();
  kernel->deliver_frame(1);
  ASSERT_EQ(bus->receive(start_ns, in), io_status::ok);
  EXPECT_EQ(in.host_time_ns, start_ns) << "without a stamp, when it was read";
}

}  // namespace
}  // namespace asperity::can_test
