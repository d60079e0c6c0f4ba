#include <gtest/gtest.h>
#include <memory>

#include "asperity/core/status.hpp"

namespace {

using namespace asperity;

result<int> half(int x) {
  if (x % 2 != 0) return error{error_code::invalid_argument, "an odd number has no half; give an even one"};
  return x / 2;
}

TEST(result, holds_a_value_or_an_error) {
  const auto good = half(6);
  ASSERT_TRUE(good);
  EXPECT_EQ(*good, 3);
  const auto bad = half(7);
  ASSERT_FALSE(bad);
  EXPECT_EQ(bad.error().code, error_code::invalid_argument);
  EXPECT_NE(bad.error().message.find("even"), std::string::npos);
}

TEST(result, moves_out_what_cannot_be_copied) {
  result<std::unique_ptr<int>> r = std::make_unique<int>(5);
  const std::unique_ptr<int> p = std::move(r).value();
  EXPECT_EQ(*p, 5);
}

TEST(result, without_a_value_means_success) {
  EXPECT_TRUE(result<void>{}.has_value());
  const result<void> bad = error{error_code::io_failed, "no"};
  EXPECT_FALSE(bad);
}

TEST(status, every_value_has_words) {
  for (int s = 0; s <= static_cast<int>(status::backend_failed); ++s) {
    EXPECT_STRNE(to_string(static_cast<status>(s)), "unknown status");
  }
  for (int c = 0; c <= static_cast<int>(error_code::busy); ++c) {
    EXPECT_STRNE(to_string(static_cast<error_code>(c)), "unknown_error");
  }
}

}  // namespace
