// The pictures that show a model from the side: coarse mesh, textured surface, and values on it.
#pragma once

#include <cstdint>
#include <vector>

#include "asperity/model/textured_model.hpp"
#include "picture/canvas.hpp"
#include "picture/colour.hpp"
#include "picture/fine_surface.hpp"
#include "picture/view.hpp"

namespace asperity::picture {

inline constexpr colour paper{0.930F, 0.930F, 0.915F};  ///< behind every panel

/// Which of a few colours each convex piece takes: pieces with a common edge differ. One number per piece; a model
/// without enough colours repeats one.
[[nodiscard]] std::vector<std::uint32_t> colour_pieces(const textured_model& model);

/// The coarse mesh: triangles in the colours of their pieces, edges thin, edges between pieces thick.
[[nodiscard]] pixmap draw_coarse(const textured_model& model, const view& from, std::size_t width, std::size_t height);

/// The textured surface as matt clay, with all of its relief.
[[nodiscard]] pixmap draw_fine(const fine_surface& surface, const view& from, std::size_t width, std::size_t height);

/// What the values of a scale stand for, in the unit of the values.
struct value_range {
  double low = 0.0;
  double high = 1.0;
  [[nodiscard]] double share(double value) const noexcept { return (value - low) / (high - low); }
};

/// The textured surface in the colours of one value per point, weakly shaded: brightness scales a colour and does not
/// bend it.
[[nodiscard]] pixmap draw_values(const fine_surface& surface, const std::vector<float>& values,
                                 const value_range& range, const colour_scale& scale, const view& from,
                                 std::size_t width, std::size_t height);

}  // namespace asperity::picture
