// One session of the two-rate loop with a device, on either clock.
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <vector>

#include "asperity/control/contact_loop.hpp"
#include "asperity/control/device_loop.hpp"
#include "asperity/control/real_time_thread.hpp"
#include "asperity/device/any_device.hpp"
#include "asperity/render/any_renderer.hpp"
#include "body_script.hpp"
#include "driver_guard.hpp"
#include "progress.hpp"

namespace asperity::command {

enum class session_clock : std::uint8_t {
  virtual_time,  ///< as fast as the machine can; the same session gives the same bits
  real_time,     ///< two threads on the machine's clock
};

/// Device ticks whose times are on record.
struct given_ticks {
  std::vector<std::int64_t> times_ns;    ///< never decreasing; the session's first, then those in which it wound down
  std::size_t of_session = 0;            ///< ticks until it was told to end
  gate_fault end = gate_fault::stopped;  ///< what it was told
};

/// What the system gave to a session on the real clock.
struct real_time_grants {
  thread_grants device;
  thread_grants contact;
  grant memory = grant::not_asked;
  int memory_error = 0;       ///< errno of a refusal
  bool later_memory = false;  ///< whether memory that was taken later was kept as well
};

/// What is shared with whoever has to close a session's recordings where its main thread cannot.
struct session_rescue {
  std::timed_mutex writing;  ///< held by whoever calls on_tick, or writes the session's files
  /// Hands every record that there is to on_tick; empty while no session runs. @pre `writing` is held
  std::function<void()> take_records;
};

/// Who watches a session while it runs. Both are called outside ticks, by the thread that called run_session().
struct session_watch {
  /// Told of every device tick, in order, and how long it took.
  std::function<void(const session_record&, double took_s)> on_tick;
  /// Virtual clock only: asked before each device tick at this time; the session goes on when it returns.
  std::function<void(std::int64_t time_ns)> pace;
};

struct session_setup {
  any_renderer feel;
  scene_placement placement{};
  any_device device;  ///< open and not armed; a simulated or recorded one where the clock is virtual
  control_settings control{};
  std::vector<body_script> moves{};  ///< of bodies that do not stand where the placement puts them
  session_clock clock = session_clock::virtual_time;
  double seconds = 3.0;
  loop_periods periods{};
  /// On the virtual clock: a contact is used when its computation is over and not when it begins, as on a real machine.
  bool contact_one_period_late = true;
  std::optional<given_ticks> ticks{};  ///< virtual clock only; without them one every device period
  /// Told of every device tick, outside it and in order. An error ends the session.
  std::function<result<void>(const session_record&)> on_tick;
  /// Real clock only, and may be empty: told once, when both threads run, what the system gave them.
  std::function<void(const real_time_grants&)> on_start{};
  /// Real clock only, and may be null: who looks after the driver, and what it may rescue.
  driver_guard* guard = nullptr;
  session_rescue* rescue = nullptr;
  std::optional<session_watch> watch{};
};

/// Times of the ticks of one loop. CPU time on the virtual clock, time on the wall on the real one.
struct loop_times {
  std::vector<double> seconds;  ///< of each tick that was timed
  std::uint64_t ticks = 0;
  std::uint64_t idle = 0;  ///< of the contact loop: found no new pose; not among ticks
  std::uint64_t late = 0;  ///< began after the following deadline (real clock) or took longer than its period (virtual)
  std::uint64_t skipped = 0;      ///< periods left out to catch up; real clock only
  std::uint64_t over_period = 0;  ///< of the timed ticks, those that took longer than their period
};

struct session_outcome {
  loop_times contact;
  loop_times device;
  rate_report rates{};  ///< how punctual the device loop was, and what lateness did to the output
  std::uint64_t rejected_samples = 0;
  std::uint64_t lost_records = 0;  ///< device ticks that on_tick never saw, because writing them was too slow
  gate_fault fault = gate_fault::none;
  std::vector<flight_entry> last_ticks;  ///< up to and including the one in which the gate shut; empty without a fault
  double ended_at_s = 0.0;               ///< when the session ended, by its own clock
  bool interrupted = false;
  bool armed_at_end = false;                  ///< the device did not take its disarm; real clock only
  std::optional<real_time_grants> real_time;  ///< real clock only
};

/// Arms the device, runs the session, takes the wrench to zero and disarms, whatever ended it.
/// @return what happened, or the error of on_tick or of the device
[[nodiscard]] result<session_outcome> run_session(session_setup setup, progress_line& progress);

}  // namespace asperity::command
