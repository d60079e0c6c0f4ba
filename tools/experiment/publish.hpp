// Findings as files: CSV, pictures, verdict.json; and all of them as one page.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
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

/// What a page says of the run.
struct page_facts {
  std::string version;  ///< of asperity
  std::string machine;  ///< processor and system, in words
  bool brief = false;
  std::string missing;  ///< sentences: what was asked for and is not there, and why; empty: nothing
};

/// Writes OUT/index.html: every experiment with its pictures and verdicts, in one file that opens without a network.
/// @return io_failed
[[nodiscard]] result<void> write_page(std::span<const published> all, const page_facts& facts,
                                      const std::filesystem::path& out);

/// This machine in words: processor, how many cores this process may use, system.
[[nodiscard]] std::string machine_text();

/// What verdict.json holds. A number that is not finite is null there.
[[nodiscard]] nlohmann::ordered_json to_json(const published& one);

/// "at most 0.002", "0.9 or more", "0.6 to 1.1"
[[nodiscard]] std::string bound_text(const statement& s);

}  // namespace asperity::experiment
