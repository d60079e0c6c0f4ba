// The triple buffer with its memory order taken away: ThreadSanitizer has to call this a data race, or its silence
// about the real one means nothing. It judges by what orders two accesses, so that one hand-over is enough.
#include <cstdint>
#include <cstdio>
#include <thread>

#include "asperity/core/triple_buffer.hpp"
#include "support/sanitizers.hpp"
#include "unit/core/hand_over_variants.hpp"

#if ASPERITY_THREAD_SANITIZER

int main() {
  using namespace asperity::test_support;
  // Not a local: the sanitizer of Clang 14 takes those for the thread's own and does not watch them.
  static asperity::triple_buffer<wide_payload<std::uint64_t>, relaxed_atomic> buffer;
  std::thread producer([&] {
    buffer.back().words.fill(1);
    buffer.publish();
  });
  while (!buffer.refresh()) std::this_thread::yield();
  std::uint64_t sum = 0;
  for (const std::uint64_t word : buffer.front().words) sum += word;
  producer.join();
  std::printf("%llu words read\n", static_cast<unsigned long long>(sum));
}

#else

int main() {
  std::puts("SKIPPED: only ThreadSanitizer sees the order of memory accesses; the tsan preset runs this");
  return 77;
}

#endif
