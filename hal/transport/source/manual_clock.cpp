#include "asperity/transport/virtual/manual_clock.hpp"

#include <algorithm>
#include <cstdint>

namespace asperity {

manual_clock::manual_clock(std::int64_t start_ns, std::int64_t step_ns)
    : now_ns_(start_ns), step_ns_(std::max<std::int64_t>(step_ns, 1)) {}

void manual_clock::wait_until_ns(std::int64_t due_ns) noexcept {
  while (now_ns_ < due_ns) {
    now_ns_ = due_ns - now_ns_ > step_ns_ ? now_ns_ + step_ns_ : due_ns;
    for (const auto& step : steps_) step(now_ns_);
  }
}

}  // namespace asperity
