// A context for a test, or the reason to skip it.
#pragma once

#include <gtest/gtest.h>
#include <string>

#include "asperity/gl/context.hpp"
#include "asperity/gl/functions.hpp"

namespace asperity::test_support {

/// Tests that need OpenGL: each has a context of its own, current in its thread, and ends without an error in it.
class gl_test : public ::testing::Test {
 protected:
  void SetUp() override {
    result<gl::context_ptr> opened = gl::open_context();
    if (!opened) GTEST_SKIP() << opened.error().message;
    context = *std::move(opened);
    ASSERT_EQ(context->make_current(), status::ok);
  }
  void TearDown() override {
    if (context == nullptr || context->make_current() != status::ok) return;
    EXPECT_EQ(gl::take_errors(context->gl()), "");
    context->release();
  }

  gl::context_ptr context;
};

}  // namespace asperity::test_support
