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
constexpr double own_axis_height = 45.0;  // numbers and label under a panel that is not the last

struct colour {
  double r, g, b;
};
// Okabe and Ito's palette: told apart by people with any kind of colour vision.
constexpr std::array<colour, 7> line_colours{{{0.0, 0.447, 0.698},
                                              {0.835, 0.369, 0.0},
                                              {0.0, 0.620, 0.451},
                                              {0.8, 0.475, 0.655},
                                              {0.902, 0.624, 0.0},
                                              {0.337, 0.706, 0.914},
                                              {0.35, 0.35, 0.35}}};
constexpr colour ink{0.15, 0.15, 0.15}, grid{0.88, 0.88, 0.88}, fine_grid{0.95, 0.95, 0.95};
constexpr std::array<double, 2> dashes{7.0, 5.0};

/// Where numbers lie on paper, and where its rules are.
struct axis {
  double low, high;  ///< of the numbers, or of their decimal logarithms
  double step;
  int decimals;
  bool logarithmic = false;

  /// 0 at the axis' beginning, 1 at its end; NaN for what has no place on it.
  [[nodiscard]] double share(double v) const {
    if (logarithmic && !(v > 0.0)) return std::nan("");
    return ((logarithmic ? std::log10(v) : v) - low) / (high - low);
  }
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

// Whole decades, at least one.
axis make_log_axis(double low, double high) {
  const double first = std::floor(std::log10(low) + 1e-9), last = std::ceil(std::log10(high) - 1e-9);
  return {first, std::max(last, first + 1.0), 1.0, 0, true};
}

using range = std::optional<std::array<double, 2>>;

void widen(range& r, double v, bool logarithmic) {
  if (!std::isfinite(v) || (logarithmic && !(v > 0.0))) return;
  if (!r) r = {v, v};
  r->at(0) = std::min(r->at(0), v);
  r->at(1) = std::max(r->at(1), v);
}

const std::vector<double>& x_of(const plot_page& page, const plot_panel& panel) {
  return panel.x.empty() ? page.x : panel.x;
}
const std::vector<double>& x_of(const plot_page& page, const plot_panel& panel, const plot_line& line) {
  return line.x.empty() ? x_of(page, panel) : line.x;
}

bool has_own_axis(const plot_panel& panel) { return !panel.x_label.empty(); }

axis x_axis_of(const plot_page& page, const plot_panel& panel) {
  range found;
  for (const plot_line& line : panel.lines) {
    for (const double v : x_of(page, panel, line)) widen(found, v, panel.log_x);
  }
  if (panel.log_x && found) return make_log_axis(found->at(0), found->at(1));
  const auto r = found.value_or(std::array{0.0, 1.0});
  return make_axis(r[0], r[1], 10, false);
}

axis y_axis_of(const plot_panel& panel) {
  range found;
  for (const plot_line& line : panel.lines) {
    for (const double v : line.y) widen(found, v, panel.log_y);
  }
  if (panel.log_y && found) return make_log_axis(found->at(0), found->at(1));
  const auto r = found.value_or(std::array{0.0, 1.0});
  return make_axis(r[0], r[1], 5, true);
}

// Places of the rules with numbers, and of the fine ones without.
template <class Rule>
void for_each_rule(const axis& a, Rule rule) {
  for (double k = std::ceil(a.low / a.step - 1e-9); k * a.step <= a.high + 1e-9 * a.step; ++k) {
    if (!a.logarithmic) {
      rule(k * a.step, true);
      continue;
    }
    rule(std::pow(10.0, k), true);
    for (int nth = 2; nth < 10 && k + 1.0 <= a.high + 1e-9; ++nth) rule(nth * std::pow(10.0, k), false);
  }
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
    double y_top = top;
    for (std::size_t i = 0; i < page.panels.size(); ++i) {
      const bool last = i + 1 == page.panels.size();
      panel(page, page.panels[i], y_top, last || has_own_axis(page.panels[i]));
      y_top += height_of(page.panels[i], last) + panel_gap;
    }
  }

  /// Height of a panel with the numbers under it that belong to no other.
  static double height_of(const plot_panel& p, bool last) {
    return panel_height + (has_own_axis(p) && !last ? own_axis_height : 0.0);
  }

 private:
  void panel(const plot_page& page, const plot_panel& p, double y_top, bool numbered) {
    const axis x = x_axis_of(page, p), y = y_axis_of(p);
    const double x_right = page_width - right, y_bottom = y_top + panel_height;
    const auto at_x = [&](double v) { return left + x.share(v) * (x_right - left); };
    const auto at_y = [&](double v) { return y_bottom - y.share(v) * panel_height; };

    for_each_rule(x, [&](double v, bool main) {
      rule(at_x(v), y_top, at_x(v), y_bottom, main ? grid : fine_grid);
      if (numbered && main) text(at_x(v), y_bottom + 20.0, number(v, x), 13.0, anchor::middle);
    });
    for_each_rule(y, [&](double v, bool main) {
      rule(left, at_y(v), x_right, at_y(v), main ? grid : fine_grid);
      if (main) text(left - 8.0, at_y(v) + 4.5, number(v, y), 13.0, anchor::end);
    });
    if (!y.logarithmic && y.low < 0.0 && y.high > 0.0) rule(left, at_y(0.0), x_right, at_y(0.0), colour{0.6, 0.6, 0.6});

    cairo_save(to_);
    cairo_rectangle(to_, left, y_top, x_right - left, panel_height);
    cairo_clip(to_);
    for (std::size_t i = 0; i < p.lines.size(); ++i) {
      const plot_line& line = p.lines[i];
      const std::vector<double>& along = x_of(page, p, line);
      if (line.style != plot_style::points) curve(along, line, line_colour(i), at_x, at_y);
      if (line.style == plot_style::points || line.style == plot_style::marked) {
        dots(along, line.y, line_colour(i), at_x, at_y);
      }
    }
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
    if (numbered) {
      text(0.5 * (left + x_right), y_bottom + 42.0, has_own_axis(p) ? p.x_label : page.x_label, 14.0, anchor::middle);
    }
  }

  template <class X, class Y>
  void curve(const std::vector<double>& x, const plot_line& line, colour c, X at_x, Y at_y) {
    set(c);
    cairo_set_line_width(to_, 1.3);
    cairo_set_line_join(to_, CAIRO_LINE_JOIN_ROUND);
    if (line.style == plot_style::dashed) cairo_set_dash(to_, dashes.data(), static_cast<int>(dashes.size()), 0.0);
    bool down = false;
    for (std::size_t i = 0; i < std::min(x.size(), line.y.size()); ++i) {
      const double h = at_x(x[i]), v = at_y(line.y[i]);
      const bool drawn = std::isfinite(h) && std::isfinite(v);
      if (drawn && down) cairo_line_to(to_, h, v);
      if (drawn && !down) cairo_move_to(to_, h, v);
      down = drawn;
    }
    cairo_stroke(to_);
    cairo_set_dash(to_, nullptr, 0, 0.0);
  }

  template <class X, class Y>
  void dots(const std::vector<double>& x, const std::vector<double>& y, colour c, X at_x, Y at_y) {
    set(c);
    for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i) {
      const double h = at_x(x[i]), v = at_y(y[i]);
      if (!std::isfinite(h) || !std::isfinite(v)) continue;
      cairo_arc(to_, h, v, 3.0, 0.0, 6.283185307179586);
      cairo_fill(to_);
    }
  }

  // Right-aligned above the panel, where no curve can run under the words.
  void legend(const plot_panel& p, double x_right, double y) {
    constexpr double size = 13.0, dash = 22.0, space = 6.0, gap = 16.0;
    double x = x_right + gap;
    for (const plot_line& line : p.lines) x -= dash + space + width_of(line.label, size) + gap;
    for (std::size_t i = 0; i < p.lines.size(); ++i) {
      key(p.lines[i].style, x, y - 4.0, dash, line_colour(i));
      text(x + dash + space, y, p.lines[i].label, size, anchor::start);
      x += dash + space + width_of(p.lines[i].label, size) + gap;
    }
  }

  void key(plot_style style, double x, double y, double width, colour c) {
    set(c);
    cairo_set_line_width(to_, 3.0);
    if (style == plot_style::dashed) cairo_set_dash(to_, dashes.data(), static_cast<int>(dashes.size()), 0.0);
    if (style != plot_style::points) {
      cairo_move_to(to_, x, y);
      cairo_line_to(to_, x + width, y);
      cairo_stroke(to_);
    }
    cairo_set_dash(to_, nullptr, 0, 0.0);
    if (style == plot_style::points || style == plot_style::marked) {
      cairo_arc(to_, x + 0.5 * width, y, 4.0, 0.0, 6.283185307179586);
      cairo_fill(to_);
    }
  }

  static colour line_colour(std::size_t i) { return line_colours[i % line_colours.size()]; }

  static std::string number(double v, const axis& on) {
    char digits[48];
    if (on.logarithmic) {
      std::snprintf(digits, sizeof digits, "%g", v);
    } else {
      std::snprintf(digits, sizeof digits, "%.*f", on.decimals, v == 0.0 ? 0.0 : v);  // no "-0"
    }
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
  double height = top + bottom - panel_gap;
  for (std::size_t i = 0; i < page.panels.size(); ++i) {
    height += painter::height_of(page.panels[i], i + 1 == page.panels.size()) + panel_gap;
  }
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
