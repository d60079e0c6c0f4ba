#include "asperity/can/socket_calls.hpp"

#include <cerrno>
#include <ctime>
#include <limits>
#include <linux/can/raw.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace asperity::can {
namespace {

template <class T>
T or_errno(T answer) noexcept {
  return answer >= 0 ? answer : static_cast<T>(-errno);
}

std::int64_t read_ns(clockid_t clock) noexcept {
  timespec t{};
  clock_gettime(clock, &t);
  return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}

class system_calls final : public socket_calls {
 public:
  [[nodiscard]] int open() noexcept override {
    return or_errno(::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW));
  }
  [[nodiscard]] int set_option(int fd, int level, int name, const void* value, socklen_t size) noexcept override {
    return or_errno(::setsockopt(fd, level, name, value, size));
  }
  [[nodiscard]] int ask(int fd, unsigned long request, ifreq& about) noexcept override {
    return or_errno(::ioctl(fd, request, &about));
  }
  [[nodiscard]] int bind(int fd, const sockaddr_can& address) noexcept override {
    return or_errno(::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address));
  }
  [[nodiscard]] std::int64_t send(int fd, const void* bytes, std::size_t size) noexcept override {
    return or_errno(std::int64_t{::send(fd, bytes, size, MSG_DONTWAIT | MSG_NOSIGNAL)});
  }
  [[nodiscard]] std::int64_t receive(int fd, msghdr& message) noexcept override {
    return or_errno(std::int64_t{::recvmsg(fd, &message, MSG_DONTWAIT)});
  }
  void close(int fd) noexcept override { ::close(fd); }

  // The wall clock is read between two looks at the other; of several tries, the one that was interrupted least.
  [[nodiscard]] std::int64_t wall_offset_ns() noexcept override {
    std::int64_t best_ns = 0;
    std::int64_t least_ns = std::numeric_limits<std::int64_t>::max();
    for (int i = 0; i < 16; ++i) {
      const std::int64_t before_ns = read_ns(CLOCK_MONOTONIC);
      const std::int64_t wall_ns = read_ns(CLOCK_REALTIME);
      const std::int64_t taken_ns = read_ns(CLOCK_MONOTONIC) - before_ns;
      if (taken_ns >= least_ns) continue;
      least_ns = taken_ns;
      best_ns = wall_ns - (before_ns + taken_ns / 2);
    }
    return best_ns;
  }
};

}  // namespace

socket_calls& system_socket_calls() noexcept {
  static system_calls calls;
  return calls;
}

}  // namespace asperity::can
