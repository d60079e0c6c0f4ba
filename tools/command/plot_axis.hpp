// An axis of a plot: from where to where it goes, and where its numbers and rules stand.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

namespace asperity::command {

/// The least and the largest of the values that have a place on an axis.
struct value_range {
  explicit value_range(bool is_logarithmic) : logarithmic(is_logarithmic) {}

  void add(const std::vector<double>& values) {
    for (const double v : values) {
      if (!std::isfinite(v) || (logarithmic && !(v > 0.0))) continue;
      low = std::min(low, v);
      high = std::max(high, v);
    }
  }
  [[nodiscard]] bool is_empty() const { return low > high; }

  bool logarithmic;
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
};

struct axis {
  double low, high;  ///< of the numbers, or of their decimal logarithms
  double step;
  int decimals;
  bool logarithmic = false;

  /// Whole decades, at least one, or numbers at 1, 2 or 5 times a power of ten; 0 to 1 where there are no values.
  /// @param wanted about so many numbers   @param cover whether the ends are numbers too
  [[nodiscard]] static axis over(const value_range& values, int wanted, bool cover) {
    if (values.is_empty()) return linear(0.0, 1.0, wanted, cover);
    if (!values.logarithmic) return linear(values.low, values.high, wanted, cover);
    const double first = std::floor(std::log10(values.low) + 1e-9);
    return {first, std::max(std::ceil(std::log10(values.high) - 1e-9), first + 1.0), 1.0, 0, true};
  }

  /// 0 at the axis' beginning, 1 at its end; NaN for what has no place on it.
  [[nodiscard]] double share(double v) const {
    if (logarithmic && !(v > 0.0)) return std::nan("");
    return ((logarithmic ? std::log10(v) : v) - low) / (high - low);
  }

  [[nodiscard]] std::string number(double v) const {
    char digits[48];
    if (logarithmic) {
      std::snprintf(digits, sizeof digits, "%g", v);
    } else {
      std::snprintf(digits, sizeof digits, "%.*f", decimals, v == 0.0 ? 0.0 : v);  // no "-0"
    }
    return digits;
  }

  /// Calls rule(value, whether it has a number) for every rule.
  template <class Rule>
  void for_each_rule(Rule rule) const {
    for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) {
      rule(logarithmic ? std::pow(10.0, k) : k * step, true);
      if (!logarithmic) continue;
      for (int nth = 2; nth < 10 && k + 1.0 <= high + 1e-9; ++nth) rule(nth * std::pow(10.0, k), false);
    }
  }

 private:
  static axis linear(double low, double high, int wanted, bool cover) {
    if (!(high > low)) {
      const double around = std::max(1e-12, std::fabs(low) * 0.1);
      low -= around;
      high += around;
    }
    const double raw = (high - low) / wanted;
    const double power = std::pow(10.0, std::floor(std::log10(raw)));
    const double lead = raw / power;
    const double step = power * (lead <= 1.0 ? 1.0 : lead <= 2.0 ? 2.0 : lead <= 5.0 ? 5.0 : 10.0);
    const int decimals = std::clamp(static_cast<int>(-std::floor(std::log10(step) + 1e-9)), 0, 9);
    if (cover) {
      low = std::floor(low / step) * step;
      high = std::ceil(high / step) * step;
    }
    return {low, high, step, decimals};
  }
};

}  // namespace asperity::command
