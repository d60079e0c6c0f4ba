// The comparison with the originals at fresh poses, as tests of benchmark models and of real meshes run it.
#pragma once

#include <algorithm>
#include <cstdio>
#include <gtest/gtest.h>
#include <map>
#include <memory>
#include <string>

#include "asperity/window/window_renderer.hpp"
#include "law/oracle/fresh_poses.hpp"
#include "law/oracle/known_defects.hpp"

namespace asperity::oracle {

/// A pair with both of its renderers, made once per program.
template <class Load>
judged_pair& pair_of(const char* probe, const char* fixed, Load&& load) {
  static std::map<std::string, std::unique_ptr<judged_pair>> made;
  auto& kept = made[std::string(probe) + " on " + fixed];
  if (kept == nullptr) kept = std::make_unique<judged_pair>(load(probe), load(fixed));
  return *kept;
}

/// Fails for each count that is not as it is known.
inline void expect_explained(const std::string& name, const std::vector<counted>& all, std::uint64_t seed) {
  for (const std::string& what : unexplained(all)) {
    ADD_FAILURE() << name << ": " << what << "; ASPERITY_SEED=" << seed << " repeats it";
  }
}

/// Judges approaches of every pair, prints what was found, and fails for each count that is not as it is known: of a
/// pair, or of all pairs together.
template <class Pairs, class Load>
void expect_as_known(const Pairs& pairs, std::uint64_t seed, std::uint64_t approaches, Load&& load) {
  std::vector<counted> all;
  for (const known_pair& known : pairs) {
    judged_pair& pair = pair_of(known.probe, known.fixed, load);
    const tally found = judge_approaches(pair, seed, 0, approaches);
    print(pair, found);
    const std::vector<counted> now = counts(found, known);
    expect_explained(pair.name(), now, seed);
    add_up(all, now);
  }
  expect_explained("all pairs together", all, seed);
}

/// A pose at which the library is wrong: still, and no worse. Where it is right now, the list is out of date.
inline void expect_still_or_better(judged_pair& pair, const known_defect& d) {
  const judged j = pair.judge_pose(d.seed, d.index, d.of, d.by);
  const char* const kind = verdict_names[static_cast<std::size_t>(d.is)];
  std::printf(
      "  %-26s seed %llu approach %-4llu %-6s %-6s way %7.3f mm, originals %7.3f, felt %7.3f; %s by %.3f mm, known "
      "%.3f\n",
      pair.name().c_str(), static_cast<unsigned long long>(d.seed), static_cast<unsigned long long>(d.index),
      formulation_names[static_cast<std::size_t>(d.of)], press_names[static_cast<std::size_t>(d.by)], j.way_m * 1e3,
      j.overlap_m * 1e3, j.felt.depth_m * 1e3, verdict_names[static_cast<std::size_t>(j.is)], j.excess_m * 1e3,
      d.excess_m * 1e3);
  EXPECT_EQ(verdict_names[static_cast<std::size_t>(j.is)], std::string(kind))
      << "where this agrees now, the defect is mended: take it off the list";
  EXPECT_LE(j.excess_m, 1.02 * d.excess_m + 1e-6) << "it has become worse";
}

/// Likewise for the contacts that the library's own finder tells at a pose, after whatever `feel` has felt before.
inline void expect_still_or_better(window_renderer& feel, const known_pose& known, const pose& T_wa,
                                   const original_and_bake& probe, const original_and_bake& fixed) {
  double worst_m = -1.0;
  int ignored = 0;
  for (const compared_contact& c : compare_contacts(feel, probe, fixed, T_wa, known.steepest, ignored)) {
    worst_m = std::max(worst_m, c.error_m() - c.bound_m);
    std::printf("  %s on %s, %s: depth %.3f mm, originals %.3f mm, bound %.3f mm\n", known.probe, known.fixed,
                known.found_by, c.depth_m * 1e3, c.originals_m * 1e3, c.bound_m * 1e3);
  }
  EXPECT_GT(worst_m, 0.0) << "where this agrees now, the defect is mended: take it off the list";
  EXPECT_LE(worst_m, 1.02 * known.excess_m) << "it has become worse";
}

}  // namespace asperity::oracle
