#include "terminal_settings.hpp"

#include <asm/termbits.h>
#include <cerrno>
#include <sys/ioctl.h>

namespace asperity::serial {

int make_raw(int fd, std::uint32_t bits_per_s, std::uint32_t& got_bits_per_s) noexcept {
  termios2 t{};
  if (::ioctl(fd, TCGETS2, &t) < 0) return errno;
  t.c_iflag = IGNBRK;
  t.c_oflag = 0;
  t.c_lflag = 0;
  // BOTHER: the rates in figures, so that any can be asked for. CLOCAL: no modem's carrier is waited for.
  t.c_cflag = CS8 | CREAD | CLOCAL | BOTHER;
  t.c_ispeed = bits_per_s;
  t.c_ospeed = bits_per_s;
  // With VMIN 0 a silent line would answer 0, as one does that has hung up.
  t.c_cc[VMIN] = 1;
  t.c_cc[VTIME] = 0;
  if (::ioctl(fd, TCSETS2, &t) < 0) return errno;
  if (::ioctl(fd, TCGETS2, &t) < 0) return errno;
  got_bits_per_s = t.c_ospeed;
  if (::ioctl(fd, TCFLSH, TCIOFLUSH) < 0) return errno;
  return 0;
}

int make_exclusive(int fd) noexcept { return ::ioctl(fd, TIOCEXCL) < 0 ? errno : 0; }

}  // namespace asperity::serial
