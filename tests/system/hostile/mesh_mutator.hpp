// Changes PLY, OBJ and STL files at random and keeps most of their structure.
#pragma once

#include <string>

#include "random_source.hpp"

namespace asperity::hostile {

/// A good small mesh in each format.
[[nodiscard]] std::string good_ascii_ply();
[[nodiscard]] std::string good_binary_ply();
[[nodiscard]] std::string good_obj();
[[nodiscard]] std::string good_ascii_stl();
[[nodiscard]] std::string good_binary_stl();

/// One to three changes of a text: words replaced by others of the format or by strange numbers, words and lines
/// swapped, doubled and dropped, the end cut off. Bytes from `text_end` on are changed as numbers.
[[nodiscard]] std::string mutated_mesh(const std::string& file, std::size_t text_end, random_source& random);

}  // namespace asperity::hostile
