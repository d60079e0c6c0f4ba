// What ends the reading of a file from within: it is wrong, too large, or nobody wants it any more.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>

#include "asperity/core/status.hpp"

namespace asperity::io {

/// What is wrong with the file under the reader's hands. Never leaves asperity::io.
struct rejection {
  error_code code;
  std::string what;
};

[[noreturn]] inline void reject(std::string what) { throw rejection{error_code::bad_format, std::move(what)}; }

/// Asks the caller of a reader, again and again, whether to go on. Every loop whose length a file decides passes here.
class reading_watch {
 public:
  reading_watch() = default;
  explicit reading_watch(std::function<bool()> keep_going) : keep_going_(std::move(keep_going)) {}

  /// Throws rejection (cancelled) where the caller has had enough.
  void ask() const {
    if (!goes_on()) throw rejection{error_code::cancelled, "was not read to its end: cancelled; nothing was kept"};
  }
  /// The same for each of many small steps: asks at one of 4096.
  void step() {
    if ((++steps_ & 0xfffU) == 0) ask();
  }
  /// For callbacks of C libraries, which an exception must not cross.
  [[nodiscard]] bool goes_on() const { return !keep_going_ || keep_going_(); }

 private:
  std::function<bool()> keep_going_;
  std::uint32_t steps_ = 0;
};

}  // namespace asperity::io
