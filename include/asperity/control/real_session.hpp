// Both loops on the real clock, each in its own thread.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <thread>
#include <utility>
#include <vector>

#include "asperity/control/contact_loop.hpp"
#include "asperity/control/device_loop.hpp"

namespace asperity {

/// Which of a session's threads asks to be set up.
enum class session_thread : std::uint8_t { contact, device };

/// Periods, room for the timing record, and what a thread does before its first tick.
struct real_schedule {
  std::int64_t device_period_ns = 1'000'000;
  std::int64_t contact_period_ns = 1'000'000;
  std::size_t timed_ticks = 1 << 16;  ///< ticks of each thread whose duration is kept; later ones are counted only
  /// Called once in each new thread: the place to ask for a scheduling class, an affinity, locked memory. May be null.
  /// asperity asks for nothing by itself, because what a program may do to its machine is the program's decision.
  void (*set_up_thread)(session_thread) = nullptr;

  [[nodiscard]] constexpr loop_periods periods() const noexcept { return {device_period_ns, contact_period_ns}; }
};

/// How the ticks of one thread went.
struct tick_timing {
  std::uint64_t ticks = 0;
  std::uint64_t idle = 0;       ///< of these, ticks of the contact loop that found no new pose; their time is not kept
  std::uint64_t late = 0;       ///< ticks that began after the deadline of the tick that should have followed
  std::uint64_t skipped = 0;    ///< periods left out to catch up
  std::int64_t longest_ns = 0;  ///< longest tick
  std::int64_t latest_ns = 0;   ///< largest delay of a tick's beginning behind its due time
  std::vector<std::int64_t> durations_ns;  ///< of the first ticks, as many as were asked for
};

/// Runs a contact thread and a device thread until stop(). Due times are absolute, so a delay does not accumulate.
/// A thread that is more than a period behind leaves out the periods that it missed, and counts them.
/// The destructor stops. @pre the device is open; it is used by the device thread only while the session runs
template <contact_renderer Renderer, haptic_device Device, session_observer Observer = no_observer>
class real_session : public session_application {
 public:
  real_session(Renderer feel, scene_placement placement, Device& dev, const control_settings& settings,
               const real_schedule& schedule = {}, Observer observer = {})
      : schedule_(schedule),
        contact_(std::move(feel), placement, shared_,
                 selection_for(schedule.periods().renewal_ns(), settings.map.scale), laws_of(settings)),
        device_(dev, with_periods(settings, schedule.periods()), placement.centre_of_mass_a, shared_,
                std::move(observer)) {}

  // The loops hold the address of the exchange, the threads that of the session.
  real_session(const real_session&) = delete;
  real_session& operator=(const real_session&) = delete;
  ~real_session() { stop(); }

  /// Starts both threads; nothing where they run already. Takes all memory for the timing record.
  void start() {
    if (device_thread_.joinable()) return;
    device_timing_ = {};
    contact_timing_ = {};
    device_timing_.durations_ns.reserve(schedule_.timed_ticks);
    contact_timing_.durations_ns.reserve(schedule_.timed_ticks);
    contact_running_.store(true, std::memory_order_relaxed);
    stop_cause_.store(gate_fault::stopped, std::memory_order_relaxed);
    device_running_.store(true, std::memory_order_relaxed);
    const std::int64_t origin_ns = clock_ns();
    contact_thread_ = std::thread([this, origin_ns] {
      loop(session_thread::contact, origin_ns, schedule_.contact_period_ns, contact_running_, contact_timing_,
           [this](std::int64_t now_ns) {
             const std::uint64_t before = contact_.computed();
             static_cast<void>(contact_.tick(now_ns));
             return contact_.computed() != before;
           });
    });
    device_thread_ = std::thread([this, origin_ns] {
      loop(session_thread::device, origin_ns, schedule_.device_period_ns, device_running_, device_timing_,
           [this](std::int64_t now_ns) {
             static_cast<void>(device_.tick(now_ns));
             return true;
           });
      wind_down();
    });
  }

  /// Brings the wrench to zero at the slew rate, disarms the device and joins both threads. Harmless when not running.
  /// @param cause that the gate is given: stopped or interrupted
  void stop(gate_fault cause = gate_fault::stopped) noexcept {
    if (device_running_.load(std::memory_order_relaxed)) stop_cause_.store(cause, std::memory_order_relaxed);
    device_running_.store(false, std::memory_order_release);
    if (device_thread_.joinable()) device_thread_.join();
    contact_running_.store(false, std::memory_order_relaxed);
    if (contact_thread_.joinable()) contact_thread_.join();
  }

  /// Timing so far. @pre the session does not run: the threads write without a lock
  [[nodiscard]] const tick_timing& device_timing() const noexcept { return device_timing_; }
  [[nodiscard]] const tick_timing& contact_timing() const noexcept { return contact_timing_; }
  /// The way by which versions of a scene that changes come into the session; see scene_editor::commit(). From one
  /// thread, while the session runs.
  [[nodiscard]] auto& scenes() noexcept requires scene_taker<Renderer> { return contact_.scenes(); }
  /// The loops. @pre the session does not run
  [[nodiscard]] contact_loop<Renderer>& contact() noexcept { return contact_; }
  [[nodiscard]] device_loop<Device, Observer>& device() noexcept { return device_; }

  /// The clock that a session's times are on.
  [[nodiscard]] static std::int64_t clock_ns() noexcept {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
  }

 private:
  // tick(begin_ns) answers whether there was something to do.
  template <class Tick>
  void loop(session_thread which, std::int64_t origin_ns, std::int64_t period_ns, const std::atomic<bool>& running,
            tick_timing& timing, Tick tick) noexcept {
    if (schedule_.set_up_thread != nullptr) schedule_.set_up_thread(which);
    std::int64_t due_ns = origin_ns;
    while (running.load(std::memory_order_acquire)) {
      sleep_until(due_ns);
      const std::int64_t begin_ns = clock_ns();
      const bool worked = tick(begin_ns);
      const std::int64_t end_ns = clock_ns();

      ++timing.ticks;
      timing.idle += worked ? 0U : 1U;
      timing.late += begin_ns - due_ns > period_ns ? 1U : 0U;
      timing.latest_ns = std::max(timing.latest_ns, begin_ns - due_ns);
      timing.longest_ns = std::max(timing.longest_ns, end_ns - begin_ns);
      if (worked && timing.durations_ns.size() < timing.durations_ns.capacity()) {
        timing.durations_ns.push_back(end_ns - begin_ns);
      }

      due_ns += period_ns;
      if (end_ns > due_ns + period_ns) {
        const std::int64_t missed = (end_ns - due_ns) / period_ns;
        timing.skipped += static_cast<std::uint64_t>(missed);
        due_ns += missed * period_ns;
      }
    }
  }

  // After the last ordinary tick: a stopped gate takes the wrench down at its slew rate, for 200 ms at the most.
  void wind_down() noexcept {
    constexpr std::int64_t longest_ns = 200'000'000;
    device_.stop(stop_cause_.load(std::memory_order_relaxed));
    for (const std::int64_t until_ns = clock_ns() + longest_ns; clock_ns() < until_ns && !device_.gate().at_rest();) {
      sleep_until(clock_ns() + schedule_.device_period_ns);
      static_cast<void>(device_.tick(clock_ns()));
    }
    static_cast<void>(device_.device().disarm());
  }

  static void sleep_until(std::int64_t due_ns) noexcept {
    std::this_thread::sleep_until(std::chrono::steady_clock::time_point(
        std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::nanoseconds(due_ns))));
  }

  real_schedule schedule_;
  contact_loop<Renderer> contact_;
  device_loop<Device, Observer> device_;
  std::atomic<bool> contact_running_{false};
  std::atomic<bool> device_running_{false};
  std::atomic<gate_fault> stop_cause_{gate_fault::stopped};
  tick_timing contact_timing_{};
  tick_timing device_timing_{};
  std::thread contact_thread_;
  std::thread device_thread_;
};

}  // namespace asperity
