// A share of the study on the benchmark models, with the same limits, and what must break them.
#include <algorithm>
#include <gtest/gtest.h>
#include <string>

#include "law/contact_study/report.hpp"
#include "law/contact_study/study.hpp"
#include "law/contact_study/study_models.hpp"

namespace asperity::contact_study {
namespace {

result<pair_of_renderers> renderers_of(const pair_name& pair) {
  const std::filesystem::path folder = ASPERITY_TEST_MODELS_DIR;
  result<model_ptr> probe = study_model(pair.probe, folder, folder);
  if (!probe) return probe.error();
  result<model_ptr> fixed = study_model(pair.fixed, folder, folder);
  if (!fixed) return fixed.error();
  return pair_of_renderers::make({std::move(probe).value(), {std::move(fixed).value()}});
}

/// One of the first three pairs of all_pairs.
class BakedPair : public testing::TestWithParam<pair_name> {
 protected:
  void SetUp() override {
    result<pair_of_renderers> made = renderers_of(GetParam());
    ASSERT_TRUE(made) << made.error().message;
    renderers_.emplace(std::move(made).value());
  }

  std::optional<pair_of_renderers> renderers_;
};

// No motion has a step of 5 mN, however closely it is looked at. Where ways out compete, or the body rocks on
// its relief, some change faster than a loop of 1 kHz sees.
TEST_P(BakedPair, TheDefaultNeitherJumpsNorMakesWork) {
  constexpr std::size_t too_fast = 4;  // of twelve motions; measured: 3, 2 and 1
  study_options options;
  options.poses = 4;
  options.with_window = false;
  const pair_result found = study_pair(std::string(GetParam().probe), *renderers_, options);
  ASSERT_EQ(found.least_motion.size(), options.poses);
  std::size_t over = 0;
  for (const pose_result& p : found.least_motion) {
    for (const motion m : all_motions) {
      const jumps& j = p.moved[static_cast<std::size_t>(m)];
      EXPECT_TRUE(j.at_1khz.ok && j.at_10khz.ok);
      ASSERT_TRUE(j.left);
      EXPECT_EQ(j.left->count, 0U) << broken_limits({found});
      over += j.over_limit() ? 1U : 0U;
    }
    EXPECT_LE(p.loop, loop_limit) << "pose " << p.index;
  }
  EXPECT_LE(over, too_fast) << broken_limits({found});
}

// Places that were once wrong. A way out was missed that a turn makes cheap: a step of 12.7 mN. The
// iteration swung to and fro, ticks answered capacity_reached, and the loop made 5.2e-5 of its work.
TEST(BlockOnGear, StaysRightWhereItWasWrong) {
  result<pair_of_renderers> made = renderers_of({"block", "gear"});
  ASSERT_TRUE(made) << made.error().message;
  least_motion_renderer& renderer = made->least_motion();
  const feel_function feel = feel_with(renderer);
  const auto stepped = find_touching_pose(renderer, 3, 39), worked = find_touching_pose(renderer, 1, 19);
  ASSERT_TRUE(stepped && worked);
  EXPECT_EQ(find_steps(feel, *stepped, motion::slide).count, 0U);
  bool all = true;
  const feel_function told = [&](const pose& T_wa) {
    const felt out = feel(T_wa);
    all = all && out.answer == status::ok;
    return out;
  };
  EXPECT_LE(loop_work(told, *worked), loop_limit);
  EXPECT_TRUE(all);
}

// Without this the test above could pass because nothing was touched, or because the measure cannot tell.
TEST_P(BakedPair, ThePapersClustersDoBoth) {
  const double k = renderers_->least_motion().force().settings().stiffness_n_per_m;
  const feel_function feel = feel_with(renderers_->window());
  bool jumped = false, stepped = false, worked = false;
  for (std::uint64_t index = 0; index < 8 && !(jumped && stepped && worked); ++index) {
    const std::optional<touching_pose> start = find_touching_pose(renderers_->least_motion(), 1, index);
    if (!start) continue;
    for (const motion m : all_motions) {
      jumped = jumped || measure_jumps(feel, *start, m, k, false).force_ratio() > 2.0 * ratio_limit;
      stepped = stepped || find_steps(feel, *start, m).largest_n > 100.0 * least_step_n;
    }
    worked = worked || loop_work(feel, *start, 250) > 10.0 * loop_limit;
  }
  EXPECT_TRUE(jumped);
  EXPECT_TRUE(stepped);
  EXPECT_TRUE(worked);
}

// A force of 10 mN that comes at once, where a spring of 50 N/mm is beside it, and the spring alone.
TEST(FindSteps, TellsAStepFromASteepPlace) {
  constexpr double step_at_m = 1.23456e-3, stiffness_n_per_m = 5e4;
  const auto left_of = [&](double step_n) {
    const feel_function feel = [&](const pose& T_wa) {
      const double way_m = T_wa.position.x;
      felt out;
      out.on_probe_w.force.x = stiffness_n_per_m * std::clamp(way_m - step_at_m + 1e-6, 0.0, 3e-6);
      out.on_probe_w.force.y = way_m > step_at_m ? step_n : 0.0;
      return out;
    };
    touching_pose start;
    start.tangent_w = vec3(1.0, 0.0, 0.0);
    return find_steps(feel, start, motion::slide);
  };
  EXPECT_EQ(left_of(0.0).count, 0U);
  const steps found = left_of(1e-2);
  EXPECT_EQ(found.count, 1U);
  EXPECT_NEAR(found.largest_n, 1e-2, 1e-5);
  EXPECT_NEAR(found.at_m, step_at_m, 2e-10);
}

INSTANTIATE_TEST_SUITE_P(Benchmark, BakedPair, testing::Values(all_pairs[0], all_pairs[1], all_pairs[2]),
                         [](const testing::TestParamInfo<pair_name>& pair) { return std::string(pair.param.probe); });

}  // namespace
}  // namespace asperity::contact_study
