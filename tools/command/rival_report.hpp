// The race with other libraries as a document, as a table and as a picture.
#pragma once

#include <span>
#include <string>

#include "asperity/core/status.hpp"
#include "cli.hpp"
#include "output_file.hpp"
#include "plot.hpp"
#include "progress.hpp"
#include "race.hpp"

namespace asperity::command {

/// What `bench --rivals` was asked for.
struct rival_bench {
  rivals::race_settings settings;
  std::string models;  ///< folder of baked models; empty: baked and forgotten
  std::string plot;    ///< picture to write; empty: none
};

/// The benchmark's three pairs, one race each. @return what a bake says | cancelled | io_failed
[[nodiscard]] result<answer> race_rivals(const rival_bench& wanted, progress_line& progress);

/// Races as a table and a document.
[[nodiscard]] answer report(std::span<const rivals::race> races, const rivals::race_settings& settings);
/// Error over time: a panel for each pair, a dot for each contender and judged pose.
[[nodiscard]] plot_page picture(std::span<const rivals::race> races);

}  // namespace asperity::command
