// Breaks the renderer in every obvious way: a statement of the experiments has to notice.
#include <algorithm>
#include <cstdio>
#include <gtest/gtest.h>
#include <string>
#include <utility>
#include <vector>

#include "broken_renderers.hpp"
#include "experiment.hpp"
#include "publish.hpp"
#include "text.hpp"

namespace broken {
namespace {

using asperity::experiment::all_experiments;
using asperity::experiment::bound_text;
using asperity::experiment::findings;
using asperity::experiment::statement;
using asperity::experiment::variant;
using asperity::experiment::workbench;

/// A mutation, an experiment that has to notice it, and with which renderer.
struct watch {
  mutation how;
  const char* experiment;
  variant (*kind)();
};

constexpr watch watches[] = {
    {mutation::no_transport, "hammer", asperity::experiment::window_soft},
    {mutation::flipped_normal, "hammer", asperity::experiment::window_soft},
    {mutation::nearest_texel, "fig8", asperity::experiment::window_central},
    {mutation::one_sided, "fig8", asperity::experiment::window_central},
    {mutation::no_curvature, "stability", asperity::experiment::window_soft},
};

workbench bench_with(mutation how, std::vector<variant> kinds) {
  return workbench({.models = ASPERITY_EXPERIMENT_MODELS_DIR,
                    .brief = true,
                    .gpu = false,
                    .variants = std::move(kinds),
                    .make_renderer = [how](asperity::scene bodies,
                                           const variant& kind) { return make_renderer(std::move(bodies), kind, how); },
                    .progress = {},
                    .cancelled = {}});
}

class mutations_are_noticed : public testing::TestWithParam<watch> {};

TEST_P(mutations_are_noticed, by_a_statement) {
  const auto [how, name, make_kind] = GetParam();
  const auto all = all_experiments();
  const auto e = std::find_if(all.begin(), all.end(), [&](const auto& one) { return std::string(one.name) == name; });
  ASSERT_NE(e, all.end()) << "there is no experiment " << name;
  workbench bench = bench_with(how, {make_kind()});
  const asperity::result<findings> found = e->run(bench);
  ASSERT_TRUE(found) << "the experiment was not finished, so that no statement could notice: " << found.error().message;
  std::vector<const statement*> failed;
  for (const statement& s : found->statements) {
    if (!s.holds()) failed.push_back(&s);
  }
  std::printf("%-24s %s: %zu of %zu statements notice it\n", to_string(how), name, failed.size(),
              found->statements.size());
  for (const statement* s : failed) {
    std::printf("    %-32s %-10s (%s)\n", s->name.c_str(), asperity::command::brief(s->value).c_str(),
                bound_text(*s).c_str());
  }
  EXPECT_FALSE(failed.empty());
}

INSTANTIATE_TEST_SUITE_P(obvious, mutations_are_noticed, testing::ValuesIn(watches), [](const auto& one) {
  std::string out = to_string(one.param.how);
  std::replace_if(
      out.begin(), out.end(), [](char c) { return c == ' ' || c == '-'; }, '_');
  return out + "_in_" + one.param.experiment;
});

// Otherwise what a statement notices might be how the broken policies are put together.
TEST(mutation_none, gives_the_bits_of_the_library) {
  workbench bench =
      bench_with(mutation::none, {asperity::experiment::window_soft(), asperity::experiment::window_central()});
  const auto block = bench.models().benchmark(asperity::models::benchmark::block);
  const auto gear = bench.models().benchmark(asperity::models::benchmark::gear);
  ASSERT_TRUE(block && gear);
  for (const variant& kind : bench.variants()) {
    auto whole = asperity::command::make_chosen_renderer({*block, {*gear}}, kind.options);
    auto put_together = bench.make_renderer({*block, {*gear}}, kind);
    ASSERT_TRUE(whole && put_together);
    int touching = 0;
    for (int i = 0; i < 20; ++i) {
      const double turn = 0.002 * i;
      asperity::pose T_wa;
      T_wa.position = {1e-4 * i, 2.3e-4 * i, 0.0709 - 5e-5 * i};
      T_wa.rotation = asperity::exp_rotation({0.3 * turn, 0.2 * turn, turn});
      const std::vector<asperity::pose> T_wb(1);
      asperity::tick a, b;
      ASSERT_EQ(whole->step({T_wa, T_wb}, a), asperity::status::ok);
      ASSERT_EQ(put_together->step({T_wa, T_wb}, b), asperity::status::ok);
      EXPECT_EQ(a.force.on_probe_w.force, b.force.on_probe_w.force) << kind.name << " at " << i;
      EXPECT_EQ(a.force.on_probe_w.torque, b.force.on_probe_w.torque) << kind.name << " at " << i;
      EXPECT_EQ(a.force.stiffness.m, b.force.stiffness.m) << kind.name << " at " << i;
      touching += glm::length(a.force.on_probe_w.force) > 0.1 ? 1 : 0;
    }
    EXPECT_GE(touching, 10) << kind.name;
  }
}

}  // namespace
}  // namespace broken
