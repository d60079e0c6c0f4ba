// The report: all of it in one file.
#include <filesystem>
#include <gtest/gtest.h>
#include <set>
#include <string>
#include <vector>

#include "some_findings.hpp"
#include "unit/io/scratch_folder.hpp"

namespace asperity::experiment {
namespace {

class page : public testing::Test {
 protected:
  [[nodiscard]] std::string written(const page_facts& facts = {"1.2.3", "a <machine>", false, {}}) const {
    const std::vector<published> all{{&made_up, some_findings()}, {&other, some_findings()}};
    const result<void> done = write_page(all, facts, out_.path());
    EXPECT_TRUE(done);
    return bytes_of(out_.path() / "index.html");
  }

  static constexpr experiment other{"other", "Another", "It differs.", nullptr};
  test_support::scratch_folder out_;
};

TEST_F(page, needs_nothing_else) {
  const std::string html = written();
  EXPECT_EQ(html.rfind("<!doctype html>", 0), 0U);
  for (const char* other_file : {"http", "src=", "<script", "@import", "<link", "url("}) {
    const std::size_t at = html.find(other_file);
    // Clips of a picture are parts of the page.
    if (std::string(other_file) == "url(") {
      for (std::size_t i = at; i != std::string::npos; i = html.find("url(", i + 1)) EXPECT_EQ(html[i + 4], '#');
    } else {
      EXPECT_EQ(at, std::string::npos) << html.substr(at == std::string::npos ? 0 : at, 80);
    }
  }
}

TEST_F(page, shows_everything) {
  const std::string html = written();
  for (const char* part :
       {"4 of 8 hold", "2 of 4 hold", "asperity 1.2.3", "made_up", "<code>no_number</code>", "no number", "at most 1",
        "at least 0.9", "0.6 to 1.1", "FAILS", "holds", "9 &lt;of&gt; 10", "left out: x &lt; y &amp; z",
        "A wave goes up &amp; down.", "href=\"made_up/numbers.csv\"", "href=\"#other\"", "id=\"other\""}) {
    EXPECT_NE(html.find(part), std::string::npos) << part;
  }
}

TEST_F(page, escapes_what_it_is_given) {
  const std::string html = written();
  EXPECT_NE(html.find("Tom &amp; &lt;Jerry&gt;"), std::string::npos);
  EXPECT_NE(html.find("a &lt; b, &quot;c&quot; &gt; d."), std::string::npos);
  EXPECT_NE(html.find("a &lt;machine&gt;"), std::string::npos);
  EXPECT_EQ(html.find("<Jerry>"), std::string::npos);
  EXPECT_EQ(html.find("<share>"), std::string::npos);
}

TEST_F(page, parts_of_pictures_have_names_of_their_own) {
  const std::string html = written();
  std::set<std::string> names;
  for (std::size_t at = html.find(" id=\""); at != std::string::npos; at = html.find(" id=\"", at + 1)) {
    const std::string name = html.substr(at + 5, html.find('"', at + 5) - at - 5);
    EXPECT_TRUE(names.insert(name).second) << name << " is there twice";
  }
  EXPECT_GT(names.size(), 40U);
  std::size_t used = 0;
  for (std::size_t at = html.find("href=\"#"); at != std::string::npos; at = html.find("href=\"#", at + 1), ++used) {
    const std::string name = html.substr(at + 7, html.find('"', at + 7) - at - 7);
    EXPECT_TRUE(names.count(name) == 1) << name << " is nowhere";
  }
  EXPECT_GT(used, 100U);
}

TEST_F(page, reports_a_brief_run_and_what_is_missing) {
  EXPECT_EQ(written().find("brief run"), std::string::npos);
  const std::string html = written({"1.2.3", "a machine", true, "Missing: fig9. The run ended before: <why>."});
  EXPECT_NE(html.find("brief run"), std::string::npos);
  EXPECT_NE(html.find("Missing: fig9. The run ended before: &lt;why&gt;."), std::string::npos);
}

TEST_F(page, this_machine_has_a_name) { EXPECT_GT(machine_text().size(), 10U); }

}  // namespace
}  // namespace asperity::experiment
