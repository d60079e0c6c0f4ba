#include "asperity/core/fixed_vector.hpp"

#include <gtest/gtest.h>

namespace {

TEST(fixed_vector, counts_what_it_refuses) {
  asperity::fixed_vector<int, 2> v;
  EXPECT_TRUE(v.push_back(1));
  EXPECT_TRUE(v.push_back(2));
  EXPECT_FALSE(v.push_back(3));
  EXPECT_TRUE(v.full());
  EXPECT_EQ(v.size(), 2U);
  EXPECT_EQ(v.dropped(), 1U);
  EXPECT_EQ(v.back(), 2);
  v.clear();
  EXPECT_TRUE(v.empty());
  EXPECT_EQ(v.dropped(), 0U);
}

TEST(fixed_vector, iterates_over_what_it_holds) {
  asperity::fixed_vector<int, 8> v;
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(v.push_back(i));
  v.truncate(3);
  int sum = 0;
  for (const int x : v) sum += x;
  EXPECT_EQ(sum, 3);
}

}  // namespace
