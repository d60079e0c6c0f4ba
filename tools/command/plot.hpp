// Stacked line plots over a common axis, as PNG or SVG.
#pragma once

#include <string>
#include <vector>

#include "asperity/core/status.hpp"
#include "output_file.hpp"

namespace asperity::command {

struct plot_line {
  std::string label;
  std::vector<double> y;  ///< one value per entry of plot_page::x; a NaN leaves a gap
};

struct plot_panel {
  std::string y_label;  ///< quantity and unit
  std::vector<plot_line> lines;
};

struct plot_page {
  std::string title;    ///< one sentence: what is to be seen
  std::string caption;  ///< how it was made
  std::string x_label;
  std::vector<double> x;  ///< ascending
  std::vector<plot_panel> panels;
};

enum class plot_format { png, svg };

/// Writes the page into an open file; the caller commits it. @return io_failed
[[nodiscard]] result<void> draw(const plot_page& page, plot_format format, output_file& out);

}  // namespace asperity::command
