// Loops over several threads whose results do not depend on how many there are.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

#include "bake/stage_monitor.hpp"

namespace asperity::bake {

/// Items per block. Fixed: sums are taken per block and then in block order, so they come out the same on any machine.
inline constexpr std::size_t block_size = 1024;

[[nodiscard]] constexpr std::size_t block_count(std::size_t items) noexcept {
  return (items + block_size - 1) / block_size;
}

/// 0 stands for as many threads as the machine has.
[[nodiscard]] inline unsigned resolve_threads(unsigned asked) noexcept {
  return asked != 0 ? asked : std::max(1U, std::thread::hardware_concurrency());
}

/// Calls body(i) for every i below `tasks`, in any order and at the same time: the calls must not write to the same
/// place. The calling thread works too, and reports progress in [from, to] of the stage.
/// @return false where the bake was cancelled; some tasks have not run then
template <class Body>
[[nodiscard]] bool parallel_tasks(std::size_t tasks, unsigned threads, stage_monitor& monitor, double from, double to,
                                  const Body& body) {
  std::atomic<std::size_t> next{0};
  std::atomic<bool> stop{false};
  const auto run_one = [&] {
    const std::size_t task = next.fetch_add(1, std::memory_order_relaxed);
    if (task >= tasks || stop.load(std::memory_order_relaxed)) return false;
    body(task);
    return true;
  };
  {
    std::vector<std::jthread> helpers;
    for (std::size_t i = 1; i < std::min<std::size_t>(threads, tasks); ++i) {
      helpers.emplace_back([&] {
        while (run_one()) {
        }
      });
    }
    while (run_one()) {
      const auto claimed = static_cast<double>(std::min(next.load(std::memory_order_relaxed), tasks));
      if (!monitor.at(from + (to - from) * claimed / static_cast<double>(tasks))) stop.store(true);
    }
  }
  return !monitor.cancelled();
}

/// Calls body(block, begin, end) for every block of [0, items), as parallel_tasks() does.
template <class Body>
[[nodiscard]] bool parallel_blocks(std::size_t items, unsigned threads, stage_monitor& monitor, double from, double to,
                                   const Body& body) {
  const auto run_block = [&](std::size_t block) {
    body(block, block * block_size, std::min(items, (block + 1) * block_size));
  };
  return parallel_tasks(block_count(items), threads, monitor, from, to, run_block);
}

}  // namespace asperity::bake
