// A USB device that repeats what it is told, and whose pipes go wrong where a test wants it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "hardware/kernel/usbip_device.hpp"

namespace asperity::test_support {

// Gives back what it is given; stores what a vendor's request writes.
class echo_function final : public usb_function {
 public:
  io_status control(const usb_setup& setup, std::span<std::uint8_t> data, std::size_t& done) override {
    if (setup.request_type == 0x40 && setup.request == 1) {
      stored.assign(data.begin(), data.end());
      last = setup;
      return io_status::ok;
    }
    if (setup.request_type != 0xc0 || setup.request != 2) return io_status::refused;
    done = std::min(stored.size(), data.size());
    std::copy_n(stored.begin(), done, data.begin());
    return io_status::ok;
  }
  bool take(std::span<const std::uint8_t> bytes) override {
    if (deaf) return false;
    taken.assign(bytes.begin(), bytes.end());
    waiting.push_back(taken);
    return true;
  }
  answer give(std::span<std::uint8_t> room, std::size_t& size) override {
    if (stalled) return answer::stall;
    if (broken > 0) {
      --broken;
      return answer::broken;
    }
    if (waiting.empty()) return answer::nothing;
    size = std::min(room.size(), waiting.front().size());
    std::copy_n(waiting.front().begin(), size, room.begin());
    waiting.pop_front();
    return answer::data;
  }
  void halt_cleared() override { stalled = false; }

  std::vector<std::uint8_t> stored{};
  usb_setup last{};
  std::deque<std::vector<std::uint8_t>> waiting{};
  std::vector<std::uint8_t> taken{};  // last
  bool deaf = false;
  bool stalled = false;
  int broken = 0;
};

}  // namespace asperity::test_support
