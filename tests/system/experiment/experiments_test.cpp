// Every experiment, in brief: each of its statements holds.
#include <gtest/gtest.h>
#include <string>

#include "experiment.hpp"
#include "publish.hpp"
#include "text.hpp"

namespace asperity::experiment {
namespace {

class experiments : public testing::TestWithParam<const experiment*> {};

std::string line_of(const statement& s) {
  return s.name + ": " + command::brief(s.value) + " (" + bound_text(s) + ") " + s.claim;
}

TEST_P(experiments, every_statement_holds) {
  workbench bench({.models = ASPERITY_EXPERIMENT_MODELS_DIR,
                   .brief = true,
                   .gpu = false,
                   .variants = {},
                   .make_renderer = {},
                   .progress = {},
                   .cancelled = {}});
  const result<findings> found = GetParam()->run(bench);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_FALSE(found->statements.empty());
  EXPECT_FALSE(found->figures.empty() && found->shown.empty()) << "nothing to look at";
  for (const statement& s : found->statements) EXPECT_TRUE(s.holds()) << line_of(s);
}

std::vector<const experiment*> pointers() {
  std::vector<const experiment*> out;
  for (const experiment& e : all_experiments()) out.push_back(&e);
  return out;
}

INSTANTIATE_TEST_SUITE_P(brief, experiments, testing::ValuesIn(pointers()),
                         [](const auto& one) { return std::string(one.param->name); });

}  // namespace
}  // namespace asperity::experiment
