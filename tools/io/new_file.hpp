// A file that takes another's place when it is whole. Shared by everything in this repository that writes files.
#pragma once

#include <filesystem>

namespace asperity::io {

/// The path that a chain of links ends in, whether a file is there or not.
[[nodiscard]] std::filesystem::path behind_links(std::filesystem::path path);

/// An open file and its name.
struct new_file {
  int descriptor = -1;         ///< open for writing; -1 where none could be made, and errno says why
  std::filesystem::path name;  ///< TARGET.partial- and twelve letters and digits
};

/// A new file beside `target`, so that renaming it over the target stays within one file system. Its name is drawn at
/// random and never one that exists: what another run left, with the same process number or not, is neither opened nor
/// in the way. Where the target is there, the file gets its mode, and its owner and group as far as this process may
/// give them away.
[[nodiscard]] new_file create_beside(const std::filesystem::path& target);

}  // namespace asperity::io
