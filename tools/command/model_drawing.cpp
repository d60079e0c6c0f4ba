#include "model_drawing.hpp"

namespace asperity::command {

result<json> write_picture(const textured_model& model, const picture::picture_options& options, output_file& to) {
  const result<picture::model_picture> drawn = picture::draw_model(model, options);
  if (!drawn) return drawn.error();
  if (const result<void> written = to.write(drawn->png); !written) return written.error();
  const picture::shown_values& v = drawn->values;
  return json{{"shows", v.is_distance ? "distance to the original" : "height above the coarse surface"},
              {"colours_from", v.low},
              {"colours_to", v.high},
              {"least", v.least},
              {"largest", v.largest},
              {"rms", v.rms}};
}

}  // namespace asperity::command
