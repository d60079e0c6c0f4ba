// What the tests over a real kernel's USB share: a device in its controller, and waiting for what the kernel makes of
// it.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <gtest/gtest.h>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "asperity/transport/real_clock.hpp"
#include "asperity/usb/usb.hpp"
#include "hardware/kernel/usbip_device.hpp"

namespace asperity::test_support {

inline constexpr std::int64_t ms = 1'000'000;

// Asks until it is so, for ten seconds at most.
inline bool eventually(const std::function<bool()>& so) {
  const auto due = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (!so()) {
    if (std::chrono::steady_clock::now() > due) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

class kernel_usb : public testing::Test {
 protected:
  void SetUp() override {
    const std::string missing = usbip_device::missing();
    if (!missing.empty()) GTEST_SKIP() << missing;
  }

  // Plugs in and waits until it is listed.
  static usb_listing plugged(usbip_device& device, int port, const usb_identity& id = {}) {
    const std::string problem = device.plug_in(port);
    EXPECT_EQ(problem, "");
    usb_listing found;
    EXPECT_TRUE(eventually([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));  // each look costs
      const auto all = usb::list_usb(id.vendor, id.product);
      if (!all || all->empty() || (*all)[0].serial != id.serial) return false;
      found = (*all)[0];
      return true;
    }));
    return found;
  }

  static std::unique_ptr<usb_link> opened(const usb_listing& l, const usb_pipes& pipes = {}) {
    auto link = usb::open_usb(l, pipes);
    EXPECT_TRUE(link) << (link ? "" : link.error().message);
    return link ? std::move(*link) : nullptr;
  }

  // The next answer that is not `nothing`.
  io_status next(usb_link& link, std::vector<std::uint8_t>& bytes, std::size_t room = 64) {
    io_status s = io_status::nothing;
    eventually([&] {
      bytes.assign(room, 0);
      usb_packet p;
      s = link.read(clock.now_ns(), bytes, p);
      if (s == io_status::ok) bytes.resize(p.size);
      return s != io_status::nothing;
    });
    return s;
  }

  real_clock clock{};
};

}  // namespace asperity::test_support
