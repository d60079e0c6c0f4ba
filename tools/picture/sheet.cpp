#include "picture/sheet.hpp"

#include <algorithm>
#include <cairo.h>
#include <cmath>
#include <utility>

namespace asperity::picture {
namespace {

constexpr colour words_colour{0.018F, 0.020F, 0.026F};

cairo_status_t append(void* closure, const unsigned char* bytes, unsigned int size) {
  static_cast<std::string*>(closure)->append(reinterpret_cast<const char*>(bytes), size);
  return CAIRO_STATUS_SUCCESS;
}

// Removes the last character of a UTF-8 text.
void shorten(std::string& words) {
  while (!words.empty() && (static_cast<unsigned char>(words.back()) & 0xC0U) == 0x80U) words.pop_back();
  if (!words.empty()) words.pop_back();
}

}  // namespace

sheet::sheet(std::size_t width, std::size_t height)
    : surface_(cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(width), static_cast<int>(height)),
               cairo_surface_destroy),
      to_(cairo_create(surface_.get()), cairo_destroy) {
  cairo_set_source_rgb(to_.get(), 1.0, 1.0, 1.0);
  cairo_paint(to_.get());
}

sheet::~sheet() = default;

void sheet::place(const pixmap& what, std::size_t left, std::size_t top) {
  cairo_surface_flush(surface_.get());
  unsigned char* const pixels = cairo_image_surface_get_data(surface_.get());
  if (pixels == nullptr) return;  // the page could not be made; png() says why
  const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface_.get()));
  for (std::size_t y = 0; y < what.height; ++y) {
    auto* row = reinterpret_cast<std::uint32_t*>(pixels + (top + y) * stride) + left;
    for (std::size_t x = 0; x < what.width; ++x) {
      const auto [r, g, b] = what.at(x, y);
      row[x] = std::uint32_t{r} << 16U | std::uint32_t{g} << 8U | std::uint32_t{b};
    }
  }
  cairo_surface_mark_dirty(surface_.get());
}

void sheet::ink(const colour& c) {
  const auto channel = [](float linear) { return to_srgb8(linear) / 255.0; };
  cairo_set_source_rgb(to_.get(), channel(c.r), channel(c.g), channel(c.b));
}

double sheet::width_of(const std::string& words) {
  cairo_text_extents_t extents;
  cairo_text_extents(to_.get(), words.c_str(), &extents);
  return extents.x_advance;
}

void sheet::text(double x, double y, std::string words, double size, weight w, anchor a, double most) {
  cairo_select_font_face(to_.get(), "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         w == weight::bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(to_.get(), size);
  double width = width_of(words);
  if (width > most) {
    while (!words.empty() && width_of(words + "\u2026") > most) shorten(words);
    words += "\u2026";
    width = width_of(words);
  }
  ink(words_colour);
  cairo_move_to(to_.get(), a == anchor::start ? x : a == anchor::middle ? x - 0.5 * width : x - width, y);
  cairo_show_text(to_.get(), words.c_str());
}

void sheet::fill(double left, double top, double width, double height, const colour& with) {
  ink(with);
  cairo_rectangle(to_.get(), left, top, width, height);
  cairo_fill(to_.get());
}

void sheet::frame(double left, double top, double width, double height, double line_width) {
  ink(words_colour);
  cairo_set_line_width(to_.get(), line_width);
  cairo_rectangle(to_.get(), left, top, width, height);
  cairo_stroke(to_.get());
}

void sheet::colour_bar(double left, double top, double width, const colour_scale& scale,
                       const std::vector<bar_mark>& marks) {
  constexpr double height = 12.0;
  for (double x = 0.0; x < width; ++x)
    fill(left + x, top, std::min(1.0, width - x), height, scale.at((x + 0.5) / width));
  for (const bar_mark& m : marks) {
    const double x = left + m.share * width;
    fill(x - 0.5, top + height, 1.0, 4.0, words_colour);
    const anchor a = m.share <= 0.0 ? anchor::start : m.share >= 1.0 ? anchor::end : anchor::middle;
    text(x, top + height + 19.0, m.label, 14.0, weight::normal, a);
  }
}

result<std::string> sheet::png() {
  std::string bytes;
  cairo_surface_flush(surface_.get());
  cairo_status_t status = cairo_status(to_.get());
  if (status == CAIRO_STATUS_SUCCESS) status = cairo_surface_write_to_png_stream(surface_.get(), append, &bytes);
  if (status != CAIRO_STATUS_SUCCESS) {
    return error{error_code::io_failed,
                 std::string("the picture could not be drawn: ") + cairo_status_to_string(status)};
  }
  return bytes;
}

}  // namespace asperity::picture
