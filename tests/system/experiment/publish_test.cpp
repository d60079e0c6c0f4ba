// The files of one experiment: complete, valid, and the verdict last.
#include <cstdlib>
#include <filesystem>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>

#include "some_findings.hpp"
#include "unit/io/scratch_folder.hpp"

namespace asperity::experiment {
namespace {

using nlohmann::json;
using test_support::scratch_folder;

TEST(publish, writes_every_file_and_nothing_else) {
  const scratch_folder out;
  ASSERT_TRUE(write_findings({&made_up, some_findings()}, out.path()));
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(out.path() / "made_up")) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, (std::vector<std::string>{"again.png", "again.svg", "numbers.csv", "verdict.json", "wave.png",
                                             "wave.svg"}));
  EXPECT_EQ(bytes_of(out.path() / "made_up" / "wave.png").substr(1, 3), "PNG");
}

TEST(publish, the_verdict_is_valid_and_complete) {
  const scratch_folder out;
  ASSERT_TRUE(write_findings({&made_up, some_findings()}, out.path()));
  const json verdict = json::parse(bytes_of(out.path() / "made_up" / "verdict.json"));
  EXPECT_EQ(verdict["experiment"], "made_up");
  EXPECT_EQ(verdict["title"], "Tom & <Jerry>");
  EXPECT_EQ(verdict["pass"], false);
  EXPECT_EQ(verdict["notes"], json({"left out: x < y & z"}));
  const json& statements = verdict["statements"];
  ASSERT_EQ(statements.size(), 4U);
  EXPECT_EQ(statements[0], (json{{"name", "small"},
                                 {"claim", "a value, N"},
                                 {"value", 0.5},
                                 {"relation", "at_most"},
                                 {"bound", 1.0},
                                 {"pass", true}}));
  EXPECT_EQ(statements[1]["relation"], "at_least");
  EXPECT_EQ(statements[1]["pass"], false);
  EXPECT_EQ(statements[2]["relation"], "between");
  EXPECT_EQ(statements[2]["bound"], json({0.6, 1.1}));
  EXPECT_EQ(statements[2]["pass"], true);
  EXPECT_TRUE(statements[3]["value"].is_null());
  EXPECT_EQ(statements[3]["pass"], false) << "what is no number holds nothing";
}

TEST(publish, an_experiment_without_statements_does_not_pass) {
  EXPECT_EQ(to_json({&made_up, {}})["pass"], false);
  findings good;
  good.statements = {at_most("small", "", 0.5, 0.5)};
  EXPECT_EQ(to_json({&made_up, good})["pass"], true) << "a bound is part of what it allows";
}

TEST(publish, csv_reads_back_as_the_same_numbers) {
  const scratch_folder out;
  ASSERT_TRUE(write_findings({&made_up, some_findings()}, out.path()));
  const std::string csv = bytes_of(out.path() / "made_up" / "numbers.csv");
  EXPECT_EQ(csv, "time_s,height_m\n0.1,0.3333333333333333\n2,nan\n3,inf\n");
  EXPECT_EQ(std::strtod("0.3333333333333333", nullptr), 1.0 / 3.0);
}

TEST(publish, no_verdict_stands_beside_files_that_are_not_its_own) {
  const scratch_folder out;
  ASSERT_TRUE(write_findings({&made_up, some_findings()}, out.path()));
  std::filesystem::remove(out.path() / "made_up" / "wave.png");
  std::filesystem::create_directory(out.path() / "made_up" / "wave.png");  // no file can be made there
  const result<void> again = write_findings({&made_up, some_findings()}, out.path());
  ASSERT_FALSE(again);
  EXPECT_NE(again.error().message.find("wave.png"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(out.path() / "made_up" / "verdict.json"));
}

TEST(publish, a_folder_that_cannot_be_made_is_named) {
  const scratch_folder out;
  static_cast<void>(out.file("made_up", "a file"));
  const result<void> written = write_findings({&made_up, some_findings()}, out.path());
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, error_code::io_failed);
  EXPECT_NE(written.error().message.find("made_up"), std::string::npos);
}

}  // namespace
}  // namespace asperity::experiment
