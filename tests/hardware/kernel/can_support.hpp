// CAN interfaces of this machine's own kernel, made for a test and removed after it.
#pragma once

#include <cstdint>
#include <ctime>
#include <gtest/gtest.h>
#include <initializer_list>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <memory>
#include <net/if.h>
#include <string>
#include <sys/socket.h>
#include <unistd.h>

#include "asperity/can/socketcan.hpp"
#include "asperity/transport/can_bus.hpp"

namespace asperity::can_kernel_test {

/// CLOCK_MONOTONIC, ns: the clock of a real session.
[[nodiscard]] inline std::int64_t now_ns() {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}

inline void sleep_ms(int ms) { ::usleep(static_cast<useconds_t>(ms) * 1000); }

[[nodiscard]] inline can_frame frame_of(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) {
  can_frame f;
  f.id = id;
  for (const std::uint8_t b : bytes) f.data[f.size++] = b;
  return f;
}

/// Receives until something other than `nothing` is answered; `nothing` where two seconds pass. The time is there to
/// let a slow guest finish, and is no statement about anything.
[[nodiscard]] inline io_status receive_soon(can_bus& bus, can_frame& frame) {
  for (int i = 0; i < 2000; ++i) {
    const io_status s = bus.receive(now_ns(), frame);
    if (s != io_status::nothing) return s;
    sleep_ms(1);
  }
  return io_status::nothing;
}

/// Calls `done` until it is true; false where two seconds pass.
template <class Condition>
[[nodiscard]] bool soon(Condition done) {
  for (int i = 0; i < 2000; ++i) {
    if (done()) return true;
    sleep_ms(1);
  }
  return false;
}

/// A socket without asperity's, to put on the bus what can_bus does not send.
class raw_socket {
 public:
  explicit raw_socket(const std::string& interface) : fd_(::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW)) {
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(::if_nametoindex(interface.c_str()));
    open_ = ::bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  }
  ~raw_socket() { ::close(fd_); }
  raw_socket(const raw_socket&) = delete;
  raw_socket& operator=(const raw_socket&) = delete;

  [[nodiscard]] bool put(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) const {
    ::can_frame f{};
    f.can_id = id;
    for (const std::uint8_t b : bytes) f.data[f.len++] = b;
    return open_ && ::write(fd_, &f, sizeof f) == static_cast<ssize_t>(sizeof f);
  }

 private:
  int fd_;
  bool open_ = false;
};

/// Why nothing here can run on this machine; empty where it can.
[[nodiscard]] inline std::string why_not() {
  if (const result<void> support = can::check_support(); !support) return support.error().message;
  if (::geteuid() != 0) return "only root may make CAN interfaces";
  return {};
}

}  // namespace asperity::can_kernel_test
