// The tokens of a C++ source: what is left of it without comments, preprocessor lines and white space.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace asperity::mutation {

struct token {
  std::size_t begin = 0;  ///< of its first character in the source
  std::size_t end = 0;
  std::string_view text;  ///< a view of the source, which outlives it
};

/// Strings, character constants and numbers with their digit separators are one token each.
[[nodiscard]] std::vector<token> tokens_of(std::string_view source);

[[nodiscard]] bool is_word(std::string_view text);

/// The token that closes the bracket at `open`: one of ( [ {. The number of tokens where nothing closes it.
[[nodiscard]] std::size_t closing(const std::vector<token>& tokens, std::size_t open);

}  // namespace asperity::mutation
