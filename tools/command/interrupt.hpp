// A wish to stop, as a flag that long work polls.
#pragma once

namespace asperity::command {

/// Turns the first SIGINT or SIGTERM into interrupted(); a second one ends the process at once.
/// A file-size limit becomes an ordinary write error instead of a signal.
void catch_interrupts();

/// True after SIGINT or SIGTERM.
[[nodiscard]] bool interrupted() noexcept;

}  // namespace asperity::command
