#include "asperity/picture/model_picture.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "asperity/core/printable.hpp"
#include "bake/geometry.hpp"
#include "picture/atlas_panel.hpp"
#include "picture/fine_surface.hpp"
#include "picture/sheet.hpp"
#include "picture/surface_panels.hpp"
#include "picture/view.hpp"
#include "text/amount.hpp"

namespace asperity::picture {
namespace {

using text::brief;

// Pixels.
constexpr std::size_t page_width = 1600, page_height = 1236;
constexpr std::size_t margin = 28, gap = 20, header = 104;
constexpr std::size_t panel_width = (page_width - 2 * margin - gap) / 2;
constexpr std::size_t panel_height = (page_height - header - margin - gap) / 2;
constexpr double inset = 24.0, title_height = 82.0, foot_height = 64.0;

// A length with the letter for micro, which a page can show and a terminal may not.
std::string length(double metres) {
  std::string words = text::length_text(metres);
  const std::size_t micro = words.find(" um");
  if (micro != std::string::npos) words.replace(micro, 3, " \u00b5m");
  if (words.front() == '-') words.replace(0, 1, "\u2212");
  return words;
}

std::string count(std::size_t n) {
  const std::string digits = std::to_string(n);
  std::string grouped;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) grouped += ',';
    grouped += digits[i];
  }
  return grouped;
}

// The next of these times a power of ten: the ends and the middle of a bar are then round.
double round_up(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double lead : {1.0, 2.0, 4.0, 6.0, 8.0}) {
    if (value <= lead * power * (1.0 + 1e-9)) return lead * power;
  }
  return 10.0 * power;
}

view look_at(const textured_model& model, const fine_surface* surface, const picture_options& options) {
  extent covered(look_from_above(model.box.high - model.box.low, options.up, options.turn_deg));
  for (const vec3& p : model.mesh.positions) covered.add(p);
  if (surface != nullptr) {
    for (const glm::vec3& p : surface->points) covered.add(vec3(p));
  }
  return covered.fit(inset, title_height, panel_width - 2.0 * inset, panel_height - title_height - foot_height);
}

shown_values describe(const std::vector<float>& values, const std::vector<float>& areas, bool is_distance,
                      double diagonal) {
  shown_values out;
  out.is_distance = is_distance;
  const auto [least, largest] = std::minmax_element(values.begin(), values.end());
  out.least = static_cast<double>(*least);
  out.largest = static_cast<double>(*largest);
  double squares = 0.0;
  double area = 0.0;
  std::vector<float> sizes(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    sizes[i] = std::fabs(values[i]);
    squares += static_cast<double>(areas[i]) * static_cast<double>(values[i]) * static_cast<double>(values[i]);
    area += static_cast<double>(areas[i]);
  }
  out.rms = area > 0.0 ? std::sqrt(squares / area) : 0.0;
  // Below a hundred-thousandth of the model there is only the rounding of float32, and a few far values shall not take
  // the colours from all the others.
  out.high = round_up(std::max(quantile(sizes, areas, 0.98), 1e-5 * diagonal));
  out.low = is_distance ? 0.0 : -out.high;
  return out;
}

std::vector<bar_mark> marks_of(const shown_values& v) {
  const std::string below = v.least < v.low ? "\u2264 " : "";
  const std::string above = v.largest > v.high ? "\u2265 " : "";
  std::vector<bar_mark> marks{{0.0, v.low == 0.0 ? "0" : below + length(v.low)},
                              {0.5, v.is_distance ? length(0.5 * v.high) : "0"},
                              {1.0, above + length(v.high)}};
  return marks;
}

class page {
 public:
  page(const textured_model& model, const picture_options& options)
      : model_(model), options_(options), sheet_(page_width, page_height) {}

  void write_header() {
    const bake_report& r = model_.report;
    const vec3 size = 1e3 * (model_.box.high - model_.box.low);
    sheet_.text(margin, 48.0, printable(model_.name.empty() ? "(no name)" : model_.name), 32.0, sheet::weight::bold,
                sheet::anchor::start, page_width - 2.0 * margin);
    std::vector<std::string> facts{brief(size.x) + " \u00d7 " + brief(size.y) + " \u00d7 " + brief(size.z) + " mm"};
    if (r.full_triangles > 0) facts.push_back("original " + count(r.full_triangles) + " triangles");
    facts.push_back("coarse mesh " + count(model_.mesh.triangles.size()) + " triangles");
    facts.push_back("relief " + length(r.peak_to_valley_m) + " peak to valley");
    facts.push_back("bake error RMS " + length(r.rms_error_m) + ", largest " + length(r.max_error_m));
    std::string line;
    for (const std::string& fact : facts) line += (line.empty() ? "" : "   \u00b7   ") + fact;
    sheet_.text(margin, 80.0, line, 18.0, sheet::weight::normal, sheet::anchor::start, page_width - 2.0 * margin);
  }

  void coarse_panel(const view& from) {
    begin(0, draw_coarse(model_, from, panel_width, panel_height), "Coarse mesh",
          count(model_.mesh.triangles.size()) + " triangles in " +
              (model_.pieces.size() == 1 ? "one convex piece"
                                         : count(model_.pieces.size()) + " convex pieces, told apart by colour"));
    scale_line(from);
  }

  void fine_panel(const fine_surface& surface, const texel_map& texels, const view& from) {
    double area = 0.0;
    for (std::size_t t = 0; t < model_.mesh.triangles.size(); ++t) {
      area += 0.5 * glm::length(area_normal(corners(model_.mesh, t)));
    }
    const std::size_t used = std::max<std::size_t>(1, texels.count(texel_use::chart));
    begin(1, draw_fine(surface, from, panel_width, panel_height), "Textured surface",
          count(used) + " texels, " + length(std::sqrt(area / static_cast<double>(used))) + " apart");
    scale_line(from);
  }

  void value_panel(const fine_surface& surface, const std::vector<float>& values, const shown_values& shown,
                   const view& from) {
    const std::string numbers =
        "RMS " + length(shown.rms) + ", largest " + length(std::max(std::fabs(shown.least), std::fabs(shown.largest)));
    begin(2, draw_values(surface, values, {shown.low, shown.high}, scale_of(shown), from, panel_width, panel_height),
          shown.is_distance ? "Distance to the original" : "Height above the coarse surface",
          shown.is_distance ? printable(options_.original_name) + ": " + numbers
                            : numbers + "; no original was given to compare with");
    scale_line(from);
    constexpr double width = 340.0;
    sheet_.colour_bar(left_ + panel_width - inset - width, top_ + panel_height - 50.0, width, scale_of(shown),
                      marks_of(shown));
  }

  void texture_panel(const texel_map& texels, const shown_values& heights) {
    const auto percent = [&](texel_use what) {
      return brief(100.0 * static_cast<double>(texels.count(what)) / static_cast<double>(texels.use.size())) + " % ";
    };
    begin(3, std::nullopt, "Haptic texture",
          count(texels.width) + " \u00d7 " + count(texels.height) + " texels: " + percent(texel_use::chart) +
              "in charts, " + percent(texel_use::gutter) + "gutter, " + percent(texel_use::unused) + "unused");
    const value_range range{heights.low, heights.high};
    const colour_scale& scale = scale_of(heights);
    constexpr double side = panel_height - title_height - inset;
    const double longer = static_cast<double>(std::max(texels.width, texels.height));
    const auto scaled = [&](std::size_t n, double room) {
      return std::max<std::size_t>(1, static_cast<std::size_t>(room * static_cast<double>(n) / longer));
    };
    const double x = left_ + inset;
    const double y = top_ + title_height;
    const std::size_t width = scaled(texels.width, side);
    const std::size_t height = scaled(texels.height, side);
    const auto at = [](double v) { return static_cast<std::size_t>(v); };
    sheet_.place(draw_texels(texels, {0, 0, texels.width, texels.height}, range, scale, width, height), at(x), at(y));

    // A part of it, large enough to see single texels.
    const double zoom_x = std::floor(x + side + 28.0);
    const double zoom_side = std::floor(left_ + panel_width - inset - zoom_x);
    const texel_window window = informative_window(texels, 40, range);
    const double pixels_per_texel = static_cast<double>(width) / static_cast<double>(texels.width);
    const auto drawn = static_cast<std::size_t>(zoom_side);
    sheet_.place(draw_texels(texels, window, range, scale, drawn, drawn), at(zoom_x), at(y));
    sheet_.frame(zoom_x, y, zoom_side, zoom_side, 2.0);
    sheet_.frame(x + static_cast<double>(window.left) * pixels_per_texel,
                 y + static_cast<double>(window.top) * pixels_per_texel,
                 static_cast<double>(window.width) * pixels_per_texel,
                 static_cast<double>(window.height) * pixels_per_texel, 2.0);
    double line = y + zoom_side + 22.0;
    sheet_.text(zoom_x, line, count(window.width) + " \u00d7 " + count(window.height) + " texels of it", 15.0);
    for (const auto& [with, words] : {std::pair{gutter_texel, "gutter"}, std::pair{unused_texel, "unused"}}) {
      line += 26.0;
      sheet_.fill(zoom_x, line - 13.0, 22.0, 15.0, with);
      sheet_.text(zoom_x + 30.0, line, words, 15.0);
    }
    sheet_.text(zoom_x, line + 46.0, "height above coarse mesh", 15.0, sheet::weight::normal, sheet::anchor::start,
                zoom_side);
    sheet_.colour_bar(zoom_x, line + 56.0, zoom_side, scale, marks_of(heights));
  }

  [[nodiscard]] result<std::string> png() { return sheet_.png(); }

 private:
  static const colour_scale& scale_of(const shown_values& v) {
    return v.is_distance ? colour_scale::from_zero() : colour_scale::about_zero();
  }

  void begin(std::size_t number, const std::optional<pixmap>& picture, const char* title, const std::string& words) {
    const std::size_t column = number % 2, row = number / 2;
    left_ = static_cast<double>(margin + column * (panel_width + gap));
    top_ = static_cast<double>(header + row * (panel_height + gap));
    if (picture) {
      sheet_.place(*picture, static_cast<std::size_t>(left_), static_cast<std::size_t>(top_));
    } else {
      sheet_.fill(left_, top_, panel_width, panel_height, paper);
    }
    sheet_.text(left_ + inset, top_ + 34.0, title, 21.0, sheet::weight::bold);
    sheet_.text(left_ + inset, top_ + 59.0, words, 16.0, sheet::weight::normal, sheet::anchor::start,
                panel_width - 2.0 * inset);
  }

  // A round length near a sixth of the panel. Parallel projection: it holds for all lines across the view.
  void scale_line(const view& from) {
    const double metres = round_up(panel_width / 6.0 / from.pixels_per_m);
    const double pixels = metres * from.pixels_per_m;
    const double y = top_ + panel_height - 44.0;
    constexpr colour dark{0.018F, 0.020F, 0.026F};
    sheet_.fill(left_ + inset, y, pixels, 2.0, dark);
    for (const double x : {left_ + inset, left_ + inset + pixels - 2.0}) sheet_.fill(x, y - 4.0, 2.0, 10.0, dark);
    sheet_.text(left_ + inset, y + 25.0, length(metres), 14.0);
  }

  const textured_model& model_;
  const picture_options& options_;
  sheet sheet_;
  double left_ = 0.0;  // of the panel that is being drawn
  double top_ = 0.0;
};

}  // namespace

result<void> check_original(const textured_model& model, const triangle_mesh& original, const std::string& name) {
  if (original.triangles.empty()) {
    return error{error_code::invalid_argument, name + " has no triangles: give the mesh that the model was baked from"};
  }
  for (const vec3& p : original.positions) {
    if (!std::isfinite(p.x + p.y + p.z)) {
      return error{error_code::invalid_argument, name + " has coordinates that are not finite: mend the mesh"};
    }
  }
  const bounds box = bounds_of(original.positions);
  const double full = box.diagonal();
  const double coarse = model.box.diagonal();
  if (!(full > 0.8 * coarse && full < 1.25 * coarse)) {
    return error{error_code::invalid_argument,
                 name + " is of another size than the model (diagonal " + text::length_text(full) + ", the model's " +
                     text::length_text(coarse) +
                     "): give the mesh that the model was baked from, and the --scale of that bake"};
  }
  const double apart = std::max(glm::length(box.low - model.box.low), glm::length(box.high - model.box.high));
  if (apart > 0.15 * coarse) {
    return error{error_code::invalid_argument,
                 name + " is of the model's size but lies elsewhere (corners of the boxes are up to " +
                     text::length_text(apart) + " apart): give the mesh that the model was baked from"};
  }
  return {};
}

result<model_picture> draw_model(const textured_model& model, const picture_options& options) {
  if (options.original != nullptr) {
    if (const result<void> fits = check_original(model, *options.original, options.original_name); !fits) {
      return fits.error();
    }
  }
  bake::stage_monitor monitor(options.progress);
  monitor.begin("picture");
  // No finer than the samples of the canvas.
  const double least_step_m = 1.0 / (canvas::fineness * look_at(model, nullptr, options).pixels_per_m);
  const fine_surface surface = sample_fine_surface(model, least_step_m);
  const view from = look_at(model, &surface, options);
  const double diagonal = model.box.diagonal();
  const shown_values heights = describe(surface.heights, surface.areas, false, diagonal);

  shown_values shown = heights;
  std::vector<float> apart;
  if (options.original != nullptr) {
    const bake::triangle_bvh tree(options.original->positions, options.original->triangles);
    result<std::vector<float>> measured = distances(surface, tree, options.threads, monitor);
    if (!measured) return measured.error();
    apart = std::move(*measured);
    shown = describe(apart, surface.areas, true, diagonal);
  }

  page to(model, options);
  const texel_map texels = map_texels(model);
  to.write_header();
  to.coarse_panel(from);
  monitor.at(0.7);
  to.fine_panel(surface, texels, from);
  monitor.at(0.8);
  to.value_panel(surface, options.original != nullptr ? apart : surface.heights, shown, from);
  monitor.at(0.9);
  to.texture_panel(texels, heights);
  if (monitor.cancelled()) return error{error_code::cancelled, "interrupted: no picture was written"};
  result<std::string> png = to.png();
  if (!png) return png.error();
  return model_picture{std::move(*png), shown};
}

}  // namespace asperity::picture
