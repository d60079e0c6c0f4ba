// The sample's spring handle as a witness: it writes every call that matters into a file, and blocks in the call that
// a test names, whatever signals come.
//   NOTING_FILE=FILE           open, arm, the first write that pushes, disarm (with the last force), close: a line each
//   NOTING_BLOCK=CALL[:N]      block in the Nth such call, the first by default: open, arm, read, write, disarm, close
//   NOTING_OPEN_MS=MS          open takes that long, under a second
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <memory>
#include <string>
#include <time.h>
#include <unistd.h>
#include <vector>

#include <asperity/device/driver_export.hpp>

#include "spring_handle.hpp"

namespace noting {

using namespace asperity;

void note(const std::string& line) noexcept {
  const char* const file = std::getenv("NOTING_FILE");
  const int to = file == nullptr ? -1 : ::open(file, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  if (to < 0) return;
  const std::string whole = line + '\n';
  static_cast<void>(::write(to, whole.data(), whole.size()) > 0);
  ::close(to);
}

// Blocks for ever in the call that the test named.
class stumbling_block {
 public:
  void pass(const char* call) noexcept {
    const char* const wanted = std::getenv("NOTING_BLOCK");
    const std::size_t length = std::strlen(call);
    if (wanted == nullptr || std::strncmp(wanted, call, length) != 0) return;
    if (wanted[length] != '\0' && wanted[length] != ':') return;
    const int at = wanted[length] == ':' ? std::atoi(wanted + length + 1) : 1;
    if (++calls_ != at) return;
    note(std::string("blocks in ") + call);
    while (true) pause();
  }

 private:
  int calls_ = 0;
};

class device {
 public:
  using policy_tag = device_tag;

  device() = default;
  device(const device&) = delete;
  device& operator=(const device&) = delete;
  ~device() { close(); }

  [[nodiscard]] const device_capabilities& capabilities() const noexcept { return handle_.capabilities(); }
  [[nodiscard]] device_state state() const noexcept { return handle_.state(); }
  [[nodiscard]] result<void> open() {
    note("open");
    block_.pass("open");
    // A homing: signals do not shorten it.
    const char* const homing = std::getenv("NOTING_OPEN_MS");
    timespec left{.tv_sec = 0, .tv_nsec = homing == nullptr ? 0 : std::atoi(homing) * 1'000'000L};
    while (nanosleep(&left, &left) != 0) {
    }
    return handle_.open();
  }
  [[nodiscard]] result<void> arm() {
    note("arm");
    block_.pass("arm");
    return handle_.arm();
  }
  [[nodiscard]] result<void> clear_fault() { return handle_.clear_fault(); }
  status disarm() noexcept {
    block_.pass("disarm");
    char line[64];
    std::snprintf(line, sizeof line, "disarm after %.6f N", last_n_);
    note(line);
    return handle_.disarm();
  }
  void close() noexcept {
    if (handle_.state() != device_state::closed) block_.pass("close");
    note("close");
    handle_.close();
  }
  [[nodiscard]] status read(std::int64_t now_ns, device_sample& in) noexcept {
    block_.pass("read");
    return handle_.read(now_ns, in);
  }
  [[nodiscard]] status write(std::int64_t now_ns, const device_command& out) noexcept {
    block_.pass("write");
    last_n_ = glm::length(out.on_hand.force);
    if (last_n_ > 0.05 && !pushed_) note("pushes");
    pushed_ = pushed_ || last_n_ > 0.05;
    return handle_.write(now_ns, out);
  }

 private:
  sample::spring_handle handle_;
  stumbling_block block_;
  double last_n_ = 0.0;
  bool pushed_ = false;
};

struct driver {
  static constexpr driver_description description{.name = "noting",
                                                  .version = "1.0",
                                                  .licence = "Apache-2.0",
                                                  .vendor = "the tests",
                                                  .maturity = driver_maturity::simulated};
  static result<std::vector<device_listing>> list() {
    return std::vector<device_listing>{{.driver = description.name,
                                        .identity = "test:noting:0001",
                                        .path = "nowhere",
                                        .name = "noting handle",
                                        .maturity = description.maturity,
                                        .capabilities = sample::spring_handle_capabilities()}};
  }
  static result<std::unique_ptr<device>> make(const device_listing&) { return std::make_unique<device>(); }
};

}  // namespace noting

ASPERITY_EXPORT_DRIVER(noting::driver);
