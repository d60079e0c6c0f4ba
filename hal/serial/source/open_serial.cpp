#include <cerrno>
#include <fcntl.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <utility>

#include "asperity/serial/serial_port.hpp"
#include "asperity/serial/stream_link.hpp"
#include "terminal_settings.hpp"

namespace asperity::serial {
namespace {

std::string words(int errno_value) { return std::generic_category().message(errno_value); }

/// Closes the descriptor unless it was handed on.
class open_file {
 public:
  explicit open_file(int fd) noexcept : fd_(fd) {}
  ~open_file() {
    if (fd_ >= 0) ::close(fd_);
  }
  open_file(const open_file&) = delete;
  open_file& operator=(const open_file&) = delete;

  [[nodiscard]] int fd() const noexcept { return fd_; }
  [[nodiscard]] int release() noexcept { return std::exchange(fd_, -1); }

 private:
  int fd_;
};

error not_opened(const std::string& path, int why) {
  switch (why) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
      return {error_code::invalid_argument, "There is no serial line " + path + " (" + words(why) +
                                                "); see /dev/serial/by-id for those that are plugged in."};
    case EACCES:
    case EPERM:
      return {error_code::unsupported, "This user may not open " + path + " (" + words(why) +
                                           "); on Debian, add it to the group that owns serial lines and log in anew: "
                                           "usermod -aG dialout USER"};
    case EBUSY:
      return {error_code::unsupported, path + " is in use by another program; `fuser " + path + "` tells which."};
    default:
      return {error_code::io_failed, path + " could not be opened: " + words(why) + "."};
  }
}

}  // namespace

result<std::unique_ptr<byte_link>> open_serial(const std::string& path, const serial_settings& settings) {
  if (settings.bits_per_s == 0)
    return error{error_code::invalid_argument, "A serial line cannot run at 0 bits per second."};
  // Without waiting for a carrier, and without becoming the terminal that ends this process when it hangs up.
  open_file file(::open(path.c_str(), O_RDWR | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  if (file.fd() < 0) return not_opened(path, errno);
  if (::isatty(file.fd()) == 0) {
    return error{error_code::invalid_argument,
                 path + " is not a serial line; see /dev/serial/by-id for those there are."};
  }
  if (const int why = make_exclusive(file.fd()); why != 0) return not_opened(path, why);
  std::uint32_t got = 0;
  if (const int why = make_raw(file.fd(), settings.bits_per_s, got); why != 0) {
    return error{error_code::io_failed, path + " does not take the settings of a raw line: " + words(why) + "."};
  }
  // Receivers sample in the middle of the tenth bit; half a bit in ten is too far off, and each end has its share.
  const std::uint32_t off = got > settings.bits_per_s ? got - settings.bits_per_s : settings.bits_per_s - got;
  if (off > settings.bits_per_s / 50) {
    return error{error_code::unsupported, path + " cannot run at " + std::to_string(settings.bits_per_s) +
                                              " bits per second; the nearest that it takes is " + std::to_string(got) +
                                              "."};
  }
  return std::unique_ptr<byte_link>(std::make_unique<stream_link>(terminal_calls(), file.release()));
}

result<std::unique_ptr<byte_link>> adopt_descriptor(int fd) {
  struct stat about {};
  const int flags = ::fcntl(fd, F_GETFL);
  if (flags < 0 || ::fstat(fd, &about) < 0) {
    return error{error_code::invalid_argument, "Descriptor " + std::to_string(fd) + " is not open."};
  }
  const bool is_socket = S_ISSOCK(about.st_mode);
  if ((!is_socket && ::isatty(fd) == 0) || (flags & O_ACCMODE) != O_RDWR) {
    return error{error_code::invalid_argument, "Descriptor " + std::to_string(fd) +
                                                   " is no stream both ways: a terminal or a stream socket, open for "
                                                   "reading and writing, is needed."};
  }
  if (::fcntl(fd, F_SETFL, flags | O_NONBLOCK) < 0) {
    return error{error_code::io_failed,
                 "Descriptor " + std::to_string(fd) + " cannot be made not to block: " + words(errno) + "."};
  }
  return std::unique_ptr<byte_link>(std::make_unique<stream_link>(is_socket ? socket_calls() : terminal_calls(), fd));
}

}  // namespace asperity::serial
