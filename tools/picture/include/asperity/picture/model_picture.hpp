// A textured model on one page: coarse mesh, textured surface, its error, its texture.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "asperity/core/status.hpp"
#include "asperity/model/textured_model.hpp"
#include "asperity/model/triangle_mesh.hpp"

namespace asperity::picture {

/// Which axis of the body points up in the picture.
enum class up_axis {
  automatic,  ///< z; but what is far taller than it is wide lies down, its shortest axis upwards
  x,
  y,
  z
};

struct picture_options {
  const triangle_mesh* original = nullptr;  ///< body frame, m; where given, the third panel shows the distance to it
  std::string original_name;                ///< for the page and for messages
  up_axis up = up_axis::automatic;
  double turn_deg = 0.0;  ///< the model is turned so far about the upward axis, counter-clockwise from above
  unsigned threads = 0;   ///< 0 for all; the picture does not depend on it
  std::function<bool(std::string_view stage, double done)> progress;  ///< answers false to stop
};

/// What the third panel shows, m.
struct shown_values {
  bool is_distance = false;  ///< to the original; else the height over the coarse surface
  double low = 0.0;          ///< ends of the colour bar; values beyond take the colour of the end
  double high = 0.0;
  double least = 0.0;  ///< of the points that were drawn
  double largest = 0.0;
  double rms = 0.0;  ///< over the area
};

struct model_picture {
  std::string png;  ///< the bytes of the file
  shown_values values;
};

/// Whether a mesh can be what the model was baked from. @param name of the mesh, for messages
/// @return invalid_argument where it is empty, not finite, or of another size or place than the model
[[nodiscard]] result<void> check_original(const textured_model& model, const triangle_mesh& original,
                                          const std::string& name);

/// Draws the page. The same model and options give the same bytes on one machine; fonts differ between machines.
/// @return invalid_argument where the original is empty, not finite, or of another size or place than the model |
/// cancelled | io_failed
[[nodiscard]] result<model_picture> draw_model(const textured_model& model, const picture_options& options = {});

}  // namespace asperity::picture
