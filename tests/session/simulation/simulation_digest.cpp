// simulation_digest: what 50 sessions came to, one line each. Builds that agree to the bit print the same.
#include <cstdio>

#include "session/simulation/many_sessions.hpp"

int main() {
  using namespace asperity::simulation;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const summary one = run_sessions({seed, 1});
    std::printf("seed %llu: %llu ticks, digest %016llx\n", static_cast<unsigned long long>(seed),
                static_cast<unsigned long long>(one.ticks), static_cast<unsigned long long>(one.digest));
  }
}
