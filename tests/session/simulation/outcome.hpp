// What came of a session.
#pragma once

#include <cstdint>

namespace asperity::simulation {

/// How a session ended.
struct outcome {
  std::uint64_t seed = 0;
  std::uint64_t ticks = 0;
  const char* broken = nullptr;  ///< invariant that broke in the last tick; nullptr where none did
  std::uint64_t digest = 0;      ///< of every number that left
  std::uint64_t touched = 0;     ///< ticks with a contact force
  std::uint64_t guarded = 0;     ///< ticks in which the passivity guard acted
  std::uint64_t rejected = 0;    ///< samples that were rejected
  std::uint64_t faults = 0;      ///< times that the gate shut
  std::uint64_t clears = 0;      ///< times that a person cleared it
  double surplus_j = 0.0;  ///< most that the hand had received beyond what it had lent, while every sample was good
  bool textured = false;
};

}  // namespace asperity::simulation
