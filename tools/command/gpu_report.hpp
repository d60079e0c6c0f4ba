// What a GPU did, for documents and people.
#pragma once

#include <string>

#include "cli.hpp"
#include "gpu_use.hpp"

namespace asperity::command {

[[nodiscard]] json to_json(const gpu_use& use);
/// One or two rows.
[[nodiscard]] std::string to_text(const gpu_use& use);

/// Says on stderr, once, what a person would not expect: that the processor draws in place of a GPU, or that the CPU
/// answers because the GPU cannot be used.
void warn(const gpu_use& use);

/// What to say where a tick was not answered.
[[nodiscard]] error gpu_failed(const gpu_use& use);

}  // namespace asperity::command
