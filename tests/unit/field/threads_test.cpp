// Fields and samples are the same to the bit, whatever the number of threads that make them.
#include "field/threads.hpp"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <gtest/gtest.h>
#include <memory>
#include <mutex>
#include <random>
#include <set>
#include <thread>
#include <vector>

#include "asperity/field/field_body.hpp"
#include "asperity/field/field_scene.hpp"
#include "same_field.hpp"
#include "support/fresh_seed.hpp"
#include "support/small_models.hpp"

namespace asperity {
namespace {

using namespace test_support;
using namespace field_test;

field_body made_with(const textured_model& model, unsigned threads, field_settings settings = {}) {
  settings.threads = threads;
  return make_field_body(model, {.field = settings}).value();
}

TEST(FieldThreads, MakeTheSameField) {
  // The second box is a plate, cut in slabs along another axis than the first; its walls ask for a finer grid.
  const field_settings few{.most_nodes = 200'000};
  for (const vec3& half : {vec3(0.006, 0.008, 0.02), vec3(0.02, 0.015, 0.002)}) {
    const textured_model box = make_textured_box(half, 256, ridges(40e-6, 1e-3));
    const field_body alone = made_with(box, 1, few);
    ASSERT_GT(alone.field.fine.bricks.size(), 1000U) << "the relief has to be cut in slabs";
    ASSERT_GT(alone.samples.samples().size(), 1000U);
    for (const unsigned threads : {2U, 3U, 7U}) {
      SCOPED_TRACE(threads);
      expect_same(alone, made_with(box, threads, few));
    }
  }
}

TEST(FieldThreads, MakeTheSameScene) {
  scene bodies;
  bodies.probe =
      std::make_shared<const textured_model>(make_textured_box({0.01, 0.01, 0.01}, 128, ridges(40e-6, 2e-3)));
  const auto plate =
      std::make_shared<const textured_model>(make_textured_box({0.02, 0.02, 0.005}, 128, ridges(20e-6, 2e-3)));
  bodies.fixed = {plate, bodies.probe, plate};
  field_body_settings one, several;
  one.field = {.most_nodes = 100'000, .threads = 1};
  several.field = {.most_nodes = 100'000, .threads = 4};
  const field_scene alone = make_field_scene(bodies, one).value();
  const field_scene together = make_field_scene(bodies, several).value();
  for (const field_scene* made : {&alone, &together}) {
    ASSERT_EQ(made->fixed.size(), 3U);
    EXPECT_EQ(made->fixed[0], made->fixed[2]);
    EXPECT_EQ(made->fixed[1], made->probe);
  }
  expect_same(*alone.probe, *together.probe);
  expect_same(*alone.fixed[0], *together.fixed[0]);
}

TEST(FieldThreads, TellTheFirstBodyThatFails) {
  scene bodies;
  bodies.probe = std::make_shared<const textured_model>(make_flat_box({0.01, 0.01, 0.01}));
  textured_model bare = *bodies.probe, empty = *bodies.probe;
  bare.texture = {};
  empty.mesh.triangles.clear();
  bodies.fixed = {std::make_shared<const textured_model>(bare), std::make_shared<const textured_model>(empty)};
  for (const unsigned threads : {1U, 3U}) {
    field_body_settings settings;
    settings.field.threads = threads;
    const auto made = make_field_scene(bodies, settings);
    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().code, error_code::bad_texture);
  }
}

TEST(FieldThreads, BuildTheSameTree) {
  std::mt19937_64 bits(
      fresh_seed("FieldThreads.BuildTheSameTree", "20 trees, half of them with several samples at a place"));
  std::uniform_int_distribution<int> side(-20, 20);  // coarse, so that many samples share a place
  for (int n = 0; n < 20; ++n) {
    std::vector<field_sample> samples(1 + bits() % 5000);
    for (field_sample& s : samples) {
      s.position_b = 1e-3F * glm::vec3(side(bits), side(bits), side(bits));
      s.cone_rad = static_cast<float>(bits() % 3);
    }
    placed_samples placed{samples, {}};
    for (std::size_t left = samples.size(); n % 2 == 1 && left > 0; left -= placed.at_place.back()) {
      placed.at_place.push_back(
          static_cast<std::uint8_t>(std::min<std::size_t>(left, 1 + bits() % placed_samples::most)));
    }
    const std::vector<double> alone = numbers_of(sample_tree(placed, 1));
    for (const unsigned threads : {2U, 5U}) EXPECT_TRUE(same_bytes(alone, numbers_of(sample_tree(placed, threads))));
  }
}

TEST(FieldThreads, DoEachTaskOnce) {
  for (const unsigned threads : {1U, 2U, 5U}) {
    for (const std::size_t tasks : {std::size_t{0}, std::size_t{1}, std::size_t{4}, std::size_t{1000}}) {
      std::vector<std::atomic<int>> done(tasks);
      detail::for_each_task(tasks, threads, [&](std::size_t i) { ++done[i]; });
      EXPECT_TRUE(std::all_of(done.begin(), done.end(), [](const std::atomic<int>& d) { return d == 1; }));
      std::vector<std::atomic<int>> part_of(tasks);
      detail::for_each_part(tasks, threads, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) ++part_of[i];
      });
      EXPECT_TRUE(std::all_of(part_of.begin(), part_of.end(), [](const std::atomic<int>& d) { return d == 1; }));
    }
  }
}

TEST(FieldThreads, HandOnWhatATaskThrows) {
  for (const unsigned threads : {1U, 4U}) {
    EXPECT_THROW(detail::for_each_task(100, threads,
                                       [](std::size_t i) {
                                         if (i == 50) throw std::bad_alloc();
                                       }),
                 std::bad_alloc);
  }
}

}  // namespace
}  // namespace asperity
