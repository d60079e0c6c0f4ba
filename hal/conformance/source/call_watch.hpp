// Counts what a call in a tick must not do, while it does it.
//
// Memory, locks, waits, clocks, printing and throwing are counted at their symbols, which call_watch.cpp defines in
// front of the C and C++ libraries, on the calling thread and between begin() and end() only. Invisible: a system call
// made without its symbol, a spin lock made of atomics, a time-stamp counter read by its instruction.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

namespace asperity::conformance {

enum class forbidden : std::uint8_t { allocation, lock, wait, clock, print, thrown };
inline constexpr std::size_t forbidden_count = 6;

/// How often, and the symbol that was first called of each kind.
struct watched {
  std::array<std::uint32_t, forbidden_count> times{};
  std::array<const char*, forbidden_count> first{};
};

class call_watch {
 public:
  /// Why nothing is seen in this build; empty where it is.
  [[nodiscard]] static std::string missing();
  static void begin() noexcept;
  [[nodiscard]] static watched end() noexcept;
};

}  // namespace asperity::conformance
