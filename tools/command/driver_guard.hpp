// What is done about a driver that does not return.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "driver_watch.hpp"

namespace asperity::command {

/// Limits of one call, and of the whole end of a session.
struct driver_limits {
  std::chrono::milliseconds tick{1000};    ///< read(), write(), disarm(), close(): at any time
  std::chrono::milliseconds arm{10000};    ///< arm(), clear_fault()
  std::chrono::milliseconds asked{1000};   ///< any call, open() and the search too, once a signal asked to stop
  std::chrono::milliseconds ending{3000};  ///< from the wish to stop until both loops have ended and disarm() is back
};

/// A thread that looks at a watch every few milliseconds. Where a call takes longer than its limit, nobody can be asked
/// to disarm: a driver takes calls one at a time, and the thread that is in it cannot be ended alone. The guard then
/// hands over to `abandon`, which closes what can be closed and ends the process.
///
/// Time in which the process was suspended does not count.
class driver_guard {
 public:
  /// @param abandon called at most once, in the guard's thread, with one sentence on what happened; does not return
  driver_guard(const driver_watch& watch, std::function<void(const std::string&)> abandon, driver_limits limits = {});
  driver_guard(const driver_guard&) = delete;
  driver_guard& operator=(const driver_guard&) = delete;
  ~driver_guard();

  /// The session was told to end: driver_limits::ending runs until the end of the wait.
  class ending {
   public:
    explicit ending(driver_guard* guard) noexcept : guard_(guard) {
      if (guard_ != nullptr) guard_->ending_.store(true);
    }
    ending(const ending&) = delete;
    ending& operator=(const ending&) = delete;
    ~ending() {
      if (guard_ != nullptr) guard_->ending_.store(false);
    }

   private:
    driver_guard* guard_;
  };

 private:
  void look();

  const driver_watch& watch_;
  std::function<void(const std::string&)> abandon_;
  driver_limits limits_;
  std::atomic<bool> ending_{false};
  std::mutex mutex_;
  std::condition_variable wake_;
  bool over_ = false;
  std::thread thread_;
};

}  // namespace asperity::command
