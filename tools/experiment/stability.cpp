// How stiff a contact may be before it gives a hand energy: by rate, latency, and what is handed over of it.
#include <algorithm>
#include <cmath>
#include <utility>

#include "experiment.hpp"
#include "series.hpp"
#include "stability_coupling.hpp"
#include "stability_hold.hpp"
#include "stability_limits.hpp"
#include "text.hpp"

namespace asperity::experiment {
namespace {

constexpr double shaken_j = 50e-3;  // spec, A9: what a held force gives a hand in 2.5 s at the least

// A limit below the softest contact is drawn at half of it, or it would leave the paper.
double drawn(double n_per_m) { return 1e-3 * (n_per_m > 0.0 ? n_per_m : 0.5 * softest_n_per_m); }

figure limits_figure(const std::vector<stiffness_limits>& all, const std::vector<coupling_limit>& couplings) {
  figure f{"stability",
           "A held force allows soft contacts only, the softer the slower and the later; linearised, far stiffer ones.",
           {}};
  f.page.title = "How stiff a contact may be before it gives the hand energy";
  f.page.caption =
      "Top: a hand presses a flat pad on a flat pad, 0.2 N, worst touch; coupling 0.5 N/mm; 64 is the stiffest tried. "
      "Bottom: the tool is clamped.";
  f.page.x_label = "rate of the contact thread (Hz)";
  for (const bool late : {true, false}) {
    command::plot_panel p{
        late ? "limit (N/mm), late" : "limit (N/mm), on time", {}, "rate of the contact thread (Hz)", {}, true, true};
    for (const contact_line line : {contact_line::held, contact_line::linearised, contact_line::curved}) {
      // On a flat contact the two linearised ones lie on each other: dashes leave the lower one to be seen.
      const bool above = line == contact_line::curved;
      command::plot_line quiet{
          line_text(line), {}, {}, above ? command::plot_style::dashed : command::plot_style::marked};
      for (const stiffness_limits& l : all) {
        if (l.line != line || l.late != late) continue;
        quiet.x.push_back(l.rate_hz);
        quiet.y.push_back(drawn(l.quiet_n_per_m));
      }
      p.lines.push_back(std::move(quiet));
    }
    command::plot_line guarded{"held force, within the guard's bound", {}, {}, command::plot_style::line};
    for (const stiffness_limits& l : all) {
      if (l.line != contact_line::held || l.late != late) continue;
      guarded.x.push_back(l.rate_hz);
      guarded.y.push_back(drawn(l.guarded_n_per_m));
    }
    p.lines.push_back(std::move(guarded));
    f.page.panels.push_back(std::move(p));
  }
  command::plot_panel p{"coupling's limit (N/mm)", {}, "damping of the virtual coupling (N s/m)", {}, false, true};
  command::plot_line measured{"measured", {}, {}, command::plot_style::marked};
  command::plot_line theory{"poles of the sampled loop", {}, {}, command::plot_style::dashed};
  command::plot_line passive{"passive in any hand", {}, {}, command::plot_style::marked};
  for (const coupling_limit& c : couplings) {
    for (command::plot_line* l : {&measured, &theory, &passive}) l->x.push_back(c.damping_n_s_per_m);
    measured.y.push_back(1e-3 * c.measured_n_per_m);
    theory.y.push_back(1e-3 * c.theory_n_per_m);
    passive.y.push_back(1e-3 * c.passive_n_per_m);
  }
  p.lines = {std::move(measured), std::move(theory), std::move(passive)};
  f.page.panels.push_back(std::move(p));
  return f;
}

/// A way to hold still in a notch, and what came of it.
struct in_notch {
  holding how;
  int rate_hz = 0;
  held_still felt;
};

std::string name_of(const in_notch& s) {
  const char* const line = s.how.line == contact_line::held         ? "held_"
                           : s.how.line == contact_line::linearised ? "linearised_"
                                                                    : "curved_";
  return line + std::to_string(s.rate_hz) + (s.how.late ? "hz_late" : "hz_on_time");
}

std::string says_of(const in_notch& s) {
  return std::string(line_text(s.how.line)) + " at " + std::to_string(s.rate_hz) + " Hz, " +
         (s.how.late ? "one period late" : "on time");
}

double share_of_bound(const in_notch& s) { return s.felt.surplus_j / s.felt.bound_j; }

bool is_stated(const in_notch& s) {
  if (s.how.line == contact_line::held) return s.how.late && s.rate_hz <= 200;
  return s.rate_hz >= 500 || (!s.how.late && s.rate_hz == 200 && s.how.line == contact_line::curved);
}

// The sentences and A9's. Whoever hands over J without the curvature fails those on the curved contact.
void state_notch(const in_notch& s, findings& out) {
  if (!is_stated(s)) return;
  const double given_mj = 1e3 * s.felt.given_j;
  if (s.how.guard) {
    out.statements.push_back(at_most("guard_bounds_" + name_of(s),
                                     "largest surplus over the guard's bound, guard on; " + says_of(s),
                                     share_of_bound(s), 1.0));
  } else if (s.how.line == contact_line::held) {
    out.statements.push_back(at_least("shakes_" + name_of(s),
                                      "energy to a hand that holds still, mJ; negative control; " + says_of(s),
                                      given_mj, 1e3 * shaken_j));
  } else if (s.how.line == contact_line::linearised) {
    if (s.how.late) {
      out.statements.push_back(at_least("shakes_" + name_of(s),
                                        "vibration of a hand that holds still, mm/s; negative control; " + says_of(s),
                                        1e3 * s.felt.vibration_m_per_s, 1e3 * trembling_m_per_s));
    }
  } else {
    out.statements.push_back(at_most("quiet_" + name_of(s), "energy to a hand that holds still, mJ; " + says_of(s),
                                     given_mj, 1e3 * quiet_j));
    out.statements.push_back(at_most("rests_" + name_of(s), "vibration of a hand that holds still, mm/s; " + says_of(s),
                                     1e3 * s.felt.vibration_m_per_s, 1e3 * trembling_m_per_s));
    out.statements.push_back(at_least("touches_" + name_of(s),
                                      "1 where the tool is in contact in the end; " + says_of(s),
                                      s.felt.touches ? 1.0 : 0.0, 1.0));
  }
}

std::vector<in_notch> ways_to_hold(bool brief) {
  std::vector<in_notch> out;
  for (const contact_line line : {contact_line::held, contact_line::linearised, contact_line::curved}) {
    for (const bool late : {true, false}) {
      for (const int rate : {100, 200, 500, 1000}) {
        for (const bool guard : {false, true}) {
          const in_notch s{
              {.line = line, .contact_period_ns = period_of(rate), .late = late, .guard = guard}, rate, {}};
          if ((guard && line != contact_line::held) || (brief && (!is_stated(s) || rate == 1000))) continue;
          out.push_back(s);
        }
      }
    }
  }
  return out;
}

// Brought down on the slope, the pad falls into the notch: what it needs to come to rest there is not a statement.
std::vector<in_notch> ways_to_fall(bool brief) {
  std::vector<in_notch> out;
  for (const bool late : {true, false}) {
    for (const int rate : {200, 500}) {
      if (!brief) out.push_back({{.contact_period_ns = period_of(rate), .late = late, .beside_m = 0.4e-3}, rate, {}});
    }
  }
  return out;
}

result<void> hold_in_notch(workbench& bench, std::vector<in_notch>& ways) {
  const result<notch> where = notch::make(bench, window_soft(), false);
  if (!where) return where.error();
  for (in_notch& s : ways) {
    if (const result<void> on = bench.go_on(); !on) return on.error();
    bench.progress("stability, " + name_of(s), 0.0);
    result<held_still> felt = hold_still(*where, s.how);
    if (!felt) return felt.error();
    s.felt = std::move(felt).value();
  }
  if (where->was_one_contact()) return {};
  return error{error_code::invalid_argument,
               "the pads met in more than one contact: what is linearised without curvature is not what it says"};
}

shown_table notch_table(const std::vector<in_notch>& all) {
  shown_table t{
      "A contact of 2 N/mm, held still in a notch for 2.5 s",
      {"handed over", "late by", "rate (Hz)", "guard", "held beside the notch (mm)", "energy to the hand (mJ)",
       "vibration (mm/s)", "largest surplus over the guard's bound", "guard acts (% of ticks)"},
      {}};
  for (const in_notch& s : all) {
    t.rows.push_back({line_text(s.how.line), s.how.late ? "one period" : "nothing", std::to_string(s.rate_hz),
                      s.how.guard ? "on" : "off", command::brief(1e3 * s.how.beside_m),
                      command::brief(1e3 * s.felt.given_j), command::brief(1e3 * s.felt.vibration_m_per_s),
                      command::brief(share_of_bound(s)), command::brief(100.0 * s.felt.guard_share)});
  }
  return t;
}

table notch_csv(const std::vector<in_notch>& all) {
  table t{"notch",
          {"line_0_held_1_linearised_2_curved", "periods_late", "rate_hz", "guard", "beside_m", "given_j",
           "vibration_m_per_s", "surplus_j", "bound_j"},
          {}};
  for (const in_notch& s : all) {
    t.rows.push_back({static_cast<double>(s.how.line), s.how.late ? 1.0 : 0.0, static_cast<double>(s.rate_hz),
                      s.how.guard ? 1.0 : 0.0, s.how.beside_m, s.felt.given_j, s.felt.vibration_m_per_s,
                      s.felt.surplus_j, s.felt.bound_j});
  }
  return t;
}

figure notch_figure(const std::vector<in_notch>& all) {
  figure f{"stability_notch",
           "A held force shakes the hand and feeds it; the guard bounds that; linearised with curvature, the contact "
           "lets the hand rest.",
           {}};
  f.page.title = "The handle while the hand holds still in a notch: 2 N/mm, one period late";
  f.page.caption = "The hand comes down in the first 0.2 s; it is judged from 1 s on.";
  f.page.x_label = "time (s)";
  f.page.panels = {{"sideways (mm)", {}}, {"energy to the hand (mJ)", {}}};
  for (const in_notch& s : all) {
    const bool shown = s.how.late && s.rate_hz == (s.how.line == contact_line::held ? 200 : 500);
    if (!shown) continue;
    const std::string label =
        std::string(line_text(s.how.line)) + ", " + std::to_string(s.rate_hz) + " Hz" + (s.how.guard ? ", guard" : "");
    f.page.panels[0].lines.push_back({label, in_milli(s.felt.sideways_m), s.felt.time_s});
    f.page.panels[1].lines.push_back({label, in_milli(s.felt.energy_j), s.felt.time_s});
    if (f.page.x.empty()) f.page.x = s.felt.time_s;
  }
  return f;
}

void state_limits(const std::vector<stiffness_limits>& all, const guard_record& guard, findings& out) {
  double held = 0.0, curved = stiffest_n_per_m;
  for (const stiffness_limits& l : all) {
    if (l.line == contact_line::held && l.late && l.rate_hz <= 200) held = std::max(held, l.quiet_n_per_m);
    if (l.line == contact_line::curved && l.rate_hz >= 500) curved = std::min(curved, l.quiet_n_per_m);
  }
  out.statements.push_back(at_most("limit_held_late",
                                   "stiffest quiet flat contact, N/mm; held force, one period late, 100 to 200 Hz; "
                                   "negative control",
                                   1e-3 * held, 2.0));
  out.statements.push_back(at_least("limit_curved",
                                    "stiffest quiet flat contact, N/mm, the least of all; linearised with curvature, "
                                    "500 Hz and more, late or not",
                                    1e-3 * curved, 4.0));
  out.statements.push_back(at_most("guard_bounds_all",
                                   "largest surplus over the guard's bound, all flat contacts with the guard on",
                                   guard.worst_share, 1.0));
  out.statements.push_back(at_least("unguarded_breaks_bound",
                                    "the same of these sessions without the guard; negative control",
                                    guard.worst_bare_share, 2.0));
  out.notes.push_back("On flat contacts the guard acted in " + std::to_string(guard.acted) + " of " +
                      std::to_string(guard.sessions) +
                      " sessions that it was on in. Where the hand never got more than the guard tolerates it was not "
                      "switched on: it would have done exactly nothing.");
}

void state_couplings(const std::vector<coupling_limit>& all, findings& out) {
  double apart = 0.0, least = 1e9;
  for (const coupling_limit& c : all) {
    apart = std::max(apart, std::fabs(c.measured_n_per_m / c.theory_n_per_m - 1.0));
    if (c.passive_n_per_m > 0.0) least = std::min(least, c.measured_n_per_m / c.passive_n_per_m);
  }
  out.statements.push_back(
      at_most("coupling_limit",
              "coupling at which a kicked hand no longer comes to rest, tool clamped: largest "
              "share that it lies off the poles of the sampled loop (the hand moves in steps of 50 us)",
              apart, 0.1));
  out.statements.push_back(at_least("coupling_passive",
                                    "the same limit over the stiffness that is passive in any hand, "
                                    "2 (b - B) / T, the least",
                                    least, 1.0));
}

table coupling_csv(const std::vector<coupling_limit>& all) {
  table t{"coupling", {"damping_n_s_per_m", "measured_n_per_m", "theory_n_per_m", "passive_n_per_m"}, {}};
  for (const coupling_limit& c : all) {
    t.rows.push_back({c.damping_n_s_per_m, c.measured_n_per_m, c.theory_n_per_m, c.passive_n_per_m});
  }
  return t;
}

}  // namespace

result<findings> run_stability(workbench& bench) {
  findings out;
  std::vector<in_notch> notches = ways_to_hold(bench.brief()), falls = ways_to_fall(bench.brief());
  if (const result<void> held = hold_in_notch(bench, notches); !held) return held.error();
  if (const result<void> held = hold_in_notch(bench, falls); !held) return held.error();
  for (const in_notch& s : notches) state_notch(s, out);

  guard_record guard;
  const result<std::vector<stiffness_limits>> limits = find_stiffness_limits(
      bench, bench.brief() ? std::vector<int>{100, 500} : std::vector<int>{100, 200, 500, 1000}, guard);
  if (!limits) return limits.error();
  state_limits(*limits, guard, out);

  bench.progress("stability, coupling", 0.0);
  const result<std::vector<coupling_limit>> couplings =
      coupling_limits(bench, bench.brief() ? std::vector<double>{1.0, 4.47}
                                           : std::vector<double>{0.25, 0.5, 1.0, 2.0, 3.0, 4.47, 7.0, 10.0});
  if (!couplings) return couplings.error();
  state_couplings(*couplings, out);

  out.figures = {limits_figure(*limits, *couplings), notch_figure(notches)};
  notches.insert(notches.end(), falls.begin(), falls.end());
  out.shown = {notch_table(notches), limits_table(*limits)};
  out.tables = {notch_csv(notches), limits_csv(*limits), coupling_csv(*couplings)};
  return out;
}

}  // namespace asperity::experiment
