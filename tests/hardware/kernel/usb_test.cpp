// asperity::usb over a real kernel's USB. Needs the module vhci-hcd and root; skips without.
#include "asperity/usb/usb.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <utility>
#include <vector>

#include "hardware/kernel/echo_function.hpp"
#include "hardware/kernel/usb_fixture.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;

std::vector<std::uint8_t> pattern(std::size_t size, std::size_t seed) {
  std::vector<std::uint8_t> out(size);
  for (std::size_t i = 0; i < size; ++i) out[i] = static_cast<std::uint8_t>(i * 7 + seed);
  return out;
}

// One device for all tests that do not pull it: the kernel takes its time to get to know one.
class kernel_usb_link : public kernel_usb {
 protected:
  static void SetUpTestSuite() {
    if (!usbip_device::missing().empty()) return;
    shared_ = new shared_device;
    shared_->listing = plugged(shared_->device, 0);
  }
  static void TearDownTestSuite() { delete std::exchange(shared_, nullptr); }
  void SetUp() override {
    kernel_usb::SetUp();
    if (shared_ == nullptr) return;
    device().with_lock([] {
      echo().waiting.clear();
      echo().deaf = echo().stalled = false;
      echo().broken = 0;
    });
  }

  static echo_function& echo() { return shared_->echo; }
  static usbip_device& device() { return shared_->device; }
  static const usb_listing& listing() { return shared_->listing; }

 private:
  struct shared_device {
    echo_function echo{};
    usbip_device device{echo, {}};
    usb_listing listing{};
  };
  static inline shared_device* shared_ = nullptr;
};

TEST_F(kernel_usb, a_device_is_listed_while_it_is_there) {
  echo_function echo;
  usbip_device device(echo, {});
  const usb_listing l = plugged(device, 0);
  EXPECT_EQ(l.vendor, 0x1209);
  EXPECT_EQ(l.product, 0x0a5f);
  EXPECT_EQ(l.serial, "V1");
  EXPECT_EQ(l.name, "asperity Virtual USB");
  EXPECT_NE(l.path.find('-'), std::string::npos) << l.path;
  EXPECT_FALSE(l.not_openable);
  const auto others = usb::list_usb(0x1209, 0x0001);
  ASSERT_TRUE(others);
  EXPECT_TRUE(others->empty());
  device.unplug();
  EXPECT_TRUE(eventually([] { return usb::list_usb(0x1209, 0x0a5f)->empty(); }));
  const auto link = usb::open_usb(l);
  ASSERT_FALSE(link);
  EXPECT_NE(link.error().message.find("not plugged in any more"), std::string::npos) << link.error().message;
}

TEST_F(kernel_usb, it_returns_under_another_path_with_the_same_serial_number) {
  echo_function echo;
  usbip_device device(echo, {});
  const usb_listing before = plugged(device, 0);
  const usb_listing after = plugged(device, 3);
  EXPECT_EQ(before.serial, after.serial);
  EXPECT_NE(before.path, after.path);
}

TEST_F(kernel_usb_link, control_requests_go_both_ways_and_stall) {
  const auto link = opened(listing());
  ASSERT_TRUE(link);
  auto out = pattern(40, 3);
  std::size_t done = 0;
  const usb_setup setup{.request_type = 0x40, .request = 1, .value = 0x1234, .index = 7};
  EXPECT_EQ(link->control(setup, out, done, 1000 * ms), io_status::ok);
  EXPECT_EQ(done, 40U);
  device().with_lock([&] {
    EXPECT_EQ(echo().stored, out);
    EXPECT_EQ(echo().last.value, 0x1234);
    EXPECT_EQ(echo().last.index, 7);
  });
  std::vector<std::uint8_t> in(64);
  EXPECT_EQ(link->control({.request_type = 0xc0, .request = 2}, in, done, 1000 * ms), io_status::ok);
  EXPECT_EQ(done, 40U);
  in.resize(40);
  EXPECT_EQ(in, out);
  EXPECT_EQ(link->control({.request_type = 0xc0, .request = 99}, in, done, 1000 * ms), io_status::refused);
}

TEST_F(kernel_usb_link, an_interface_is_ours_alone_and_pipes_are_checked) {
  const usb_listing& l = listing();
  const auto first = opened(l);
  const auto second = usb::open_usb(l);
  ASSERT_FALSE(second);
  EXPECT_NE(second.error().message.find("in use by another program"), std::string::npos) << second.error().message;
  const auto message = [&](usb_pipes p) { return usb::open_usb(l, p).error().message; };
  EXPECT_NE(message({.in = 0x83}).find("no bulk or interrupt endpoint 131"), std::string::npos);
  EXPECT_NE(message({.in = 0x02}).find("not possible"), std::string::npos);
  EXPECT_NE(message({.transfer_bytes = 100}).find("multiple"), std::string::npos);
  EXPECT_NE(message({.in_transfers = 0}).find("not possible"), std::string::npos);
}

TEST_F(kernel_usb_link, bytes_go_both_ways_in_order_and_at_every_length) {
  const auto link = opened(listing(), {.transfer_bytes = 512});
  ASSERT_TRUE(link);
  std::vector<std::uint8_t> back;
  for (std::size_t size = 1; size <= 512; size += size < 70 ? 1 : 37) {
    const auto out = pattern(size, size);
    io_status s = io_status::busy;
    ASSERT_TRUE(eventually([&] { return (s = link->write(clock.now_ns(), out)) != io_status::busy; }));
    ASSERT_EQ(s, io_status::ok) << size;
    ASSERT_EQ(next(*link, back, 512), io_status::ok) << size;
    ASSERT_EQ(back, out);
  }
  EXPECT_EQ(link->write(clock.now_ns(), pattern(513, 0)), io_status::refused);
  ASSERT_EQ(link->write(clock.now_ns(), pattern(30, 1)), io_status::ok);
  EXPECT_EQ(next(*link, back, 16), io_status::too_short);
  ASSERT_EQ(link->write(clock.now_ns(), pattern(30, 2)), io_status::ok);
  ASSERT_EQ(next(*link, back), io_status::ok);
  EXPECT_EQ(back, pattern(30, 2));
}

TEST_F(kernel_usb_link, a_thousand_questions_a_second) {
  const auto link = opened(listing());
  ASSERT_TRUE(link);
  constexpr int ticks = 300;
  int sent = 0;
  int received = 0;
  std::int64_t newest_ns = 0;
  std::vector<double> lateness_ms;
  std::vector<std::uint8_t> bytes(64);
  std::int64_t due_ns = clock.now_ns();
  const std::int64_t give_up_ns = due_ns + 20'000 * ms;
  while (received < ticks && due_ns < give_up_ns) {
    due_ns += ms;
    clock.wait_until_ns(due_ns);
    const std::int64_t now_ns = clock.now_ns();
    lateness_ms.push_back(static_cast<double>(now_ns - due_ns) * 1e-6);
    usb_packet p;
    io_status s = io_status::ok;
    while ((s = link->read(now_ns, bytes, p)) == io_status::ok) {
      ASSERT_EQ(p.size, 4U);
      ASSERT_EQ(bytes[0] | (bytes[1] << 8), received);
      ASSERT_GE(p.host_time_ns, newest_ns);
      ASSERT_LE(p.host_time_ns, now_ns);
      newest_ns = p.host_time_ns;
      ++received;
    }
    ASSERT_EQ(s, io_status::nothing);
    if (sent == ticks) continue;
    const std::array<std::uint8_t, 4> question = {static_cast<std::uint8_t>(sent),
                                                  static_cast<std::uint8_t>(sent >> 8)};
    s = link->write(now_ns, question);
    if (s == io_status::ok) ++sent;
    ASSERT_TRUE(s == io_status::ok || s == io_status::busy) << to_string(s);
  }
  EXPECT_EQ(received, ticks);
  std::sort(lateness_ms.begin(), lateness_ms.end());
  std::printf("ticks begin late by: median %.3f ms, 99%% %.3f ms, most %.3f ms\n", lateness_ms[lateness_ms.size() / 2],
              lateness_ms[lateness_ms.size() * 99 / 100], lateness_ms.back());
}

TEST_F(kernel_usb_link, a_device_that_takes_nothing_makes_it_busy_and_never_waits) {
  device().with_lock([] { echo().deaf = true; });
  const auto link = opened(listing(), {.out_transfers = 3});
  ASSERT_TRUE(link);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(link->write(clock.now_ns(), pattern(8, 1)), io_status::ok);
  EXPECT_EQ(link->write(clock.now_ns(), pattern(8, 2)), io_status::busy);
  device().with_lock([] { echo().deaf = false; });
  EXPECT_TRUE(eventually([&] { return link->write(clock.now_ns(), pattern(8, 3)) == io_status::ok; }));
  std::vector<std::uint8_t> back;
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(next(*link, back), io_status::ok);
    EXPECT_EQ(back, pattern(8, 1));
  }
  ASSERT_EQ(next(*link, back), io_status::ok);
  EXPECT_EQ(back, pattern(8, 3));
}

TEST_F(kernel_usb_link, a_stalled_pipe_is_a_failure_and_not_a_hang) {
  device().with_lock([] { echo().stalled = true; });
  const usb_listing& l = listing();
  auto link = opened(l);
  ASSERT_TRUE(link);
  std::vector<std::uint8_t> back;
  EXPECT_EQ(next(*link, back), io_status::failed);
  link.reset();
  device().with_lock([] { echo().stalled = false; });
  link = opened(l);
  ASSERT_TRUE(link);
  ASSERT_EQ(link->write(clock.now_ns(), pattern(5, 5)), io_status::ok);
  ASSERT_EQ(next(*link, back), io_status::ok);
  EXPECT_EQ(back, pattern(5, 5));
}

TEST_F(kernel_usb_link, a_transfer_that_breaks_is_reported_once_and_the_pipe_goes_on) {
  const auto link = opened(listing(), {.in_transfers = 1});
  ASSERT_TRUE(link);
  std::vector<std::uint8_t> back;
  for (std::size_t i = 0; i < 3; ++i) {
    device().with_lock([] { echo().broken = 1; });
    ASSERT_EQ(next(*link, back), io_status::failed) << i;
    ASSERT_EQ(link->write(clock.now_ns(), pattern(9, i)), io_status::ok);
    ASSERT_EQ(next(*link, back), io_status::ok);
    EXPECT_EQ(back, pattern(9, i));
  }
}

TEST_F(kernel_usb_link, closing_sends_what_was_written_and_takes_back_what_was_asked) {
  const usb_listing& l = listing();
  for (int i = 0; i < 3; ++i) {
    auto link = opened(l, {.in_transfers = 6});
    ASSERT_TRUE(link);
    ASSERT_EQ(link->write(clock.now_ns(), pattern(16, 9)), io_status::ok);
    const unsigned before = device().taken_back();
    link.reset();
    EXPECT_GE(device().taken_back() - before, 5U);  // the echo may have ended one
  }
  // What was written goes out although the device takes its time.
  {
    auto link = opened(l);
    device().with_lock([] {
      echo().deaf = true;
      echo().waiting.clear();
    });
    ASSERT_EQ(link->write(clock.now_ns(), pattern(16, 7)), io_status::ok);
    std::thread listening([] {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      device().with_lock([] { echo().deaf = false; });
    });
    link.reset();
    listening.join();
    device().with_lock([] { EXPECT_EQ(echo().taken, pattern(16, 7)); });
  }
  // A device that takes nothing cannot hold the destructor for ever.
  device().with_lock([] { echo().deaf = true; });
  auto link = opened(l);
  ASSERT_EQ(link->write(clock.now_ns(), pattern(16, 9)), io_status::ok);
  link.reset();
  EXPECT_TRUE(opened(l));
}

TEST_F(kernel_usb, pulled_in_mid_transfer_it_is_gone_for_ever) {
  for (int run = 0; run < 2; ++run) {
    echo_function echo;
    usbip_device device(echo, {});
    const usb_listing l = plugged(device, run % 3);
    auto link = opened(l);
    ASSERT_TRUE(link);
    std::thread hand([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      device.unplug();
    });
    io_status read = io_status::ok;
    io_status written = io_status::ok;
    std::vector<std::uint8_t> bytes(64);
    EXPECT_TRUE(eventually([&] {
      usb_packet p;
      read = link->read(clock.now_ns(), bytes, p);
      if (run > 0) written = link->write(clock.now_ns(), pattern(16, 1));
      return read == io_status::gone;
    })) << to_string(read)
        << ", " << to_string(written);
    hand.join();
    usb_packet p;
    std::size_t done = 0;
    EXPECT_EQ(link->read(clock.now_ns(), bytes, p), io_status::gone);
    EXPECT_EQ(link->write(clock.now_ns(), pattern(16, 1)), io_status::gone);
    EXPECT_EQ(link->control({.request_type = 0xc0, .request = 2}, bytes, done, 100 * ms), io_status::gone);
    EXPECT_EQ(device.plug_in(run % 3), "");
    EXPECT_EQ(link->read(clock.now_ns(), bytes, p), io_status::gone);  // the new one is another device
    link.reset();
  }
}

TEST_F(kernel_usb_link, without_permission_the_reason_has_the_line_for_udev) {
  const usb_listing& l = listing();
  const pid_t child = ::fork();
  if (child == 0) {
    if (::setgid(65534) != 0 || ::setuid(65534) != 0) ::_exit(2);
    const auto link = usb::open_usb(l);
    const auto listed = usb::list_usb(l.vendor, l.product);
    const std::string rule = "ATTR{idVendor}==\"1209\", ATTR{idProduct}==\"0a5f\"";
    const bool reported = !link && link.error().message.find(rule) != std::string::npos;
    const bool known = listed && listed->size() == 1 && (*listed)[0].serial == "V1" && (*listed)[0].not_openable;
    if (!reported) std::printf("%s\n", link ? "it was opened" : link.error().message.c_str());
    std::fflush(stdout);
    ::_exit(reported ? (known ? 0 : 3) : 4);
  }
  int state = 0;
  ASSERT_EQ(::waitpid(child, &state, 0), child);
  EXPECT_TRUE(WIFEXITED(state));
  EXPECT_EQ(WEXITSTATUS(state), 0);
}

}  // namespace
