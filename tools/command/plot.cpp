#include "plot.hpp"

#include <algorithm>
#include <array>
#include <cairo-svg.h>
#include <cairo.h>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "plot_axis.hpp"

namespace asperity::command {
namespace {

// Sizes in points of the SVG and pixels of the PNG.
constexpr double page_width = 1200.0;
constexpr double left = 90.0, right = 30.0, bottom = 55.0;
constexpr double inner_width = page_width - left - right;
constexpr double panel_height = 230.0;
constexpr double own_axis_height = 45.0;  // numbers and label under a panel that is not the last
constexpr double title_size = 19.0, caption_size = 13.0, label_size = 14.0, number_size = 13.0, legend_size = 13.0;
constexpr double title_row = 24.0, caption_row = 18.0, legend_row = 19.0;
constexpr double first_row = 34.0, under_head = 12.0, over_panel = 7.0, panel_gap = 11.0;
constexpr double key_width = 22.0, key_space = 6.0, key_gap = 16.0;

struct colour {
  double r, g, b;
};
// Okabe and Ito's palette: told apart by people with any kind of colour vision.
constexpr std::array<colour, 8> line_colours{{{0.0, 0.447, 0.698},
                                              {0.835, 0.369, 0.0},
                                              {0.0, 0.620, 0.451},
                                              {0.8, 0.475, 0.655},
                                              {0.902, 0.624, 0.0},
                                              {0.337, 0.706, 0.914},
                                              {0.35, 0.35, 0.35},
                                              {0.5, 0.1, 0.15}}};
constexpr colour ink{0.15, 0.15, 0.15}, grid{0.88, 0.88, 0.88}, fine_grid{0.95, 0.95, 0.95};
constexpr std::array<double, 2> dashes{7.0, 5.0};

const std::vector<double>& x_of(const plot_page& page, const plot_panel& panel, const plot_line& line) {
  return !line.x.empty() ? line.x : !panel.x.empty() ? panel.x : page.x;
}

bool has_own_axis(const plot_panel& panel) { return !panel.x_label.empty(); }

// The last panel that shares the page's axis has its numbers, and so has one over a panel with another axis.
bool is_numbered(const plot_page& page, std::size_t i) {
  return i + 1 == page.panels.size() || has_own_axis(page.panels[i]) || has_own_axis(page.panels[i + 1]);
}

axis x_axis_of(const plot_page& page, const plot_panel& panel) {
  value_range found(panel.log_x);
  for (const plot_line& line : panel.lines) found.add(x_of(page, panel, line));
  return axis::over(found, 10, false);
}

axis y_axis_of(const plot_panel& panel) {
  value_range found(panel.log_y);
  for (const plot_line& line : panel.lines) found.add(line.y);
  return axis::over(found, 5, true);
}

enum class anchor { start, middle, end };

/// Where everything on the page goes: texts and legends take as many rows as they need.
struct page_layout {
  std::vector<std::string> title, caption;                    ///< rows
  std::vector<std::vector<std::vector<std::size_t>>> legend;  ///< of each panel: rows of lines by number
  std::vector<double> panel_top;
  double height = 0.0;
};

class painter {
 public:
  explicit painter(cairo_t* to) : to_(to) {
    cairo_select_font_face(to_, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  }

  /// Needs a context to measure letters with; what is drawn on it does not matter.
  [[nodiscard]] page_layout arrange(const plot_page& page) {
    page_layout out{wrapped(page.title, title_size), wrapped(page.caption, caption_size), {}, {}, 0.0};
    double y = first_row + title_row * static_cast<double>(out.title.size()) +
               caption_row * static_cast<double>(out.caption.size()) - caption_row + under_head;
    for (std::size_t i = 0; i < page.panels.size(); ++i) {
      out.legend.push_back(legend_rows(page.panels[i]));
      y += legend_row * static_cast<double>(out.legend.back().size()) + over_panel;
      out.panel_top.push_back(y);
      const bool last = i + 1 == page.panels.size();
      y += panel_height + (last ? bottom : panel_gap) + (is_numbered(page, i) && !last ? own_axis_height : 0.0);
    }
    out.height = std::ceil(y);
    return out;
  }

  void paint(const plot_page& page, const page_layout& at) {
    set(colour{1.0, 1.0, 1.0});
    cairo_paint(to_);
    double y = first_row;
    for (const std::string& row : at.title) {
      text(left, y, row, title_size, anchor::start);
      y += title_row;
    }
    for (const std::string& row : at.caption) {
      text(left, y, row, caption_size, anchor::start);
      y += caption_row;
    }
    for (std::size_t i = 0; i < page.panels.size(); ++i) {
      panel(page, page.panels[i], at.panel_top[i], at.legend[i], is_numbered(page, i));
    }
  }

 private:
  void panel(const plot_page& page, const plot_panel& p, double y_top,
             const std::vector<std::vector<std::size_t>>& legend_of_lines, bool numbered) {
    const axis x = x_axis_of(page, p), y = y_axis_of(p);
    const double x_right = page_width - right, y_bottom = y_top + panel_height;
    const auto at_x = [&](double v) { return left + x.share(v) * (x_right - left); };
    const auto at_y = [&](double v) { return y_bottom - y.share(v) * panel_height; };

    x.for_each_rule([&](double v, bool main) {
      rule(at_x(v), y_top, at_x(v), y_bottom, main ? grid : fine_grid);
      if (numbered && main) text(at_x(v), y_bottom + 20.0, x.number(v), number_size, anchor::middle);
    });
    y.for_each_rule([&](double v, bool main) {
      rule(left, at_y(v), x_right, at_y(v), main ? grid : fine_grid);
      if (main) text(left - 8.0, at_y(v) + 4.5, y.number(v), number_size, anchor::end);
    });
    if (!y.logarithmic && y.low < 0.0 && y.high > 0.0) rule(left, at_y(0.0), x_right, at_y(0.0), colour{0.6, 0.6, 0.6});

    cairo_save(to_);
    cairo_rectangle(to_, left, y_top, x_right - left, panel_height);
    cairo_clip(to_);
    for (std::size_t i = 0; i < p.lines.size(); ++i) {
      const plot_line& line = p.lines[i];
      const std::vector<double>& along = x_of(page, p, line);
      if (line.style != plot_style::points) curve(along, line, line_colour(i), at_x, at_y);
      if (has_dots(line.style)) dots(along, line.y, line_colour(i), at_x, at_y);
    }
    cairo_restore(to_);

    set(ink);
    cairo_set_line_width(to_, 1.0);
    cairo_rectangle(to_, left, y_top, x_right - left, panel_height);
    cairo_stroke(to_);
    legend(p, legend_of_lines, x_right, y_top - over_panel);
    cairo_save(to_);
    cairo_translate(to_, 22.0, 0.5 * (y_top + y_bottom));
    cairo_rotate(to_, -1.5707963267948966);
    // A long one is written smaller: it would run into the neighbour's.
    text(0.0, 0.0, p.y_label, label_size * std::min(1.0, panel_height / std::max(1.0, width_of(p.y_label, label_size))),
         anchor::middle);
    cairo_restore(to_);
    if (numbered) {
      text(0.5 * (left + x_right), y_bottom + 42.0, has_own_axis(p) ? p.x_label : page.x_label, label_size,
           anchor::middle);
    }
  }

  template <class X, class Y>
  void curve(const std::vector<double>& x, const plot_line& line, colour c, X at_x, Y at_y) {
    set(c);
    cairo_set_line_width(to_, 1.3);
    cairo_set_line_join(to_, CAIRO_LINE_JOIN_ROUND);
    dash(line.style == plot_style::dashed);
    // A curve of many thousand values would make a picture of megabytes: what lies within a tenth of a point of the
    // last value drawn cannot be seen, and is drawn only where a gap follows.
    constexpr double unseen = 0.1;
    const std::size_t count = std::min(x.size(), line.y.size());
    bool down = false, held_back = false;
    double last_h = 0.0, last_v = 0.0, pen_h = 0.0, pen_v = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const double h = at_x(x[i]), v = at_y(line.y[i]);
      const bool drawn = std::isfinite(h) && std::isfinite(v);
      if (!drawn && held_back) cairo_line_to(to_, last_h, last_v);
      held_back = drawn && down && std::fabs(h - pen_h) < unseen && std::fabs(v - pen_v) < unseen;
      if (drawn && !held_back) {
        if (down) {
          cairo_line_to(to_, h, v);
        } else {
          cairo_move_to(to_, h, v);
        }
        pen_h = h;
        pen_v = v;
      }
      last_h = h;
      last_v = v;
      down = drawn;
    }
    if (held_back) cairo_line_to(to_, last_h, last_v);
    cairo_stroke(to_);
    dash(false);
  }

  template <class X, class Y>
  void dots(const std::vector<double>& x, const std::vector<double>& y, colour c, X at_x, Y at_y) {
    set(c);
    for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i) {
      const double h = at_x(x[i]), v = at_y(y[i]);
      if (std::isfinite(h) && std::isfinite(v)) dot(h, v, 3.0);
    }
  }

  // Right-aligned above the panel, where no curve can run under the words.
  void legend(const plot_panel& p, const std::vector<std::vector<std::size_t>>& rows, double x_right, double y) {
    for (std::size_t r = rows.size(); r-- > 0; y -= legend_row) {
      double x = x_right + key_gap;
      for (const std::size_t i : rows[r]) x -= entry_width(p.lines[i]);
      for (const std::size_t i : rows[r]) {
        key(p.lines[i].style, x, y - 4.0, key_width, line_colour(i));
        text(x + key_width + key_space, y, p.lines[i].label, legend_size, anchor::start);
        x += entry_width(p.lines[i]);
      }
    }
  }

  [[nodiscard]] double entry_width(const plot_line& line) {
    return key_width + key_space + width_of(line.label, legend_size) + key_gap;
  }

  // A line without a label is not in the legend: it goes with another one.
  [[nodiscard]] std::vector<std::vector<std::size_t>> legend_rows(const plot_panel& p) {
    std::vector<std::vector<std::size_t>> rows;
    double used = 0.0;
    for (std::size_t i = 0; i < p.lines.size(); ++i) {
      if (p.lines[i].label.empty()) continue;
      const double width = entry_width(p.lines[i]);
      if (rows.empty() || used + width > inner_width + key_gap) {
        rows.emplace_back();
        used = 0.0;
      }
      rows.back().push_back(i);
      used += width;
    }
    return rows;
  }

  // Broken between words where it is wider than the panels.
  [[nodiscard]] std::vector<std::string> wrapped(const std::string& words, double size) {
    std::vector<std::string> rows{""};
    for (std::size_t from = 0; from < words.size();) {
      const std::size_t to = std::min(words.find(' ', from), words.size());
      const std::string word = words.substr(from, to - from);
      std::string longer = rows.back().empty() ? word : rows.back() + ' ' + word;
      if (!rows.back().empty() && width_of(longer, size) > inner_width) {
        rows.push_back(word);
      } else {
        rows.back() = std::move(longer);
      }
      from = to + 1;
    }
    return rows;
  }

  void key(plot_style style, double x, double y, double width, colour c) {
    set(c);
    cairo_set_line_width(to_, 3.0);
    dash(style == plot_style::dashed);
    if (style != plot_style::points) {
      cairo_move_to(to_, x, y);
      cairo_line_to(to_, x + width, y);
      cairo_stroke(to_);
    }
    dash(false);
    if (has_dots(style)) dot(x + 0.5 * width, y, 4.0);
  }

  static bool has_dots(plot_style style) { return style == plot_style::points || style == plot_style::marked; }
  static colour line_colour(std::size_t i) { return line_colours[i % line_colours.size()]; }

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

  void dot(double x, double y, double radius) {
    cairo_arc(to_, x, y, radius, 0.0, 6.283185307179586);
    cairo_fill(to_);
  }

  void dash(bool on) { cairo_set_dash(to_, dashes.data(), on ? static_cast<int>(dashes.size()) : 0, 0.0); }

  void set(colour c) { cairo_set_source_rgb(to_, c.r, c.g, c.b); }

  cairo_t* to_;
};

struct sink {
  const plot_writer* write;
  std::optional<error> fault;  // Cairo forgets the reason
};

cairo_status_t write_some(void* closure, const unsigned char* bytes, unsigned int size) {
  auto& to = *static_cast<sink*>(closure);
  const result<void> written = (*to.write)({reinterpret_cast<const char*>(bytes), size});
  if (written) return CAIRO_STATUS_SUCCESS;
  to.fault = written.error();
  return CAIRO_STATUS_WRITE_ERROR;
}

using surface_ptr = std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)>;
using context_ptr = std::unique_ptr<cairo_t, void (*)(cairo_t*)>;

page_layout arrange(const plot_page& page) {
  const surface_ptr none(cairo_image_surface_create(CAIRO_FORMAT_RGB24, 1, 1), cairo_surface_destroy);
  const context_ptr context(cairo_create(none.get()), cairo_destroy);
  return painter(context.get()).arrange(page);
}

}  // namespace

result<void> draw(const plot_page& page, plot_format format, const plot_writer& write) {
  const page_layout at = arrange(page);
  sink to{&write, std::nullopt};
  const surface_ptr surface(
      format == plot_format::svg
          ? cairo_svg_surface_create_for_stream(write_some, &to, page_width, at.height)
          : cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(page_width), static_cast<int>(at.height)),
      cairo_surface_destroy);
  const context_ptr context(cairo_create(surface.get()), cairo_destroy);
  painter(context.get()).paint(page, at);
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

result<void> draw(const plot_page& page, plot_format format, output_file& out) {
  return draw(page, format, [&](std::string_view bytes) { return out.write(bytes); });
}

}  // namespace asperity::command
