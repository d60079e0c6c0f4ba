// How finer nodes continue the spline of a brick: knot insertion.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "least_motion/moving_shape.hpp"

namespace asperity::exits {

/// What a node of S, from one before a brick on, gives to each of the brick's nodes along an axis: a cubic B-spline is a
/// sum of `finer` times narrower ones, whose weights are those of four boxes of that many nodes, one after the other.
struct inserted_nodes {
  static constexpr std::size_t along = moving_shape::along, finer = moving_shape::finer;
  static constexpr std::size_t coarse = moving_shape::cells + 3;  ///< nodes of S, from one before the brick on

  std::array<std::array<double, along>, coarse> of{};  ///< by node of S, then of the brick
  std::array<std::size_t, along> first{}, end{};       ///< the nodes of S that give a node of the brick something

  inserted_nodes() {
    std::vector<double> mask{static_cast<double>(finer)};
    for (int box = 0; box < 4; ++box) {
      std::vector<double> wider(mask.size() + finer - 1, 0.0);
      for (std::size_t i = 0; i < mask.size(); ++i) {
        for (std::size_t j = 0; j < finer; ++j) wider[i + j] += mask[i] / static_cast<double>(finer);
      }
      mask = std::move(wider);
    }
    for (std::size_t n = 0; n < along; ++n) {
      first[n] = coarse;
      for (std::size_t q = 0; q < coarse; ++q) {
        // Both count from the brick's first node, which is the second of each.
        const std::size_t i = n + 3 * (finer - 1), before = q * finer;
        if (i < before || i - before >= mask.size()) continue;
        of[q][n] = mask[i - before];
        first[n] = std::min(first[n], q);
        end[n] = q + 1;
      }
    }
  }
};

}  // namespace asperity::exits
