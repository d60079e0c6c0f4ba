// What support planes did not answer in a session, flag by flag.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "asperity/control/session_record.hpp"
#include "cli.hpp"

namespace asperity::command {

/// Counts the flags of device ticks. Constant size.
class wall_summary {
 public:
  static constexpr std::size_t flags = 8;

  void add(const session_record& tick) noexcept;

  /// Null where no tick had a support plane: other contacts are not watched.
  [[nodiscard]] json to_json() const;
  [[nodiscard]] std::string to_text() const;
  /// A line for each flag that was told: what it means, when, and what to change.
  [[nodiscard]] std::string warnings() const;

 private:
  struct count {
    std::uint64_t ticks = 0;
    std::int64_t first_ns = 0;
  };

  std::array<count, flags> counts_{};
  bool has_planes_ = false;
  double overlap_max_m_ = 0.0;
};

}  // namespace asperity::command
