#include "asperity/transport/real_clock.hpp"

#include <chrono>
#include <cstdint>
#include <thread>

namespace asperity {

std::int64_t real_clock::now_ns() noexcept {
  using namespace std::chrono;
  return duration_cast<nanoseconds>(steady_clock::now().time_since_epoch()).count();
}

void real_clock::wait_until_ns(std::int64_t due_ns) noexcept {
  using namespace std::chrono;
  std::this_thread::sleep_until(steady_clock::time_point(duration_cast<steady_clock::duration>(nanoseconds(due_ns))));
}

}  // namespace asperity
