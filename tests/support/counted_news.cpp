#include "support/counted_news.hpp"

#include <cstdlib>
#include <new>

namespace {
thread_local std::size_t news = 0;

void* take(std::size_t bytes) {
  ++news;
  if (void* const p = std::malloc(bytes == 0 ? 1 : bytes)) return p;
  throw std::bad_alloc();
}
}  // namespace

namespace asperity::test_support {
std::size_t news_in_this_thread() noexcept { return news; }
}  // namespace asperity::test_support

// Aligned forms call neither of these; nothing under test has over-aligned members.
void* operator new(std::size_t bytes) { return take(bytes); }
void* operator new[](std::size_t bytes) { return take(bytes); }
void operator delete(void* p) noexcept { std::free(p); }
void operator delete[](void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
void operator delete[](void* p, std::size_t) noexcept { std::free(p); }
