#include "new_file.hpp"

#include <array>
#include <cerrno>
#include <cstdint>
#include <ctime>
#include <fcntl.h>
#include <string>
#include <sys/random.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace asperity::io {
namespace {

namespace fs = std::filesystem;

// Twelve letters and digits, 60 bits. Without the system's random numbers the clock and the process tell runs apart.
std::string random_word() {
  std::uint64_t bits = 0;
  if (getrandom(&bits, sizeof bits, GRND_NONBLOCK) != static_cast<ssize_t>(sizeof bits)) {
    timespec now{};
    clock_gettime(CLOCK_REALTIME, &now);
    bits = static_cast<std::uint64_t>(now.tv_sec) * 1'000'000'000U + static_cast<std::uint64_t>(now.tv_nsec);
    bits = (bits ^ (static_cast<std::uint64_t>(getpid()) << 40U)) * 0x9e3779b97f4a7c15ULL;
  }
  constexpr std::array<char, 33> digits{"abcdefghijkmnopqrstuvwxyz2345678"};
  std::string out;
  for (int i = 0; i < 12; ++i, bits >>= 5U) out += digits[bits & 31U];
  return out;
}

}  // namespace

fs::path behind_links(fs::path path) {
  std::error_code ec;
  for (int link = 0; link < 40 && fs::is_symlink(fs::symlink_status(path, ec)); ++link) {
    path = path.parent_path() / fs::read_symlink(path, ec);  // an absolute one replaces the parent
  }
  return path;
}

new_file create_beside(const fs::path& target) {
  struct stat old {};
  const bool replaces = stat(target.c_str(), &old) == 0 && S_ISREG(old.st_mode);
  // Nobody may look into the new file before it has the old one's mode.
  const mode_t mode = replaces ? S_IRUSR | S_IWUSR : S_IRUSR | S_IWUSR | S_IRGRP | S_IWGRP | S_IROTH | S_IWOTH;
  new_file made;
  for (int attempt = 0; attempt < 100; ++attempt) {
    made.name = target;
    made.name += ".partial-" + random_word();
    made.descriptor = open(made.name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
    if (made.descriptor >= 0 || errno != EEXIST) break;
  }
  if (made.descriptor < 0 || !replaces) return made;
  // Owner and group first: a change of them clears bits of the mode. A group that may not be given keeps the owner's.
  if (fchown(made.descriptor, old.st_uid, old.st_gid) != 0) {
    static_cast<void>(fchown(made.descriptor, static_cast<uid_t>(-1), old.st_gid) == 0);
  }
  struct stat given {};
  mode_t kept = old.st_mode & 07777U;
  if (fstat(made.descriptor, &given) == 0) {
    // Rights of an owner or group that this file does not have are not handed to others.
    if (given.st_uid != old.st_uid) kept &= ~static_cast<mode_t>(S_ISUID);
    if (given.st_gid != old.st_gid) kept &= ~static_cast<mode_t>(S_ISGID | S_IRWXG);
  }
  static_cast<void>(fchmod(made.descriptor, kept));  // a file system without modes refuses, and needs none
  return made;
}

}  // namespace asperity::io
