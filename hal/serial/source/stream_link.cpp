#include "asperity/serial/stream_link.hpp"

#include <cerrno>
#include <sys/socket.h>
#include <unistd.h>

namespace asperity::serial {
namespace {

std::int64_t or_errno(ssize_t answer) noexcept { return answer >= 0 ? std::int64_t{answer} : -std::int64_t{errno}; }

class system_terminal_calls final : public stream_calls {
 public:
  [[nodiscard]] std::int64_t read(int fd, void* bytes, std::size_t size) noexcept override {
    return or_errno(::read(fd, bytes, size));
  }
  [[nodiscard]] std::int64_t write(int fd, const void* bytes, std::size_t size) noexcept override {
    return or_errno(::write(fd, bytes, size));
  }
  void close(int fd) noexcept override { ::close(fd); }
};

class system_socket_calls final : public stream_calls {
 public:
  [[nodiscard]] std::int64_t read(int fd, void* bytes, std::size_t size) noexcept override {
    return or_errno(::recv(fd, bytes, size, MSG_DONTWAIT));
  }
  [[nodiscard]] std::int64_t write(int fd, const void* bytes, std::size_t size) noexcept override {
    return or_errno(::send(fd, bytes, size, MSG_DONTWAIT | MSG_NOSIGNAL));
  }
  void close(int fd) noexcept override { ::close(fd); }
};

}  // namespace

stream_calls& terminal_calls() noexcept {
  static system_terminal_calls calls;
  return calls;
}

stream_calls& socket_calls() noexcept {
  static system_socket_calls calls;
  return calls;
}

io_status stream_link::read(std::int64_t /*now_ns*/, std::span<std::uint8_t> bytes, std::size_t& done) noexcept {
  done = 0;
  if (gone_) return io_status::gone;
  if (bytes.empty()) return io_status::nothing;
  const std::int64_t answer = calls_.read(fd_, bytes.data(), bytes.size());
  if (answer < 0) return failed_with(answer, io_status::nothing);
  if (answer == 0) {  // a line that is merely silent says EAGAIN: see VMIN in terminal_settings.cpp
    gone_ = true;
    return io_status::gone;
  }
  done = static_cast<std::size_t>(answer);
  return io_status::ok;
}

io_status stream_link::write(std::int64_t /*now_ns*/, std::span<const std::uint8_t> bytes, std::size_t& done) noexcept {
  done = 0;
  if (gone_) return io_status::gone;
  if (bytes.empty()) return io_status::ok;
  const std::int64_t answer = calls_.write(fd_, bytes.data(), bytes.size());
  if (answer < 0) return failed_with(answer, io_status::busy);
  done = static_cast<std::size_t>(answer);
  if (done == 0) return io_status::busy;
  return done == bytes.size() ? io_status::ok : io_status::too_short;
}

io_status stream_link::failed_with(std::int64_t answer, io_status not_now) noexcept {
  errno_ = static_cast<int>(-answer);
  switch (errno_) {
    case EAGAIN:
    case EINTR:
    case ENOBUFS:
      return not_now;
    case EIO:  // what a terminal says once its adapter or its other side is no more
    case ENODEV:
    case ENXIO:
    case EPIPE:
    case ECONNRESET:
      gone_ = true;
      return io_status::gone;
    default:
      return io_status::failed;
  }
}

}  // namespace asperity::serial
