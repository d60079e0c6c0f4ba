#include "law/presses/run_press.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "law/oracle/against_originals.hpp"

namespace asperity::presses {

using oracle::percentile;

namespace {

template <class What>
int count(const std::vector<press_result>& presses, What&& what) {
  return static_cast<int>(std::count_if(presses.begin(), presses.end(), what));
}

/// Where presses broke a rule, mm; "-" where none did, or not so many.
std::string where(const std::vector<press_result>& presses, breach press_result::*rule, double share) {
  std::vector<double> at;
  for (const press_result& p : presses) at.push_back((p.*rule).found ? (p.*rule).at_m : infinity);
  const double m = percentile(std::move(at), share);
  if (!(m < infinity)) return "-";
  char text[16];
  std::snprintf(text, sizeof text, "%.1f", m * 1e3);
  return text;
}

}  // namespace

press_result run_press(const step_function& step, const press_touch& touch, const press_rules& rules,
                       exit_search& originals) {
  press_result out;
  out.worst_share = out.worst_fall = out.least_n = infinity;
  const double k = rules.stiffness_n_per_m;
  // The largest force so far along the press and at all, and where the latter was.
  double peak_n = 0.0, longest_n = 0.0, longest_at_m = 0.0;
  vec3 last_way_w = touch.out_w;
  const auto exit_at = [&](double way_m) {
    const way_out found = originals.true_exit(touch.pressed(way_m), last_way_w);
    last_way_w = found.direction_w;
    return found;
  };
  const auto leads_elsewhere = [&](const way_out& exit, double d) {
    return exit.way_m < rules.held_elsewhere * d || glm::dot(exit.direction_w, touch.out_w) < rules.same_way;
  };
  const auto steps = static_cast<int>(std::floor(touch.press_m / rules.step_m + 1e-9));
  for (int i = 1; i <= steps; ++i) {
    const double d = i * rules.step_m;
    const wrench w = step(touch.pressed(d));
    if (!is_finite(w)) {
      ++out.unanswered;
      continue;
    }
    const double along = glm::dot(w.force, touch.out_w), length = glm::length(w.force);
    out.steps.push_back({d, along, length});
    out.last_n = along;
    if (d >= rules.from_m - 1e-9) {
      const double expected = rules.weak_share * k * (d - rules.allowance_m);
      const bool weak = along < expected, falls = along < rules.fall_share * peak_n, pulls = along < -rules.pull_n;
      bool elsewhere = false;
      // A rule that is broken already is not asked again.
      if ((weak && !out.weak.found) || (falls && !out.falls.found) || (pulls && !out.pulls.found)) {
        way_out exit = exit_at(d);
        elsewhere = leads_elsewhere(exit, d);
        if (!elsewhere) {
          const way_out next = exit_at(rules.ahead * d);
          elsewhere = leads_elsewhere(next, rules.ahead * d);
          if (elsewhere) exit.direction_w = next.direction_w;
        }
        const auto note = [&](breach& b, bool broken, double at_least) {
          if (broken && !b.found) b = {true, d, along, at_least};
        };
        if (elsewhere) {
          const double at_least = rules.weak_share * k * (exit.way_m - rules.allowance_m);
          note(out.weak, weak && length < at_least, at_least);
          double followed = rules.fall_share * longest_n;
          if (falls && length < followed && !out.falls.found) {
            const double before = exit_at(longest_at_m).way_m;
            if (exit.way_m < before) followed *= exit.way_m / before;
          }
          note(out.falls, falls && length < followed, followed);
          note(out.pulls, pulls && glm::dot(w.force, exit.direction_w) < -rules.pull_n, 0.0);
          ++out.elsewhere;
        } else {
          note(out.weak, weak, expected);
          note(out.falls, falls, rules.fall_share * peak_n);
          note(out.pulls, pulls, -rules.pull_n);
        }
      }
      out.least_n = std::min(out.least_n, along);
      if (!elsewhere) {
        out.worst_share = std::min(out.worst_share, along / (k * d));
        if (peak_n > 0.0) out.worst_fall = std::min(out.worst_fall, along / peak_n);
      }
    }
    peak_n = std::max(peak_n, along);
    if (length > longest_n) {
      longest_n = length;
      longest_at_m = d;
    }
  }
  out.peak_n = peak_n;
  return out;
}

int press_row::weak() const {
  return count(presses, [](const press_result& p) { return p.weak.found; });
}
int press_row::falls() const {
  return count(presses, [](const press_result& p) { return p.falls.found; });
}
int press_row::pulls() const {
  return count(presses, [](const press_result& p) { return p.pulls.found; });
}
int press_row::unanswered() const {
  return count(presses, [](const press_result& p) { return p.unanswered > 0; });
}
int press_row::good() const {
  return count(presses, [](const press_result& p) { return p.good(); });
}

void print_heading(std::FILE* to) {
  std::fprintf(to, "%-13s %-13s %4s %5s | %-17s | %-17s | %-18s | %-21s | %5s %5s %6s | %s\n", "probe", "fixed", "n",
               "to mm", "F.n < k d/2 at mm", "falls 5 % at mm", "pulls  least F.n N", "F.n end p0 p10 p50 N", "F/kd",
               "peak", "elsewh", "touch ms, step us");
}

void print_row(std::FILE* to, const press_row& row) {
  std::vector<double> last, peak, share;
  double least = infinity;
  int elsewhere = 0;
  for (const press_result& p : row.presses) {
    last.push_back(p.last_n);
    peak.push_back(p.peak_n);
    share.push_back(p.worst_share);
    least = std::min(least, p.least_n);
    elsewhere += p.elsewhere > 0 ? 1 : 0;
  }
  const auto at = [&](breach press_result::*rule, double s) { return where(row.presses, rule, s); };
  std::fprintf(to, "%-13s %-13s %4zu %5.1f | %4d %5s %6s | %4d %5s %6s | %5d %12.2f | %6.2f %6.2f %6.2f  | %5.2f %5.2f",
               row.probe.c_str(), row.fixed.c_str(), row.presses.size(), row.longest_m * 1e3, row.weak(),
               at(&press_result::weak, 0.0).c_str(), at(&press_result::weak, 0.5).c_str(), row.falls(),
               at(&press_result::falls, 0.0).c_str(), at(&press_result::falls, 0.5).c_str(), row.pulls(),
               row.presses.empty() ? 0.0 : least, percentile(last, 0.0), percentile(last, 0.1), percentile(last, 0.5),
               percentile(share, 0.0), percentile(peak, 0.5));
  const double n = std::max<double>(1.0, static_cast<double>(row.presses.size()));
  std::fprintf(to, " %6d | %.1f, %.0f%s\n", elsewhere, row.touch_s * 1e3 / n,
               row.step_s * 1e6 / std::max<double>(1.0, static_cast<double>(row.step_count)),
               row.unanswered() > 0 ? "  UNANSWERED" : "");
  std::fflush(to);
}

std::string in_words(const press_row& row, std::size_t press) {
  const press_result& p = row.presses[press];
  std::string out = row.probe + " on " + row.fixed + ", press " + std::to_string(press) + ":";
  const auto report = [&](const char* what, const breach& b) {
    if (!b.found) return;
    char text[160];
    std::snprintf(text, sizeof text, " %s at %.2f mm: %.3f N where at least %.3f N is asked for;", what, b.at_m * 1e3,
                  b.force_n, b.expected_n);
    out += text;
  };
  report("weak", p.weak);
  report("falls", p.falls);
  report("pulls", p.pulls);
  if (p.unanswered > 0) out += " " + std::to_string(p.unanswered) + " steps without an answer;";
  return out;
}

}  // namespace asperity::presses
