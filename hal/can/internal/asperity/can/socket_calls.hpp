// The system calls of the CAN transport.
#pragma once

#include <cstddef>
#include <cstdint>
#include <linux/can.h>
#include <net/if.h>
#include <sys/socket.h>

namespace asperity::can {

// What goes over the socket. Not CAN_MTU and CANFD_MTU: those are macros, and name asperity::can_frame in here.
inline constexpr std::size_t classic_frame_bytes = sizeof(::can_frame);
inline constexpr std::size_t fd_frame_bytes = sizeof(::canfd_frame);
static_assert(classic_frame_bytes == 16 && fd_frame_bytes == 72);

/// The system calls of the transport, as an interface, so that a test can stand in for the kernel. Each call answers 0
/// or more, or an errno value with a minus.
class socket_calls {
 public:
  socket_calls() = default;
  socket_calls(const socket_calls&) = delete;
  socket_calls& operator=(const socket_calls&) = delete;
  virtual ~socket_calls() = default;

  /// A raw CAN socket that does not block. @return its descriptor
  [[nodiscard]] virtual int open() noexcept = 0;
  [[nodiscard]] virtual int set_option(int fd, int level, int name, const void* value, socklen_t size) noexcept = 0;
  /// SIOCGIF...: a question about an interface.
  [[nodiscard]] virtual int ask(int fd, unsigned long request, ifreq& about) noexcept = 0;
  [[nodiscard]] virtual int bind(int fd, const sockaddr_can& address) noexcept = 0;
  /// @return bytes that were taken
  [[nodiscard]] virtual std::int64_t send(int fd, const void* bytes, std::size_t size) noexcept = 0;
  /// @return bytes that were given
  [[nodiscard]] virtual std::int64_t receive(int fd, msghdr& message) noexcept = 0;
  virtual void close(int fd) noexcept = 0;
  /// Wall clock less CLOCK_MONOTONIC, ns.
  [[nodiscard]] virtual std::int64_t wall_offset_ns() noexcept = 0;
};

/// The system calls themselves.
[[nodiscard]] socket_calls& system_socket_calls() noexcept;

}  // namespace asperity::can
