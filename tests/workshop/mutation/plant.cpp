#include "workshop/mutation/plant.hpp"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <string_view>
#include <vector>

#include "workshop/mutation/scopes.hpp"
#include "workshop/mutation/tokens.hpp"

namespace asperity::mutation {
namespace {

struct replacement {
  std::size_t begin = 0;  // in the source
  std::size_t end = 0;
  std::string text;
};

// "TEXT #2": the text and which of its kind. 0: the only one.
struct choice {
  std::string text;
  std::size_t nth = 0;
};

choice chosen(std::string text) {
  const std::size_t hash = text.rfind(" #");
  if (hash == std::string::npos) return {std::move(text), 0};
  std::size_t nth = 0;
  const char* const end = text.data() + text.size();
  const auto [read, failed] = std::from_chars(text.data() + hash + 2, end, nth);
  if (failed != std::errc() || read != end || nth == 0) return {std::move(text), 0};
  text.resize(text.find_last_not_of(' ', hash) + 1);
  return {std::move(text), nth};
}

class planter {
 public:
  planter(const std::string& source, const bug& what)
      : source_(&source), what_(&what), tokens_(tokens_of(source)), scopes_(scopes_of(tokens_)) {}

  result<std::string> plant() {
    for (const edit& e : what_->edits) {
      const result<void> done = one(e);
      if (!done) return done.error();
    }
    std::sort(made_.begin(), made_.end(), [](const auto& a, const auto& b) { return a.begin < b.begin; });
    std::string out;
    std::size_t at = 0;
    for (const replacement& r : made_) {
      if (r.begin < at) return fault("two of its changes overlap");
      out += source_->substr(at, r.begin - at) + r.text;
      at = r.end;
    }
    out += source_->substr(at);
    if (out == *source_) return fault("it changes nothing");
    return out;
  }

 private:
  using span = std::pair<std::size_t, std::size_t>;  // tokens: first, one past the last

  result<void> one(const edit& e) {
    const result<scope> found = find_scope(e.in);
    if (!found) return found.error();
    const scope& s = *found;
    const std::size_t space = std::min(e.operation.find(' '), e.operation.size());
    const std::string verb = e.operation.substr(0, space);
    std::string rest = e.operation.substr(std::min(space + 1, e.operation.size()));
    if (verb == "body") {
      if (s.is_class) return fault("a class has no body to replace");
      replace({s.open, s.close + 1}, "{ " + rest + " }");
      return {};
    }
    if (verb == "change") return change(s, rest);
    if (verb == "negate") return negate(s, chosen(rest));
    if (verb == "drop") return drop(s, chosen(rest));
    if (verb == "swap") return swap(s, chosen(rest));
    return fault("there is no operation '" + verb + "'");
  }

  result<scope> find_scope(const std::string& in) {
    choice wanted = chosen(in);
    const bool is_class = wanted.text.starts_with("class ");
    if (is_class) wanted.text.erase(0, 6);
    std::vector<scope> found;
    for (const scope& s : scopes_) {
      if (s.is_class == is_class && names(wanted.text, s.name)) found.push_back(s);
    }
    const result<std::size_t> i = pick(found.size(), wanted, is_class ? "class" : "function");
    if (!i) return i.error();
    return found[*i];
  }

  result<std::size_t> pick(std::size_t count, const choice& wanted, const std::string& kind) const {
    const std::string what = "the " + kind + " '" + wanted.text + "'";
    if (count == 0) return fault(what + " is not there");
    if (wanted.nth > count) return fault(what + " is there only " + std::to_string(count) + " times");
    if (wanted.nth == 0 && count > 1) {
      return fault(what + " is there " + std::to_string(count) + " times; say which: '#1' at its end");
    }
    return wanted.nth == 0 ? 0 : wanted.nth - 1;
  }

  // Where the tokens of `text` stand in a scope.
  result<span> find(const scope& s, const choice& wanted, const std::string& kind) const {
    const std::vector<token> pattern = tokens_of(wanted.text);
    if (pattern.empty()) return fault("a change names no " + kind);
    std::vector<span> found;
    for (std::size_t i = s.head; i + pattern.size() <= s.close + 1; ++i) {
      bool same = true;
      for (std::size_t k = 0; same && k < pattern.size(); ++k) same = tokens_[i + k].text == pattern[k].text;
      if (same) found.emplace_back(i, i + pattern.size());
    }
    const result<std::size_t> i = pick(found.size(), wanted, kind);
    if (!i) return error{i.error().code, i.error().message + " (in " + s.name + ")"};
    return found[*i];
  }

  result<void> change(const scope& s, const std::string& rest) {
    const std::size_t arrow = rest.find("=>");
    if (arrow == std::string::npos) return fault("'change' needs a =>");
    std::string before = rest.substr(0, arrow);
    before.resize(before.find_last_not_of(' ') + 1);
    const result<span> at = find(s, chosen(before), "text");
    if (!at) return at.error();
    replace(*at, rest.substr(std::min(rest.find_first_not_of(' ', arrow + 2), rest.size())));
    return {};
  }

  result<void> negate(const scope& s, const choice& wanted) {
    const result<span> at = find(s, wanted, "condition");
    if (!at) return at.error();
    const auto [begin, end] = *at;
    const std::string_view keyword = begin >= 2 ? tokens_[begin - 2].text : std::string_view();
    if (tokens_[begin - 1].text != "(" || (keyword != "if" && keyword != "while" && keyword != "constexpr") ||
        closing(tokens_, begin - 1) != end) {
      return fault("'" + wanted.text + "' is not the whole condition of an if or a while (in " + s.name + ")");
    }
    replace(*at, "!(" + text(*at) + ")");
    return {};
  }

  result<void> drop(const scope& s, const choice& wanted) {
    const result<span> at = find(s, wanted, "statement");
    if (!at) return at.error();
    const std::string_view before = tokens_[at->first - 1].text;
    if (before != ";" && before != "{" && before != "}" && before != ")" && before != ":" && before != "else") {
      return fault("no statement begins with '" + wanted.text + "' (in " + s.name + ")");
    }
    replace({at->first, statement_end(at->first)}, ";");
    return {};
  }

  [[nodiscard]] std::size_t statement_end(std::size_t i) const {
    const std::string_view first = tokens_[i].text;
    const bool compound = first == "if" || first == "for" || first == "while" || first == "switch" || first == "{";
    for (; i < tokens_.size(); ++i) {
      const std::string_view t = tokens_[i].text;
      bool ends = t == ";";
      if (t == "(" || t == "[" || t == "{") {
        i = closing(tokens_, i);
        ends = compound && t == "{";
      }
      if (ends && !(compound && i + 1 < tokens_.size() && tokens_[i + 1].text == "else")) return i + 1;
    }
    return i;
  }

  // "NAME I J"
  result<void> swap(const scope& s, choice wanted) {
    std::size_t numbers[2] = {};
    for (const int which : {1, 0}) {
      const std::size_t space = wanted.text.rfind(' ');
      if (space == std::string::npos) return fault("'swap' needs a name and two numbers of arguments");
      std::from_chars(wanted.text.data() + space + 1, wanted.text.data() + wanted.text.size(), numbers[which]);
      wanted.text.resize(space);
    }
    wanted.text += " (";
    const result<span> at = find(s, wanted, "call");
    if (!at) return at.error();
    const std::size_t open = at->second - 1;
    const std::size_t close = closing(tokens_, open);
    std::vector<span> arguments{{open + 1, open + 1}};
    for (std::size_t i = open + 1; i <= close; ++i) {
      const std::string_view t = tokens_[i].text;
      if (t == "(" || t == "[" || t == "{") i = closing(tokens_, i);
      if (t == "," || i == close) {
        arguments.back().second = i;
        if (i < close) arguments.emplace_back(i + 1, i + 1);
      }
    }
    for (const std::size_t n : numbers) {
      if (n == 0 || n > arguments.size()) return fault("'" + wanted.text + "' has no argument " + std::to_string(n));
    }
    replace(arguments[numbers[0] - 1], text(arguments[numbers[1] - 1]));
    replace(arguments[numbers[1] - 1], text(arguments[numbers[0] - 1]));
    return {};
  }

  [[nodiscard]] std::string text(span s) const {
    return source_->substr(tokens_[s.first].begin, tokens_[s.second - 1].end - tokens_[s.first].begin);
  }

  void replace(span s, std::string with) {
    made_.push_back({tokens_[s.first].begin, tokens_[s.second - 1].end, std::move(with)});
  }

  [[nodiscard]] error fault(const std::string& problem) const {
    return {error_code::bad_format, what_->file + ": the bug '" + what_->name + "' cannot be planted: " + problem};
  }

  const std::string* source_;
  const bug* what_;
  std::vector<token> tokens_;
  std::vector<scope> scopes_;
  std::vector<replacement> made_;
};

}  // namespace

result<std::string> plant(const std::string& source, const bug& what) { return planter(source, what).plant(); }

}  // namespace asperity::mutation
