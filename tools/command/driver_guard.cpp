#include "driver_guard.hpp"

#include <algorithm>
#include <optional>
#include <pthread.h>
#include <sched.h>
#include <utility>

#include "interrupt.hpp"
#include "text.hpp"

namespace asperity::command {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds look_every(20);

// Above the session's threads: a driver that never sleeps in a real-time class must not keep its guard from running.
void rise_above_the_session() {
  sched_param p{};
  p.sched_priority = 45;
  static_cast<void>(pthread_setschedparam(pthread_self(), SCHED_FIFO, &p));
}

std::optional<milliseconds> limit_of(driver_call which, const driver_limits& most, bool asked) {
  switch (which) {
    case driver_call::none:
      return std::nullopt;
    case driver_call::find:
    case driver_call::open:  // homing waits for a person
      return asked ? std::optional(most.asked) : std::nullopt;
    case driver_call::arm:
    case driver_call::clear_fault:
      return asked ? most.asked : most.arm;
    case driver_call::read:
    case driver_call::write:
    case driver_call::disarm:
    case driver_call::close:
      return most.tick;
  }
  return std::nullopt;
}

std::string in_seconds(milliseconds t) { return brief(1e-3 * static_cast<double>(t.count())) + " s"; }

std::string what_of_the_device(const driver_watch& watch) {
  return watch.armed() ? "; the device was NOT disarmed, so it may hold its last wrench until a watchdog of its own "
                         "ends it: switch it off"
                       : "; the device was not armed";
}

}  // namespace

driver_guard::driver_guard(const driver_watch& watch, std::function<void(const std::string&)> abandon,
                           driver_limits most)
    : watch_(watch), abandon_(std::move(abandon)), limits_(most), thread_([this] { look(); }) {}

driver_guard::~driver_guard() {
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void driver_guard::look() {
  rise_above_the_session();
  using clock = std::chrono::steady_clock;
  milliseconds in_call(0), asked_for(0), in_ending(0);
  std::uint64_t call = 0;
  clock::time_point last = clock::now();
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, look_every, [this] { return over_; })) {
    const clock::time_point now = clock::now();
    // A process that was suspended, or a machine that slept, was away for longer than it waited.
    const milliseconds passed = std::min(std::chrono::duration_cast<milliseconds>(now - last), 5 * look_every);
    last = now;
    const driver_watch::moment m = watch_.now();
    in_call = m.number == call ? in_call + passed : milliseconds(0);
    asked_for = interrupted() ? asked_for + passed : milliseconds(0);
    in_ending = ending_ ? in_ending + passed : milliseconds(0);
    call = m.number;

    const std::optional<milliseconds> limit = limit_of(m.inside, limits_, interrupted());
    // A call that was waited for gladly has its second from the signal on.
    const milliseconds waited =
        m.inside == driver_call::find || m.inside == driver_call::open ? std::min(in_call, asked_for) : in_call;
    if (limit && waited >= *limit) {
      abandon_("the driver has not returned from " + std::string(to_string(m.inside)) + " for " + in_seconds(waited) +
               what_of_the_device(watch_));
      return;
    }
    if (in_ending >= limits_.ending) {
      abandon_("the session has not ended " + in_seconds(in_ending) + " after it was told to, the last call of its " +
               "driver was " + to_string(m.last) + what_of_the_device(watch_));
      return;
    }
  }
}

}  // namespace asperity::command
