#include "batch.hpp"

#include <algorithm>
#include <atomic>
#include <limits>
#include <mutex>
#include <thread>

namespace asperity::python {
namespace {

constexpr std::size_t block = 32;  // half a millisecond to some: short beside a signal, long beside a counter

class shared_batch {
 public:
  shared_batch(std::span<const pose> T_wa, std::span<const pose> T_wb, std::uint64_t version, std::span<double> out)
      : T_wa_(T_wa), T_wb_(T_wb), version_(version), out_(out) {}

  /// @return whether there may be more
  bool step_block(any_renderer& feel) {
    const std::size_t begin = next_.fetch_add(block, std::memory_order_relaxed);
    if (begin >= T_wa_.size() || stop_.load(std::memory_order_relaxed)) return false;
    tick found;
    for (std::size_t i = begin; i < std::min(begin + block, T_wa_.size()); ++i) {
      scene_pose at{T_wa_[i], T_wb_};
      at.version = version_;
      const status answered = feel.step(at, found);
      const vec6 w = to_vec6(found.force.on_probe_w);
      for (std::size_t k = 0; k < 6; ++k) out_[6 * i + k] = w[k];
      if (answered != status::ok) note(i, answered);
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

  std::span<const pose> T_wa_, T_wb_;
  std::uint64_t version_;
  std::span<double> out_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> stop_{false};
  std::mutex lock_;
  batch_outcome outcome_;
};

}  // namespace

batch_outcome step_all(std::span<any_renderer> renderers, std::span<const pose> T_wa, std::span<const pose> T_wb,
                       std::uint64_t version, std::span<double> out, const std::function<bool()>& keep_going) {
  shared_batch all(T_wa, T_wb, version, out);
  bool cancelled = false;
  {
    std::vector<std::jthread> helpers;
    for (std::size_t t = 1; t < std::min(renderers.size(), (T_wa.size() + block - 1) / block); ++t) {
      helpers.emplace_back([&all, &feel = renderers[t]] {
        while (all.step_block(feel)) {
        }
      });
    }
    while (all.step_block(renderers.front())) {
      if (cancelled || keep_going()) continue;
      cancelled = true;
      all.stop();
    }
  }
  batch_outcome outcome = all.outcome();
  outcome.cancelled = cancelled;
  return outcome;
}

}  // namespace asperity::python
