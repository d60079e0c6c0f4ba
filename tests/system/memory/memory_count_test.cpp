// The bytes that a model and a renderer report are those that they have asked for, to the byte.
#include <cstdio>
#include <gtest/gtest.h>
#include <memory>
#include <optional>
#include <utility>

#include "asperity/field/field_body.hpp"
#include "asperity/least_motion/least_motion_renderer.hpp"
#include "asperity/window/window_renderer.hpp"
#include "counted_heap.hpp"
#include "support/piece_models.hpp"
#include "support/small_models.hpp"
#include "window/collision_body.hpp"

namespace asperity {
namespace {

using test_support::bytes_on_loan;
using test_support::make_flat_box;

/// A box whose parts all have memory: a name that does not fit into the string, and several pieces.
textured_model make_model() {
  textured_model model = make_flat_box({0.01, 0.01, 0.01}, 96);
  model.name = "a box with a name of more than fifteen letters";
  model.pieces = test::make_piece_model(model.mesh, test::cut_into::flat_faces)->pieces;
  return model;
}

TEST(MemoryCount, AModelReportsWhatItHasAskedFor) {
  const std::size_t before = bytes_on_loan();
  const textured_model model = make_model();
  const std::size_t asked = bytes_on_loan() - before;
  EXPECT_EQ(model.heap_bytes(), asked);
  EXPECT_EQ(memory_bytes(model), sizeof model + asked);
}

TEST(MemoryCount, CountsCapacityAndNotSize) {
  textured_model model = make_model();
  const std::size_t before = memory_bytes(model);
  model.texture.texels.clear();
  EXPECT_EQ(memory_bytes(model), before);
  model.mesh.positions.reserve(2 * model.mesh.positions.capacity());
  EXPECT_GT(memory_bytes(model), before);
}

TEST(MemoryCount, AShortNameTakesNothing) {
  textured_model model = make_model();
  const std::size_t with_long_name = memory_bytes(model);
  const std::size_t name = model.name.capacity() + 1;
  std::string("box").swap(model.name);
  EXPECT_EQ(memory_bytes(model), with_long_name - name);
}

TEST(MemoryCount, AModelThatAppearsTwiceCountsOnce) {
  const auto a = std::make_shared<const textured_model>(make_model());
  const auto b = std::make_shared<const textured_model>(make_model());
  const std::size_t one = memory_bytes(scene{a, {}});
  const auto with = [&](std::vector<model_ptr> fixed) {
    const scene bodies{a, std::move(fixed)};
    return memory_bytes(bodies) - heap_bytes(bodies.fixed) - one;
  };
  EXPECT_EQ(with({a}), 0U);
  EXPECT_EQ(with({a, a}), 0U);
  EXPECT_EQ(with({b}), memory_bytes(*b));
  EXPECT_EQ(with({b, a, b}), memory_bytes(*b));
}

class RendererMemory : public ::testing::Test {
 protected:
  RendererMemory() {
    const std::size_t before = bytes_on_loan();
    auto made = make_window_renderer({model_, {model_, other_}});
    EXPECT_TRUE(made);
    if (made) feel_.emplace(std::move(made).value());
    asked_ = bytes_on_loan() - before;
  }

  model_ptr model_ = std::make_shared<const textured_model>(make_model());
  model_ptr other_ = std::make_shared<const textured_model>(make_flat_box({0.02, 0.02, 0.02}));
  std::optional<window_renderer> feel_;
  std::size_t asked_ = 0;
};

TEST_F(RendererMemory, IsWhatItHasAskedFor) {
  EXPECT_EQ(feel_->memory_bytes(), sizeof(window_renderer) + asked_);
  EXPECT_GT(asked_, std::size_t{1} << 20);
}

TEST_F(RendererMemory, StaysTheSameInTicks) {
  const std::size_t before = feel_->memory_bytes();
  const std::vector<pose> T_wb(2);
  tick out;
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(feel_->step({{{1.0, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.029 - 1e-4 * i}}, T_wb}, out), status::ok);
  }
  EXPECT_EQ(feel_->memory_bytes(), before);
}

// A report that forgets the smallest of the parts is found out: the comparison is to the byte.
TEST_F(RendererMemory, AForgottenPartWouldShow) {
  const collision_body body(model_);
  for (const std::size_t part : {body.piece_tree.heap_bytes(), body.triangle_tree.heap_bytes(),
                                 body.shapes.front().heap_bytes(), feel_->found().heap_bytes()}) {
    EXPECT_GT(part, 0U);
    EXPECT_NE(feel_->memory_bytes() - part, sizeof(window_renderer) + asked_);
  }
}

// What is known of a model is kept once, and what a tick works with once: a body more is its place, its scale and where
// its model is. Contacts of two bodies at once have room of their own.
TEST_F(RendererMemory, OfManyBodiesOfOneModelIsThatOfOne) {
  const auto bytes = [&](std::size_t count) {
    const std::size_t before = bytes_on_loan();
    const auto made = make_window_renderer({model_, std::vector<model_ptr>(count, other_)});
    EXPECT_TRUE(made);
    const std::size_t asked = bytes_on_loan() - before;
    EXPECT_EQ(made.value().memory_bytes(), sizeof(window_renderer) + asked);
    return asked;
  };
  const std::size_t one = bytes(1), two = bytes(2), hundred = bytes(100);
  std::printf("  1 body %zu bytes, 2 bodies %zu, 100 bodies %zu\n", one, two, hundred);
  EXPECT_LT(hundred - two, 98U * 512U);
  EXPECT_LT(static_cast<double>(hundred), 1.1 * static_cast<double>(one));
  // As many models cost what they cost each.
  scene of_their_own{model_, {}};
  for (int i = 0; i < 4; ++i) of_their_own.fixed.push_back(std::make_shared<const textured_model>(*other_));
  EXPECT_GT(make_window_renderer(of_their_own).value().memory_bytes(),
            two + sizeof(window_renderer) + 3 * collision_body(other_).heap_bytes());
}

/// A finder that holds memory and does not say so.
struct silent_finder : convex_piece_finder {
  using convex_piece_finder::convex_piece_finder;
  void heap_bytes() const = delete;
};

TEST_F(RendererMemory, APolicyThatReportsNothingCountsWithItsSize) {
  const scene bodies = feel_->scene();
  const basic_renderer<silent_finder, cpu_depth, gradient_penalty> silent(
      bodies, silent_finder(bodies), make_cpu_depth(bodies).value(), gradient_penalty());
  EXPECT_EQ(silent.memory_bytes() + feel_->finder().heap_bytes(), feel_->memory_bytes());
}

/// What make_shared asks for beyond the object: the counts. They belong to nobody in particular.
template <class T>
std::size_t counts_of_a_shared() {
  const std::size_t before = bytes_on_loan();
  const auto one = std::make_shared<const T>();
  return bytes_on_loan() - before - sizeof(T);
}

/// The renderer that these tests look at: made once, because its fields take most of their time.
struct counted_renderer {
  model_ptr model = std::make_shared<const textured_model>(make_model());
  model_ptr other = std::make_shared<const textured_model>(make_flat_box({0.02, 0.02, 0.02}));
  std::optional<least_motion_renderer> feel;
  std::size_t asked = 0;

  counted_renderer() {
    const std::size_t before = bytes_on_loan();
    auto made = make_renderer({model, {model, other, model, other}});
    EXPECT_TRUE(made);
    if (made) feel.emplace(std::move(made).value());
    asked = bytes_on_loan() - before;
  }
};

class DefaultRendererMemory : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { counted_ = std::make_unique<counted_renderer>(); }
  static void TearDownTestSuite() { counted_.reset(); }

  /// Of what the policies share: two scenes, and of either two bodies.
  [[nodiscard]] static std::size_t counts() { return 6 * counts_of_a_shared<field_scene>(); }
  [[nodiscard]] const field_scene& fields() { return feel_->depth().bodies(); }

 private:
  inline static std::unique_ptr<counted_renderer> counted_;

 protected:
  const model_ptr &model_ = counted_->model, &other_ = counted_->other;
  std::optional<least_motion_renderer>& feel_ = counted_->feel;
  const std::size_t asked_ = counted_->asked;
};

TEST_F(DefaultRendererMemory, IsWhatItHasAskedFor) {
  EXPECT_EQ(feel_->memory_bytes() + counts(), sizeof(least_motion_renderer) + asked_);
  EXPECT_GT(asked_, std::size_t{1} << 20);
}

TEST_F(DefaultRendererMemory, CountsSharedBodiesOnce) {
  // Five bodies, two models: the probe's is also a fixed body, and either appears twice.
  EXPECT_EQ(fields().fixed[0], fields().probe);
  EXPECT_EQ(fields().fixed[2], fields().probe);
  EXPECT_EQ(fields().fixed[1], fields().fixed[3]);
  EXPECT_EQ(fields().heap_bytes(), heap_bytes(fields().fixed) + 2 * sizeof(field_body) + fields().probe->heap_bytes() +
                                       fields().fixed[1]->heap_bytes());
  // Finder and depth backend share them: a finder alone reports none.
  const std::size_t of_depth = feel_->depth().heap_bytes();
  EXPECT_GT(of_depth, fields().heap_bytes());
  EXPECT_LT(of_depth, 2 * fields().heap_bytes());
}

TEST_F(DefaultRendererMemory, RenderersOfTheSameBodiesCanShareThem) {
  const scene bodies{model_, {other_}};
  auto made = make_field_scene(bodies);
  ASSERT_TRUE(made);
  const auto shared = std::make_shared<const field_scene>(std::move(made).value());
  const auto ways_of = exits::make_exit_scene(*shared);
  least_motion_renderer_settings stiffer;
  stiffer.force.stiffness_n_per_m *= 2.0;
  auto one = make_least_motion_renderer(bodies, shared, ways_of),
       two = make_least_motion_renderer(bodies, shared, ways_of, stiffer);
  auto own = make_renderer(bodies);
  ASSERT_TRUE(one && two && own);
  EXPECT_EQ(&one.value().depth().bodies(), shared.get());
  EXPECT_EQ(&two.value().depth().bodies(), shared.get());
  const std::vector<pose> T_wb(1);
  const scene_pose pressed{{{1.0, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.0295}}, T_wb};
  tick by_one, by_two, by_own;
  ASSERT_EQ(one.value().step(pressed, by_one), status::ok);
  ASSERT_EQ(two.value().step(pressed, by_two), status::ok);
  ASSERT_EQ(own.value().step(pressed, by_own), status::ok);
  EXPECT_GT(by_one.force.on_probe_w.force.z, 0.0);
  EXPECT_EQ(by_one.force.on_probe_w.force, by_own.force.on_probe_w.force);
  EXPECT_GT(by_two.force.on_probe_w.force.z, by_one.force.on_probe_w.force.z);

  EXPECT_FALSE(make_least_motion_renderer({model_, {other_, other_}}, shared, ways_of));
  EXPECT_FALSE(make_least_motion_renderer(bodies, std::make_shared<const field_scene>()));
  EXPECT_FALSE(make_least_motion_renderer(bodies, nullptr));
  EXPECT_FALSE(make_least_motion_renderer(bodies, shared, nullptr));
  // What was made for the search of other bodies.
  EXPECT_FALSE(make_least_motion_renderer(bodies, shared, exits::make_exit_scene(fields())));
}

TEST_F(DefaultRendererMemory, StaysTheSameInTicks) {
  const std::size_t before = feel_->memory_bytes();
  const std::vector<pose> T_wb{
      {}, {}, {{1.0, 0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}}, {{1.0, 0.0, 0.0, 0.0}, {2.0, 0.0, 0.0}}};
  tick out;
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(feel_->step({{{1.0, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.0305 - 1e-4 * i}}, T_wb}, out), status::ok);
  }
  EXPECT_GT(glm::length(out.force.on_probe_w.force), 0.1);
  EXPECT_EQ(feel_->memory_bytes(), before);
}

// A report that forgets the smallest of the parts is found out: the comparison is to the byte.
TEST_F(DefaultRendererMemory, AForgottenPartWouldShow) {
  const field_body& body = *fields().probe;
  for (const std::size_t part : {body.field.heap_bytes(), body.samples.heap_bytes(), heap_bytes(fields().fixed),
                                 feel_->force().heap_bytes(), feel_->found().heap_bytes()}) {
    EXPECT_GT(part, 0U);
  }
}

}  // namespace
}  // namespace asperity
