#include "xml_extent.hpp"

#include <algorithm>
#include <string>

namespace asperity {
namespace {

class extent_counter {
 public:
  explicit extent_counter(std::string_view text) noexcept : text_(text) {}

  result<void> count() {
    for (at_ = text_.find('<'); at_ < text_.size(); at_ = text_.find('<', at_)) {
      start_ = at_;
      if (skipped("<!--", "-->") || skipped("<![CDATA[", "]]>") || skipped("<?", "?>") || skipped("<!", ">")) continue;
      if (const result<void> good = count_tag(); !good) return good;
    }
    return {};
  }

 private:
  /// Goes past what begins and ends so; to the end of the text where it does not end.
  bool skipped(std::string_view first, std::string_view last) noexcept {
    if (text_.substr(at_, first.size()) != first) return false;
    const std::size_t end = text_.find(last, at_ + first.size());
    at_ = end == std::string_view::npos ? text_.size() : end + last.size();
    return true;
  }

  result<void> count_tag() {
    const bool closing = text_.substr(at_, 2) == "</";
    std::size_t attributes = 0;
    char before = '<';
    for (++at_; at_ < text_.size() && text_[at_] != '>'; ++at_) {
      before = text_[at_];
      if (before != '"' && before != '\'') continue;
      if (++attributes > most_xml_attributes_of_one)
        return too_much("an element", most_xml_attributes_of_one, "attributes");
      at_ = std::min(text_.find(before, at_ + 1), text_.size() - 1);
    }
    if ((attributes_ += attributes) > most_xml_attributes) return too_much("it", most_xml_attributes, "attributes");
    if (closing) {
      levels_ -= levels_ > 0 ? 1 : 0;
      return {};
    }
    if (++elements_ > most_xml_elements) return too_much("it", most_xml_elements, "elements");
    if (before == '/') return {};
    if (++levels_ > most_xml_levels) return too_much("it", most_xml_levels, "levels of elements");
    return {};
  }

  [[nodiscard]] error too_much(const char* what, std::size_t most, const char* of) const {
    const auto line = 1 + std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(start_), '\n');
    return {error_code::limit_exceeded, "URDF, line " + std::to_string(line) + ": " + what + " has more than " +
                                            std::to_string(most) + " " + of + ", which no arm's document has"};
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t start_ = 0;  // of the present tag
  std::size_t elements_ = 0;
  std::size_t attributes_ = 0;
  std::size_t levels_ = 0;
};

}  // namespace

result<void> check_xml_extent(std::string_view text) { return extent_counter(text).count(); }

}  // namespace asperity
