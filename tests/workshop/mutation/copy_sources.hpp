// The copy of the sources in which bugs are planted.
#pragma once

#include <filesystem>

#include "asperity/core/status.hpp"

namespace asperity::mutation {

/// Makes `copy` hold what git knows of `root`, as it stands there, and its new files. Files that are alike are left
/// alone, so that nothing is compiled again for them.
[[nodiscard]] result<void> copy_sources(const std::filesystem::path& root, const std::filesystem::path& copy);

}  // namespace asperity::mutation
