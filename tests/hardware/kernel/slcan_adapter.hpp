// A CAN adapter on a serial line that is this process: the kernel's slcan driver on one side of a pseudo terminal, the
// test on the other.
#pragma once

#include <atomic>
#include <cstdint>
#include <gtest/gtest.h>
#include <string>
#include <thread>

namespace asperity::can_kernel_test {

/// Answers the driver's commands, echoes each frame with bit 0x400 of its identifier set, and says what the test makes
/// it say. The lines it speaks are those of the LAWICEL adapters: "tIIILDD..\r" is a frame, "O" opens, "s" a state.
class slcan_adapter {
 public:
  slcan_adapter() = default;
  ~slcan_adapter() { unplug(); }
  slcan_adapter(const slcan_adapter&) = delete;
  slcan_adapter& operator=(const slcan_adapter&) = delete;

  /// Makes the interface and brings it up. @return why that was not possible; empty where it was
  [[nodiscard]] std::string plug_in(int queue_frames = 100);
  /// The line hangs up, as when the adapter is pulled out.
  void unplug();
  /// From here on the adapter takes nothing more from its line, or does again.
  void stall(bool on) { stalled_ = on; }
  /// Says something to the driver: "sb255000\r" is bus-off.
  [[nodiscard]] bool say(const std::string& line) const;

  [[nodiscard]] const std::string& interface() const { return interface_; }

 private:
  void serve();

  int master_ = -1;
  int slave_ = -1;
  std::string interface_;
  std::thread thread_;
  std::atomic<bool> stop_ = false;
  std::atomic<bool> stalled_ = false;
};

}  // namespace asperity::can_kernel_test
