#include "heap_room.hpp"

#if defined(__GLIBC__)
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <malloc.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>
#endif

namespace asperity::command {

#if defined(__GLIBC__)

namespace {

bool is_limited(decltype(RLIMIT_AS) what) noexcept {
  rlimit limit{};
  return getrlimit(what, &limit) != 0 || limit.rlim_cur != RLIM_INFINITY;
}

}  // namespace

void prepare_heap() noexcept {
  constexpr std::size_t room = std::size_t{512} << 20;
  if (is_limited(RLIMIT_AS) || is_limited(RLIMIT_DATA)) return;
  // Large blocks come from the heap, not from mappings of their own, which are given back as soon as they are free.
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_TRIM_THRESHOLD, static_cast<int>(2 * room - 1));
  mallopt(M_TOP_PAD, 64 << 20);
  void* const block = std::malloc(room);
  if (block == nullptr) return;
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  const std::uintptr_t address = reinterpret_cast<std::uintptr_t>(block), skip = (page - address % page) % page;
  static_cast<void>(madvise(static_cast<char*>(block) + skip, (room - skip) / page * page, MADV_HUGEPAGE));
  std::free(block);
}

void share_heap() noexcept { mallopt(M_ARENA_MAX, 1); }

void trim_heap() noexcept { malloc_trim(0); }

#else

void prepare_heap() noexcept {}
void share_heap() noexcept {}
void trim_heap() noexcept {}

#endif

}  // namespace asperity::command
