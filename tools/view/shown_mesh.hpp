// A model as a page draws it: points of its textured surface, as many as a browser shows fluently.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "asperity/model/textured_model.hpp"
#include "asperity/model/triangle_mesh.hpp"

namespace asperity::view {

/// Points of all bodies of a scene together that a page is sent, at the most: about twice as many triangles.
inline constexpr std::size_t live_points = 200'000;
/// The same for a page that is one file.
inline constexpr std::size_t exported_points = 60'000;

/// A body's drawn surface. The bytes are little endian: "ASPM", points, patches and coarse vertices as 32-bit numbers;
/// box of the points, low and high, range of the relief, upper end of the errors' range (below 0: there are none) and a
/// zero as ten floats; columns and rows of each patch (fine_patch), one per coarse triangle, as two 32-bit numbers; the
/// coarse vertices as floats and the triangles as three 32-bit numbers each; x, y, z and relief of each point as 16-bit
/// shares of the box and the range; for each point its normal as signed bytes and the number of its piece's colour; and
/// where there are errors each point's as a 16-bit share of their range.
struct shown_mesh {
  std::string bytes;
  std::size_t points = 0;
  std::size_t triangles = 0;
  double step_m = 0.0;  ///< least distance of the points; 0 where each texel has one
  double low_m = 0.0;   ///< relief over the coarse mesh, the range of the colours
  double high_m = 0.0;

  /// Distance of the points to the original's surface, m.
  struct distances {
    double high_m = 0.0;  ///< end of the colours: 98 % of the area is below
    double rms_m = 0.0;   ///< over the area
    double largest_m = 0.0;
  };
  std::optional<distances> errors{};  ///< where the original was given
};

/// Samples the textured surface with at most about `most_points`. The same model gives the same bytes.
/// @param original the mesh that the model was baked from; null: the distance to it is not told
[[nodiscard]] shown_mesh show_mesh(const textured_model& model, std::size_t most_points,
                                   const triangle_mesh* original = nullptr);

}  // namespace asperity::view
