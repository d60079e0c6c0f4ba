#include "stability_limits.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>

#include "text.hpp"

namespace asperity::experiment {
namespace {

constexpr double flat_press_n = 0.2;  // 1.6 mm deep in the softest contact

// Near a limit, one touch decides by chance: by when between two contacts it comes, at last by the last bit of a
// depth. From these heights the pad comes down 2 to 3 ms later each, 13 ms in all: more than any period of contacts.
constexpr double drops_m[] = {20e-6, 26e-6, 33e-6, 41e-6, 50e-6, 60e-6};

bool is_quiet(const held_still& felt) noexcept {
  return felt.touches && felt.given_j < quiet_j && felt.vibration_m_per_s < trembling_m_per_s;
}

// Which of the three limits lie above the stiffnesses that were tried.
struct limits_open {
  bool quiet = true, bounded = true, guarded = true;
};

// One touch, and again with the guard where it would have acted: otherwise that session is the same to the bit.
result<void> touch(const notch& where, holding how, limits_open& open, guard_record& record) {
  const result<held_still> bare = hold_still(where, how);
  if (!bare) return bare.error();
  open.quiet = open.quiet && is_quiet(*bare);
  open.bounded = open.bounded && bare->surplus_j <= bare->bound_j;
  if (!open.guarded || bare->surplus_j <= guard_settings{}.tolerance_j) return {};
  how.guard = true;
  const result<held_still> with = hold_still(where, how);
  if (!with) return with.error();
  open.guarded = with->surplus_j <= with->bound_j;
  ++record.sessions;
  record.acted += with->guard_share > 0.0 ? 1 : 0;
  record.worst_share = std::max(record.worst_share, with->surplus_j / with->bound_j);
  record.worst_bare_share = std::max(record.worst_bare_share, bare->surplus_j / bare->bound_j);
  return {};
}

// Upwards until all three limits are known: stiffer contacts are not tried once one has failed.
result<stiffness_limits> limits_of(workbench& bench, const notch& where, stiffness_limits what, guard_record& record) {
  const double factor = bench.brief() ? 8.0 : 2.0;
  const std::size_t touches = bench.brief() ? 1 : std::size(drops_m);
  limits_open open;
  for (double k = softest_n_per_m; k <= stiffest_n_per_m * 1.001; k *= factor) {
    for (std::size_t i = 0; i < touches && (open.quiet || open.bounded || open.guarded); ++i) {
      if (const result<void> on = bench.go_on(); !on) return on.error();
      const holding how{.stiffness_n_per_m = k,
                        .line = what.line,
                        .contact_period_ns = period_of(what.rate_hz),
                        .late = what.late,
                        .press_n = flat_press_n,
                        .drop_m = drops_m[i],
                        .settle_s = 0.5,
                        .hold_s = 0.7};
      if (const result<void> done = touch(where, how, open, record); !done) return done.error();
    }
    if (open.quiet) what.quiet_n_per_m = k;
    if (open.bounded) what.bounded_n_per_m = k;
    if (open.guarded) what.guarded_n_per_m = k;
  }
  return what;
}

std::string limit_text(double n_per_m) {
  if (n_per_m <= 0.0) return "below " + command::brief(1e-3 * softest_n_per_m);
  return (n_per_m > 0.999 * stiffest_n_per_m ? "more than " : "") + command::brief(1e-3 * n_per_m);
}

}  // namespace

const char* line_text(contact_line line) noexcept {
  switch (line) {
    case contact_line::held:
      return "held force";
    case contact_line::linearised:
      return "linearised";
    case contact_line::curved:
      return "linearised with curvature";
  }
  return "";
}

result<std::vector<stiffness_limits>> find_stiffness_limits(workbench& bench, const std::vector<int>& rates_hz,
                                                            guard_record& record) {
  const result<notch> where = notch::make(bench, window_soft(), true);
  if (!where) return where.error();
  std::vector<stiffness_limits> out;
  const std::size_t all = 6 * rates_hz.size();
  for (const contact_line line : {contact_line::held, contact_line::linearised, contact_line::curved}) {
    for (const bool late : {true, false}) {
      for (const int rate : rates_hz) {
        bench.progress("stability, limits", static_cast<double>(out.size()) / static_cast<double>(all));
        const result<stiffness_limits> found =
            limits_of(bench, *where, {.line = line, .late = late, .rate_hz = rate}, record);
        if (!found) return found.error();
        out.push_back(*found);
      }
    }
  }
  return out;
}

shown_table limits_table(const std::vector<stiffness_limits>& all) {
  shown_table t{"Stiffest contact (N/mm) with which a hand that presses a flat pad on a flat pad ...",
                {"handed over", "late by", "rate (Hz)", "rests after every touch",
                 "gets less than the guard's bound, guard off", "the same, guard on"},
                {}};
  for (const stiffness_limits& l : all) {
    t.rows.push_back({line_text(l.line), l.late ? "one period" : "nothing", std::to_string(l.rate_hz),
                      limit_text(l.quiet_n_per_m), limit_text(l.bounded_n_per_m), limit_text(l.guarded_n_per_m)});
  }
  return t;
}

table limits_csv(const std::vector<stiffness_limits>& all) {
  table t{"limits",
          {"line_0_held_1_linearised_2_curved", "periods_late", "rate_hz", "quiet_n_per_m", "bounded_n_per_m",
           "bounded_with_guard_n_per_m"},
          {}};
  for (const stiffness_limits& l : all) {
    t.rows.push_back({static_cast<double>(l.line), l.late ? 1.0 : 0.0, static_cast<double>(l.rate_hz), l.quiet_n_per_m,
                      l.bounded_n_per_m, l.guarded_n_per_m});
  }
  return t;
}

}  // namespace asperity::experiment
