// Sees whether a file was opened, by any process.
#pragma once

#include <array>
#include <filesystem>
#include <sys/inotify.h>
#include <unistd.h>

namespace asperity::hostile {

class open_watch {
 public:
  explicit open_watch(const std::filesystem::path& file) : fd_(::inotify_init1(IN_NONBLOCK | IN_CLOEXEC)) {
    watching_ = fd_ >= 0 && ::inotify_add_watch(fd_, file.c_str(), IN_OPEN | IN_ACCESS) >= 0;
  }
  ~open_watch() {
    if (fd_ >= 0) ::close(fd_);
  }
  open_watch(const open_watch&) = delete;
  open_watch& operator=(const open_watch&) = delete;

  /// False where the system offers no watches.
  [[nodiscard]] bool watching() const noexcept { return watching_; }
  /// Whether the file was opened since the last call.
  [[nodiscard]] bool opened() const {
    bool any = false;
    alignas(inotify_event) std::array<char, 4096> events{};
    while (::read(fd_, events.data(), events.size()) > 0) any = true;
    return any;
  }

 private:
  int fd_;
  bool watching_ = false;
};

}  // namespace asperity::hostile
