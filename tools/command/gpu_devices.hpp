// The GPUs that --gpu can name. In builds with OpenGL.
#pragma once

#include "cli.hpp"

namespace asperity::command {

/// Opens a context on each in turn, which takes tens of milliseconds each.
/// @return `gpus` and their text | unsupported, with the step that failed and how to mend it
[[nodiscard]] result<answer> list_gpus();

}  // namespace asperity::command
