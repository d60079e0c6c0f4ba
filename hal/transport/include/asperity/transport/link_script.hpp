// Scripted faults of a link that exists in this process only.
#pragma once

#include <cstdint>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "asperity/core/export.hpp"
#include "asperity/transport/io_status.hpp"

namespace asperity {

enum class link_fault : std::uint8_t {
  lose,       ///< the frame is taken and never arrives
  delay,      ///< it arrives `amount_ns` later than it would have
  reorder,    ///< it arrives after the next one of its direction
  duplicate,  ///< it arrives twice
  shorten,    ///< its last byte is missing
  flip_bit,   ///< one seeded bit is wrong
  answer,     ///< the call answers `with`, and nothing is sent or received
  bus_off,    ///< CAN: the controller leaves the bus until the window ends; frames are taken and lost
  unplug,     ///< the link is gone and stays so
};

enum class link_direction : std::uint8_t { to_device, from_device, both };

/// One fault: in a window of time, in a window of calls, or both (each window is open where it is not given).
struct link_event {
  link_fault kind = link_fault::lose;
  link_direction direction = link_direction::both;
  std::int64_t from_ns = std::numeric_limits<std::int64_t>::min();
  std::int64_t until_ns = std::numeric_limits<std::int64_t>::max();  ///< not included
  std::uint64_t from_call = 0;  ///< calls on the host's end are counted from 0, both directions in one count
  std::uint64_t until_call = std::numeric_limits<std::uint64_t>::max();  ///< not included
  double share = 1.0;                                                    ///< of the frames in the window; seeded
  std::int64_t amount_ns = 0;                                            ///< of delay
  io_status with = io_status::failed;                                    ///< of answer
};

/// The nth call on the link answers `with`; everything else goes well.
[[nodiscard]] ASPERITY_API link_event fail_call(std::uint64_t n, io_status with) noexcept;

/// Faults of one virtual link. The same seed and the same calls give the same faults.
struct link_script {
  std::vector<link_event> events{};
  std::int64_t latency_ns = 0;  ///< of every frame, each way
  std::uint64_t seed = 1;
};

/// Plays a script: asked once per call of the host's end and once per frame.
/// @rt safe after construction
class ASPERITY_API link_player {
 public:
  explicit link_player(link_script script = {}) : script_(std::move(script)), bits_(script_.seed) {}

  /// Counts a call on the host's end. @return its number
  std::uint64_t count_call() noexcept { return calls_++; }

  /// The first event of that kind that applies to the call, or null. Draws from the seed where `share` is below one.
  [[nodiscard]] const link_event* find(link_fault kind, link_direction direction, std::int64_t now_ns,
                                       std::uint64_t call) noexcept;

  /// A seeded number below `bound`, for choosing what to spoil. @pre bound > 0
  [[nodiscard]] std::uint64_t below(std::uint64_t bound) noexcept { return bits_() % bound; }

  [[nodiscard]] std::uint64_t calls() const noexcept { return calls_; }
  [[nodiscard]] const link_script& script() const noexcept { return script_; }

 private:
  [[nodiscard]] double unit() noexcept { return static_cast<double>(bits_() >> 11) * 0x1.0p-53; }

  link_script script_;
  std::mt19937_64 bits_;
  std::uint64_t calls_ = 0;
};

}  // namespace asperity
