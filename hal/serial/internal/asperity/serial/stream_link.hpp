// An open descriptor as a byte_link.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "asperity/transport/byte_link.hpp"

namespace asperity::serial {

/// The system calls of a stream, as an interface, so that a test can stand in for the kernel. Each call answers a
/// number of bytes, or an errno value with a minus.
class stream_calls {
 public:
  stream_calls() = default;
  stream_calls(const stream_calls&) = delete;
  stream_calls& operator=(const stream_calls&) = delete;
  virtual ~stream_calls() = default;

  [[nodiscard]] virtual std::int64_t read(int fd, void* bytes, std::size_t size) noexcept = 0;
  [[nodiscard]] virtual std::int64_t write(int fd, const void* bytes, std::size_t size) noexcept = 0;
  virtual void close(int fd) noexcept = 0;
};

/// The system calls themselves, for terminals, and for sockets, where a write to nobody would end the process.
[[nodiscard]] stream_calls& terminal_calls() noexcept;
[[nodiscard]] stream_calls& socket_calls() noexcept;

/// Takes a descriptor that does not block. @pre `calls` outlives it
class stream_link final : public byte_link {
 public:
  stream_link(stream_calls& calls, int fd) noexcept : calls_(calls), fd_(fd) {}
  ~stream_link() override { calls_.close(fd_); }
  stream_link(const stream_link&) = delete;
  stream_link& operator=(const stream_link&) = delete;

  [[nodiscard]] io_status read(std::int64_t now_ns, std::span<std::uint8_t> bytes, std::size_t& done) noexcept override;
  [[nodiscard]] io_status write(std::int64_t now_ns, std::span<const std::uint8_t> bytes,
                                std::size_t& done) noexcept override;
  [[nodiscard]] int errno_value() const noexcept override { return errno_; }

 private:
  [[nodiscard]] io_status failed_with(std::int64_t answer, io_status not_now) noexcept;

  stream_calls& calls_;
  int fd_;
  bool gone_ = false;
  int errno_ = 0;
};

}  // namespace asperity::serial
