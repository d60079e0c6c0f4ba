// Walks over a text file token by token and knows the line it is on.
#pragma once

#include <charconv>
#include <cstddef>
#include <string>
#include <string_view>
#include <system_error>

#include "reading_watch.hpp"

namespace asperity::io {

/// Asks whether to go on at each line, and within a line of any length.
/// @pre the text and the watch outlive the cursor
class text_cursor {
 public:
  text_cursor(std::string_view text, reading_watch& watch, std::size_t line = 1) noexcept
      : at_(text.data()), end_(text.data() + text.size()), line_(line), watch_(&watch) {}

  [[nodiscard]] std::size_t line() const noexcept { return line_; }
  [[nodiscard]] std::string place() const { return "line " + std::to_string(line_); }
  [[nodiscard]] std::size_t left() const noexcept { return static_cast<std::size_t>(end_ - at_); }

  /// The next word of this line; empty at the end of the line.
  std::string_view word() {
    skip_blanks();
    const char* first = at_;
    skip([](char c) { return !is_blank(c) && c != '\n'; });
    return {first, static_cast<std::size_t>(at_ - first)};
  }

  /// The next word of this line or of those that follow; empty at the end of the text.
  std::string_view word_anywhere() {
    for (;;) {
      const std::string_view w = word();
      if (!w.empty() || !next_line()) return w;
    }
  }

  /// Goes to the start of the next line; false at the end of the text.
  bool next_line() {
    watch_->step();
    skip([](char c) { return c != '\n'; });
    if (at_ == end_) return false;
    ++at_;
    ++line_;
    return true;
  }

 private:
  static bool is_blank(char c) noexcept { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

  /// Goes on while the characters are of a kind.
  template <class Kind>
  void skip(const Kind& is_of_kind) {
    constexpr std::ptrdiff_t at_a_time = 1 << 20;
    for (;;) {
      const char* const stop = end_ - at_ > at_a_time ? at_ + at_a_time : end_;
      while (at_ != stop && is_of_kind(*at_)) ++at_;
      if (at_ != stop || at_ == end_) return;
      watch_->ask();
    }
  }

  void skip_blanks() {
    for (;;) {
      skip(is_blank);
      // A backslash at the end of a line carries it on (OBJ).
      if (at_ == end_ || *at_ != '\\') return;
      const char* next = at_ + 1;
      if (next != end_ && *next == '\r') ++next;
      if (next == end_ || *next != '\n') return;
      at_ = next + 1;
      ++line_;
      watch_->step();
    }
  }

  const char* at_;
  const char* end_;
  std::size_t line_;
  reading_watch* watch_;
};

/// Number in a word, the whole word; false otherwise. A leading plus sign is allowed.
template <class T>
[[nodiscard]] bool to_number(std::string_view word, T& value) noexcept {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  const auto [end, ec] = std::from_chars(word.data(), word.data() + word.size(), value);
  return ec == std::errc{} && end == word.data() + word.size();
}

}  // namespace asperity::io
