#include "counted_heap.hpp"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

std::atomic<std::size_t> on_loan{0};
std::atomic<std::size_t> most_on_loan{0};

// In front of every block, as long as the strictest alignment that plain `new` promises.
constexpr std::size_t prefix = __STDCPP_DEFAULT_NEW_ALIGNMENT__;

void* lend(std::size_t bytes) {
  void* const block = std::malloc(prefix + bytes);
  if (block == nullptr) throw std::bad_alloc();
  *static_cast<std::size_t*>(block) = bytes;
  const std::size_t now = on_loan += bytes;
  std::size_t most = most_on_loan.load();
  while (now > most && !most_on_loan.compare_exchange_weak(most, now)) {
  }
  return static_cast<std::byte*>(block) + prefix;
}

void take_back(void* lent) noexcept {
  if (lent == nullptr) return;
  void* const block = static_cast<std::byte*>(lent) - prefix;
  on_loan -= *static_cast<std::size_t*>(block);
  std::free(block);
}

}  // namespace

void* operator new(std::size_t bytes) { return lend(bytes); }
void* operator new[](std::size_t bytes) { return lend(bytes); }
void operator delete(void* lent) noexcept { take_back(lent); }
void operator delete[](void* lent) noexcept { take_back(lent); }
void operator delete(void* lent, std::size_t) noexcept { take_back(lent); }
void operator delete[](void* lent, std::size_t) noexcept { take_back(lent); }

namespace asperity::test_support {

std::size_t bytes_on_loan() noexcept { return on_loan.load(); }
std::size_t most_bytes_on_loan() noexcept { return most_on_loan.load(); }
void watch_from_here() noexcept { most_on_loan = on_loan.load(); }

}  // namespace asperity::test_support
