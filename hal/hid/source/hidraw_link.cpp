#include "asperity/hid/hidraw_link.hpp"

#include <cerrno>
#include <poll.h>
#include <unistd.h>

namespace asperity::hid {

hidraw_link::~hidraw_link() { ::close(fd_); }

io_status hidraw_link::read(std::int64_t now_ns, std::span<std::uint8_t> bytes, hid_report& report) noexcept {
  if (bytes.empty()) return io_status::failed;
  const ssize_t n = ::read(fd_, bytes.data(), bytes.size());
  if (n > 0) {
    report = {static_cast<std::size_t>(n), now_ns};
    return io_status::ok;
  }
  if (n == 0) {
    errno_ = 0;
    return io_status::gone;
  }
  switch (errno) {
    case EAGAIN:
    case EINTR:
      return io_status::nothing;
    case EIO:  // hidraw's word for a device that is not there any more
    case ENODEV:
    case ENXIO:
      errno_ = errno;
      return io_status::gone;
    default:
      errno_ = errno;
      return io_status::failed;
  }
}

io_status hidraw_link::write(std::int64_t /*now_ns*/, std::span<const std::uint8_t> bytes) noexcept {
  if (bytes.empty()) return io_status::refused;
  const ssize_t n = ::write(fd_, bytes.data(), bytes.size());
  if (n >= 0) return static_cast<std::size_t>(n) == bytes.size() ? io_status::ok : io_status::too_short;
  switch (errno) {
    case EAGAIN:
    case EINTR:
      return io_status::busy;
    case EINVAL:  // the kernel refuses lengths that no report has
    case EMSGSIZE:
    case ENOSYS:
      errno_ = errno;
      return io_status::refused;
    case ENODEV:
    case ENXIO:
    case ESHUTDOWN:
      errno_ = errno;
      return io_status::gone;
    default:  // a transfer that broke off: perhaps because the device left in the middle of it
      errno_ = errno;
      return hung_up() ? io_status::gone : io_status::failed;
  }
}

bool hidraw_link::hung_up() const noexcept {
  pollfd p{fd_, POLLIN, 0};
  return ::poll(&p, 1, 0) > 0 && (p.revents & (POLLERR | POLLHUP | POLLNVAL)) != 0;
}

}  // namespace asperity::hid
