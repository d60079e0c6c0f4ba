// Catches whatever a tick must not do, while it does it.
//
// Between entering and leaving the trap, on that thread only:
// - allocation and release, locks, clocks, printing and throwing are caught at their symbols, which tick_trap.cpp
//   defines in front of the C and C++ libraries. This sees what never reaches the kernel: a mutex that nobody holds, a
//   clock that is read from a page that the kernel shares, a line that waits in a buffer.
// - every system call is caught by the kernel itself (syscall user dispatch, Linux 5.11). There is no list of them that
//   could be incomplete.
// - page faults cannot be caught, because nobody is asked; they are counted.
// Invisible: a time-stamp counter read by its instruction, and a spin lock made of atomics.
//
// Link the objects of tick_trap into the test's program.
#pragma once

#include <cstdint>
#include <string>

namespace asperity::test_support {

/// Runs ticks inside the trap. A violation ends the process with `exit_status` and one line on stderr:
/// "tick trap: NAME inside a tick".
class tick_trap {
 public:
  static constexpr int exit_status = 86;

  /// Why nothing is trapped in this build; empty where it is.
  [[nodiscard]] static std::string missing();
  /// Why system calls go unseen on this kernel; empty where they are seen. What has a symbol is trapped all the same.
  [[nodiscard]] static std::string missing_system_calls();

  /// Runs one tick inside the trap. Traps do not nest.
  template <class Tick>
  void operator()(Tick&& tick) noexcept {
    const std::uint64_t before = thread_page_faults();
    enter();
    tick();
    leave();
    page_faults_ += thread_page_faults() - before;
    ++ticks_;
  }

  /// Ticks that went through.
  [[nodiscard]] std::uint64_t ticks() const noexcept { return ticks_; }
  /// Page faults in them, minor and major.
  [[nodiscard]] std::uint64_t page_faults() const noexcept { return page_faults_; }

 private:
  static void enter() noexcept;
  static void leave() noexcept;
  static std::uint64_t thread_page_faults() noexcept;

  std::uint64_t ticks_ = 0;
  std::uint64_t page_faults_ = 0;
};

}  // namespace asperity::test_support
