// A page of panels and words, written as PNG.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "asperity/core/status.hpp"
#include "picture/canvas.hpp"
#include "picture/colour.hpp"

// Cairo's own names for its types, so that its header stays out of this one.
struct _cairo;          // NOLINT(bugprone-reserved-identifier)
struct _cairo_surface;  // NOLINT(bugprone-reserved-identifier)

namespace asperity::picture {

/// A mark on a colour bar.
struct bar_mark {
  double share = 0.0;  ///< place along the bar, 0 to 1
  std::string label;
};

/// A white page; everything in pixels from its upper left corner.
class sheet {
 public:
  enum class weight { normal, bold };
  enum class anchor { start, middle, end };

  sheet(std::size_t width, std::size_t height);
  ~sheet();
  sheet(const sheet&) = delete;
  sheet& operator=(const sheet&) = delete;

  /// Copies a picture. @pre it lies on the page
  void place(const pixmap& what, std::size_t left, std::size_t top);

  /// One line, its baseline at y; cut with an ellipsis where it is wider than `most`.
  void text(double x, double y, std::string words, double size, weight w = weight::normal, anchor a = anchor::start,
            double most = 1e9);
  void fill(double left, double top, double width, double height, const colour& with);
  void frame(double left, double top, double width, double height, double line_width);

  /// The colours of a scale from left to right, marks and their labels below.
  void colour_bar(double left, double top, double width, const colour_scale& scale, const std::vector<bar_mark>& marks);

  /// @return io_failed
  [[nodiscard]] result<std::string> png();

 private:
  void ink(const colour& c);
  [[nodiscard]] double width_of(const std::string& words);

  std::unique_ptr<_cairo_surface, void (*)(_cairo_surface*)> surface_;
  std::unique_ptr<_cairo, void (*)(_cairo*)> to_;
};

}  // namespace asperity::picture
