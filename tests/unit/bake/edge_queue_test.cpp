#include "bake/edge_queue.hpp"

#include <functional>
#include <gtest/gtest.h>
#include <random>
#include <set>
#include <utility>
#include <vector>

namespace asperity::bake {
namespace {

constexpr std::uint32_t halfedges = 500;

// Against a set that is sorted all the time. Few costs, so that many are equal.
TEST(EdgeQueue, GivesTheCheapestWhateverHasChanged) {
  std::mt19937 roll(5);
  const auto cost = [&] { return static_cast<double>(roll() % 20); };
  edge_queue queue(halfedges, std::less<std::uint32_t>());
  std::set<std::pair<double, std::uint32_t>> sorted;
  std::vector<double> cost_of(halfedges, -1.0);
  const auto drop = [&](std::uint32_t h) { sorted.erase({cost_of[h], h}); };

  std::vector<std::uint32_t> first;
  std::vector<double> costs;
  for (std::uint32_t h = 0; h < halfedges; h += 2) {
    first.push_back(h);
    costs.push_back(cost_of[h] = cost());
    sorted.emplace(cost_of[h], h);
  }
  queue.fill(first, costs);
  for (int i = 0; i < 20000 && !sorted.empty(); ++i) {
    ASSERT_FALSE(queue.empty());
    ASSERT_EQ(queue.top(), sorted.begin()->second) << i;
    const auto h = static_cast<std::uint32_t>(roll() % halfedges);
    switch (roll() % 4) {
      case 0:
        queue.erase(queue.top());
        sorted.erase(sorted.begin());
        break;
      case 1:
        queue.erase(h);
        drop(h);
        break;
      default:
        drop(h);
        sorted.emplace(cost_of[h] = cost(), h);
        queue.set(h, cost_of[h]);
    }
  }
  while (!sorted.empty()) {
    ASSERT_EQ(queue.top(), sorted.begin()->second);
    queue.erase(queue.top());
    sorted.erase(sorted.begin());
  }
  EXPECT_TRUE(queue.empty());
}

TEST(EdgeQueue, AnEmptyOneStaysEmpty) {
  edge_queue queue(3, std::less<std::uint32_t>());
  queue.fill({}, {});
  queue.erase(1);
  EXPECT_TRUE(queue.empty());
  queue.set(2, 1.0);
  EXPECT_EQ(queue.top(), 2u);
}

}  // namespace
}  // namespace asperity::bake
