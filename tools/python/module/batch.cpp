#include "batch.hpp"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <thread>
#include <vector>

namespace asperity::python {
namespace {

class shared_rows {
 public:
  shared_rows(const batch_shares& shares, const std::function<status(std::size_t, std::size_t)>& step)
      : shares_(shares), step_(step) {}

  /// @return whether there may be more
  bool step_block(std::size_t thread) {
    const std::size_t begin = next_.fetch_add(shares_.block, std::memory_order_relaxed);
    if (begin >= shares_.rows || stop_.load(std::memory_order_relaxed)) return false;
    for (std::size_t i = begin; i < std::min(begin + shares_.block, shares_.rows); ++i) {
      if (const status answered = step_(thread, i); answered != status::ok) note(i, answered);
    }
    return true;
  }

  void stop() noexcept { stop_.store(true, std::memory_order_relaxed); }
  [[nodiscard]] const batch_outcome& outcome() const noexcept { return outcome_; }

 private:
  void note(std::size_t i, status answered) {
    const std::lock_guard lock(lock_);
    if (answered == status::capacity_reached) {
      ++outcome_.incomplete;
    } else if (i < outcome_.failed_at || outcome_.failed == status::ok) {
      outcome_.failed = answered;
      outcome_.failed_at = i;
    }
  }

  batch_shares shares_;
  const std::function<status(std::size_t, std::size_t)>& step_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> stop_{false};
  std::mutex lock_;
  batch_outcome outcome_;
};

}  // namespace

batch_outcome step_rows(const batch_shares& shares, const std::function<status(std::size_t, std::size_t)>& step,
                        const std::function<bool()>& keep_going) {
  shared_rows all(shares, step);
  {
    std::vector<std::jthread> helpers;
    for (std::size_t t = 1; t < std::min(shares.threads, (shares.rows + shares.block - 1) / shares.block); ++t) {
      helpers.emplace_back([&all, t] {
        while (all.step_block(t)) {
        }
      });
    }
    bool cancelled = false;
    while (all.step_block(0)) {
      if (cancelled || keep_going()) continue;
      cancelled = true;
      all.stop();
    }
  }
  return all.outcome();
}

}  // namespace asperity::python
