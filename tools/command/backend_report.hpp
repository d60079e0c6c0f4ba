// Depth backends compared, as a document and for people.
#pragma once

#include "asperity/model/scene.hpp"
#include "backend_times.hpp"
#include "cli.hpp"

namespace asperity::command {

/// Says on stderr where the "GPU" is the processor, unless `quiet`.
[[nodiscard]] answer report(const scene& bodies, const backend_bench& options, const bench_of_backends& timed,
                            bool quiet);

}  // namespace asperity::command
