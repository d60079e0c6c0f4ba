// Loops over several threads whose results do not depend on how many there are.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <system_error>
#include <thread>
#include <vector>

namespace asperity::detail {

/// 0 stands for as many threads as the machine has.
[[nodiscard]] inline unsigned resolve_threads(unsigned asked) noexcept {
  return asked != 0 ? asked : std::max(1U, std::thread::hardware_concurrency());
}

/// Calls body(i) for every i below `tasks`, in any order and at the same time: the calls must not write to the same
/// place. The calling thread works too, alone where the system gives it no other. What a call throws is thrown on.
/// Not for a tick.
template <class Body>
void for_each_task(std::size_t tasks, unsigned threads, const Body& body) {
  if (threads <= 1 || tasks <= 1) {
    for (std::size_t i = 0; i < tasks; ++i) body(i);
    return;
  }
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next.fetch_add(1); i < tasks; i = next.fetch_add(1)) body(i);
  };
#if defined(__cpp_exceptions)
  std::atomic<bool> failed{false};
  std::exception_ptr failure;
  const auto work_safely = [&] {
    try {
      work();
    } catch (...) {
      next.store(tasks);
      if (!failed.exchange(true)) failure = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> helpers;
    try {
      while (helpers.size() + 1 < std::min<std::size_t>(threads, tasks)) helpers.emplace_back(work_safely);
    } catch (const std::system_error&) {  // no more threads: those that there are do the work
    }
    work_safely();
  }
  if (failure) std::rethrow_exception(failure);
#else
  std::vector<std::jthread> helpers;
  while (helpers.size() + 1 < std::min<std::size_t>(threads, tasks)) helpers.emplace_back(work);
  work();
#endif
}

/// Where part i of `parts` begins in `items`; part `parts` begins at its end.
[[nodiscard]] constexpr std::size_t part_begin(std::size_t items, std::size_t parts, std::size_t i) noexcept {
  return items / parts * i + std::min(i, items % parts);
}

/// How many parts to cut work into: one for a single thread, and some for each of several, as some take longer.
[[nodiscard]] constexpr std::size_t parts_for(std::size_t items, unsigned threads) noexcept {
  return std::max<std::size_t>(1, std::min<std::size_t>(items, threads > 1 ? std::size_t{4} * threads : 1));
}

/// Calls body(begin, end) for parts of [0, items), as for_each_task() does.
template <class Body>
void for_each_part(std::size_t items, unsigned threads, const Body& body) {
  const std::size_t parts = parts_for(items, threads);
  for_each_task(parts, threads,
                [&](std::size_t i) { body(part_begin(items, parts, i), part_begin(items, parts, i + 1)); });
}

/// One list of the lists that parts made, in their order.
template <class T>
[[nodiscard]] std::vector<T> joined(std::vector<std::vector<T>> lists) {
  if (lists.size() == 1) return std::move(lists[0]);
  std::size_t count = 0;
  for (const std::vector<T>& l : lists) count += l.size();
  std::vector<T> out;
  out.reserve(count);
  for (std::vector<T>& l : lists) {
    out.insert(out.end(), l.begin(), l.end());
    l = std::vector<T>();
  }
  return out;
}

}  // namespace asperity::detail
