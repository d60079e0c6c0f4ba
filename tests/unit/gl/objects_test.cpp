#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <memory>

#include "asperity/gl/mapped_buffer.hpp"
#include "asperity/gl/program.hpp"
#include "asperity/gl/uploaded_model.hpp"
#include "support/gl_context.hpp"
#include "support/height_models.hpp"

namespace asperity::gl {
namespace {

using GlObjects = test_support::gl_test;

TEST_F(GlObjects, MemoryIsCountedAndGivenBack) {
  ASSERT_EQ(context->device_bytes(), 0U);
  {
    auto first = make_texture(context, GL_R32F, 32, 32, "another");
    ASSERT_TRUE(first);
    auto texture = make_texture(context, GL_RGBA32F, 32, 16, "a texture");
    ASSERT_TRUE(texture);
    EXPECT_EQ(context->device_bytes(), 4096U + 32 * 16 * 16);
    const owned_name moved = *std::move(first);
    EXPECT_EQ(context->device_bytes(), 4096U + 32 * 16 * 16);
  }
  EXPECT_EQ(context->device_bytes(), 0U);
}

TEST_F(GlObjects, TheLimitIsALimit) {
  context->limit_memory(10'000);
  ASSERT_TRUE(make_texture(context, GL_R32F, 50, 40, "the first"));
  const auto held = make_texture(context, GL_R32F, 50, 40, "the second");
  ASSERT_TRUE(held) << "the first one's memory was given back";
  const auto third = make_texture(context, GL_R32F, 50, 40, "the third");
  ASSERT_FALSE(third);
  EXPECT_EQ(third.error().code, error_code::limit_exceeded);
  EXPECT_NE(third.error().message.find("the third needs 8000 bytes"), std::string::npos) << third.error().message;
  EXPECT_EQ(context->device_bytes(), 8'000U);
  EXPECT_FALSE(mapped_buffer::make(context, 8'000, direction::to_device, "a mapped one"));
}

TEST_F(GlObjects, ATextureBeyondTheDeviceIsRefused) {
  const auto texture = make_texture(context, GL_RGBA32F, 1U << 20, 4, "a wide texture");
  ASSERT_FALSE(texture);
  EXPECT_EQ(texture.error().code, error_code::unsupported);
  EXPECT_EQ(context->device_bytes(), 0U);
}

TEST_F(GlObjects, AShaderThatDoesNotCompileSaysWhere) {
  const shader_stage stage{GL_COMPUTE_SHADER,
                           "#define GOOD 1\n",
                           {{"good.glsl", "layout(local_size_x = 1) in;\n"},
                            {"bad.glsl", "void helper() {}\nvoid main() { nonsense = 1; }\n"}}};
  const auto program = make_program(context, std::span(&stage, 1), "a test");
  ASSERT_FALSE(program);
  EXPECT_EQ(program.error().code, error_code::unsupported);
  const std::string& m = program.error().message;
  EXPECT_NE(m.find("a test: bad.glsl line 2: "), std::string::npos) << m;
  EXPECT_NE(m.find("nonsense"), std::string::npos) << m;
}

TEST_F(GlObjects, ErrorsAreSeen) {
  EXPECT_EQ(take_errors(context->gl()), "");
  context->gl().Enable(0xdead);
  EXPECT_EQ(take_errors(context->gl()), "GL_INVALID_ENUM");
  EXPECT_EQ(take_errors(context->gl()), "");
}

TEST_F(GlObjects, AModelIsUploadedOnce) {
  test_support::plate_spec spec;
  spec.texels = 64;
  const model_ptr model = test_support::make_plate(spec);
  std::size_t bytes = 0;
  {
    const auto first = upload(context, model);
    ASSERT_TRUE(first) << first.error().message;
    bytes = context->device_bytes();
    EXPECT_EQ(bytes, (*first)->device_bytes());
    EXPECT_EQ(bytes, model->texture.texels.size() * 16);
    const auto second = upload(context, model);
    ASSERT_TRUE(second);
    EXPECT_EQ(first->get(), second->get());
    EXPECT_EQ(context->device_bytes(), bytes);
    const auto other = upload(context, test_support::make_plate(spec));
    ASSERT_TRUE(other);
    EXPECT_EQ(context->device_bytes(), 2 * bytes);
  }
  EXPECT_EQ(context->device_bytes(), 0U);
}

TEST_F(GlObjects, TexelsArriveAndBrokenOnesAreMarked) {
  test_support::plate_spec spec;
  spec.texels = 32;
  auto model = std::make_shared<textured_model>(*test_support::make_plate(spec));
  model->texture.texels[5].y = std::numeric_limits<float>::quiet_NaN();
  model->texture.texels[9].x = std::numeric_limits<float>::infinity();
  const auto there = upload(context, model);
  ASSERT_TRUE(there);
  const functions& gl = context->gl();
  const owned_name frame = make_name(context, name_kind::framebuffer);
  gl.BindFramebuffer(GL_FRAMEBUFFER, frame.get());
  gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, (*there)->texture.get(), 0);
  ASSERT_EQ(gl.CheckFramebufferStatus(GL_FRAMEBUFFER), static_cast<GLenum>(GL_FRAMEBUFFER_COMPLETE));
  std::vector<glm::vec4> read(model->texture.texels.size());
  gl.ReadPixels(0, 0, static_cast<GLsizei>(model->texture.width), static_cast<GLsizei>(model->texture.height), GL_RGBA,
                GL_FLOAT, read.data());
  std::size_t broken = 0;
  for (std::size_t i = 0; i < read.size(); ++i) {
    if (i == 5 || i == 9) {
      EXPECT_EQ(read[i], glm::vec4(0.0F));
      ++broken;
    } else {
      EXPECT_EQ(read[i], glm::vec4(model->texture.texels[i], 1.0F));
    }
  }
  EXPECT_EQ(broken, 2U);
  gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
}

TEST_F(GlObjects, OutliveTheirThread) {
  result<owned_name> texture = make_texture(context, GL_R32F, 8, 4, "a texture");
  ASSERT_TRUE(texture);
  context->release();
  {
    const owned_name gone = *std::move(texture);
    EXPECT_FALSE(context->is_current());
  }
  EXPECT_EQ(context->device_bytes(), 0U);
  EXPECT_FALSE(context->is_current());
}

}  // namespace
}  // namespace asperity::gl
