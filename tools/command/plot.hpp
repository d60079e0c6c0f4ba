// Stacked plots, over a common axis or one of their own, as PNG or SVG.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "asperity/core/status.hpp"
#include "output_file.hpp"

namespace asperity::command {

enum class plot_style : std::uint8_t {
  line,
  dashed,
  points,  ///< a dot at each value, without a line
  marked,  ///< a line with a dot at each value
};

struct plot_line {
  std::string label;           ///< empty: not in the legend
  std::vector<double> y;       ///< one value per entry of x; a NaN leaves a gap
  std::vector<double> x = {};  ///< its own; empty: the panel's
  plot_style style = plot_style::line;
};

struct plot_panel {
  std::string y_label;  ///< quantity and unit
  std::vector<plot_line> lines;
  std::string x_label = {};    ///< not empty: the panel has an axis of its own, over its own x
  std::vector<double> x = {};  ///< ascending; empty: the page's
  bool log_x = false;          ///< of an axis of its own, whose values are all above zero
  bool log_y = false;          ///< values that are not above zero leave gaps
};

struct plot_page {
  std::string title;    ///< one sentence: what is to be seen; long ones are wrapped
  std::string caption;  ///< how it was made
  std::string x_label;
  std::vector<double> x;  ///< ascending
  std::vector<plot_panel> panels;
};

enum class plot_format { png, svg };

/// Takes the bytes of a picture, in order.
using plot_writer = std::function<result<void>(std::string_view bytes)>;

/// Draws the page. @return the writer's error | io_failed
[[nodiscard]] result<void> draw(const plot_page& page, plot_format format, const plot_writer& write);
/// Writes the page into an open file; the caller commits it. @return io_failed
[[nodiscard]] result<void> draw(const plot_page& page, plot_format format, output_file& out);

}  // namespace asperity::command
