#include "dot_rows.hpp"

#include <algorithm>
#include <cmath>

namespace asperity::experiment {
namespace {

constexpr double row_pitch_m = 2.4e-3;
constexpr double off_the_end_m = 2e-3;  // of the hand beyond the ends of a row, onto the flat

double height_over(const vec2& p) {
  const double row = std::round(p.y / row_pitch_m + 0.5 * static_cast<double>(dot_rows::count - 1));
  if (!(row >= 0.0 && row < static_cast<double>(dot_rows::count))) return 0.0;
  const auto number = static_cast<std::size_t>(row);
  const double spacing = dot_rows::spacing_m(number);
  const double last = std::floor(0.5 * dot_rows::length_m / spacing);
  const double nearest = spacing * std::clamp(std::round(p.x / spacing), -last, last);
  const double off = std::hypot(p.x - nearest, p.y - dot_rows::y_m(number));
  constexpr double top = 0.5 * dot_rows::top_diameter_m, base = 0.5 * dot_rows::base_diameter_m;
  return dot_rows::height_m * std::clamp((base - off) / (base - top), 0.0, 1.0);
}

}  // namespace

double dot_rows::spacing_m(std::size_t row) {
  return smallest_m * std::pow(largest_m / smallest_m, static_cast<double>(row) / static_cast<double>(count - 1));
}

double dot_rows::y_m(std::size_t row) {
  return row_pitch_m * (static_cast<double>(row) - 0.5 * static_cast<double>(count - 1));
}

result<model_ptr> dot_rows::bake(workbench& bench) {
  const vec2 size(length_m + 8e-3, row_pitch_m * static_cast<double>(count) + 4e-3);
  return bake_plate(bench, "dots_in_18_rows", size, 1024, height_over);
}

double dot_rows::drop_spacing_m(double ball_m) {
  return base_diameter_m + 2.0 * std::sqrt(2.0 * ball_m * height_m - height_m * height_m);
}

void add_rows(stroking& how, const std::vector<std::size_t>& rows, double speed_m_per_s, double push_n,
              int first_felt) {
  constexpr double across_m_per_s = 0.06;
  const double end_m = 0.5 * dot_rows::length_m + off_the_end_m;
  if (how.strokes.empty()) how.from_m = {-end_m, dot_rows::y_m(rows.front())};
  double side = how.strokes.empty() || how.strokes.back().to_m.x < 0.0 ? -1.0 : 1.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double y = dot_rows::y_m(rows[i]);
    how.strokes.push_back({{side * end_m, y}, across_m_per_s, push_n, -1});
    how.strokes.push_back({{-side * end_m, y}, speed_m_per_s, push_n, first_felt + static_cast<int>(i)});
    side = -side;
  }
}

curve_peak peak_of(const spacing_curve& curve) {
  const std::vector<double>& y = curve.value;
  const std::size_t n = y.size();
  std::vector<double> smooth(n);
  for (std::size_t i = 0; i < n; ++i) {
    smooth[i] = 0.25 * y[i == 0 ? 0 : i - 1] + 0.5 * y[i] + 0.25 * y[i + 1 == n ? i : i + 1];
  }
  const auto top = static_cast<std::size_t>(std::max_element(smooth.begin(), smooth.end()) - smooth.begin());
  curve_peak out{curve.spacing_m[top], smooth[top]};
  if (top == 0 || top + 1 == n) return out;
  const double left = smooth[top] - smooth[top - 1], right = smooth[top] - smooth[top + 1];
  if (!(left + right > 0.0)) return out;
  const double shift = 0.5 * (left - right) / (left + right);
  out.spacing_m *= std::pow(curve.spacing_m[top + 1] / curve.spacing_m[top], shift);
  return out;
}

double power_law(const std::vector<double>& x, const std::vector<double>& y) {
  double mx = 0.0, my = 0.0, xy = 0.0, xx = 0.0;
  const auto n = static_cast<double>(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    mx += std::log(x[i]) / n;
    my += std::log(y[i]) / n;
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    xy += (std::log(x[i]) - mx) * (std::log(y[i]) - my);
    xx += (std::log(x[i]) - mx) * (std::log(x[i]) - mx);
  }
  return xy / xx;
}

}  // namespace asperity::experiment
