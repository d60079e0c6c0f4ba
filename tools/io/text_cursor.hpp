// Walks over a text file token by token and knows the line it is on.
#pragma once

#include <charconv>
#include <cstddef>
#include <string>
#include <string_view>
#include <system_error>

namespace asperity::io {

/// @pre the text outlives the cursor
class text_cursor {
 public:
  explicit text_cursor(std::string_view text, std::size_t line = 1) noexcept
      : at_(text.data()), end_(text.data() + text.size()), line_(line) {}

  [[nodiscard]] std::size_t line() const noexcept { return line_; }
  [[nodiscard]] std::string place() const { return "line " + std::to_string(line_); }
  [[nodiscard]] std::size_t left() const noexcept { return static_cast<std::size_t>(end_ - at_); }

  /// The next word of this line; empty at the end of the line.
  std::string_view word() noexcept {
    skip_blanks();
    const char* first = at_;
    while (at_ != end_ && !is_blank(*at_) && *at_ != '\n') ++at_;
    return {first, static_cast<std::size_t>(at_ - first)};
  }

  /// The next word of this line or of those that follow; empty at the end of the text.
  std::string_view word_anywhere() noexcept {
    for (;;) {
      const std::string_view w = word();
      if (!w.empty() || !next_line()) return w;
    }
  }

  /// Goes to the start of the next line; false at the end of the text.
  bool next_line() noexcept {
    while (at_ != end_ && *at_ != '\n') ++at_;
    if (at_ == end_) return false;
    ++at_;
    ++line_;
    return true;
  }

 private:
  static bool is_blank(char c) noexcept { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

  void skip_blanks() noexcept {
    for (;;) {
      while (at_ != end_ && is_blank(*at_)) ++at_;
      // A backslash at the end of a line carries it on (OBJ).
      if (at_ == end_ || *at_ != '\\') return;
      const char* next = at_ + 1;
      if (next != end_ && *next == '\r') ++next;
      if (next == end_ || *next != '\n') return;
      at_ = next + 1;
      ++line_;
    }
  }

  const char* at_;
  const char* end_;
  std::size_t line_;
};

/// Number in a word, the whole word; false otherwise. A leading plus sign is allowed.
template <class T>
[[nodiscard]] bool to_number(std::string_view word, T& value) noexcept {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  const auto [end, ec] = std::from_chars(word.data(), word.data() + word.size(), value);
  return ec == std::errc{} && end == word.data() + word.size();
}

}  // namespace asperity::io
