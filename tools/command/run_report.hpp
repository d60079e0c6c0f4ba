// A session told to a program and to a person.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "cli.hpp"
#include "device_replay.hpp"
#include "gpu_use.hpp"
#include "rate_check.hpp"
#include "run_command.hpp"
#include "run_coupling.hpp"
#include "run_start.hpp"
#include "session.hpp"
#include "session_summary.hpp"

namespace asperity::command {

/// What a session holds in memory, bytes, and on a GPU.
struct memory_use {
  std::size_t models = 0;
  std::size_t renderer = 0;
  std::shared_ptr<gpu_use> gpu{};  ///< null where no GPU is used
};

/// All that a session left to tell.
struct session_findings {
  explicit session_findings(const loop_periods& periods) : summary(periods.device_ns) {}

  given_poses poses;
  session_outcome ended;
  session_summary summary;
  memory_use memory;
  chosen_coupling coupling;
  std::optional<rate_check> rate;  ///< what contact ticks took before the session
  probe_settings probe;
  std::optional<replay_outcome> replay;  ///< only of a replay
  std::string driver{};                  ///< what became of the driver's process; empty where all is well
  surface_pairs surfaces{};              ///< of the probe with each fixed body; empty with other contacts than planes
};

/// What a session in real time asked the system for and got, in one line.
[[nodiscard]] std::string to_text(const real_time_grants& got);

[[nodiscard]] answer report(const run_command& options, const session_findings& found);

}  // namespace asperity::command
