// The study as a table.
#pragma once

#include <string>
#include <vector>

#include "law/contact_study/study.hpp"

namespace asperity::contact_study {

/// For a terminal: a line per pair, motion and formulation, and what is over the limits.
[[nodiscard]] std::string text_table(const std::vector<pair_result>& pairs);

/// The same as a Markdown table.
[[nodiscard]] std::string markdown_table(const std::vector<pair_result>& pairs);

/// One line per motion of the default that is over a limit: pair, pose, motion, figures.
[[nodiscard]] std::string broken_limits(const std::vector<pair_result>& pairs);

}  // namespace asperity::contact_study
