// A wish to stop, as a flag that long work polls.
#pragma once

#include <string>

namespace asperity::command {

/// Catches every signal that would end the program and can be caught, but those that say that the program itself is
/// broken (SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTRAP, SIGSYS): after these nothing that it does can be trusted.
///
/// The first one becomes interrupted(). A second one ends the process at once, unless a device_hold lives.
/// A pipe without a reader (SIGPIPE) and a file-size limit (SIGXFSZ) become ordinary write errors.
void catch_interrupts();

/// True after a signal that asked to stop.
[[nodiscard]] bool interrupted() noexcept;

/// The opposite, for what asks whether to go on.
[[nodiscard]] inline bool not_interrupted() noexcept { return !interrupted(); }

/// The signal that asked first; 0 where none did.
[[nodiscard]] int stop_signal() noexcept;

/// Its name, such as "SIGHUP".
[[nodiscard]] std::string signal_name(int number);

/// While one lives a device may be putting out a wrench, or recordings of it are open: no signal that can be caught
/// ends the process, and SIGTSTP (Ctrl-Z), SIGTTIN and SIGTTOU ask to stop too, for a suspended program answers no
/// device. One at a time, made and destroyed by the main thread.
class device_hold {
 public:
  device_hold();
  device_hold(const device_hold&) = delete;
  device_hold& operator=(const device_hold&) = delete;
  ~device_hold();
};

}  // namespace asperity::command
