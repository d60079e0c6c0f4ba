// A virtual clock that goes as fast as somebody wants to look at it.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <thread>

#include "interrupt.hpp"
#include "view/feed.hpp"

namespace asperity::command {

/// Keeps a session on the virtual clock at the speed that its pages ask for, and still while they pause it. The session
/// itself is the same at any speed.
class session_pace {
 public:
  explicit session_pace(view::feed& wishes) : wishes_(&wishes) {}

  /// Returns when the tick at this time may run, or when a signal asked to stop.
  void wait_for(std::int64_t time_ns) {
    using std::chrono::steady_clock;
    while (wishes_->paused() && !interrupted()) {
      begun_ = false;
      if (wishes_->take_step()) return;
      std::this_thread::sleep_for(look_again);
    }
    while (!interrupted() && !wishes_->paused()) {
      const double speed = wishes_->speed();
      const auto now = steady_clock::now();
      if (!begun_ || speed != speed_) start(time_ns, speed, now);
      const double due_ns = static_cast<double>(time_ns - from_ns_) / speed_;
      const auto due = at_ + std::chrono::nanoseconds(static_cast<std::int64_t>(due_ns));
      // A machine that cannot keep up is not hurried afterwards.
      if (now - due > look_again * 10) begun_ = false;
      if (now >= due) return;
      std::this_thread::sleep_for(std::min<steady_clock::duration>(due - now, look_again));
    }
  }

 private:
  static constexpr std::chrono::milliseconds look_again{10};

  void start(std::int64_t time_ns, double speed, std::chrono::steady_clock::time_point now) {
    from_ns_ = time_ns;
    speed_ = speed;
    at_ = now;
    begun_ = true;
  }

  view::feed* wishes_;
  std::int64_t from_ns_ = 0;
  double speed_ = 1.0;
  std::chrono::steady_clock::time_point at_{};
  bool begun_ = false;
};

}  // namespace asperity::command
