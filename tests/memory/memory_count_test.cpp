// The bytes that a model and a renderer report are those that they have asked for, to the byte.
#include <gtest/gtest.h>
#include <memory>
#include <optional>
#include <utility>

#include "asperity/render/default_renderer.hpp"
#include "counted_heap.hpp"
#include "support/piece_models.hpp"
#include "support/small_models.hpp"

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
    auto made = make_paper_renderer({model_, {model_, other_}});
    EXPECT_TRUE(made);
    if (made) feel_.emplace(std::move(made).value());
    asked_ = bytes_on_loan() - before;
  }

  model_ptr model_ = std::make_shared<const textured_model>(make_model());
  model_ptr other_ = std::make_shared<const textured_model>(make_flat_box({0.02, 0.02, 0.02}));
  std::optional<paper_renderer> feel_;
  std::size_t asked_ = 0;
};

TEST_F(RendererMemory, IsWhatItHasAskedFor) {
  EXPECT_EQ(feel_->memory_bytes(), sizeof(paper_renderer) + asked_);
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
                                 body.shapes.front().heap_bytes(), feel_->contacts().heap_bytes()}) {
    EXPECT_GT(part, 0U);
    EXPECT_NE(feel_->memory_bytes() - part, sizeof(paper_renderer) + asked_);
  }
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

class SharedRendererMemory : public ::testing::Test {
 protected:
  SharedRendererMemory() {
    settings_.cells.pitch_m = 5e-4;
    const std::size_t before = bytes_on_loan();
    auto made = make_renderer({model_, {model_, other_, model_, other_}}, settings_);
    EXPECT_TRUE(made);
    if (made) feel_.emplace(std::move(made).value());
    asked_ = bytes_on_loan() - before;
  }

  [[nodiscard]] const cell_scene& cells() { return feel_->depth().bodies(); }

  renderer_settings settings_;
  model_ptr model_ = std::make_shared<const textured_model>(make_model());
  model_ptr other_ = std::make_shared<const textured_model>(make_flat_box({0.02, 0.02, 0.02}));
  std::optional<renderer> feel_;
  std::size_t asked_ = 0;
};

TEST_F(SharedRendererMemory, IsWhatItHasAskedFor) {
  const std::size_t counts = counts_of_a_shared<cell_scene>() + 2 * counts_of_a_shared<surface_cells>();
  EXPECT_EQ(feel_->memory_bytes() + counts, sizeof(renderer) + asked_);
  EXPECT_GT(asked_, std::size_t{1} << 20);
}

TEST_F(SharedRendererMemory, CountsSharedCellsOnce) {
  // Five bodies, two models: the probe's is also a fixed body, and either appears twice.
  EXPECT_EQ(cells().fixed[0], cells().probe);
  EXPECT_EQ(cells().fixed[2], cells().probe);
  EXPECT_EQ(cells().fixed[1], cells().fixed[3]);
  EXPECT_EQ(cells().heap_bytes(), heap_bytes(cells().fixed) + 2 * sizeof(surface_cells) + cells().probe->heap_bytes() +
                                      cells().fixed[1]->heap_bytes());
  // Finder and depth backend share them: a finder alone reports none.
  auto one = make_renderer({model_, {other_}}, settings_);
  ASSERT_TRUE(one);
  const std::size_t more_bodies = heap_bytes(feel_->scene().fixed) - heap_bytes(one.value().scene().fixed) +
                                  heap_bytes(cells().fixed) - heap_bytes(one.value().depth().bodies().fixed);
  EXPECT_EQ(feel_->memory_bytes() - one.value().memory_bytes(), more_bodies);
}

TEST_F(SharedRendererMemory, RenderersOfTheSameBodiesCanShareTheirCells) {
  const scene bodies{model_, {other_}};
  auto cut = make_cell_scene(bodies, settings_.cells);
  ASSERT_TRUE(cut);
  const auto shared = std::make_shared<const cell_scene>(std::move(cut).value());
  renderer_settings stiffer = settings_;
  stiffer.shared.stiffness_n_per_m *= 2.0;
  auto one = make_renderer(bodies, shared, settings_), two = make_renderer(bodies, shared, stiffer);
  auto own = make_renderer(bodies, settings_);
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

  EXPECT_FALSE(make_renderer({model_, {other_, other_}}, shared, settings_));
  EXPECT_FALSE(make_renderer(bodies, std::make_shared<const cell_scene>(), settings_));
  EXPECT_FALSE(make_renderer(bodies, nullptr, settings_));
}

TEST_F(SharedRendererMemory, StaysTheSameInTicks) {
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
TEST_F(SharedRendererMemory, AForgottenPartWouldShow) {
  const surface_cells& c = *cells().probe;
  for (const std::size_t part :
       {heap_bytes(c.cells), heap_bytes(c.origins), heap_bytes(c.outgoing), heap_bytes(c.edges), heap_bytes(c.tiles),
        c.edge_tree.heap_bytes(), feel_->force().heap_bytes(), feel_->contacts().heap_bytes()}) {
    EXPECT_GT(part, counts_of_a_shared<cell_scene>() + 2 * counts_of_a_shared<surface_cells>());
  }
}

}  // namespace
}  // namespace asperity
