// A fixed number of mutations with a fixed seed, and what became of them.
#pragma once

#include <algorithm>
#include <cstdio>
#include <gtest/gtest.h>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "random_source.hpp"
#include "survival.hpp"

namespace asperity::hostile {

/// Counts what became of the runs.
class tally {
 public:
  template <class T>
  void add(const result<T>& answer) {
    ++runs_;
    if (answer) {
      ++loaded_;
    } else {
      ++refusals_[kind_of(answer.error().message)];
    }
  }

  void print(const char* what) const {
    std::printf("%s: %zu runs, %zu loaded, %zu kinds of refusal\n", what, runs_, loaded_, refusals_.size());
    std::vector<std::pair<std::size_t, std::string>> often;
    for (const auto& [kind, count] : refusals_) often.emplace_back(count, kind);
    std::sort(often.rbegin(), often.rend());
    for (std::size_t i = 0; i < std::min<std::size_t>(often.size(), 12); ++i) {
      std::printf("  %6zu  %.110s\n", often[i].first, often[i].second.c_str());
    }
  }
  [[nodiscard]] std::size_t kinds() const { return refusals_.size(); }
  [[nodiscard]] double loaded() const { return static_cast<double>(loaded_) / static_cast<double>(runs_); }

 private:
  std::size_t runs_ = 0;
  std::size_t loaded_ = 0;
  std::map<std::string, std::size_t> refusals_;
};

/// Runs `read` on mutations. Mutations stray: half of them go on from an earlier one that still loaded.
template <class Read, class Mutate>
tally fuzz(std::size_t runs, std::uint64_t seed, const std::string& good, const Mutate& mutate, const Read& read) {
  random_source random(seed);
  tally out;
  std::vector<std::string> pool{good};
  for (std::size_t run = 0; run < runs; ++run) {
    const std::string bytes = mutate(random.once_in(2) ? good : random.one_of(pool), random);
    const auto answer = read(bytes);
    out.add(answer);
    const auto wrong = complaint(answer);
    EXPECT_FALSE(wrong) << "run " << run << ": " << wrong.value_or("");
    if (wrong) break;
    if (!answer) continue;
    if (pool.size() < 64) {
      pool.push_back(bytes);
    } else {
      pool[random.below(pool.size())] = bytes;
    }
  }
  return out;
}

}  // namespace asperity::hostile
