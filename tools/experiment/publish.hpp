// Findings as files: CSV, pictures, verdict.json; and all of them as one page.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "asperity/core/status.hpp"
#include "experiment.hpp"

namespace asperity::experiment {

/// An experiment and what came of it.
struct published {
  const experiment* what = nullptr;
  findings found;
};

/// Writes OUT/NAME/: a CSV file for each table, an SVG and a PNG file for each figure, and verdict.json, which comes
/// last: where it stands, the rest is whole.
/// @return io_failed
[[nodiscard]] result<void> write_findings(const published& one, const std::filesystem::path& out);

/// Writes OUT/index.html: every experiment with its pictures and verdicts, in one file that opens without a network.
/// @return io_failed
[[nodiscard]] result<void> write_page(std::span<const published> all, const std::filesystem::path& out);

/// "at most 0.002", "0.9 or more", "0.6 to 1.1"
[[nodiscard]] std::string bound_text(const statement& s);

}  // namespace asperity::experiment
