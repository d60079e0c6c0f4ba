// A recording of `run --record`, read back.
#pragma once

#include <filesystem>
#include <vector>

#include "asperity/core/status.hpp"
#include "view/trace.hpp"

namespace asperity::command {

/// Longest recording that a page is given, rows: ten minutes at 1 kHz.
inline constexpr std::size_t most_shown_rows = 600'000;

/// Rows as a page shows them. A recording does not tell where the hand wants the probe: it has the handle's pose, and
/// the first row says how the two belong together, for the session began with the probe in the hand.
/// @param scale the session's --scale
/// @return io_failed | bad_format, with the line | limit_exceeded
[[nodiscard]] result<std::vector<view::trace_row>> read_recording(const std::filesystem::path& file, double scale);

}  // namespace asperity::command
