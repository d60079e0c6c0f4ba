// Columns of numbers.
#pragma once

#include <vector>

namespace asperity::experiment {

/// The same in thousandths of the unit, as diagrams are labelled: metres in mm, seconds in ms.
[[nodiscard]] inline std::vector<double> in_milli(std::vector<double> values) {
  for (double& v : values) v *= 1e3;
  return values;
}

}  // namespace asperity::experiment
