// An open SocketCAN socket as a can_bus.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>

#include "asperity/can/socket_calls.hpp"
#include "asperity/can/socketcan.hpp"
#include "asperity/can/stamp_clock.hpp"

namespace asperity::can {

/// open_socketcan() with these system calls. @pre `calls` outlives what is returned
[[nodiscard]] result<std::unique_ptr<can_bus>> open_socketcan(const std::string& interface,
                                                              const socketcan_settings& settings, socket_calls& calls);

/// check_support() with these system calls.
[[nodiscard]] result<void> check_support(socket_calls& calls);

/// The command that brings an interface up, and the user to run it as.
[[nodiscard]] std::string how_to_bring_up(const std::string& name, bool with_fd);

class socketcan_bus final : public can_bus {
 public:
  /// Takes a descriptor that is bound to the interface of that number.
  socketcan_bus(socket_calls& calls, int fd, int interface_index, bool takes_fd, std::int64_t busy_back_off_ns) noexcept
      : calls_(calls),
        fd_(fd),
        index_(interface_index),
        takes_fd_(takes_fd),
        back_off_ns_(busy_back_off_ns),
        stamps_(calls.wall_offset_ns()) {}
  ~socketcan_bus() override { calls_.close(fd_); }
  socketcan_bus(const socketcan_bus&) = delete;
  socketcan_bus& operator=(const socketcan_bus&) = delete;

  [[nodiscard]] io_status send(std::int64_t now_ns, const can_frame& frame) noexcept override;
  [[nodiscard]] io_status receive(std::int64_t now_ns, can_frame& frame) noexcept override;
  [[nodiscard]] can_health health() const noexcept override { return health_; }
  [[nodiscard]] bool takes_fd() const noexcept override { return takes_fd_; }
  [[nodiscard]] int errno_value() const noexcept override { return errno_; }

  /// Most error frames that one receive() takes, so that a storm of them cannot hold a tick.
  static constexpr int most_error_frames = 64;
  /// While the link is down the kernel is asked about it no more often than this.
  static constexpr std::int64_t ask_every_ns = 10'000'000;

 private:
  struct received;  // one message of the kernel, with what came beside it

  [[nodiscard]] io_status take(received& in, std::int64_t size, std::int64_t now_ns, can_frame& frame) noexcept;
  [[nodiscard]] io_status nothing_there(std::int64_t now_ns) noexcept;
  [[nodiscard]] io_status failed_with(std::int64_t answer, std::int64_t now_ns) noexcept;
  void ask_about_link(std::int64_t now_ns) noexcept;
  void controller_started() noexcept;

  socket_calls& calls_;
  int fd_;
  int index_;
  bool takes_fd_;
  std::int64_t back_off_ns_;
  stamp_clock stamps_;
  can_health health_{};
  std::int64_t busy_until_ns_ = std::numeric_limits<std::int64_t>::min();
  std::int64_t ask_at_ns_ = std::numeric_limits<std::int64_t>::min();
  std::uint32_t dropped_ = 0;  // the socket's own count, which wraps
  bool link_down_ = false;
  bool gone_ = false;
  int errno_ = 0;
};

}  // namespace asperity::can
