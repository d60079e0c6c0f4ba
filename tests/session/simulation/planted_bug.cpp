// planted_bug NAME SEEDS INVARIANT: the simulation, compiled with one line of a header broken, has to notice.
// Prints the share of seeds in which it did and the first of them; fails where there is none, or where no session broke
// the INVARIANT (the beginning of its words) that the bug was planted against.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "session/simulation/many_sessions.hpp"

int main(int argc, char** argv) {
  using namespace asperity::simulation;
  if (argc != 4) return std::fputs("usage: planted_bug NAME SEEDS INVARIANT\n", stderr), 2;
  const std::string invariant = argv[3];
  const summary all = run_sessions(seeds_to_run({1, std::strtoull(argv[2], nullptr, 10)}));
  const auto as_expected = [&](const outcome& o) { return std::string(o.broken).rfind(invariant, 0) == 0; };
  const auto first = std::find_if(all.broken.begin(), all.broken.end(), as_expected);
  std::printf("%s: found in %zu of %llu sessions", argv[1], all.broken.size(),
              static_cast<unsigned long long>(all.sessions));
  if (first == all.broken.end()) return std::printf(", and nowhere as '%s'\n", invariant.c_str()), 1;
  std::printf(", first as it should be in %s\n", to_string(*first).c_str());
  return 0;
}
