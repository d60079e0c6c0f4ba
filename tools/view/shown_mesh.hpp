// A model as a page draws it: points of its textured surface, as many as a browser shows fluently.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "asperity/model/textured_model.hpp"

namespace asperity::view {

/// Points of all bodies of a scene together that a page is sent, at the most: about twice as many triangles.
inline constexpr std::size_t live_points = 200'000;
/// The same for a page that is one file.
inline constexpr std::size_t exported_points = 60'000;

/// A body's drawn surface. The bytes are little endian: "ASPM", points and patches as 32-bit numbers, one word
/// of zero; box of the points, low and high, and range of the relief as eight floats; columns and rows of each patch
/// (fine_patch) as two 32-bit numbers; x, y, z and relief of each point as 16-bit shares of the box and the range; and
/// for each point its normal as signed bytes and the number of its piece's colour.
struct shown_mesh {
  std::string bytes;
  std::size_t points = 0;
  std::size_t triangles = 0;
  double step_m = 0.0;  ///< least distance of the points; 0 where each texel has one
  double low_m = 0.0;   ///< relief over the coarse mesh, the range of the colours
  double high_m = 0.0;
};

/// Samples the textured surface with at most about `most_points`. The same model gives the same bytes.
[[nodiscard]] shown_mesh show_mesh(const textured_model& model, std::size_t most_points);

}  // namespace asperity::view
