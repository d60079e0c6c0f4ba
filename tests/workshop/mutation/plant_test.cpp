// Functions are found whatever stands around them, and what no longer fits is refused.
#include "workshop/mutation/plant.hpp"

#include <gtest/gtest.h>
#include <string>
#include <utility>
#include <vector>

#include "workshop/mutation/catalogue.hpp"
#include "workshop/mutation/scopes.hpp"
#include "workshop/mutation/tokens.hpp"
#include "workshop/mutation/trial.hpp"

namespace {

using namespace asperity;
using namespace asperity::mutation;

const std::string sample = R"source(
#include "a.hpp"
#define TWO(x) \
  void hidden() { x; }
namespace outer::inner { namespace {
// void commented() { return; }
struct limits { double peak = 10'000.0; int hold{20}; };
template <class T, int n = (3 > 2)>
class SHOWN box final : public base<T> {
 public:
  explicit box(int a, double b) : a_(a), b_{b}, c_(f({1, 2})) { if (a > 0) a_ = min(a, max(b, 1)); }
  ~box() { close(); }
  bool operator()(int x) const noexcept { return x < a_; }
  bool operator==(const box& o) const { return a_ == o.a_; }
  auto text() -> const char* { return "}" R"x(")})x"; }
 private:
  int a_ = 'x';
};
}  // namespace
inline constexpr auto lambda = [](int x) { return x; };
[[nodiscard]] int twice(int x) { return x + x; }
int twice(double x) {
  int sum = 0;
  for (int i = 0; i < 2; ++i) { sum += static_cast<int>(x); }
  if (sum > 3) { sum = 3; } else { sum = 0; }
  while (sum > 9) --sum;
  return sum;  // sum += 1
}
}  // namespace outer::inner
void outer::inner::thing::act() const { go(1, 2); }
extern "C" { int plain(void) { return 1; } }
)source";

std::string planted(const std::string& in, const std::string& operation) {
  const result<std::string> out = plant(sample, {"b", "room", "file", {"t"}, {{in, operation}}});
  return out ? *out : "error: " + out.error().message;
}

// What is new in a text that differs from the sample in one place.
std::string difference(const std::string& text) {
  std::size_t begin = 0;
  while (begin < sample.size() && begin < text.size() && sample[begin] == text[begin]) ++begin;
  std::size_t end = 0;
  while (begin + end < sample.size() && begin + end < text.size() &&
         sample[sample.size() - 1 - end] == text[text.size() - 1 - end]) {
    ++end;
  }
  return sample.substr(begin, sample.size() - begin - end) + " -> " + text.substr(begin, text.size() - begin - end);
}

TEST(scopes, are_found_with_their_names) {
  const std::vector<token> tokens = tokens_of(sample);
  std::vector<std::string> names;
  for (const scope& s : scopes_of(tokens)) {
    names.push_back((s.is_class ? "class " : "") + s.name);
    EXPECT_EQ(tokens[s.open].text, "{") << s.name;
    EXPECT_EQ(tokens[s.close].text, "}") << s.name;
  }
  const std::string box = "outer::inner::(unnamed)::box";
  EXPECT_EQ(names, (std::vector<std::string>{"class outer::inner::(unnamed)::limits", "class " + box, box + "::box",
                                             box + "::~box", box + "::operator()", box + "::operator==", box + "::text",
                                             "outer::inner::twice", "outer::inner::twice", "outer::inner::thing::act",
                                             "plain"}));
}

TEST(plant, does_what_it_is_told) {
  EXPECT_EQ(difference(planted("class limits", "change peak = 10'000.0 => peak = 0.0")), "10'00 -> ");
  EXPECT_EQ(difference(planted("box::operator()", "change < => <=")), " -> =");
  EXPECT_EQ(difference(planted("box::operator==", "body return false;")), "a_ == o.a_ -> false");
  EXPECT_EQ(difference(planted("box::box", "change c_(f({1, 2})) => c_(0)")), "f({1, 2}) -> 0");
  EXPECT_EQ(difference(planted("box::box", "negate a > 0")), "a > 0 -> !(a > 0)");
  EXPECT_EQ(difference(planted("box::box", "swap min 1 2")), "a, max(b, 1) -> max(b, 1), a");
  EXPECT_EQ(difference(planted("~box", "drop close()")), "close() -> ");
  EXPECT_EQ(difference(planted("twice #2", "drop for")),
            "for (int i = 0; i < 2; ++i) { sum += static_cast<int>(x); } -> ;");
  EXPECT_EQ(difference(planted("twice #2", "drop if")), "if (sum > 3) { sum = 3; } else { sum = 0; } -> ;");
  EXPECT_EQ(difference(planted("twice #2", "change sum = 0 #2 => sum = 1")), "0 -> 1");
  EXPECT_EQ(difference(planted("twice #1", "change x + x => x")), " + x -> ");
  EXPECT_EQ(difference(planted("thing::act", "swap go 1 2")), "1, 2 -> 2, 1");
}

TEST(plant, refuses_what_does_not_fit) {
  const auto refused = [](const std::string& in, const std::string& operation, const std::string& why) {
    const std::string answer = planted(in, operation);
    EXPECT_NE(answer.find("error: file: the bug 'b' cannot be planted: "), std::string::npos) << operation;
    EXPECT_NE(answer.find(why), std::string::npos) << answer;
  };
  refused("twice", "body return 0;", "the function 'twice' is there 2 times");
  refused("twice #3", "body return 0;", "there only 2 times");
  refused("wice", "body return 0;", "the function 'wice' is not there");
  refused("hidden", "body return 0;", "is not there");
  refused("commented", "body return;", "is not there");
  refused("lambda", "body return 0;", "is not there");
  refused("twice #2", "change sum = 0 => sum = 1", "is there 2 times");
  refused("twice #2", "change sum += 1 => sum += 2", "is not there");  // in a comment only
  refused("twice #1", "change x + x => x + x", "it changes nothing");
  refused("twice #2", "negate sum", "is there");
  refused("twice #2", "negate sum > 33", "is not there");
  refused("twice #1", "negate x + x", "is not the whole condition");
  refused("twice #1", "drop x + x", "no statement begins with");
  refused("thing::act", "swap go 1 3", "has no argument 3");
  refused("thing::act", "turn go", "there is no operation 'turn'");
  refused("class limits", "body return;", "a class has no body");
}

TEST(catalogue, names_the_line_of_a_fault) {
  const auto fault = [](const std::string& text) {
    const result<std::vector<bug>> bugs = read_catalogue(text, "list");
    return bugs ? std::string("none") : bugs.error().message;
  };
  const std::string head = "# a comment\nroom r\nfile f\ntests t u\n";
  EXPECT_EQ(fault(head + "bug a\n in f\n drop g\n"), "none");
  EXPECT_EQ(fault(head + "bug a\n in f\n"), "list:6: the bug 'a' has no room, file, tests or change");
  EXPECT_EQ(fault("bug a\n in f\n drop g\n"), "list:3: the bug 'a' has no room, file, tests or change");
  EXPECT_EQ(fault(head + "drop g\n"), "list:5: 'drop' stands in front of every bug");
  EXPECT_EQ(fault(head + "bug a\n drop g\n"), "list:6: 'drop' of the bug 'a' needs an 'in FUNCTION' in front of it");
  EXPECT_EQ(fault(head + "bug a\n in f\n drop g\nbug a\n"), "list:8: there are two bugs 'a'");
  EXPECT_EQ(fault(head + "bug\n"), "list:5: 'bug' has nothing behind it");
}

// The list fits the sources: every bug's function and element is there, and planting it changes the text.
TEST(catalogue, can_be_planted_in_the_sources_as_they_are) {
  const std::string root = ASPERITY_SOURCE_DIR;
  for (const auto& [folder, least] :
       {std::pair{"/tests/workshop/mutation/catalogue", 60U}, {"/tests/session/simulation/catalogue", 8U}}) {
    const result<std::vector<bug>> bugs = read_catalogues(root + folder);
    ASSERT_TRUE(bugs) << bugs.error().message;
    EXPECT_GE(bugs->size(), least);
    for (const bug& b : *bugs) {
      const result<std::string> source = read_text(root + '/' + b.file);
      ASSERT_TRUE(source) << source.error().message;
      const result<std::string> broken = plant(*source, b);
      EXPECT_TRUE(broken) << broken.error().message;
      if (broken) {
        EXPECT_NE(*broken, *source) << b.name;
      }
    }
  }
}

}  // namespace
