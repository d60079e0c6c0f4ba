// The picture of a model as bake and inspect write it.
#pragma once

#include "asperity/model/textured_model.hpp"
#include "asperity/picture/model_picture.hpp"
#include "cli.hpp"
#include "output_file.hpp"

namespace asperity::command {

/// Draws a model into an open file, which the caller commits. Progress and interruption are told through the options.
/// @return what the third panel shows, SI, for the document | invalid_argument | cancelled | io_failed
[[nodiscard]] result<json> write_picture(const textured_model& model, const picture::picture_options& options,
                                         output_file& to);

}  // namespace asperity::command
