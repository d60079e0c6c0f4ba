// Work that takes longer than a person waits: it runs in a thread of its own while the caller's watches for Ctrl-C.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "asperity/core/status.hpp"
#include "errors.hpp"
#include "pybind.hpp"

namespace asperity::python {

/// What the work tells its caller, and whether it shall go on.
class work_monitor {
 public:
  /// From the work. @return false where it shall end
  bool enter(std::string_view stage, double done) {
    const std::lock_guard lock(lock_);
    // One line for a stage's progress, one for each stage: what the caller has not read yet is replaced.
    if (!news_.empty() && news_.back().first == stage) {
      news_.back().second = done;
    } else {
      news_.emplace_back(stage, done);
    }
    return !stop_.load(std::memory_order_relaxed);
  }
  [[nodiscard]] bool wanted() const noexcept { return !stop_.load(std::memory_order_relaxed); }

  void stop() noexcept { stop_.store(true, std::memory_order_relaxed); }
  [[nodiscard]] std::deque<std::pair<std::string, double>> take() {
    const std::lock_guard lock(lock_);
    return std::exchange(news_, {});
  }
  void end() {
    const std::lock_guard lock(lock_);
    ended_ = true;
    changed_.notify_all();
  }
  /// @return whether the work has ended
  bool wait(std::chrono::milliseconds longest) {
    std::unique_lock lock(lock_);
    return changed_.wait_for(lock, longest, [&] { return ended_; });
  }

 private:
  std::mutex lock_;
  std::condition_variable changed_;
  std::deque<std::pair<std::string, double>> news_;
  std::atomic<bool> stop_{false};
  bool ended_ = false;
};

/// For work on the calling thread, without the GIL: asks Python every 50 ms whether a signal has come, such as Ctrl-C.
class signal_watch {
 public:
  /// @return whether to go on   @pre the GIL is not held
  [[nodiscard]] bool operator()() {
    const auto now = std::chrono::steady_clock::now();
    if (now - last_look_ < std::chrono::milliseconds(50)) return true;
    last_look_ = now;
    const py::gil_scoped_acquire gil;
    if (PyErr_CheckSignals() == 0) return true;
    raised_.emplace();
    return false;
  }
  /// Raises what ended the work, if anything did. @pre the GIL is held
  void rethrow() const {
    if (raised_) throw *raised_;
  }

 private:
  std::chrono::steady_clock::time_point last_look_ = std::chrono::steady_clock::now();
  std::optional<py::error_already_set> raised_;
};

/// Tells `progress` the news; has Python act on signals. @return what was raised, if anything
/// @pre the GIL is held
std::optional<py::error_already_set> look_after(work_monitor& monitor, const py::object& progress);

/// Runs the work without the GIL. A signal or an exception of `progress` ends it: its stages ask at least ten times a
/// second, but for a few that cannot be left; one of those is waited for no longer than 0.2 s and runs out alone.
/// @param work owns what it needs, and touches nothing of Python
/// @param progress called as progress(stage, done) on the calling thread; None: nobody. False from it cancels.
template <class T>
[[nodiscard]] T run_interruptibly(std::function<result<T>(work_monitor&)> work, const py::object& progress) {
  struct shared_state {
    work_monitor monitor;
    std::optional<result<T>> outcome;
    std::exception_ptr thrown;
  };
  const auto state = std::make_shared<shared_state>();
  std::thread worker([state, work = std::move(work)]() mutable {
    try {
      state->outcome.emplace(work(state->monitor));
    } catch (...) {
      state->thrown = std::current_exception();
    }
    work = nullptr;  // what it owned goes with it, before the caller goes on
    state->monitor.end();
  });
  std::optional<py::error_already_set> raised;
  for (bool ended = false; !ended && !raised;) {
    {
      const py::gil_scoped_release others_may_run;
      ended = state->monitor.wait(std::chrono::milliseconds(20));
    }
    raised = look_after(state->monitor, progress);
  }
  {
    const py::gil_scoped_release others_may_run;
    if (raised) state->monitor.stop();
    if (!raised || state->monitor.wait(std::chrono::milliseconds(200))) {
      worker.join();
    } else {
      worker.detach();
    }
  }
  if (raised) throw *raised;
  if (state->thrown) std::rethrow_exception(state->thrown);
  return unwrap(std::move(*state->outcome));
}

}  // namespace asperity::python
