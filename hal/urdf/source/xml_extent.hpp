// Sizes beyond which a document is refused before an XML parser sees it.
#pragma once

#include <cstddef>
#include <string_view>

#include "asperity/core/status.hpp"

namespace asperity {

/// Limits of a document: elements, attributes of one and of all, levels. An arm's document has a hundredth of them.
inline constexpr std::size_t most_xml_elements = 100'000;
inline constexpr std::size_t most_xml_attributes_of_one = 64;
inline constexpr std::size_t most_xml_attributes = 400'000;
inline constexpr std::size_t most_xml_levels = 64;

/// Counts in one pass, by the rules that tinyxml2 splits a text with. What is no XML passes: the parser refuses it.
/// @return limit_exceeded with the line
[[nodiscard]] result<void> check_xml_extent(std::string_view text);

}  // namespace asperity
