// Makes text from outside safe to print: names in files and of devices, paths, messages of libraries.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace asperity {

namespace printable_detail {

struct character {
  char32_t code = 0;
  std::size_t bytes = 0;  // 0: the text does not begin with a character of UTF-8
};

/// The first character of a text that is not empty. Overlong forms and surrogates are not accepted.
[[nodiscard]] inline character first_of(std::string_view text) noexcept {
  const auto byte = [&](std::size_t i) { return static_cast<char32_t>(static_cast<unsigned char>(text[i])); };
  const char32_t first = byte(0);
  if (first < 0x80) return {first, 1};
  const std::size_t bytes = first >= 0xc2 && first < 0xe0 ? 2
                            : (first & 0xf0U) == 0xe0     ? 3
                            : (first & 0xf8U) == 0xf0     ? 4
                                                          : 0;
  if (bytes == 0 || text.size() < bytes) return {};
  char32_t code = first & (0x7fU >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xc0U) != 0x80) return {};
    code = code << 6U | (byte(i) & 0x3fU);
  }
  const bool overlong = (bytes == 3 && code < 0x800) || (bytes == 4 && code < 0x10000);
  const bool surrogate = code >= 0xd800 && code < 0xe000;
  return overlong || surrogate || code > 0x10ffff ? character{} : character{code, bytes};
}

/// What a terminal acts on instead of showing it, or shows in another place or not at all: control characters (C0, C1),
/// line and paragraph separators, marks, embeddings, overrides and isolates of writing direction, invisible tags.
[[nodiscard]] inline bool is_hidden(char32_t c) noexcept {
  return c < 0x20 || (c >= 0x7f && c < 0xa0) || c == 0x061c || c == 0x200e || c == 0x200f ||
         (c >= 0x2028 && c <= 0x202e) || (c >= 0x2066 && c <= 0x2069) || c == 0xfeff || (c >= 0xfff9 && c <= 0xfffb) ||
         (c >= 0xe0000 && c <= 0xe007f);
}

inline void append_hexadecimal(std::string& to, char32_t value, std::size_t least_digits) {
  std::string digits;
  for (; value != 0 || digits.size() < least_digits; value >>= 4U)
    digits.insert(0, 1, "0123456789abcdef"[value & 0xfU]);
  to += digits;
}

inline void append_escaped(std::string& to, char32_t code) {
  if (code == '\n' || code == '\r' || code == '\t') {
    to += code == '\n' ? "\\n" : code == '\r' ? "\\r" : "\\t";
  } else if (code < 0x80) {
    append_hexadecimal(to += "\\x", code, 2);
  } else {
    append_hexadecimal(to += "\\u{", code, 4);
    to += '}';
  }
}

}  // namespace printable_detail

/// The text as one line of valid UTF-8 that no terminal acts on: control characters become \n, \r, \t or \x1b, bytes
/// that are not UTF-8 become \xff, and characters that are invisible or turn the direction of writing become \u{202e}.
/// The rest stays as it is. A backslash does too, so an escape cannot be told from the same characters in the text: the
/// line is for people.
/// @param keep a control character that stays, such as the line end of a text of several lines; 0: none
[[nodiscard]] inline std::string printable(std::string_view text, char keep = '\0') {
  using namespace printable_detail;
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const auto [code, bytes] = first_of(text);
    if (bytes == 0) {
      append_hexadecimal(out += "\\x", static_cast<unsigned char>(text[0]), 2);
    } else if (is_hidden(code) && (keep == '\0' || text[0] != keep)) {
      append_escaped(out, code);
    } else {
      out += text.substr(0, bytes);
    }
    text.remove_prefix(bytes == 0 ? 1 : bytes);
  }
  return out;
}

}  // namespace asperity
