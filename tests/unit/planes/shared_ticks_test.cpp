// Threads that share a tick: every task is done once and by the time that run() returns, and a tick answers the same to
// the bit however many there are.
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <gtest/gtest.h>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "asperity/planes/plane_renderer.hpp"
#include "asperity/planes/scene_editor.hpp"
#include "planes/tick_team.hpp"
#include "support/extent.hpp"
#include "support/fresh_seed.hpp"
#include "unit/planes/ridged_scene.hpp"

namespace asperity {
namespace {

using namespace test_support;

unsigned drawn_threads(std::mt19937_64& bits) { return 2 + static_cast<unsigned>(bits() % 6); }

TEST(TickTeam, DoesEachTaskOnceAndWaitsForAll) {
  std::mt19937_64 bits(fresh_seed("TickTeam.DoesEachTaskOnceAndWaitsForAll", "12 teams, 300 calls of each"));
  std::size_t by_helpers = 0;
  // Who has a number, has it alone: what a thread keeps under it needs no lock.
  std::array<std::atomic<bool>, tick_team::most_threads> has_number{};
  std::atomic<int> shared_numbers{0};
  for (int n = 0; n < 12; ++n) {
    tick_team team(drawn_threads(bits));
    std::vector<std::uint32_t> done(400);
    for (int call = 0; call < extent(300, 30'000); ++call) {
      const std::size_t tasks = bits() % done.size();
      const auto mark = static_cast<std::uint32_t>(bits());
      std::fill(done.begin(), done.end(), 0U);
      std::atomic<std::size_t> helped{0};
      // What a task writes is read without a lock: run() has to come after all of them.
      team.run(tasks, [&](std::size_t task, unsigned thread) noexcept {
        if (has_number[thread].exchange(true)) shared_numbers.fetch_add(1);
        done[task] += mark;
        has_number[thread].store(false);
        if (thread != 0) helped.fetch_add(1, std::memory_order_relaxed);
      });
      by_helpers += helped.load();
      const auto end_of_done = done.begin() + static_cast<std::ptrdiff_t>(tasks);
      ASSERT_EQ(std::count(done.begin(), end_of_done, mark), static_cast<std::ptrdiff_t>(tasks)) << "call " << call;
      ASSERT_TRUE(mark == 0 || std::count(end_of_done, done.end(), mark) == 0) << "call " << call;
    }
  }
  EXPECT_EQ(shared_numbers.load(), 0);
  std::printf("%zu tasks were done by helpers\n", by_helpers);
}

// Two tasks that wait for each other: the caller has one, so a helper has to take the other, awake or asleep.
TEST(TickTeam, WakesAHelperThatSleeps) {
  tick_team team(2);
  ASSERT_EQ(team.threads(), 2U);
  for (const int pause_ms : {0, 0, 20, 0, 20}) {
    std::this_thread::sleep_for(std::chrono::milliseconds(pause_ms));
    std::atomic<int> there{0};
    std::array<unsigned, 2> by{};
    team.run(2, [&](std::size_t task, unsigned thread) noexcept {
      by[task] = thread;
      there.fetch_add(1);
      while (there.load() < 2) std::this_thread::yield();
    });
    EXPECT_NE(by[0], by[1]);
  }
}

TEST(TickTeam, SetsEachHelperUpOnce) {
  static std::array<std::atomic<int>, tick_team::most_threads + 1> set_up;
  for (auto& n : set_up) n = 0;
  {
    const tick_team team(5, [](unsigned helper) { set_up[helper].fetch_add(1); });
  }
  for (std::size_t h = 0; h < set_up.size(); ++h) EXPECT_EQ(set_up[h].load(), h >= 1 && h < 5 ? 1 : 0) << h;
}

TEST(TickTeam, HasAtLeastTheCallerAndAtMostSixteen) {
  EXPECT_EQ(tick_team(0).threads(), 1U);
  EXPECT_EQ(tick_team(1).threads(), 1U);
  EXPECT_EQ(tick_team(100).threads(), 16U);
  int sum = 0;
  tick_team(1).run(5,
                   [&](std::size_t task, unsigned thread) noexcept { sum += static_cast<int>(task + 100 * thread); });
  EXPECT_EQ(sum, 10);
}

bool same(const support_plane& a, const support_plane& b) {
  return a.sample == b.sample && a.body == b.body && a.depth_m == b.depth_m && a.n_ab_w == b.n_ab_w && a.r_w == b.r_w &&
         a.gradient.linear == b.gradient.linear && a.gradient.angular == b.gradient.angular;
}

void expect_same(std::span<const support_plane> a, std::span<const support_plane> b, const std::string& what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_TRUE(same(a[i], b[i])) << what << ", plane " << i;
}

void expect_same(const tick& a, const tick& b, const std::string& what) {
  expect_same(a.planes, b.planes, what);
  EXPECT_EQ(a.force.on_probe_w.force, b.force.on_probe_w.force) << what;
  EXPECT_EQ(a.force.on_probe_w.torque, b.force.on_probe_w.torque) << what;
  EXPECT_EQ(a.known.way_m, b.known.way_m) << what;
  EXPECT_EQ(a.known.turn_rad, b.known.turn_rad) << what;
  EXPECT_EQ(a.flags, b.flags) << what;
}

// Walks over two bodies, above them and into them, steps of a slow hand and leaps; and questions for poses near by, some
// of which more planes answer than a list holds.
TEST(SharedTicks, AnswerTheSameForAnyNumberOfThreads) {
  draws draw{std::mt19937_64(fresh_seed("SharedTicks.AnswerTheSameForAnyNumberOfThreads", "8 walks of 20 ticks"))};
  const std::vector<pose> T_wb{{draw.rotation(), vec3(0.0)}, {draw.rotation(), {0.0, 0.02, 0.02}}};
  plane_renderer layer = make_ridged();  // what a renderer knows of earlier ticks says how far free space is known
  std::size_t told = 0, full = 0;
  for (int walk = 0; walk < extent(8, 60); ++walk) {
    const unsigned threads = drawn_threads(draw.bits);
    plane_renderer alone = make_ridged(), shared = make_ridged(threads);
    // Laid on the bodies, and in every fourth walk up to three reaches above them: what is free is told, too.
    pose T_wa = laid_down(draw, layer, T_wb, 1e-4 * draw.unit());
    if (walk % 4 == 3) T_wa.position.z += 3e-3 * (1.0 + draw.unit());
    const double step_m = walk % 3 == 0 ? 1e-6 : (walk % 3 == 1 ? 5e-5 : 6e-4);
    for (int n = 0; n < 20; ++n) {
      const std::string what =
          std::to_string(threads) + " threads, walk " + std::to_string(walk) + ", tick " + std::to_string(n);
      T_wa.position += step_m * draw.vector();
      T_wa.rotation = glm::normalize(exp_rotation(20.0 * step_m * draw.vector()) * T_wa.rotation);
      const scene_pose at{T_wa, T_wb, n % 2 == 0 ? 1e-3 : 1e-2};
      tick a, b;
      ASSERT_EQ(alone.step(at, a), shared.step(at, b)) << what;
      expect_same(a, b, what);
      told += a.planes.size();
      for (int q = n % 5 == 0 ? 0 : 1; q < 4; ++q) {
        const vec6 moved{1e-4 * draw.vector(), 3e-3 * draw.vector()};
        const double above_m = q == 0 ? -4e-4 : -1e-5;
        plane_list of_one, of_all;
        const status answered = alone.planes_at(moved, above_m, of_one);
        ASSERT_EQ(answered, shared.planes_at(moved, above_m, of_all)) << what;
        expect_same({of_one.data(), of_one.size()}, {of_all.data(), of_all.size()}, what + ", question");
        full += answered == status::capacity_reached ? 1 : 0;
      }
    }
  }
  EXPECT_GT(told, 1000U);
  EXPECT_GT(full, 2U) << "no question had more answers than a list holds";
}

TEST(SharedTicks, AnswerTheSameInASceneThatChanges) {
  draws draw{std::mt19937_64(fresh_seed("SharedTicks.AnswerTheSameInASceneThatChanges", "40 ticks"))};
  scene_editor editor = scene_editor::make(ridged().of.probe).value();
  ASSERT_TRUE(editor.add(ridged().of.fixed[0], ridged().fields->fixed[0], {}));
  plane_renderer alone = make_plane_renderer(editor).value();
  plane_renderer shared = make_plane_renderer(editor, {.threads = drawn_threads(draw.bits)}).value();
  pose T_wa{exp_rotation(0.05 * draw.vector()), {0.0, 0.0, 0.0094}};
  std::vector<pose> T_wb(editor.limits().bodies);
  std::size_t told = 0;
  for (int n = 0; n < 40; ++n) {
    if (n == 10) {
      T_wb[1].position = {0.009, 0.0, 0.009};
      ASSERT_TRUE(editor.add(ridged().of.fixed[1], ridged().fields->fixed[1], T_wb[1]));
      const auto next = editor.prepare();
      static_cast<void>(alone.take(next));
      static_cast<void>(shared.take(next));
    }
    T_wa.position += 1e-4 * draw.vector();
    tick a, b;
    ASSERT_EQ(alone.step({T_wa, T_wb}, a), shared.step({T_wa, T_wb}, b));
    expect_same(a, b, "tick " + std::to_string(n));
    told += a.planes.size();
  }
  EXPECT_GT(told, 100U);
}

TEST(SharedTicks, RefuseNoThreadAndTooMany) {
  for (const unsigned threads : {0U, 17U, 4'000'000'000U}) {
    const auto refused = make_plane_renderer(ridged().of, ridged().fields, {.threads = threads});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, error_code::invalid_argument);
    EXPECT_NE(refused.error().message.find("threads must be from 1 to 16, and is " + std::to_string(threads)),
              std::string::npos)
        << refused.error().message;
    scene_editor editor = scene_editor::make(ridged().of.probe).value();
    EXPECT_FALSE(make_plane_renderer(editor, {.threads = threads}));
  }
}

}  // namespace
}  // namespace asperity
