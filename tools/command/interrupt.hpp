// A wish to stop, as a flag that long work polls.
#pragma once

namespace asperity::command {

/// Turns the first SIGINT or SIGTERM into interrupted(); a second one ends the process at once.
/// A file-size limit becomes an ordinary write error instead of a signal.
void catch_interrupts();

/// True after SIGINT or SIGTERM.
[[nodiscard]] bool interrupted() noexcept;

/// The opposite, for what asks whether to go on.
[[nodiscard]] inline bool not_interrupted() noexcept { return !interrupted(); }

}  // namespace asperity::command
