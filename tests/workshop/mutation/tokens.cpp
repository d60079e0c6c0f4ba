#include "workshop/mutation/tokens.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <utility>

namespace asperity::mutation {
namespace {

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }
bool is_space(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }

// Longest first.
constexpr std::array<std::string_view, 27> long_marks{"<<=", ">>=", "<=>", "...", "->*", "::", "->", "++", "--",
                                                      "<<",  ">>",  "<=",  ">=",  "==",  "!=", "&&", "||", "+=",
                                                      "-=",  "*=",  "/=",  "%=",  "&=",  "|=", "^=", ".*", "##"};

class token_reader {
 public:
  explicit token_reader(std::string_view source) : source_(source) {}

  std::vector<token> read() {
    while (skip_unseen()) {
      const std::size_t begin = at_;
      take_one();
      out_.push_back({begin, at_, source_.substr(begin, at_ - begin)});
      line_begins_ = false;
    }
    return std::move(out_);
  }

 private:
  [[nodiscard]] char look(std::size_t ahead = 0) const {
    return at_ + ahead < source_.size() ? source_[at_ + ahead] : '\0';
  }

  void to(std::size_t found, std::size_t past) {
    at_ = found == std::string_view::npos ? source_.size() : found + past;
  }

  // White space, comments and preprocessor lines. @return whether anything follows
  bool skip_unseen() {
    while (at_ < source_.size()) {
      if (is_space(look())) {
        line_begins_ |= look() == '\n';
        ++at_;
      } else if (look() == '/' && look(1) == '/') {
        to(source_.find('\n', at_), 0);
      } else if (look() == '/' && look(1) == '*') {
        to(source_.find("*/", at_ + 2), 2);
      } else if (look() == '#' && line_begins_) {
        skip_directive();
      } else {
        return true;
      }
    }
    return false;
  }

  void skip_directive() {
    while (at_ < source_.size() && look() != '\n') at_ += look() == '\\' && look(1) == '\n' ? 2U : 1U;
  }

  void take_one() {
    const char c = look();
    if (is_letter(c)) {
      while (is_letter(look()) || is_digit(look())) ++at_;
      if (look() == '"' && source_[at_ - 1] == 'R') take_raw_text();
    } else if (is_digit(c) || (c == '.' && is_digit(look(1)))) {
      take_number();
    } else if (c == '"' || c == '\'') {
      take_text(c);
    } else {
      take_mark();
    }
  }

  void take_number() {
    while (at_ < source_.size()) {
      const char c = look();
      const bool exponent = c == 'e' || c == 'E' || c == 'p' || c == 'P';
      if (exponent && (look(1) == '+' || look(1) == '-')) {
        at_ += 2;
      } else if (is_letter(c) || is_digit(c) || c == '.') {
        ++at_;
      } else if (c == '\'' && (is_letter(look(1)) || is_digit(look(1)))) {
        ++at_;
      } else {
        break;
      }
    }
  }

  void take_text(char quote) {
    ++at_;
    while (at_ < source_.size() && look() != quote) at_ += look() == '\\' ? 2U : 1U;
    at_ = std::min(at_ + 1, source_.size());
  }

  void take_raw_text() {
    const std::size_t open = source_.find('(', at_);
    if (open == std::string_view::npos) return to(open, 0);
    const std::string close = ")" + std::string(source_.substr(at_ + 1, open - at_ - 1)) + "\"";
    to(source_.find(close, open), close.size());
  }

  void take_mark() {
    for (const std::string_view mark : long_marks) {
      if (source_.substr(at_, mark.size()) == mark) {
        at_ += mark.size();
        return;
      }
    }
    ++at_;
  }

  std::string_view source_;
  std::size_t at_ = 0;
  bool line_begins_ = true;
  std::vector<token> out_;
};

}  // namespace

std::vector<token> tokens_of(std::string_view source) { return token_reader(source).read(); }

bool is_word(std::string_view text) { return !text.empty() && is_letter(text.front()); }

std::size_t closing(const std::vector<token>& tokens, std::size_t open) {
  int depth = 0;
  for (std::size_t i = open; i < tokens.size(); ++i) {
    const std::string_view t = tokens[i].text;
    if (t == "(" || t == "[" || t == "{") ++depth;
    if ((t == ")" || t == "]" || t == "}") && --depth == 0) return i;
  }
  return tokens.size();
}

}  // namespace asperity::mutation
