// asperity bake --split: one model for each part of a mesh, all of them or none.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "asperity/io/mesh_file.hpp"
#include "cli.hpp"

namespace asperity::command {

/// Where the model of each part goes: beside `out`, NAME-1.glb and on, or NAME-GROUP.glb where the file names the part.
[[nodiscard]] std::vector<std::string> files_of_parts(const std::vector<io::mesh_part>& parts, const std::string& out);

/// Bakes every part under a temporary name, and gives all of them their names where every one was baked.
/// @param bake_part bakes part k into the file named
[[nodiscard]] result<answer> bake_parts(
    const std::string& source, const std::vector<std::string>& files,
    const std::function<result<answer>(std::size_t k, const std::string& file)>& bake_part);

}  // namespace asperity::command
