#include "workshop/mutation/scopes.hpp"

#include <optional>
#include <string_view>

namespace asperity::mutation {
namespace {

class finder {
 public:
  explicit finder(const std::vector<token>& tokens) : tokens_(&tokens) {}

  std::vector<scope> find() {
    block(0, tokens_->size(), "");
    return std::move(found_);
  }

 private:
  [[nodiscard]] std::string_view text(std::size_t i) const {
    return i < tokens_->size() ? (*tokens_)[i].text : std::string_view();
  }
  [[nodiscard]] bool is_one_of(std::size_t i, std::initializer_list<std::string_view> words) const {
    for (const std::string_view w : words) {
      if (text(i) == w) return true;
    }
    return false;
  }

  // The declarations between two tokens, of a file, a namespace or a class.
  void block(std::size_t begin, std::size_t end, const std::string& prefix) {
    std::size_t head = begin;
    for (std::size_t i = begin; i < end; ++i) {
      if (text(i) == ";") {
        head = i + 1;
      } else if (text(i) == ":" && i > begin && is_one_of(i - 1, {"public", "private", "protected"})) {
        head = i + 1;
      } else if (text(i) == "(" || text(i) == "[") {
        i = closing(*tokens_, i);
      } else if (text(i) == "{") {
        const std::size_t close = closing(*tokens_, i);
        if (opened(head, i, close, prefix)) head = close + 1;
        i = close;
      }
    }
  }

  // What a { opens whose declaration began at `head`. @return whether the } ends the declaration
  bool opened(std::size_t head, std::size_t open, std::size_t close, const std::string& prefix) {
    const std::size_t first = after_template(head);
    if (is_one_of(first, {"namespace", "inline"}) && (text(first) == "namespace" || text(first + 1) == "namespace")) {
      block(open + 1, close, prefix + namespace_name(first, open));
      return true;
    }
    if (text(first) == "extern" && open == first + 2) {
      block(open + 1, close, prefix);
      return true;
    }
    if (is_one_of(first, {"class", "struct", "union"})) {
      const std::string name = prefix + class_name(first + 1, open);
      found_.push_back({name, true, head, open, close});
      block(open + 1, close, name + "::");
      return true;
    }
    const std::optional<std::string> name = function_name(head, open);
    if (!name) return false;
    found_.push_back({prefix + *name, false, head, open, close});
    return true;
  }

  [[nodiscard]] std::size_t after_template(std::size_t i) const {
    while (text(i) == "template" && text(i + 1) == "<") {
      int depth = 0;
      for (++i; i < tokens_->size(); ++i) {
        if (text(i) == "(") i = closing(*tokens_, i);
        if (text(i) == "<") ++depth;
        if (text(i) == ">") --depth;
        if (text(i) == ">>") depth -= 2;
        if (depth <= 0) break;
      }
      ++i;
    }
    return i;
  }

  [[nodiscard]] std::string namespace_name(std::size_t i, std::size_t open) const {
    std::string name;
    for (; i < open; ++i) {
      if (!is_one_of(i, {"inline", "namespace"})) name += text(i);
    }
    return (name.empty() ? "(unnamed)" : name) + "::";
  }

  // The last word before what a class begins with: words in front of it are macros, which say what a library shows.
  [[nodiscard]] std::string class_name(std::size_t i, std::size_t open) const {
    for (; i < open; ++i) {
      if (text(i) == "[" || text(i) == "(") {
        i = closing(*tokens_, i);
      } else if (is_word(text(i)) && text(i) != "alignas" && (!is_word(text(i + 1)) || text(i + 1) == "final")) {
        return std::string(text(i));
      }
    }
    return "(unnamed)";
  }

  // The name before the parameters; nothing where the { is an initialiser's.
  [[nodiscard]] std::optional<std::string> function_name(std::size_t head, std::size_t open) const {
    for (std::size_t i = after_template(head); i < open; ++i) {
      if (text(i) == "[") {
        i = closing(*tokens_, i);
      } else if (text(i) == "operator") {
        std::size_t parameters = i + 1;
        while (parameters < open && (text(parameters) != "(" || text(parameters + 1) == ")")) {
          parameters += text(parameters) == "(" ? 2U : 1U;
          if (text(parameters) == "(") break;
        }
        std::string name;
        for (std::size_t k = i; k < parameters; ++k) name += text(k);
        return is_body(parameters, open) ? std::optional(name) : std::nullopt;
      } else if (text(i) == "=") {
        return std::nullopt;
      } else if (text(i) == "(") {
        if (i > head && is_word(text(i - 1)) &&
            !is_one_of(i - 1, {"alignas", "decltype", "explicit", "requires", "noexcept"})) {
          return is_body(i, open) ? std::optional(qualified(i - 1, head)) : std::nullopt;
        }
        i = closing(*tokens_, i);
      }
    }
    return std::nullopt;
  }

  // "a::b" or "~b", of which `last` is the last token.
  [[nodiscard]] std::string qualified(std::size_t last, std::size_t head) const {
    std::string name(text(last));
    std::size_t i = last;
    if (i > head && text(i - 1) == "~") name = "~" + name, --i;
    while (i >= head + 2 && text(i - 1) == "::" && is_word(text(i - 2))) {
      name = std::string(text(i - 2)) + "::" + name;
      i -= 2;
    }
    return name;
  }

  // Not where the { initialises a member: there is a : after the parameters, and a name before the {.
  [[nodiscard]] bool is_body(std::size_t parameters, std::size_t open) const {
    for (std::size_t i = closing(*tokens_, parameters); i < open; ++i) {
      if (text(i) == ":") return !is_word(text(open - 1)) && text(open - 1) != ">";
    }
    return true;
  }

  const std::vector<token>* tokens_;
  std::vector<scope> found_;
};

}  // namespace

std::vector<scope> scopes_of(const std::vector<token>& tokens) { return finder(tokens).find(); }

bool names(const std::string& wanted, const std::string& name) {
  if (name == wanted) return true;
  return name.size() > wanted.size() + 2 && name.ends_with(wanted) &&
         name.substr(name.size() - wanted.size() - 2, 2) == "::";
}

}  // namespace asperity::mutation
