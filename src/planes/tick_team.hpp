// Threads that share the work of a tick.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <system_error>
#include <thread>
#include <vector>

namespace asperity {

/// The thread that calls, and helpers that wait for it. Work is cut into tasks that write to different places, so what
/// comes out depends neither on how many threads there are nor on who does which task.
///
/// A helper takes a task when it gets a processor; nobody waits for one that gets none, because the calling thread does
/// what is left. One that has begun a task is waited for. Between two calls helpers look for the next one for some
/// tenths of a millisecond, then they sleep, and the next call wakes them.
class tick_team {
 public:
  static constexpr unsigned most_threads = 16;

  /// Starts threads - 1 helpers, or fewer where the system gives no more. Not in a tick.
  /// @param set_up called first in each helper, with its number from 1 on; may be null
  explicit tick_team(unsigned threads, void (*set_up)(unsigned) = nullptr) {
    const unsigned helpers = std::clamp(threads, 1U, most_threads) - 1;
    helpers_.reserve(helpers);
#if defined(__cpp_exceptions)
    try {
      start(helpers, set_up);
    } catch (const std::system_error&) {  // no more threads: those that there are do the work
    }
#else
    start(helpers, set_up);
#endif
  }
  tick_team(const tick_team&) = delete;
  tick_team& operator=(const tick_team&) = delete;
  ~tick_team() {
    ends_.store(true);
    call();
    for (std::thread& h : helpers_) h.join();
  }

  [[nodiscard]] unsigned threads() const noexcept { return static_cast<unsigned>(helpers_.size()) + 1; }

  /// Calls body(task, thread) for every task below `tasks`, thread being below threads(), and returns when all have
  /// returned. From one thread at a time; not from within a task.
  /// @pre body is noexcept   @rt safe: no lock, and one system call where helpers sleep; see above who is waited for
  template <class Body>
  void run(std::size_t tasks, const Body& body) noexcept {
    if (helpers_.empty() || tasks <= 1) {
      for (std::size_t task = 0; task < tasks; ++task) body(task, 0U);
      return;
    }
    tasks_ = tasks;
    body_ = std::addressof(body);
    do_task_ = [](const void* of, std::size_t task, unsigned thread) noexcept {
      (*static_cast<const Body*>(of))(task, thread);
    };
    next_.store(0, std::memory_order_relaxed);
    open_.store(following(calls_.load(std::memory_order_relaxed)));
    call();
    work(0);
    // Who enters from here on finds it closed. Who was in before has a task, or finds that none is left.
    open_.store(closed);
    while (inside_.load() != 0) pause();
  }

 private:
  static constexpr std::uint32_t closed = 0;
  // Some tenths of a millisecond: more than lies between two calls of a tick, and less than between two ticks.
  static constexpr int looks = 20'000;

  [[nodiscard]] static constexpr std::uint32_t following(std::uint32_t call) noexcept {
    return call + 1 != closed ? call + 1 : call + 2;
  }
  static void pause() noexcept {
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#elif defined(__aarch64__)
    asm volatile("yield");
#endif
  }

  void start(unsigned helpers, void (*set_up)(unsigned)) {
    for (unsigned h = 1; h <= helpers; ++h) helpers_.emplace_back([this, h, set_up] { help(h, set_up); });
  }
  void call() noexcept {
    calls_.store(following(calls_.load(std::memory_order_relaxed)));
    calls_.notify_all();
  }
  void work(unsigned thread) noexcept {
    for (std::size_t task = next_.fetch_add(1, std::memory_order_relaxed); task < tasks_;
         task = next_.fetch_add(1, std::memory_order_relaxed)) {
      do_task_(body_, task, thread);
    }
  }
  void help(unsigned thread, void (*set_up)(unsigned)) noexcept {
    if (set_up != nullptr) set_up(thread);
    std::uint32_t seen = closed;
    for (;;) {
      std::uint32_t now = calls_.load();
      for (int i = 0; now == seen && i < looks; ++i) {
        pause();
        now = calls_.load();
      }
      if (now == seen) {
        calls_.wait(seen);
        continue;
      }
      seen = now;
      if (ends_.load()) return;
      // In first, then a look whether it is still open: so run() sees either nobody inside or everybody who works.
      inside_.fetch_add(1);
      if (open_.load() == now) work(thread);
      inside_.fetch_sub(1);
    }
  }

  std::size_t tasks_ = 0;
  const void* body_ = nullptr;
  void (*do_task_)(const void*, std::size_t, unsigned) noexcept = nullptr;
  alignas(64) std::atomic<std::size_t> next_{0};
  alignas(64) std::atomic<std::uint32_t> calls_{closed};  // the last one
  std::atomic<std::uint32_t> open_{closed};               // the one that may be helped
  std::atomic<bool> ends_{false};
  alignas(64) std::atomic<std::uint32_t> inside_{0};  // helpers
  std::vector<std::thread> helpers_;                  // last: they use what is above
};

/// As tick_team::run(), by one thread where there is no team.
template <class Body>
void share(tick_team* team, std::size_t tasks, const Body& body) noexcept {
  if (team != nullptr) return team->run(tasks, body);
  for (std::size_t task = 0; task < tasks; ++task) body(task, 0U);
}

/// The same for `items` in their order, some of them a task: body(item, thread).
template <class Body>
void share_items(tick_team* team, std::size_t items, std::size_t per_task, const Body& body) noexcept {
  share(team, (items + per_task - 1) / per_task, [&](std::size_t task, unsigned thread) noexcept {
    for (std::size_t i = task * per_task; i < std::min(items, (task + 1) * per_task); ++i) body(i, thread);
  });
}

}  // namespace asperity
