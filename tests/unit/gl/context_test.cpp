#include "asperity/gl/context.hpp"

#include <array>
#include <gtest/gtest.h>
#include <thread>
#include <vector>

#include "asperity/gl/device.hpp"
#include "asperity/gl/mapped_buffer.hpp"
#include "asperity/gl/program.hpp"
#include "support/gl_context.hpp"

namespace asperity::gl {
namespace {

using GlContext = test_support::gl_test;

/// Fills a buffer with `seed` plus the index by a compute shader: true where every number arrived.
bool counts(const context_ptr& context, std::uint32_t seed) {
  constexpr std::string_view text = R"(
layout(local_size_x = 64) in;
layout(std430, binding = 0) writeonly buffer result { uint number[]; };
uniform uint seed;
void main() { number[gl_GlobalInvocationID.x] = seed + gl_GlobalInvocationID.x; }
)";
  const shader_stage stage{GL_COMPUTE_SHADER, "", {{"count.glsl", text}}};
  auto program = make_program(context, std::span(&stage, 1), "counting");
  auto buffer = mapped_buffer::make(context, 4 * 1024, direction::from_device, "numbers");
  if (!program || !buffer) return false;
  const functions& gl = context->gl();
  gl.UseProgram(program->get());
  gl.Uniform1ui(gl.GetUniformLocation(program->get(), "seed"), seed);
  gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, buffer->name());
  gl.DispatchCompute(16, 1, 1);
  if (wait_for_device(gl, 5'000'000'000) != status::ok || buffer->receive(4 * 1024) != status::ok) return false;
  const auto numbers = buffer->as<std::uint32_t>();
  for (std::uint32_t i = 0; i < 1024; ++i) {
    if (numbers[i] != seed + i) return false;
  }
  return true;
}

TEST_F(GlContext, SaysWhatItIs) {
  const context_facts& facts = context->facts();
  EXPECT_FALSE(facts.renderer.empty());
  EXPECT_GE(10 * facts.major + facts.minor, facts.dialect == dialect::core ? 43 : 31);
  const bool llvmpipe = facts.renderer.find("llvmpipe") != std::string::npos;
  EXPECT_TRUE(facts.software || !llvmpipe);
  EXPECT_EQ(context->check(), status::ok);
  EXPECT_TRUE(counts(context, 7));
}

TEST_F(GlContext, ComesAndGoes) {
  for (std::uint32_t i = 0; i < 3; ++i) {
    context.reset();
    const auto again = open_context();
    ASSERT_TRUE(again) << again.error().message;
    context = *again;
    ASSERT_EQ(context->make_current(), status::ok);
    EXPECT_TRUE(counts(context, i));
  }
}

TEST_F(GlContext, EsCountsToo) {
  const auto es = open_context({.dialect = dialect::es});
  if (!es) GTEST_SKIP() << es.error().message;
  ASSERT_EQ((*es)->make_current(), status::ok);
  EXPECT_EQ((*es)->facts().dialect, dialect::es);
  EXPECT_FALSE((*es)->facts().double_precision);
  EXPECT_TRUE(counts(*es, 11));
  EXPECT_EQ(take_errors((*es)->gl()), "");
}

TEST_F(GlContext, SeveralDoNotDisturbEachOther) {
  const auto other = open_context();
  ASSERT_TRUE(other);
  for (std::uint32_t i = 0; i < 2; ++i) {
    ASSERT_EQ(context->make_current(), status::ok);
    EXPECT_TRUE(counts(context, i));
    ASSERT_EQ((*other)->make_current(), status::ok);
    EXPECT_FALSE(context->is_current());
    EXPECT_TRUE(counts(*other, 100 + i));
  }
}

TEST_F(GlContext, EachThreadHasItsOwn) {
  std::array<int, 4> good{};
  std::vector<std::thread> threads;
  for (int& g : good) {
    threads.emplace_back([&g] {
      const auto mine = open_context();
      if (!mine || (*mine)->make_current() != status::ok) return;
      for (std::uint32_t i = 0; i < 5; ++i) g += counts(*mine, i) ? 1 : 0;
    });
  }
  for (std::thread& t : threads) t.join();
  for (const int g : good) EXPECT_EQ(g, 5);
}

TEST_F(GlContext, BelongsToOneThreadAtATime) {
  status elsewhere = status::ok, after = status::backend_failed;
  bool counted = false;
  std::thread([&] { elsewhere = context->make_current(); }).join();
  EXPECT_EQ(elsewhere, status::backend_failed);
  EXPECT_TRUE(context->is_current());
  context->release();
  std::thread([&] {
    after = context->make_current();
    counted = counts(context, 3);
  }).join();
  EXPECT_EQ(after, status::ok);
  EXPECT_TRUE(counted);
  // The thread ended with the context in its hands.
  EXPECT_EQ(context->make_current(), status::ok);
  EXPECT_TRUE(counts(context, 4));
}

TEST_F(GlContext, AScopePutsBackWhatWasThere) {
  const auto other = open_context();
  ASSERT_TRUE(other);
  {
    const current_scope here(*other);
    EXPECT_EQ(here.state(), status::ok);
    EXPECT_TRUE((*other)->is_current());
  }
  EXPECT_TRUE(context->is_current());
  context->release();
  { const current_scope here(*other); }
  EXPECT_FALSE((*other)->is_current());
  EXPECT_FALSE(context->is_current());
}

TEST_F(GlContext, ALostOneCannotBeUsed) {
  context->simulate_loss();
  EXPECT_EQ(context->check(), status::backend_failed);
  EXPECT_EQ(context->make_current(), status::backend_failed);
}

TEST_F(GlContext, IsChosenByIndexOrName) {
  const auto devices = list_devices();
  ASSERT_TRUE(devices);
  ASSERT_FALSE(devices->empty());
  std::size_t working = 0;
  for (const device& d : *devices) {
    if (!d.problem.empty()) continue;
    ++working;
    for (const std::string& by : {std::to_string(d.index), d.name}) {
      const auto c = open_context({.device = by});
      ASSERT_TRUE(c) << c.error().message;
      EXPECT_EQ((*c)->facts().renderer, d.name);
    }
  }
  EXPECT_GT(working, 0U);
  const auto none = open_context({.device = "no such card"});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, error_code::invalid_argument);
  EXPECT_NE(none.error().message.find(context->facts().renderer), std::string::npos) << none.error().message;
  const auto beyond = open_context({.device = std::to_string(devices->size())});
  ASSERT_FALSE(beyond);
  EXPECT_EQ(beyond.error().code, error_code::invalid_argument);
}

}  // namespace
}  // namespace asperity::gl
