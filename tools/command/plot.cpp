#include "plot.hpp"

#include <algorithm>
#include <array>
#include <cairo-svg.h>
#include <cairo.h>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

namespace asperity::command {
namespace {

// Sizes in points of the SVG and pixels of the PNG.
constexpr double page_width = 1200.0;
constexpr double left = 90.0, right = 30.0, top = 92.0, bottom = 55.0;
constexpr double panel_height = 230.0, panel_gap = 30.0;

struct colour {
  double r, g, b;
};
// Okabe and Ito's palette: told apart by people with any kind of colour vision.
constexpr std::array<colour, 4> line_colours{
    {{0.0, 0.447, 0.698}, {0.835, 0.369, 0.0}, {0.0, 0.620, 0.451}, {0.8, 0.475, 0.655}}};
constexpr colour ink{0.15, 0.15, 0.15}, grid{0.88, 0.88, 0.88};

struct axis {
  double low, high, step;
  int decimals;
};

// Ticks at 1, 2 or 5 times a power of ten; about `wanted` of them.
axis make_axis(double low, double high, int wanted, bool cover) {
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

std::optional<std::array<double, 2>> range_of(const plot_panel& panel) {
  std::optional<std::array<double, 2>> range;
  for (const plot_line& line : panel.lines) {
    for (const double y : line.y) {
      if (!std::isfinite(y)) continue;
      if (!range) range = {y, y};
      range->at(0) = std::min(range->at(0), y);
      range->at(1) = std::max(range->at(1), y);
    }
  }
  return range;
}

enum class anchor { start, middle, end };

class painter {
 public:
  explicit painter(cairo_t* to) : to_(to) {
    cairo_select_font_face(to_, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  }

  void paint(const plot_page& page) {
    set(colour{1.0, 1.0, 1.0});
    cairo_paint(to_);
    text(left, 34.0, page.title, 19.0, anchor::start);
    text(left, 58.0, page.caption, 13.0, anchor::start);
    const axis x = make_axis(page.x.empty() ? 0.0 : page.x.front(), page.x.empty() ? 1.0 : page.x.back(), 10, false);
    double y_top = top;
    for (std::size_t i = 0; i < page.panels.size(); ++i) {
      panel(page, page.panels[i], x, y_top, i + 1 == page.panels.size());
      y_top += panel_height + panel_gap;
    }
  }

 private:
  void panel(const plot_page& page, const plot_panel& p, const axis& x, double y_top, bool last) {
    const auto range = range_of(p).value_or(std::array{0.0, 1.0});
    const axis y = make_axis(range[0], range[1], 5, true);
    const double x_right = page_width - right, y_bottom = y_top + panel_height;
    const auto at_x = [&](double v) { return left + (v - x.low) / (x.high - x.low) * (x_right - left); };
    const auto at_y = [&](double v) { return y_bottom - (v - y.low) / (y.high - y.low) * panel_height; };

    for (double k = std::ceil(x.low / x.step - 1e-9); k * x.step <= x.high + 1e-9 * x.step; ++k) {
      rule(at_x(k * x.step), y_top, at_x(k * x.step), y_bottom, grid);
      if (last) text(at_x(k * x.step), y_bottom + 20.0, number(k * x.step, x.decimals), 13.0, anchor::middle);
    }
    for (double k = std::ceil(y.low / y.step - 1e-9); k * y.step <= y.high + 1e-9 * y.step; ++k) {
      rule(left, at_y(k * y.step), x_right, at_y(k * y.step), grid);
      text(left - 8.0, at_y(k * y.step) + 4.5, number(k * y.step, y.decimals), 13.0, anchor::end);
    }
    if (y.low < 0.0 && y.high > 0.0) rule(left, at_y(0.0), x_right, at_y(0.0), colour{0.6, 0.6, 0.6});

    cairo_save(to_);
    cairo_rectangle(to_, left, y_top, x_right - left, panel_height);
    cairo_clip(to_);
    for (std::size_t i = 0; i < p.lines.size(); ++i) curve(page.x, p.lines[i].y, line_colour(i), at_x, at_y);
    cairo_restore(to_);

    set(ink);
    cairo_set_line_width(to_, 1.0);
    cairo_rectangle(to_, left, y_top, x_right - left, panel_height);
    cairo_stroke(to_);
    legend(p, x_right, y_top - 7.0);
    cairo_save(to_);
    cairo_translate(to_, 22.0, 0.5 * (y_top + y_bottom));
    cairo_rotate(to_, -1.5707963267948966);
    text(0.0, 0.0, p.y_label, 14.0, anchor::middle);
    cairo_restore(to_);
    if (last) text(0.5 * (left + x_right), y_bottom + 42.0, page.x_label, 14.0, anchor::middle);
  }

  template <class X, class Y>
  void curve(const std::vector<double>& x, const std::vector<double>& y, colour c, X at_x, Y at_y) {
    set(c);
    cairo_set_line_width(to_, 1.3);
    cairo_set_line_join(to_, CAIRO_LINE_JOIN_ROUND);
    bool down = false;
    for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i) {
      const bool drawn = std::isfinite(y[i]);
      if (drawn && down) cairo_line_to(to_, at_x(x[i]), at_y(y[i]));
      if (drawn && !down) cairo_move_to(to_, at_x(x[i]), at_y(y[i]));
      down = drawn;
    }
    cairo_stroke(to_);
  }

  // Right-aligned above the panel, where no curve can run under the words.
  void legend(const plot_panel& p, double x_right, double y) {
    constexpr double size = 13.0, dash = 22.0, space = 6.0, gap = 16.0;
    double x = x_right + gap;
    for (const plot_line& line : p.lines) x -= dash + space + width_of(line.label, size) + gap;
    for (std::size_t i = 0; i < p.lines.size(); ++i) {
      set(line_colour(i));
      cairo_set_line_width(to_, 3.0);
      cairo_move_to(to_, x, y - 4.0);
      cairo_line_to(to_, x + dash, y - 4.0);
      cairo_stroke(to_);
      text(x + dash + space, y, p.lines[i].label, size, anchor::start);
      x += dash + space + width_of(p.lines[i].label, size) + gap;
    }
  }

  static colour line_colour(std::size_t i) { return line_colours[i % line_colours.size()]; }

  static std::string number(double v, int decimals) {
    char digits[48];
    std::snprintf(digits, sizeof digits, "%.*f", decimals, v == 0.0 ? 0.0 : v);  // no "-0"
    return digits;
  }

  double width_of(const std::string& s, double size) {
    cairo_text_extents_t extents;
    cairo_set_font_size(to_, size);
    cairo_text_extents(to_, s.c_str(), &extents);
    return extents.x_advance;
  }

  void text(double x, double y, const std::string& s, double size, anchor where) {
    const double width = width_of(s, size);
    set(ink);
    cairo_move_to(to_, where == anchor::start ? x : where == anchor::middle ? x - 0.5 * width : x - width, y);
    cairo_show_text(to_, s.c_str());
  }

  void rule(double x0, double y0, double x1, double y1, colour c) {
    set(c);
    cairo_set_line_width(to_, 1.0);
    cairo_move_to(to_, x0, y0);
    cairo_line_to(to_, x1, y1);
    cairo_stroke(to_);
  }

  void set(colour c) { cairo_set_source_rgb(to_, c.r, c.g, c.b); }

  cairo_t* to_;
};

struct sink {
  output_file* file;
  std::optional<error> fault;  // Cairo forgets the reason
};

cairo_status_t write_some(void* closure, const unsigned char* bytes, unsigned int size) {
  auto& to = *static_cast<sink*>(closure);
  const result<void> written = to.file->write({reinterpret_cast<const char*>(bytes), size});
  if (written) return CAIRO_STATUS_SUCCESS;
  to.fault = written.error();
  return CAIRO_STATUS_WRITE_ERROR;
}

}  // namespace

result<void> draw(const plot_page& page, plot_format format, output_file& out) {
  const double height = top + bottom + static_cast<double>(page.panels.size()) * (panel_height + panel_gap) - panel_gap;
  sink to{&out, std::nullopt};
  const std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface(
      format == plot_format::svg
          ? cairo_svg_surface_create_for_stream(write_some, &to, page_width, height)
          : cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(page_width), static_cast<int>(height)),
      cairo_surface_destroy);
  const std::unique_ptr<cairo_t, void (*)(cairo_t*)> context(cairo_create(surface.get()), cairo_destroy);
  painter(context.get()).paint(page);
  cairo_show_page(context.get());

  cairo_status_t status = cairo_status(context.get());
  if (status == CAIRO_STATUS_SUCCESS && format == plot_format::png) {
    status = cairo_surface_write_to_png_stream(surface.get(), write_some, &to);
  }
  cairo_surface_finish(surface.get());
  if (status == CAIRO_STATUS_SUCCESS) status = cairo_surface_status(surface.get());
  if (to.fault) return *to.fault;
  if (status != CAIRO_STATUS_SUCCESS) {
    return error{error_code::io_failed, std::string("the plot could not be drawn: ") + cairo_status_to_string(status)};
  }
  return {};
}

}  // namespace asperity::command
