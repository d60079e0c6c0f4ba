// What makes a surface feel rough: the spacing of its elements against the probe's size, the force and the speed; and
// what a contact loop that is too slow makes of it.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "dot_rows.hpp"
#include "experiment.hpp"
#include "series.hpp"
#include "text.hpp"

namespace asperity::experiment {
namespace {

constexpr double usual_push_n = 0.6;
constexpr double usual_speed_m_per_s = 0.06;
constexpr double usual_ball_m = 1.5e-3;

/// How the contacts are computed and used, and what is stated of it: how far the curve over the spacing is from the
/// usual one, as a share of that.
struct loop_kind {
  const char* name;
  const char* says;
  std::int64_t period_ns;
  bool hold;
  bool late;
  bool in_brief = false;
  double distorts_at_most = 0.0, distorts_at_least = 0.0;  ///< 0: nothing is stated
};
constexpr loop_kind usual_loop{"linear_1000", "1 kHz, linearised", 1'000'000, false, false};
constexpr std::array<loop_kind, 8> other_loops{
    {{"held_1000", "1 kHz, held", 1'000'000, true, false, false, 0.25, 0.0},
     {"linear_200", "200 Hz, linearised", 5'000'000, false, false, true, 0.3, 0.0},
     {"held_200", "200 Hz, held", 5'000'000, true, false, false, 0.0, 0.2},
     {"held_100", "100 Hz, held", 10'000'000, true, false, true, 0.0, 0.5},
     {"linear_1000_late", "1 kHz, linearised, late", 1'000'000, false, true, false, 0.25, 0.0},
     {"linear_200_late", "200 Hz, linearised, late", 5'000'000, false, true, false},
     {"held_200_late", "200 Hz, held, late", 5'000'000, true, true, true, 0.0, 0.5},
     {"held_100_late", "100 Hz, held, late", 10'000'000, true, true, false, 0.0, 0.5}}};

std::string in_mm(double metres) { return command::brief(1e3 * metres); }

// Everything that the parts of the experiment share.
struct dot_study {
  workbench& bench;
  model_ptr plate;
  std::vector<std::size_t> near;  ///< a few rows about the peak of the usual ball
  double done = 0.0;

  [[nodiscard]] result<std::vector<felt_stroke>> feel(double ball_m, const stroking& how) {
    if (const result<void> on = bench.go_on(); !on) return on.error();
    bench.progress("roughness", done);
    done = std::min(1.0, done + (bench.brief() ? 0.12 : 0.07));
    const result<model_ptr> stylus = bake_stylus(bench, ball_m);
    if (!stylus) return stylus.error();
    return stroke_plate(bench, least_motion_contacts(), *stylus, plate, how);
  }

  /// All rows; of a brief run those about the spacing at which the ball drops to the ground.
  [[nodiscard]] std::vector<std::size_t> rows_for(double ball_m) const {
    const double drop_m = dot_rows::drop_spacing_m(ball_m);
    std::vector<std::size_t> out;
    for (std::size_t i = 0; i < dot_rows::count; ++i) {
      const double ratio = dot_rows::spacing_m(i) / drop_m;
      if (!bench.brief() || (ratio > 0.55 && ratio < 1.7)) out.push_back(i);
    }
    return out;
  }

  /// Shaking across the plate over the spacing of the dots.
  [[nodiscard]] result<spacing_curve> curve(double ball_m, const loop_kind& loop) {
    const std::vector<std::size_t> rows = rows_for(ball_m);
    stroking how;
    how.contact_period_ns = loop.period_ns;
    how.hold_wrench = loop.hold;
    how.contact_one_period_late = loop.late;
    add_rows(how, rows, usual_speed_m_per_s, usual_push_n, 0);
    const result<std::vector<felt_stroke>> felt = feel(ball_m, how);
    if (!felt) return felt.error();
    spacing_curve out;
    for (std::size_t i = 0; i < felt->size(); ++i) {
      out.spacing_m.push_back(dot_rows::spacing_m(rows[i]));
      out.value.push_back(rms_about_mean((*felt)[i].normal_m_per_s2));
    }
    return out;
  }
};

double smallest_step(const std::vector<double>& values) {
  double out = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < values.size(); ++i) out = std::min(out, values[i] - values[i - 1]);
  return out;
}

// A curve for each ball: where its peak is.
result<spacing_curve> balls(dot_study& s, findings& out) {
  const std::vector<double> radii =
      s.bench.brief() ? std::vector{0.5e-3, 1.5e-3, 3e-3} : std::vector{0.5e-3, 1e-3, 1.5e-3, 2e-3, 3e-3};
  figure f{"radius",
           "The larger the ball, the further apart the dots that shake it most: those that it just drops between.",
           {}};
  f.page.title = "Which spacing of dots shakes the hand most";
  f.page.caption = "Truncated cones 0.46 mm high; a hand of 100 g, 0.6 N, 60 mm/s.";
  command::plot_panel curves{"normal acceleration, RMS (m/s\u00b2)", {}, "spacing of the dots (mm)", {}, false, false};
  command::plot_panel peaks{"spacing of the peak (mm)", {}, "radius of the ball (mm)", in_milli(radii), false, false};
  table numbers{"radius", {"radius_mm", "spacing_mm", "normal_rms_m_per_s2"}, {}};
  table peak_numbers{"radius_peaks", {"radius_mm", "peak_spacing_mm", "drop_spacing_mm", "peak_m_per_s2"}, {}};
  std::vector<double> peak_mm, drop_mm, low_mm, high_mm;
  double worst = 0.0;
  spacing_curve usual;
  for (const double ball_m : radii) {
    const result<spacing_curve> curve = s.curve(ball_m, usual_loop);
    if (!curve) return curve.error();
    if (ball_m == usual_ball_m) usual = *curve;
    curves.lines.push_back(
        {"radius " + in_mm(ball_m) + " mm", curve->value, in_milli(curve->spacing_m), command::plot_style::marked});
    for (std::size_t i = 0; i < curve->value.size(); ++i)
      numbers.rows.push_back({1e3 * ball_m, 1e3 * curve->spacing_m[i], curve->value[i]});
    const curve_peak peak = peak_of(*curve);
    const double drop_m = dot_rows::drop_spacing_m(ball_m);
    peak_mm.push_back(1e3 * peak.spacing_m);
    drop_mm.push_back(1e3 * drop_m);
    low_mm.push_back(0.88e3 * drop_m);
    high_mm.push_back(1.12e3 * drop_m);
    worst = std::max(worst, std::fabs(peak.spacing_m / drop_m - 1.0));
    peak_numbers.rows.push_back({1e3 * ball_m, peak_mm.back(), drop_mm.back(), peak.value});
  }
  peaks.lines = {{"measured", peak_mm, {}, command::plot_style::marked},
                 {"geometric drop spacing", drop_mm},
                 {"12 % less", low_mm, {}, command::plot_style::dashed},
                 {"12 % more", high_mm, {}, command::plot_style::dashed}};
  f.page.panels = {std::move(curves), std::move(peaks)};
  out.figures.push_back(std::move(f));
  out.tables.push_back(std::move(numbers));
  out.tables.push_back(std::move(peak_numbers));
  out.statements.push_back(at_least("peak_rises_with_radius",
                                    "smallest rise of the peak's spacing from one ball to the next larger one, mm",
                                    smallest_step(peak_mm), 0.1));
  out.statements.push_back(at_most("peak_at_drop_spacing",
                                   "largest distance of a peak from the spacing at which the ball drops to the ground, "
                                   "as a share of that",
                                   worst, 0.12));
  return usual;
}

/// Means over the rows about the peak, for one force or one speed.
struct shaking {
  double along = 0.0, normal = 0.0;
};

shaking mean_shaking(const std::vector<felt_stroke>& felt, int first, std::size_t count) {
  shaking out;
  for (const felt_stroke& f : felt) {
    if (f.felt < first || f.felt >= first + static_cast<int>(count)) continue;
    out.along += rms_about_mean(f.along_m_per_s2) / static_cast<double>(count);
    out.normal += rms_about_mean(f.normal_m_per_s2) / static_cast<double>(count);
  }
  return out;
}

// Everything else being equal: harder, and faster.
result<void> force_and_speed(dot_study& s, findings& out) {
  const std::vector<double> pushes_n = s.bench.brief() ? std::vector{0.15, 0.6, 1.2} : std::vector{0.15, 0.3, 0.6, 1.2};
  const std::vector<double> speeds_mm_per_s =
      s.bench.brief() ? std::vector{30.0, 60.0, 120.0} : std::vector{15.0, 30.0, 60.0, 120.0, 220.0};
  const std::size_t n = s.near.size();
  stroking how;
  int first = 0;
  for (const double push : pushes_n) {
    add_rows(how, s.near, usual_speed_m_per_s, push, first);
    first += static_cast<int>(n);
  }
  for (const double speed : speeds_mm_per_s) {
    add_rows(how, s.near, 1e-3 * speed, usual_push_n, first);
    first += static_cast<int>(n);
  }
  const result<std::vector<felt_stroke>> felt = s.feel(usual_ball_m, how);
  if (!felt) return felt.error();

  table by_force{"force", {"push_n", "along_rms_m_per_s2", "normal_rms_m_per_s2"}, {}};
  table by_speed{"speed", {"speed_mm_per_s", "along_rms_m_per_s2", "normal_rms_m_per_s2"}, {}};
  std::vector<double> along, normal, along_by_speed, normal_by_speed;
  first = 0;
  for (const double push : pushes_n) {
    const shaking m = mean_shaking(*felt, first, n);
    by_force.rows.push_back({push, m.along, m.normal});
    along.push_back(m.along);
    normal.push_back(m.normal);
    first += static_cast<int>(n);
  }
  double smallest_ratio = std::numeric_limits<double>::infinity();
  for (const double speed : speeds_mm_per_s) {
    const shaking m = mean_shaking(*felt, first, n);
    by_speed.rows.push_back({speed, m.along, m.normal});
    if (!normal_by_speed.empty()) smallest_ratio = std::min(smallest_ratio, m.normal / normal_by_speed.back());
    along_by_speed.push_back(m.along);
    normal_by_speed.push_back(m.normal);
    first += static_cast<int>(n);
  }
  out.statements.push_back(between("along_grows_with_force",
                                   "exponent of the tangential acceleration over the normal force, ball of 1.5 mm",
                                   power_law(pushes_n, along), 0.6, 1.1));
  out.statements.push_back(at_least("normal_grows_with_speed",
                                    "smallest factor of the normal acceleration from one speed to the next faster one",
                                    smallest_ratio, 1.05));
  figure f{"force_and_speed",
           "Pressing harder shakes the hand along the plate, hardly across it; stroking faster shakes it across.",
           {}};
  f.page.title = "Force and speed";
  f.page.caption = "A ball of 1.5 mm over dots about as far apart as it is shaken most by; means over these rows.";
  f.page.panels = {{"acceleration, RMS (m/s\u00b2)", {}, "force of the hand (N)", pushes_n, true, true},
                   {"acceleration, RMS (m/s\u00b2)", {}, "speed of the hand (mm/s)", speeds_mm_per_s, true, true}};
  f.page.panels[0].lines = {{"along the plate", along, {}, command::plot_style::marked},
                            {"across it", normal, {}, command::plot_style::marked}};
  f.page.panels[1].lines = {{"along the plate", along_by_speed, {}, command::plot_style::marked},
                            {"across it", normal_by_speed, {}, command::plot_style::marked}};
  out.figures.push_back(std::move(f));
  out.tables.push_back(std::move(by_force));
  out.tables.push_back(std::move(by_speed));
  return {};
}

// Mean over the rows of how far a curve is from the usual one, as a share of that.
double distortion(const spacing_curve& curve, const spacing_curve& usual) {
  double sum = 0.0, all = 0.0;
  for (std::size_t i = 0; i < curve.value.size(); ++i) {
    sum += std::fabs(curve.value[i] - usual.value[i]);
    all += usual.value[i];
  }
  return sum / all;
}

// The same ball and rows, with contacts that come less often, that are held instead of linearised, and that are used
// one period late, as on a machine that takes all its time to compute them.
result<void> rates(dot_study& s, const spacing_curve& usual, findings& out) {
  figure f{"rate",
           "A contact force that is held between 100 computations a second, or 200 that come late, shakes the hand by "
           "itself: the dots' spacing no longer shows. With the contact's stiffness it takes a late 200 Hz to do harm.",
           {}};
  f.page.title = "What the rate of the contacts makes of it";
  f.page.caption = "A ball of 1.5 mm, 0.6 N, 60 mm/s; the device's loop runs at 1 kHz in all of them.";
  f.page.x_label = "spacing of the dots (mm)";
  f.page.x = in_milli(usual.spacing_m);
  command::plot_panel at_once{"used at once: RMS (m/s\u00b2)", {}, {}, {}, false, true};
  command::plot_panel late{"one period late: RMS (m/s\u00b2)", {}, {}, {}, false, true};
  for (command::plot_panel* p : {&at_once, &late})
    p->lines.push_back({usual_loop.says, usual.value, {}, command::plot_style::marked});
  late.lines.front().label += ", at once";
  table numbers{"rate", {"spacing_mm", usual_loop.name}, {}};
  for (std::size_t i = 0; i < usual.value.size(); ++i)
    numbers.rows.push_back({1e3 * usual.spacing_m[i], usual.value[i]});
  for (const loop_kind& kind : other_loops) {
    if (s.bench.brief() && !kind.in_brief) continue;
    const result<spacing_curve> curve = s.curve(usual_ball_m, kind);
    if (!curve) return curve.error();
    const double off = distortion(*curve, usual);
    const std::string claim = std::string("distance of the curve with contacts at ") + kind.says +
                              " from the one at 1 kHz, linearised, as a share of that";
    if (kind.distorts_at_most > 0.0)
      out.statements.push_back(at_most(std::string(kind.name) + "_keeps", claim, off, kind.distorts_at_most));
    if (kind.distorts_at_least > 0.0)
      out.statements.push_back(
          at_least(std::string(kind.name) + "_distorts", claim + " (negative control)", off, kind.distorts_at_least));
    if (!(kind.distorts_at_most > 0.0) && !(kind.distorts_at_least > 0.0))
      out.notes.push_back(claim + ": " + command::brief(off) + ", of which nothing is stated");
    (kind.late ? late : at_once).lines.push_back({kind.says, curve->value, {}, command::plot_style::marked});
    numbers.columns.emplace_back(kind.name);
    for (std::size_t i = 0; i < usual.value.size(); ++i) numbers.rows[i].push_back(curve->value[i]);
  }
  f.page.panels = {std::move(at_once), std::move(late)};
  out.figures.push_back(std::move(f));
  out.tables.push_back(std::move(numbers));
  return {};
}

}  // namespace

result<findings> run_roughness(workbench& bench) {
  const result<model_ptr> plate = dot_rows::bake(bench);
  if (!plate) return plate.error();
  dot_study s{bench, *plate,
              bench.brief() ? std::vector<std::size_t>{10, 11} : std::vector<std::size_t>{9, 10, 11, 12}};
  findings out;
  const result<spacing_curve> usual = balls(s, out);
  if (!usual) return usual.error();
  if (const result<void> ok = force_and_speed(s, out); !ok) return ok.error();
  if (const result<void> ok = rates(s, *usual, out); !ok) return ok.error();
  return out;
}

}  // namespace asperity::experiment
