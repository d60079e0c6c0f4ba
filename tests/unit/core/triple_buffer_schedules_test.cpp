// The triple buffer's own code in every order in which two threads can interleave it.
//
// The consumer runs; before each of its accesses to shared memory the producer takes any number of its steps. All
// choices of these numbers are all interleavings. Memory is sequentially consistent here: orders of memory accesses are
// ThreadSanitizer's part (triple_buffer_test, triple_buffer_relaxed_control).
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <iostream>
#include <utility>
#include <vector>

#include "asperity/core/triple_buffer.hpp"
#include "unit/core/hand_over_variants.hpp"

namespace {

using asperity::triple_buffer;
using asperity::test_support::two_slot_buffer;

/// Enumerates sequences of choices, depth first.
class choices {
 public:
  /// A number from 0 to `most`.
  std::size_t choose(std::size_t most) {
    if (depth_ == made_.size()) made_.push_back({0, most});
    return made_[depth_++].taken;
  }
  /// Begins the next sequence. @return false after the last
  bool next() {
    depth_ = 0;
    while (!made_.empty() && made_.back().taken == made_.back().most) made_.pop_back();
    if (made_.empty()) return false;
    ++made_.back().taken;
    return true;
  }

 private:
  struct choice {
    std::size_t taken, most;
  };
  std::vector<choice> made_;
  std::size_t depth_ = 0;
};

/// Lets the producer run. Empty while it does.
struct interruption {
  void (*call)(void*) = nullptr;
  void* with = nullptr;
};
interruption before_access;

void pause() {
  if (before_access.call != nullptr) before_access.call(before_access.with);
}

/// A shared byte that can be interrupted before each access.
template <class T>
class stepped {
 public:
  stepped(T v) noexcept : value_(v) {}
  T load(std::memory_order) const {
    pause();
    return value_;
  }
  T exchange(T v, std::memory_order) {
    pause();
    return std::exchange(value_, v);
  }

 protected:
  T value_;
};

/// Broken: the exchange is a load and a store.
template <class T>
class torn_exchange : public stepped<T> {
 public:
  using stepped<T>::stepped;
  T exchange(T v, std::memory_order order) {
    const T old = this->load(order);
    pause();
    this->value_ = v;
    return old;
  }
};

/// Broken: every value looks new.
template <class T>
class always_fresh : public stepped<T> {
 public:
  using stepped<T>::stepped;
  T load(std::memory_order order) const { return static_cast<T>(stepped<T>::load(order) | 4); }
};

/// Broken: no value looks new, the mark is lost on the way.
template <class T>
class never_fresh : public stepped<T> {
 public:
  using stepped<T>::stepped;
  T exchange(T v, std::memory_order order) { return stepped<T>::exchange(static_cast<T>(v & 3), order); }
};

int loads = 0;
int exchanges = 0;

/// Counts what is done to it.
template <class T>
class counted {
 public:
  counted(T v) noexcept : value_(v) {}
  T load(std::memory_order) const {
    ++loads;
    return value_;
  }
  T exchange(T v, std::memory_order) {
    ++exchanges;
    return std::exchange(value_, v);
  }

 private:
  T value_;
};

struct halves {
  std::size_t first = 0, second = 0;
};

constexpr std::size_t published = 4;
constexpr std::size_t polls = 4;

/// Schedules in which something went wrong.
struct verdict {
  std::uint64_t schedules = 0;
  std::uint64_t torn = 0;       ///< two halves of different values
  std::uint64_t backwards = 0;  ///< not newer than the value before
  std::uint64_t stale = 0;      ///< older than what was published before refresh() was called
  std::uint64_t unsteady = 0;   ///< front() changed without a refresh()
  std::uint64_t lost = 0;       ///< the last value never arrived
};

template <class Buffer>
class two_threads {
 public:
  two_threads(choices& order, verdict& out) : order_(order), out_(out) {}

  void run() {
    for (std::size_t i = 0; i < polls; ++i) poll();
    before_access = {};
    while (step_ < steps) produce();
    poll();
    out_.torn += torn_;
    out_.backwards += backwards_;
    out_.stale += stale_;
    out_.unsteady += unsteady_;
    out_.lost += last_ != published;
  }

 private:
  static constexpr std::size_t steps = 3 * published;

  // publish() has one access to shared memory: writing the two halves and publishing are all the steps there are.
  void produce() {
    const std::size_t value = step_ / 3 + 1;
    if (step_ % 3 == 0) buffer_.back().first = value;
    if (step_ % 3 == 1) buffer_.back().second = value;
    if (step_ % 3 == 2) buffer_.publish();
    ++step_;
  }

  void interrupt() {
    const interruption again = std::exchange(before_access, {});
    for (std::size_t n = order_.choose(steps - step_); n > 0; --n) produce();
    before_access = again;
  }

  void poll() {
    if (step_ < steps) before_access = {[](void* self) { static_cast<two_threads*>(self)->interrupt(); }, this};
    const std::size_t newest = step_ / 3;
    unsteady_ = unsteady_ || buffer_.front().second != last_;
    if (!buffer_.refresh()) return;
    pause();
    const std::size_t first = buffer_.front().first;
    pause();
    const std::size_t second = buffer_.front().second;
    torn_ = torn_ || first != second;
    backwards_ = backwards_ || second <= last_;
    stale_ = stale_ || second < newest;
    last_ = second;
  }

  choices& order_;
  verdict& out_;
  Buffer buffer_{};
  std::size_t step_ = 0;
  std::size_t last_ = 0;
  bool torn_ = false, backwards_ = false, stale_ = false, unsteady_ = false;
};

/// Every schedule, or those up to the first that shows `fault`.
template <class Buffer>
verdict every_schedule(std::uint64_t verdict::*fault = nullptr) {
  choices order;
  verdict out;
  do {
    two_threads<Buffer>(order, out).run();
    ++out.schedules;
    if (fault != nullptr && out.*fault > 0) break;
  } while (order.next());
  before_access = {};
  return out;
}

TEST(triple_buffer_schedules, no_interleaving_tears_goes_back_or_loses_a_value) {
  const verdict v = every_schedule<triple_buffer<halves, stepped>>();
  std::cout << v.schedules << " schedules of " << published << " values and " << polls << " polls\n";
  EXPECT_GT(v.schedules, 100'000U);  // fewer would mean that the producer was not let in everywhere
  EXPECT_EQ(v.torn, 0U);
  EXPECT_EQ(v.backwards, 0U);
  EXPECT_EQ(v.stale, 0U);
  EXPECT_EQ(v.unsteady, 0U);
  EXPECT_EQ(v.lost, 0U);
}

// What the enumeration above rests on: a publish() that touched the shared byte twice could be interrupted in between.
TEST(triple_buffer_schedules, publishing_is_one_access_to_what_is_shared) {
  triple_buffer<halves, counted> buffer;
  for (int i = 0; i < 8; ++i) {
    loads = exchanges = 0;
    buffer.publish();
    EXPECT_EQ(loads, 0);
    EXPECT_EQ(exchanges, 1);
    if (i % 3 == 2) {
      loads = exchanges = 0;
      EXPECT_TRUE(buffer.refresh());
      EXPECT_EQ(exchanges, 1);
      EXPECT_FALSE(buffer.refresh());  // looks, and takes nothing
      EXPECT_EQ(exchanges, 1);
    }
  }
}

TEST(triple_buffer_schedules, an_exchange_in_two_steps_tears) {
  EXPECT_GT((every_schedule<triple_buffer<halves, torn_exchange>>(&verdict::torn).torn), 0U);
}

TEST(triple_buffer_schedules, without_the_mark_of_a_new_value_it_goes_back) {
  EXPECT_GT((every_schedule<triple_buffer<halves, always_fresh>>(&verdict::backwards).backwards), 0U);
}

TEST(triple_buffer_schedules, with_the_mark_lost_no_value_arrives) {
  EXPECT_GT((every_schedule<triple_buffer<halves, never_fresh>>(&verdict::lost).lost), 0U);
}

TEST(triple_buffer_schedules, two_slots_tear) {
  EXPECT_GT((every_schedule<two_slot_buffer<halves, stepped>>(&verdict::torn).torn), 0U);
}

}  // namespace
