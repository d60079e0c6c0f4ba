// Whether what a command writes would destroy what it reads.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "asperity/core/status.hpp"

namespace asperity::command {

/// A file as the command line names it: with what, and where. An empty path is no file.
struct named_file {
  std::string option;  ///< such as "--record"
  std::filesystem::path file;
};

/// Whether two names mean one file: the same device and inode, through links of either kind; where neither is there
/// yet, the same place behind symbolic links. What cannot be replaced and keeps nothing, such as /dev/null, is
/// never the same as anything.
[[nodiscard]] bool is_one_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// A mesh and, where it is a .gltf, the buffers and images that it names. Empty for an empty path; a file that cannot
/// be read names nothing, and whoever reads it will say so.
[[nodiscard]] std::vector<named_file> mesh_files(const std::filesystem::path& mesh, const std::string& option);

/// Refuses an output that is an input, and two outputs that are one file. To be asked before anything is opened.
/// @return invalid_argument with both options
[[nodiscard]] result<void> check_outputs(std::span<const named_file> inputs, std::span<const named_file> outputs);

}  // namespace asperity::command
