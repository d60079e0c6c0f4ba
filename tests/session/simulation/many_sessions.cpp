#include "session/simulation/many_sessions.hpp"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <sstream>

#include "session/simulation/session.hpp"

namespace asperity::simulation {

seed_range seeds_to_run(seed_range otherwise) {
  const char* const wanted = std::getenv("ASPERITY_SESSION");
  return wanted == nullptr ? otherwise : seed_range{std::strtoull(wanted, nullptr, 10), 1};
}

summary run_sessions(const seed_range& seeds) {
  summary sum;
  for (std::uint64_t i = 0; i < seeds.count; ++i) {
    session one(make_scenario(seeds.first + i));
    const outcome o = one.run();
    ++sum.sessions;
    sum.textured += o.textured ? 1U : 0U;
    sum.ticks += o.ticks;
    sum.touched += o.touched;
    sum.guarded += o.guarded;
    sum.rejected += o.rejected;
    sum.faults += o.faults;
    sum.clears += o.clears;
    sum.past_hard_limit += o.surplus_j > guard_settings{}.hard_limit_j ? 1U : 0U;
    sum.surplus_j = std::max(sum.surplus_j, o.surplus_j);
    sum.digest = std::rotl(sum.digest, 1) ^ o.digest;
    if (o.broken != nullptr) sum.broken.push_back(o);
  }
  return sum;
}

std::string to_string(const outcome& o) {
  std::ostringstream out;
  out << "seed " << o.seed << ", tick " << o.ticks << ": " << o.broken;
  return out.str();
}

std::string to_string(const summary& s) {
  std::ostringstream out;
  out << s.sessions << " sessions (" << s.textured << " with textured models), " << s.ticks << " ticks: " << s.touched
      << " in contact, " << s.guarded << " with the guard acting, " << s.rejected << " bad samples, " << s.faults
      << " faults, " << s.clears << " of them cleared; largest surplus " << 1e3 * s.surplus_j
      << " mJ, hard limit passed in " << s.past_hard_limit << " sessions; " << s.broken.size()
      << " sessions broken; digest " << std::hex << s.digest;
  return out.str();
}

}  // namespace asperity::simulation
