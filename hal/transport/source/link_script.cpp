#include "asperity/transport/link_script.hpp"

#include <cstdint>

namespace asperity {

link_event fail_call(std::uint64_t n, io_status with) noexcept {
  return {.kind = link_fault::answer, .from_call = n, .until_call = n + 1, .with = with};
}

const link_event* link_player::find(link_fault kind, link_direction direction, std::int64_t now_ns,
                                    std::uint64_t call) noexcept {
  for (const link_event& e : script_.events) {
    if (e.kind != kind || now_ns < e.from_ns || now_ns >= e.until_ns) continue;
    if (call < e.from_call || call >= e.until_call) continue;
    if (e.direction != link_direction::both && e.direction != direction) continue;
    if (e.share < 1.0 && unit() >= e.share) continue;
    return &e;
  }
  return nullptr;
}

}  // namespace asperity
