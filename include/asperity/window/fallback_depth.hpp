// A depth backend that may fail, and another one that takes over within the same tick.
#pragma once

#include <concepts>
#include <cstdint>
#include <span>
#include <utility>

#include "asperity/core/memory.hpp"
#include "asperity/render/depth_backend.hpp"

namespace asperity {

/// Asks `First`; where that could not answer, asks `Second` in the same tick, and counts it.
///
/// A GPU may lose its context, run out of memory or be given more contacts than it takes. The hand must not feel that,
/// so the second backend, which is the CPU's as a rule, measures the tick. Inputs that no
/// backend can measure - sizes that do not fit (not_ready), texels that are not finite (not_finite) - are not asked
/// twice.
/// A second answer costs the tick its own time on top; after `give_up_after` failures in a row the first backend is not
/// asked again, so that a lost GPU costs no more than that.
/// @tparam First, Second  backends of the same contacts and readings
template <depth_backend First, depth_backend Second>
requires std::same_as<found_by<First>, found_by<Second>> && std::same_as<reading_of<First>, reading_of<Second>>
class fallback_depth {
 public:
  using policy_tag = depth_tag;
  using reading_type = reading_of<First>;

  /// Counts of the first backend's answers so far.
  struct counts {
    std::uint64_t ticks = 0;      ///< calls of measure()
    std::uint64_t fallbacks = 0;  ///< of those, measured by the second backend
    bool gave_up = false;         ///< the first one is not asked any more
  };

  static constexpr std::uint32_t give_up_after = 8;

  fallback_depth(First first, Second second) : first_(std::move(first)), second_(std::move(second)) {}

  /// @return as the backend that answered
  /// @rt as both backends
  [[nodiscard]] status measure(const scene_pose& at, const found_by<First>& found,
                               std::span<reading_type> out) noexcept {
    ++counts_.ticks;
    if (!counts_.gave_up) {
      const status s = first_.measure(at, found, out);
      if (s != status::backend_failed && s != status::capacity_reached) {
        in_a_row_ = 0;
        return s;
      }
      counts_.gave_up = ++in_a_row_ >= give_up_after && s == status::backend_failed;
    }
    ++counts_.fallbacks;
    return second_.measure(at, found, out);
  }

  /// Asks the first backend again, for instance after its context was opened anew.
  void retry() noexcept {
    counts_.gave_up = false;
    in_a_row_ = 0;
  }

  [[nodiscard]] const counts& counted() const noexcept { return counts_; }
  [[nodiscard]] First& first() noexcept { return first_; }
  [[nodiscard]] Second& second() noexcept { return second_; }
  [[nodiscard]] std::size_t heap_bytes() const noexcept {
    std::size_t bytes = 0;
    if constexpr (reports_heap<First>) bytes += first_.heap_bytes();
    if constexpr (reports_heap<Second>) bytes += second_.heap_bytes();
    return bytes;
  }

 private:
  First first_;
  Second second_;
  counts counts_;
  std::uint32_t in_a_row_ = 0;
};

}  // namespace asperity
