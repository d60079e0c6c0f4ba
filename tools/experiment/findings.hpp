// What an experiment comes to: statements that a machine can check, pictures, and the numbers behind them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "plot.hpp"

namespace asperity::experiment {

/// How a value has to lie to its bound.
enum class relation : std::uint8_t { at_most, at_least, between };

/// One checkable sentence: a number that was measured, and what it has to be.
struct statement {
  std::string name;   ///< short, of lower case, digits and underscores; one of its kind within an experiment
  std::string claim;  ///< the sentence, with the unit of the value: "largest |F_x| over largest |F|"
  double value = 0.0;
  relation is = relation::at_most;
  double bound = 0.0;        ///< the limit; the lower one of `between`
  double upper_bound = 0.0;  ///< of `between` alone

  /// False for a value that is no number.
  [[nodiscard]] bool holds() const noexcept {
    switch (is) {
      case relation::at_most:
        return value <= bound;
      case relation::at_least:
        return value >= bound;
      case relation::between:
        return value >= bound && value <= upper_bound;
    }
    return false;
  }
};

[[nodiscard]] inline statement at_most(std::string name, std::string claim, double value, double bound) {
  return {std::move(name), std::move(claim), value, relation::at_most, bound, 0.0};
}
[[nodiscard]] inline statement at_least(std::string name, std::string claim, double value, double bound) {
  return {std::move(name), std::move(claim), value, relation::at_least, bound, 0.0};
}
[[nodiscard]] inline statement between(std::string name, std::string claim, double value, double low, double high) {
  return {std::move(name), std::move(claim), value, relation::between, low, high};
}

/// A picture, laid out like the paper's figure where there is one.
struct figure {
  std::string name;  ///< of the file, without its extension
  std::string see;   ///< one sentence: what to see
  command::plot_page page;
};

/// A CSV file.
struct table {
  std::string name;                  ///< of the file, without its extension
  std::vector<std::string> columns;  ///< quantity and unit, as in "force_n"
  std::vector<std::vector<double>> rows;
};

/// A table to be read in the report: a confusion matrix, timings as percentiles.
struct shown_table {
  std::string title;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};

struct findings {
  std::vector<statement> statements;
  std::vector<figure> figures;
  std::vector<table> tables;
  std::vector<shown_table> shown;
  std::vector<std::string> notes;  ///< sentences: what was left out and why, what surprises
};

}  // namespace asperity::experiment
