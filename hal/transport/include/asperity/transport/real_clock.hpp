// The clock of a session in the real world.
#pragma once

#include <chrono>
#include <cstdint>
#include <thread>

#include "asperity/transport/io_clock.hpp"

namespace asperity {

/// The monotonic clock that a real_session runs on.
class real_clock final : public io_clock {
 public:
  [[nodiscard]] std::int64_t now_ns() noexcept override {
    using namespace std::chrono;
    return duration_cast<nanoseconds>(steady_clock::now().time_since_epoch()).count();
  }
  void wait_until_ns(std::int64_t due_ns) noexcept override {
    using namespace std::chrono;
    std::this_thread::sleep_until(steady_clock::time_point(duration_cast<steady_clock::duration>(nanoseconds(due_ns))));
  }
};

}  // namespace asperity
