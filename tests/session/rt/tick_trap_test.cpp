// The trap itself: each violation, planted, is caught under its name, and a good tick goes through.
#include "session/rt/tick_trap.hpp"

#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <gtest/gtest.h>
#include <iostream>
#include <mutex>
#include <new>
#include <shared_mutex>
#include <string>
#include <sys/syscall.h>
#include <thread>
#include <unistd.h>

namespace {

using asperity::test_support::tick_trap;

// What a violation works on is out here, so that no compiler proves it to be without effect.
void* volatile memory = nullptr;
volatile double number = 2.0;
volatile int count = 0;
std::mutex mutex;
std::shared_mutex shared_mutex;
std::condition_variable condition;

struct built_at_run_time {
  int value = count;
};

struct violation {
  const char* name;
  void (*commit)();
  std::string caught;         ///< as the trap names it
  bool needs_kernel = false;  ///< leaves no trace but a system call
};

std::string system_call(long n) { return "system call " + std::to_string(n) + " "; }

const std::array violations{
    violation{"new_expression", [] { memory = ::operator new(64); }, "operator new"},
    violation{"new_array", [] { memory = ::operator new[](64); }, "operator new"},
    violation{"new_aligned", [] { memory = ::operator new (64, std::align_val_t{64}); }, "aligned_alloc"},
    violation{"delete_expression", [] { ::operator delete(memory); }, "operator delete"},
    violation{"malloc", [] { memory = std::malloc(64); }, "malloc"},
    violation{"calloc", [] { memory = std::calloc(8, 8); }, "calloc"},
    violation{"realloc", [] { memory = std::realloc(memory, 128); }, "realloc"},
    violation{"free", [] { std::free(memory); }, "free"},
    violation{"mutex", [] { const std::lock_guard lock(mutex); }, "pthread_mutex_lock"},
    violation{"mutex_try", [] { count = mutex.try_lock() ? 1 : 0; }, "pthread_mutex_trylock"},
    violation{"shared_mutex", [] { const std::shared_lock lock(shared_mutex); }, "pthread_rwlock_rdlock"},
    violation{"condition", [] { condition.notify_one(); }, "pthread_cond_signal"},
    violation{"static_local",
              [] {
                static const built_at_run_time once;
                count = once.value;
              },
              "initialisation of a static local"},
    violation{"clock_gettime",
              [] {
                timespec t{};
                clock_gettime(CLOCK_MONOTONIC, &t);
                number = static_cast<double>(t.tv_nsec);
              },
              "clock_gettime"},
    violation{"steady_clock",
              [] { number = static_cast<double>(std::chrono::steady_clock::now().time_since_epoch().count()); },
              "clock_gettime"},
    violation{"time", [] { number = static_cast<double>(std::time(nullptr)); }, "time"},
    violation{"printf", [] { std::printf("%f\n", number); }, "printf"},
    violation{"puts", [] { std::puts("text"); }, "puts"},
    violation{"fprintf", [] { std::fprintf(stderr, "%f\n", number); }, "fprintf"},
    violation{"cout", [] { std::cout << "text"; }, "fwrite"},
    violation{"throw_expression",
              [] {
                try {
                  if (number > 0.0) throw 1;
                } catch (int) {
                }
              },
              "throw"},
    violation{"write", [] { count = static_cast<int>(::write(STDERR_FILENO, "", 0)); }, system_call(SYS_write), true},
    violation{"nanosleep",
              [] {
                const timespec t{0, 1};
                nanosleep(&t, nullptr);
              },
              system_call(SYS_clock_nanosleep), true},
    violation{"sleep_for", [] { std::this_thread::sleep_for(std::chrono::nanoseconds(1)); },
              system_call(SYS_clock_nanosleep), true},
    violation{"yield", [] { std::this_thread::yield(); }, system_call(SYS_sched_yield), true},
    violation{"any_system_call", [] { count = static_cast<int>(::syscall(SYS_getppid)); }, system_call(SYS_getppid),
              true},
};

class planted_violation : public testing::TestWithParam<violation> {
 protected:
  void SetUp() override {
    if (!GetParam().needs_kernel) return;
    if (const std::string why = tick_trap::missing_system_calls(); !why.empty()) GTEST_SKIP() << why;
  }
};

TEST_P(planted_violation, is_caught_under_its_name) {
  memory = std::malloc(64);
  const std::string line = "tick trap: " + GetParam().caught + ".*inside a tick";
  EXPECT_EXIT(tick_trap{}(GetParam().commit), testing::ExitedWithCode(tick_trap::exit_status), line);
  std::free(memory);
}

TEST_P(planted_violation, is_nobodys_business_outside_a_tick) {
  memory = std::malloc(64);
  tick_trap trap;
  trap([] {});
  EXPECT_EXIT((GetParam().commit(), std::_Exit(0)), testing::ExitedWithCode(0), "");
  std::free(memory);
}

// None where there is no trap: tick_trap.lets_a_good_tick_through says why.
std::vector<violation> catchable() {
  if (!tick_trap::missing().empty()) return {};
  return {violations.begin(), violations.end()};
}

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(planted_violation);
INSTANTIATE_TEST_SUITE_P(tick_trap, planted_violation, testing::ValuesIn(catchable()),
                         [](const auto& each) { return std::string(each.param.name); });

TEST(tick_trap, lets_a_good_tick_through) {
  if (const std::string why = tick_trap::missing(); !why.empty()) GTEST_SKIP() << why;
  tick_trap trap;
  for (int i = 0; i < 1000; ++i) trap([] { number = std::sqrt(std::exp(std::sin(number)) + 2.0); });
  EXPECT_EQ(trap.ticks(), 1000U);
}

TEST(tick_trap, watches_its_own_thread_only) {
  if (const std::string why = tick_trap::missing(); !why.empty()) GTEST_SKIP() << why;
  std::atomic<bool> in_tick = false;
  std::atomic<bool> allocated = false;
  std::thread other([&] {
    while (!in_tick) std::this_thread::yield();
    ::operator delete(::operator new(64));
    allocated = true;
  });
  tick_trap trap;
  trap([&] {
    in_tick = true;
    while (!allocated) {
    }
  });
  other.join();
  EXPECT_EQ(trap.ticks(), 1U);
}

// A tick that needs more stack than any tick before it: no call to catch, but pages that the kernel has to find.
[[gnu::noinline]] void touch_stack() {
  volatile char pages[1 << 20];
  for (std::size_t i = 0; i < sizeof pages; i += 1024) pages[i] = 1;
}

TEST(tick_trap, counts_the_page_faults_of_fresh_stack) {
  tick_trap first;
  tick_trap second;
  std::thread fresh([&] {
    first(touch_stack);
    second(touch_stack);
  });
  fresh.join();
  EXPECT_GE(first.page_faults(), (1U << 20) / static_cast<unsigned>(::sysconf(_SC_PAGESIZE)) - 16);
  EXPECT_EQ(second.page_faults(), 0U);
}

}  // namespace
