// The branches by which least motion finds samples are compact: they are the balls of the samples' own tree.
#include "least_motion/mark_tree.hpp"

#include <cstdint>
#include <gtest/gtest.h>
#include <random>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "support/fresh_seed.hpp"

namespace asperity::exits {
namespace {

// Halves by the number of samples are the tree's where each place has one sample. Where places have more they lie across
// the tree's, are larger, and the middle of a contact, which is a mean over branches, lies aside of it: a ball on a ball was
// felt 7 % too soft.
TEST(MarkTree, HasTheBallsOfTheSamplesTree) {
  std::mt19937_64 bits(test_support::fresh_seed("MarkTree.HasTheBallsOfTheSamplesTree", "20 trees"));
  std::uniform_real_distribution<float> side(-0.1F, 0.1F);
  for (int n = 0; n < 20; ++n) {
    placed_samples placed;
    for (std::size_t places = 1 + bits() % 2000; places > 0; --places) {
      const glm::vec3 at(side(bits), side(bits), side(bits));
      placed.at_place.push_back(static_cast<std::uint8_t>(1 + bits() % placed_samples::most));
      for (std::uint8_t i = 0; i < placed.at_place.back(); ++i) {
        placed.all.push_back({at + 0.01F * glm::vec3(side(bits), side(bits), side(bits))});
      }
    }
    const sample_tree tree(placed);
    std::set<std::pair<std::size_t, std::size_t>> balls;  // their first sample, and how many
    for (std::uint32_t b = 0; b < tree.balls(); ++b) {
      const std::span<const field_sample> part = tree.at(b).samples();
      balls.insert({static_cast<std::size_t>(part.data() - tree.samples().data()), part.size()});
    }
    const mark_tree marks(tree);
    std::size_t in_leaves = 0;
    for (const branch& b : marks.branches()) {
      if (b.count > sample_tree::leaf_samples) {
        EXPECT_TRUE(balls.contains({b.first, b.count})) << b.first;
      }
      if (b.right == 0) in_leaves += b.count;
    }
    EXPECT_EQ(in_leaves, tree.samples().size());
  }
}

}  // namespace
}  // namespace asperity::exits
