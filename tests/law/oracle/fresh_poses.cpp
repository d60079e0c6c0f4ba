#include "law/oracle/fresh_poses.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace asperity::oracle {
namespace {

using count = std::uint64_t;

/// Sums the smaller side of the distribution, in logarithms so that nothing underflows.
double sum_of_terms(count from, count to, count n, double p) {
  double sum = 0.0;
  for (count i = from; i <= to && i <= n; ++i) {
    const auto x = static_cast<double>(i), all = static_cast<double>(n);
    sum += std::exp(std::lgamma(all + 1.0) - std::lgamma(x + 1.0) - std::lgamma(all - x + 1.0) + x * std::log(p) +
                    (all - x) * std::log1p(-p));
  }
  return std::min(1.0, sum);
}

constexpr double confidence_left = 1e-3;

/// The place between 0 and 1 where a rising function passes `confidence_left`.
template <class Rising>
double solve(Rising&& f) {
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (f(middle) < confidence_left ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

std::string in_words(const counted& c, const char* change) {
  return c.what + ": " + std::to_string(c.now) + " of " + std::to_string(c.of) + ", known are " +
         std::to_string(c.known) + " of " + std::to_string(c.of_all) + ": " + change;
}

}  // namespace

double binomial_at_least(count k, count n, double p) {
  if (k == 0) return 1.0;
  if (p <= 0.0) return 0.0;
  if (p >= 1.0) return 1.0;
  return sum_of_terms(k, n, n, p);
}
double binomial_at_most(count k, count n, double p) {
  if (k >= n) return 1.0;
  if (p <= 0.0) return 1.0;
  if (p >= 1.0) return 0.0;
  return sum_of_terms(0, k, n, p);
}
double rate_at_most(count seen, count all) {
  return solve([&](double q) { return 2.0 * confidence_left - binomial_at_most(seen, all, q); });
}
double rate_at_least(count seen, count all) {
  return seen == 0 ? 0.0 : solve([&](double q) { return binomial_at_least(seen, all, q); });
}

void tally::add(const judged_approach& one) {
  ++approaches;
  for (std::size_t f = 0; f < of.size(); ++f) {
    for (std::size_t by = 0; by < of[f].size(); ++by) {
      const judged& j = one.poses[f][by];
      const auto is = static_cast<std::size_t>(j.is);
      if (of[f][by][is]++ == 0 || j.excess_m > worst[f][by][is].poses[f][by].excess_m) worst[f][by][is] = one;
    }
  }
  if (one.window.nothing) {
    ++windows_empty;
    return;
  }
  window_errors_m.push_back(std::fabs(one.window.depth_m - one.window.on_grid_m));
  if (one.window.excess_m() <= 0.0) return;
  if (windows_beyond++ == 0 || one.window.excess_m() > worst_window.window.excess_m()) worst_window = one;
}

tally judge_approaches(judged_pair& pair, std::uint64_t seed, std::uint64_t first, std::uint64_t many) {
  tally out;
  for (std::uint64_t i = first; i < first + many; ++i) out.add(pair.judge_approach(seed, i));
  return out;
}

void print(const judged_pair& pair, const tally& t) {
  std::printf("  %s, %llu approaches; bakes err by up to %.0f um together\n", pair.name().c_str(),
              static_cast<unsigned long long>(t.approaches), pair.bake_error_m() * 1e6);
  for (std::size_t f = 0; f < t.of.size(); ++f) {
    for (std::size_t by = 0; by < t.of[f].size(); ++by) {
      for (std::size_t is = 1; is < t.of[f][by].size(); ++is) {
        if (t.of[f][by][is] == 0) continue;
        const judged_approach& a = t.worst[f][by][is];
        const judged& j = a.poses[f][by];
        std::printf(
            "    %-6s %-10s %-11s %5.1f %% (%llu); worst approach %llu: way %.3f mm, originals %.3f, felt %.3f, "
            "beyond the bound %.4f\n",
            formulation_names[f], press_names[by], verdict_names[is],
            100.0 * static_cast<double>(t.of[f][by][is]) / static_cast<double>(t.approaches),
            static_cast<unsigned long long>(t.of[f][by][is]), static_cast<unsigned long long>(a.index), j.way_m * 1e3,
            j.overlap_m * 1e3, j.felt.depth_m * 1e3, j.excess_m * 1e3);
      }
    }
  }
  const window_depth& w = t.worst_window.window;
  std::printf("    windows: off by %.1f um in the median, %.1f at p95; beyond the bound %llu, empty %llu",
              percentile(t.window_errors_m, 0.5) * 1e6, percentile(t.window_errors_m, 0.95) * 1e6,
              static_cast<unsigned long long>(t.windows_beyond), static_cast<unsigned long long>(t.windows_empty));
  if (t.windows_beyond > 0) {
    std::printf("; worst approach %llu: %.3f mm, originals %.3f", static_cast<unsigned long long>(t.worst_window.index),
                w.depth_m * 1e3, w.way_m * 1e3);
  }
  std::printf("\n");
}

std::vector<counted> counts(const tally& t, const known_pair& known) {
  std::vector<counted> out;
  for (std::size_t f = 0; f < t.of.size(); ++f) {
    for (std::size_t by = 0; by < presses; ++by) {
      for (std::size_t is = 1; is < verdicts; ++is) {
        count seen = 0;
        for (const known_rate& r : known.rates) {
          const bool same = static_cast<std::size_t>(r.of) == f && static_cast<std::size_t>(r.by) == by &&
                            static_cast<std::size_t>(r.is) == is;
          if (same) seen = r.seen;
        }
        out.push_back({std::string(formulation_names[f]) + ", " + press_names[by] + ", " + verdict_names[is],
                       t.of[f][by][is], t.approaches, seen, known.approaches});
      }
    }
  }
  out.push_back({"windows beyond their bound", t.windows_beyond, t.approaches, known.windows_beyond, known.approaches});
  out.push_back({"windows without overlap", t.windows_empty, t.approaches, known.windows_empty, known.approaches});
  // Of the errors that were known, half were larger than their median.
  const auto further = std::count_if(t.window_errors_m.begin(), t.window_errors_m.end(),
                                     [&](double e) { return e > known.window_p50_m; });
  out.push_back({"windows further off than their median", static_cast<count>(further), t.window_errors_m.size(),
                 known.approaches / 2, known.approaches});
  return out;
}

void add_up(std::vector<counted>& sum, const std::vector<counted>& more) {
  if (sum.empty()) {
    sum = more;
    return;
  }
  for (std::size_t i = 0; i < sum.size(); ++i) {
    sum[i].now += more[i].now;
    sum[i].of += more[i].of;
    sum[i].known += more[i].known;
    sum[i].of_all += more[i].of_all;
  }
}

std::vector<std::string> unexplained(const std::vector<counted>& all) {
  std::vector<std::string> out;
  for (const counted& c : all) {
    if (binomial_at_least(c.now, c.of, rate_at_most(c.known, c.of_all)) < least_probability) {
      out.push_back(in_words(c, "it has become worse"));
    }
    if (binomial_at_most(c.now, c.of, rate_at_least(c.known, c.of_all)) < least_probability) {
      out.push_back(in_words(c, "it has become better; measure anew, and take the old rate off the list"));
    }
  }
  return out;
}

}  // namespace asperity::oracle
