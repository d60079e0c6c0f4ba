// What a plot's SVG is made of: nothing off the page, line styles, axes, gaps.
#include "plot.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

namespace asperity::command {
namespace {

std::string svg_of(const plot_page& page) {
  std::string out;
  const result<void> drawn = draw(page, plot_format::svg, [&](std::string_view bytes) {
    out += bytes;
    return result<void>();
  });
  EXPECT_TRUE(drawn);
  return out;
}

struct place {
  double x, y;
};

// Where letters begin.
std::vector<place> letters(const std::string& svg) {
  std::vector<place> out;
  for (std::size_t at = svg.find("<use "); at != std::string::npos; at = svg.find("<use ", at + 1)) {
    const std::size_t x = svg.find(" x=\"", at), y = svg.find(" y=\"", at), end = svg.find('>', at);
    if (x > end || y > end) continue;
    out.push_back({std::atof(svg.c_str() + x + 4), std::atof(svg.c_str() + y + 4)});
  }
  return out;
}

double height_of(const std::string& svg) {
  const std::string before = "viewBox=\"0 0 1200 ";
  const std::size_t at = svg.find(before);
  EXPECT_NE(at, std::string::npos);
  return std::atof(svg.c_str() + at + before.size());
}

std::size_t count(const std::string& in, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = in.find(what); at != std::string::npos; at = in.find(what, at + 1)) ++n;
  return n;
}

/// One panel with one line, which is blue.
plot_page one_line(std::vector<double> y, plot_style style = plot_style::line) {
  plot_page page{"A line", "Made for a test.", "time (s)", {}, {{"value (1)", {{"line", std::move(y), {}, style}}}}};
  for (std::size_t i = 0; i < page.panels[0].lines[0].y.size(); ++i) page.x.push_back(static_cast<double>(i + 1));
  return page;
}

// The path data of the curve: the longest path there is.
std::string longest_path(const std::string& svg) {
  std::string out;
  for (std::size_t at = svg.find(" d=\""); at != std::string::npos; at = svg.find(" d=\"", at + 1)) {
    std::string path = svg.substr(at + 4, svg.find('"', at + 4) - at - 4);
    // Letters are paths too; theirs are closed.
    if (path.size() > out.size() && path.find('Z') == std::string::npos) out = std::move(path);
  }
  return out;
}

std::vector<double> ramp(std::size_t n) {
  std::vector<double> out;
  for (std::size_t i = 0; i < n; ++i) out.push_back(std::sin(0.3 * static_cast<double>(i)));
  return out;
}

void expect_on_page(const std::string& svg) {
  const double height = height_of(svg);
  const std::vector<place> found = letters(svg);
  ASSERT_GT(found.size(), 20U);
  for (const place& p : found) {
    EXPECT_GE(p.x, 5.0);
    EXPECT_LE(p.x, 1190.0);
    EXPECT_GE(p.y, 5.0);
    EXPECT_LE(p.y, height - 2.0);
  }
}

TEST(plot, a_legend_of_long_labels_takes_rows_and_stays_on_the_page) {
  plot_page page = one_line(ramp(40));
  page.panels.push_back(page.panels.front());
  const double two_panels = height_of(svg_of(page));
  for (int i = 0; i < 4; ++i) {
    page.panels[0].lines.push_back(page.panels[0].lines[0]);
    page.panels[0].lines.back().label = "occlusion queries with central differences, number " + std::to_string(i);
  }
  const std::string svg = svg_of(page);
  expect_on_page(svg);
  EXPECT_GT(height_of(svg), two_panels + 10.0);
}

TEST(plot, long_sentences_are_wrapped) {
  plot_page page = one_line(ramp(40));
  const double before = height_of(svg_of(page));
  for (int i = 0; i < 40; ++i) {
    page.title += " and on";
    page.caption += " with words that go on and on";
  }
  page.panels[0].y_label = "a quantity whose name is longer than its panel is high (m)";
  const std::string svg = svg_of(page);
  expect_on_page(svg);
  EXPECT_GT(height_of(svg), before + 40.0);
}

TEST(plot, an_axis_of_its_own_has_room_for_its_numbers) {
  plot_page page = one_line(ramp(40));
  page.panels.push_back(page.panels.front());
  const std::string shared = svg_of(page);
  page.panels[0].x_label = "frequency (Hz)";
  page.panels[0].x = page.x;
  const std::string own = svg_of(page);
  expect_on_page(own);
  EXPECT_GT(height_of(own), height_of(shared) + 30.0);
  EXPECT_GT(letters(own).size(), letters(shared).size() + 10);
}

TEST(plot, styles_differ) {
  EXPECT_EQ(count(svg_of(one_line(ramp(40))), "stroke-dasharray"), 0U);
  EXPECT_EQ(count(svg_of(one_line(ramp(40), plot_style::dashed)), "stroke-dasharray"), 2U) << "the line and its key";
  const auto dots = [](plot_style style) {
    return count(svg_of(one_line(ramp(40), style)), "stroke:none;fill-rule:nonzero;fill:rgb(0%,44.7%,69.8%)");
  };
  EXPECT_EQ(dots(plot_style::line), 0U);
  EXPECT_EQ(dots(plot_style::points), 41U) << "one for each value, and the key's";
  EXPECT_EQ(dots(plot_style::marked), 41U);
  const std::size_t with_line = longest_path(svg_of(one_line(ramp(40), plot_style::marked))).size();
  EXPECT_GT(with_line, 2 * longest_path(svg_of(one_line(ramp(40), plot_style::points))).size());
}

TEST(plot, what_is_no_number_leaves_a_gap) {
  std::vector<double> y = ramp(40);
  EXPECT_EQ(count(longest_path(svg_of(one_line(y))), "M "), 1U);
  y[10] = std::numeric_limits<double>::quiet_NaN();
  y[20] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(count(longest_path(svg_of(one_line(y))), "M "), 3U);
  expect_on_page(svg_of(one_line({std::nan(""), std::nan("")})));
}

TEST(plot, a_logarithmic_axis_shows_powers_as_equal_steps) {
  std::vector<double> y;
  for (int i = 0; i < 7; ++i) y.push_back(std::pow(10.0, i));
  plot_page page = one_line(y);
  page.panels[0].log_y = true;
  page.panels[0].x_label = "frequency (Hz)";
  page.panels[0].log_x = true;
  page.panels[0].x = y;
  page.panels[0].lines[0].y[3] = 0.0;  // has no logarithm
  std::vector<double> numbers;
  std::string path = longest_path(svg_of(page));
  EXPECT_EQ(count(path, "M "), 2U);
  for (char* at = path.data(); *at != '\0';) {
    char* end = nullptr;
    const double v = std::strtod(at, &end);
    if (end == at) {
      ++at;
      continue;
    }
    numbers.push_back(v);
    at = end;
  }
  ASSERT_EQ(numbers.size(), 12U);
  EXPECT_NEAR(numbers[2] - numbers[0], numbers[4] - numbers[2], 0.02);
  EXPECT_NEAR(numbers[1] - numbers[3], numbers[3] - numbers[5], 0.02);
  EXPECT_GT(numbers[1] - numbers[3], 20.0);
  expect_on_page(svg_of(page));
}

TEST(plot, a_long_recording_is_a_small_picture_with_all_its_peaks) {
  std::vector<double> y(200'000, 0.0);
  y[100'000] = 1.0;
  const std::string svg = svg_of(one_line(y));
  EXPECT_LT(svg.size(), 1'000'000U);
  // The peak reaches the panel's top, which lies 230 points above its bottom.
  const std::string path = longest_path(svg);
  double low = 1e9, high = -1e9;
  for (std::size_t at = path.find_first_of("ML"); at != std::string::npos; at = path.find_first_of("ML", at + 1)) {
    char* end = nullptr;
    static_cast<void>(std::strtod(path.c_str() + at + 1, &end));
    const double v = std::strtod(end, nullptr);
    low = std::min(low, v);
    high = std::max(high, v);
  }
  EXPECT_NEAR(high - low, 230.0, 0.5);
}

}  // namespace
}  // namespace asperity::command
