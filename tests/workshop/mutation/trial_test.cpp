// Trials of a source of ten lines and one test of it: what is caught, what survives, what cannot be built.
#include "workshop/mutation/trial.hpp"

#include <filesystem>
#include <gtest/gtest.h>
#include <string>
#include <unistd.h>

#include "workshop/mutation/ledger.hpp"

namespace {

using namespace asperity;
using namespace asperity::mutation;
namespace fs = std::filesystem;

// The test looks at one branch of two.
const std::string source = R"(
inline int larger(int a, int b) {
  if (a > b) return a;
  return b;
}
)";
const std::string test = R"text(
#include "larger.hpp"
#include <cstdio>
int main() {
  if (larger(2, 1) == 2) return 0;
  std::puts("[  FAILED  ] larger.first (0 ms)");
return 1;
}
)text";

struct trial_test : testing::Test {
  trial_test() : place(fs::temp_directory_path() / ("asperity-trial-" + std::to_string(getpid()))) {
    fs::create_directories(place / "build");
    EXPECT_TRUE(write_text(place / "larger.hpp", source));
    EXPECT_TRUE(write_text(place / "quick.cpp", test));
    shop.source = place;
    shop.build = place / "build";
    shop.build_command = ASPERITY_CXX_COMPILER " -I{source} {source}/{test}.cpp -o {build}/{test}";
    shop.run_command = "{build}/{test}";
    shop.run_limit_s = 1;
  }
  ~trial_test() override { fs::remove_all(place); }

  result<outcome> attempt(const std::string& operation) {
    return try_bug(shop, {"b", "r", "larger.hpp", {"quick"}, {{"larger", operation}}});
  }

  fs::path place;
  workshop shop;
};

TEST_F(trial_test, tells_the_caught_from_the_survivors) {
  EXPECT_TRUE(try_sound(shop, "quick"));

  const result<outcome> caught = attempt("negate a > b");
  ASSERT_TRUE(caught) << caught.error().message;
  EXPECT_EQ(caught->answer, verdict::caught);
  EXPECT_EQ(caught->test, "quick");
  EXPECT_EQ(caught->how, "larger.first");

  const result<outcome> survivor = attempt("change return b => return a");
  ASSERT_TRUE(survivor) << survivor.error().message;
  EXPECT_EQ(survivor->answer, verdict::survived);

  const result<outcome> hangs = attempt("change if => while (true) if");
  const result<outcome> hanging = attempt("body for (;;) {}");
  ASSERT_TRUE(hangs && hanging);
  EXPECT_EQ(hangs->answer, verdict::survived);  // it returns from the loop
  EXPECT_EQ(hanging->answer, verdict::caught);
  EXPECT_EQ(hanging->how, "time-out");

  const result<outcome> not_built = attempt("change return b => return nothing");
  ASSERT_TRUE(not_built);
  EXPECT_EQ(not_built->answer, verdict::not_built);
  EXPECT_EQ(*read_text(place / "larger.hpp"), source);  // whole again

  EXPECT_FALSE(attempt("negate a < b"));
  const std::string all = totals({{{}, *caught}, {{}, *survivor}, {{}, *hanging}, {{}, *not_built}});
  EXPECT_EQ(all, "4 bugs: 2 caught, 1 survived, 1 not built");
}

TEST_F(trial_test, takes_no_test_that_fails_or_is_missing_for_a_judge) {
  EXPECT_TRUE(write_text(place / "failing.cpp", "int main() { return 1; }\n"));
  EXPECT_FALSE(try_sound(shop, "failing"));
  EXPECT_FALSE(try_sound(shop, "missing"));
  shop.run_command = "{build}/no-such-program";
  EXPECT_FALSE(attempt("negate a > b"));
}

TEST_F(trial_test, keeps_what_became_of_a_bug_as_long_as_it_is_the_same) {
  const fs::path file = place / "results.tsv";
  {
    ledger book(file);
    EXPECT_EQ(book.find("a", "1"), nullptr);
    EXPECT_TRUE(book.add("a", "1", {verdict::survived, "", "", 1.5}));
    EXPECT_TRUE(book.add("a", "2", {verdict::caught, "hal_test", "gate.case", 2.5}));
  }
  const ledger again(file);
  EXPECT_EQ(again.find("a", "1"), nullptr);
  const outcome* const kept = again.find("a", "2");
  ASSERT_NE(kept, nullptr);
  EXPECT_EQ(kept->answer, verdict::caught);
  EXPECT_EQ(kept->test, "hal_test");
  EXPECT_EQ(kept->how, "gate.case");
  EXPECT_EQ(kept->seconds, 2.5);
}

}  // namespace
