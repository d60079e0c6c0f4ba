// The tree against testing every box.
#include "window/aabb_tree.hpp"

#include <gtest/gtest.h>
#include <vector>

#include "support/random_hulls.hpp"

namespace asperity {
namespace {

TEST(aabb_tree, finds_what_testing_every_box_finds) {
  test::uniform_source uniform(31);
  for (const std::size_t count : {1U, 2U, 3U, 17U, 500U}) {
    std::vector<bounds> boxes;
    for (std::size_t i = 0; i < count; ++i) {
      const vec3 low = uniform.in_box(1.0);
      boxes.push_back({low, low + glm::abs(uniform.in_box(0.2))});
    }
    const aabb_tree tree(boxes);
    for (int k = 0; k < 100; ++k) {
      const vec3 low = uniform.in_box(1.2);
      const bounds box{low, low + glm::abs(uniform.in_box(0.5))};
      std::vector<int> hits(count, 0);
      tree.query(box, [&](std::uint32_t i) { ++hits[i]; });
      for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(hits[i], overlap(boxes[i], box) ? 1 : 0);
    }
  }
}

TEST(aabb_tree, equal_boxes_are_all_found) {
  const std::vector<bounds> boxes(64, bounds{vec3(0.0), vec3(1.0)});
  std::size_t hits = 0;
  aabb_tree(boxes).query({vec3(1.0), vec3(2.0)}, [&](std::uint32_t) { ++hits; });
  EXPECT_EQ(hits, 64U);
}

TEST(aabb_tree, an_empty_tree_finds_nothing) {
  std::size_t hits = 0;
  aabb_tree().query({vec3(-1.0), vec3(1.0)}, [&](std::uint32_t) { ++hits; });
  EXPECT_EQ(hits, 0U);
}

}  // namespace
}  // namespace asperity
