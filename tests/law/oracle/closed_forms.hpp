// What the closed-form tests share: the data, the scenes' units, and a table of errors against limits.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "asperity/window/cpu_depth.hpp"
#include "support/height_models.hpp"

namespace asperity::oracle {

using json = nlohmann::json;

/// The data are in millimetres; the library is not.
inline constexpr double mm = 1e-3;

/// Cases of one closed form, as tests/law/oracle/data/closed_forms.json has them.
[[nodiscard]] inline const json& cases(const std::string& name) {
  static const json all = [] {
    std::ifstream in(ASPERITY_ORACLE_DATA);
    return json::parse(in);
  }();
  return all.at(name).at("cases");
}

[[nodiscard]] inline vec3 vector_of(const json& j) { return {j.at(0), j.at(1), j.at(2)}; }

/// Errors by line of a test, printed beside their limits and asserted.
class error_table {
 public:
  explicit error_table(std::string title) : title_(std::move(title)) {}
  error_table(const error_table&) = delete;
  error_table& operator=(const error_table&) = delete;

  /// Notes an error that may not exceed its limit.
  void add(const std::string& name, double error, double limit) { note(name, error, limit, 1.0, false); }

  /// Notes an error of a line whose median may not exceed the limit, and whose largest not twice that.
  void add_typical(const std::string& name, double error, double limit) { note(name, error, limit, 2.0, true); }

  ~error_table() {
    EXPECT_FALSE(lines_.empty()) << title_ << ": no case was judged";
    std::printf("%s\n  %-58s %5s  %-10s %-10s %-10s\n", title_.c_str(), "case", "count", "median", "max", "limit");
    for (line& l : lines_) {
      std::sort(l.errors.begin(), l.errors.end());
      const double median = l.errors[l.errors.size() / 2], largest = l.errors.back();
      const bool held = l.held && (!l.typical || median <= l.limit);
      std::printf("  %-58s %5zu  %-10.3g %-10.3g %-10.3g%s\n", l.name.c_str(), l.errors.size(), median, largest,
                  l.limit, !held ? "  EXCEEDED" : (l.typical ? "  (median; twice that at most)" : ""));
      EXPECT_TRUE(held) << title_ << ": " << l.name;
    }
  }

 private:
  struct line {
    std::string name;
    std::vector<double> errors;
    double limit = 0.0;  ///< the largest that was given
    bool held = true;
    bool typical = false;
  };

  void note(const std::string& name, double error, double limit, double slack, bool typical) {
    auto at = std::find_if(lines_.begin(), lines_.end(), [&](const line& l) { return l.name == name; });
    if (at == lines_.end()) at = lines_.insert(lines_.end(), line{.name = name, .errors = {}, .typical = typical});
    at->limit = std::max(at->limit, limit);
    if (!(error <= slack * limit)) at->held = false;  // so that a NaN fails
    at->errors.push_back(std::isnan(error) ? std::numeric_limits<double>::infinity() : error);
  }

  std::string title_;
  std::vector<line> lines_;
};

[[nodiscard]] inline test_support::height_function in_metres(test_support::height_function mm_heights) {
  if (!mm_heights) return {};
  return [f = std::move(mm_heights)](double x, double y) { return mm * f(x / mm, y / mm); };
}

[[nodiscard]] inline test_support::plate_spec plate_mm(double half_mm, std::uint32_t texels,
                                                       test_support::height_function heights_mm) {
  test_support::plate_spec s;
  s.half_x = s.half_y = half_mm * mm;
  s.texels = texels;
  s.height = in_metres(std::move(heights_mm));
  return s;
}

/// Makes a scene once and keeps it: cases come in groups with the same bodies.
class kept_scenes {
 public:
  /// @param numbers  what the bodies are made from   @param make  make(): the bodies
  template <class Make>
  [[nodiscard]] const scene& of(const std::array<double, 3>& numbers, Make make) {
    const auto [at, is_new] = made_.try_emplace(numbers);
    if (is_new) at->second = make();
    return at->second;
  }

 private:
  std::map<std::array<double, 3>, scene> made_;
};

[[nodiscard]] inline window_depth_settings settings_for(gradient_scheme scheme, std::uint32_t grid, double tau_mm,
                                                        double step_mm) {
  window_depth_settings s;
  s.gradient = scheme;
  s.grid = grid;
  s.tau_m = tau_mm * mm;
  s.difference_step_m = step_mm * mm;
  return s;
}

/// The error measure of the acceptance list: largest component, angular ones as at a lever arm of 30 mm.
[[nodiscard]] inline double gradient_error(const vec6& g, const vec6& expected) {
  const vec6 d = g - expected;
  double worst = 0.0;
  for (std::size_t i = 0; i < 6; ++i) {
    const double e = std::fabs(d[i]) / (i < 3 ? 1.0 : 30.0 * mm);
    worst = !(e <= worst) ? e : worst;
  }
  return worst;
}

/// Gradient that a wrench in N and N mm at stiffness k (N/mm) and depth (mm) stands for, SI.
[[nodiscard]] inline vec6 gradient_of(const vec3& force, const vec3& torque_nmm, double k, double depth_mm) {
  return -1.0 / (k * depth_mm) * vec6{force, mm * torque_nmm};
}

}  // namespace asperity::oracle
