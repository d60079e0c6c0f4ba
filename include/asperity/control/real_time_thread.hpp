// What a session's threads may ask the system for: a real-time scheduling class, a processor, memory that stays.
//
// Opt-in. The library asks for nothing by itself, because what a program may do to its machine is the program's
// decision. To opt in:
//
//   const asperity::memory_lock locked;  // once everything is loaded, before start()
//   asperity::real_schedule schedule{.set_up_thread = asperity::set_up_real_time_thread};
//   ...
//   session.start();
//   asperity::thread_grants got = asperity::latest_grants(asperity::session_thread::device);  // after the first tick
//
// Nothing here fails: what the system refuses is reported, and the session runs without it.
// A header and no compiled part, because it needs the C library alone; only on Linux does it ask for anything.
#pragma once

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdint>

#include "asperity/control/real_session.hpp"

#if defined(__linux__)
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#endif

namespace asperity {

/// What became of one wish.
enum class grant : std::uint8_t {
  not_asked,  ///< it would have done harm here, or nobody wished for it
  granted,
  refused,      ///< by the system: see its error number
  unsupported,  ///< not on this system
};

/// What a thread asked for and got.
struct thread_grants {
  grant scheduling = grant::not_asked;
  int priority = 0;          ///< of SCHED_FIFO, where it was granted
  int scheduling_error = 0;  ///< errno of the refusal
  grant affinity = grant::not_asked;
  int processor = -1;      ///< where it was granted
  int affinity_error = 0;  ///< errno of the refusal
};

/// What a session's threads ask for.
struct real_time_wish {
  /// SCHED_FIFO priority of the device thread. Below 50, where a real-time kernel serves the interrupts of the device's
  /// own link; the contact thread gets half of it.
  int device_priority = 40;
  /// Processors that this process has to have for its contact thread to get a class of its own. With fewer, a contact
  /// thread that is busy all the time could keep the application's thread from running.
  int processors_for_contact_class = 3;
  /// Processors for each thread to be tied to one. With fewer, a thread that must wait for its own processor while
  /// another one is free is worse off.
  int processors_for_affinity = 4;
};

#if defined(__linux__)

namespace real_time_detail {

/// The device thread's class, or half of its priority.
inline void ask_for_class(const real_time_wish& wish, bool is_device, thread_grants& got) noexcept {
  const auto ask = [&](int device_priority) {
    const int priority = is_device ? device_priority : device_priority / 2;
    if (priority < 1) return EPERM;
    sched_param p{};
    p.sched_priority = priority;
    // Unlike sched_setscheduler() it returns the error; the flag keeps the class from being inherited.
    const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO | SCHED_RESET_ON_FORK, &p);
    if (error == 0) got.priority = priority;
    return error;
  };
  int error = ask(std::clamp(wish.device_priority, 1, 99));
  rlimit limit{};
  if (error == EPERM && getrlimit(RLIMIT_RTPRIO, &limit) == 0 && limit.rlim_cur > 0 && limit.rlim_cur < 99) {
    error = ask(std::min(wish.device_priority, static_cast<int>(limit.rlim_cur)));
  }
  got.scheduling = error == 0 ? grant::granted : grant::refused;
  got.scheduling_error = error;
}

/// The processors that this process has, and how many.
inline int processors_of_process(cpu_set_t& allowed) noexcept {
  CPU_ZERO(&allowed);
  return sched_getaffinity(0, sizeof allowed, &allowed) == 0 ? CPU_COUNT(&allowed) : 1;
}

}  // namespace real_time_detail

/// Asks for the contact thread's class for a thread that shares its ticks (plane_renderer_settings::threads), where this
/// process has a processor for each of them beside those that wish.processors_for_contact_class counts. Not in a tick.
/// @param helper its number, from 1 on
[[nodiscard]] inline thread_grants ask_for_real_time_helper(unsigned helper, const real_time_wish& wish = {}) noexcept {
  thread_grants got;
  cpu_set_t allowed;
  if (real_time_detail::processors_of_process(allowed) >=
      wish.processors_for_contact_class + static_cast<int>(helper)) {
    real_time_detail::ask_for_class(wish, false, got);
  }
  return got;
}

/// Asks for what `wish` says for the calling thread, one of a real_session's. Not in a tick.
/// The priority is lowered to the process's limit (RLIMIT_RTPRIO) where that is lower. Children that the thread starts
/// do not inherit its class.
[[nodiscard]] inline thread_grants ask_for_real_time(session_thread which, const real_time_wish& wish = {}) noexcept {
  thread_grants got;
  cpu_set_t allowed;
  const int processors = real_time_detail::processors_of_process(allowed);
  const bool is_device = which == session_thread::device;

  if (is_device || processors >= wish.processors_for_contact_class) {
    real_time_detail::ask_for_class(wish, is_device, got);
  }

  // The last processors: the first one often serves the machine's interrupts.
  if (processors >= wish.processors_for_affinity) {
    int from_the_end = is_device ? 0 : 1;
    for (int processor = CPU_SETSIZE - 1; processor >= 0; --processor) {
      if (!CPU_ISSET(static_cast<std::size_t>(processor), &allowed) || from_the_end-- > 0) continue;
      cpu_set_t one;
      CPU_ZERO(&one);
      CPU_SET(static_cast<std::size_t>(processor), &one);
      const int error = sched_setaffinity(0, sizeof one, &one) == 0 ? 0 : errno;
      got.affinity = error == 0 ? grant::granted : grant::refused;
      got.affinity_error = error;
      if (error == 0) got.processor = processor;
      break;
    }
  }
  return got;
}

/// Keeps the process's memory from being paged out while it lives. What is there already is read in at once, so it is
/// made when everything is loaded and before the session starts. Memory that comes later is kept too where no
/// limit stands against it; under a limit (RLIMIT_MEMLOCK) that could make a later allocation fail, so it is
/// left out. One at a time in a process.
class memory_lock {
 public:
  memory_lock() noexcept {
    rlimit limit{};
    const bool unlimited = getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur == RLIM_INFINITY;
    error_ = mlockall(unlimited ? MCL_CURRENT | MCL_FUTURE : MCL_CURRENT) == 0 ? 0 : errno;
    future_ = unlimited && error_ == 0;
  }
  memory_lock(const memory_lock&) = delete;
  memory_lock& operator=(const memory_lock&) = delete;
  ~memory_lock() {
    if (error_ == 0) munlockall();
  }

  [[nodiscard]] grant outcome() const noexcept { return error_ == 0 ? grant::granted : grant::refused; }
  /// errno of the refusal; 0 without one.
  [[nodiscard]] int refusal() const noexcept { return error_; }
  /// Whether memory that is taken later is kept as well.
  [[nodiscard]] bool keeps_later_memory() const noexcept { return future_; }

 private:
  int error_ = 0;
  bool future_ = false;
};

#else

[[nodiscard]] inline thread_grants ask_for_real_time_helper(unsigned, const real_time_wish& = {}) noexcept {
  return {.scheduling = grant::unsupported, .affinity = grant::unsupported};
}

[[nodiscard]] inline thread_grants ask_for_real_time(session_thread, const real_time_wish& = {}) noexcept {
  return {.scheduling = grant::unsupported, .affinity = grant::unsupported};
}

class memory_lock {
 public:
  memory_lock() noexcept = default;
  memory_lock(const memory_lock&) = delete;
  memory_lock& operator=(const memory_lock&) = delete;
  [[nodiscard]] grant outcome() const noexcept { return grant::unsupported; }
  [[nodiscard]] int refusal() const noexcept { return 0; }
  [[nodiscard]] bool keeps_later_memory() const noexcept { return false; }
};

#endif

namespace real_time_detail {

/// Grants of the latest thread of one kind. Plain numbers: atomics of that size need no library.
struct kept_grants {
  std::atomic<grant> scheduling{grant::not_asked}, affinity{grant::not_asked};
  std::atomic<int> priority{0}, scheduling_error{0}, processor{-1}, affinity_error{0};
};
inline kept_grants of_contact{}, of_device{};

[[nodiscard]] inline kept_grants& of(session_thread which) noexcept {
  return which == session_thread::device ? of_device : of_contact;
}

}  // namespace real_time_detail

/// For real_schedule::set_up_thread: asks for what real_time_wish wishes by default.
inline void set_up_real_time_thread(session_thread which) noexcept {
  const thread_grants got = ask_for_real_time(which);
  real_time_detail::kept_grants& to = real_time_detail::of(which);
  to.scheduling = got.scheduling;
  to.priority = got.priority;
  to.scheduling_error = got.scheduling_error;
  to.affinity = got.affinity;
  to.processor = got.processor;
  to.affinity_error = got.affinity_error;
}

/// For plane_renderer_settings::set_up_helper: asks for the contact thread's class. What is refused is not told.
inline void set_up_real_time_helper(unsigned helper) noexcept { static_cast<void>(ask_for_real_time_helper(helper)); }

/// What set_up_real_time_thread() got for the latest thread of that kind. @pre that thread has ticked, or has ended
[[nodiscard]] inline thread_grants latest_grants(session_thread which) noexcept {
  const real_time_detail::kept_grants& from = real_time_detail::of(which);
  return {.scheduling = from.scheduling,
          .priority = from.priority,
          .scheduling_error = from.scheduling_error,
          .affinity = from.affinity,
          .processor = from.processor,
          .affinity_error = from.affinity_error};
}

}  // namespace asperity
