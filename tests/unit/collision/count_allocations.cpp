// Lives in a file of its own: inlined next to its callers, a replaced operator new looks mismatched to the compiler.
#include "count_allocations.hpp"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {
std::atomic<std::size_t> allocations{0};
}

namespace asperity::test {
std::size_t allocation_count() noexcept { return allocations; }
}  // namespace asperity::test

void* operator new(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size > 0 ? size : 1)) return p;
  std::abort();
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
