// Findings with everything that can be wrong in them.
#pragma once

#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>

#include "publish.hpp"

namespace asperity::experiment {

inline constexpr experiment made_up{"made_up", "Tom & <Jerry>", "What is done: a < b, \"c\" > d.", nullptr};

[[nodiscard]] inline findings some_findings() {
  findings f;
  f.statements = {at_most("small", "a value, N", 0.5, 1.0), at_least("large", "a <share> & more", 0.25, 0.9),
                  between("middle", "an exponent", 0.75, 0.6, 1.1),
                  at_most("no_number", "nothing was measured, m", std::nan(""), 1.0)};
  figure drawn{"wave", "A wave goes up & down.", {}};
  drawn.page.title = "A wave";
  drawn.page.x_label = "time (s)";
  drawn.page.x = {0.0, 1.0, 2.0};
  drawn.page.panels = {{"height (m)", {{"one", {0.0, 1.0, 0.0}}, {"two", {1.0, 0.0, 1.0}}}}};
  f.figures = {drawn, drawn};
  f.figures[1].name = "again";
  f.tables = {{"numbers",
               {"time_s", "height_m"},
               {{0.1, 1.0 / 3.0}, {2.0, std::nan("")}, {3.0, std::numeric_limits<double>::infinity()}}}};
  f.shown = {{"Confusion", {"felt \\ was", "stripes"}, {{"stripes", "9 <of> 10"}}}};
  f.notes = {"left out: x < y & z"};
  return f;
}

[[nodiscard]] inline std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace asperity::experiment
