// The experiments, and where to find them.
#pragma once

#include <span>

#include "asperity/core/status.hpp"
#include "findings.hpp"
#include "workbench.hpp"

namespace asperity::experiment {

/// One experiment. It writes nothing and knows no command line.
struct experiment {
  const char* name;     ///< on the command line, and of its folder
  const char* title;    ///< a few words for the report
  const char* purpose;  ///< one or two sentences: what is done, and what it shows
  result<findings> (*run)(workbench& bench);
};

/// All of them, in the order of the report.
[[nodiscard]] std::span<const experiment> all_experiments() noexcept;

// One source file each.
[[nodiscard]] result<findings> run_fig7(workbench& bench);
[[nodiscard]] result<findings> run_fig8(workbench& bench);
[[nodiscard]] result<findings> run_fig9(workbench& bench);
[[nodiscard]] result<findings> run_hammer(workbench& bench);
[[nodiscard]] result<findings> run_roughness(workbench& bench);
[[nodiscard]] result<findings> run_baselines(workbench& bench);
[[nodiscard]] result<findings> run_patterns(workbench& bench);
[[nodiscard]] result<findings> run_stability(workbench& bench);

}  // namespace asperity::experiment
