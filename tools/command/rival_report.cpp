#include "rival_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "interrupt.hpp"
#include "model_shelf.hpp"
#include "options.hpp"
#include "publish.hpp"
#include "statistics.hpp"
#include "text.hpp"

namespace asperity::command {
namespace {

using rivals::outcome;
using rivals::race;

constexpr double degrees = 57.29577951308232;

/// Median and 99th percentile, values that occurred; of nothing, nothing.
struct spread {
  std::size_t count = 0;
  double p50 = 0.0, p99 = 0.0;
};

spread spread_of(std::vector<double> values, double scale = 1.0) {
  for (double& v : values) v = scale * std::fabs(v);
  const time_summary s = summarise(std::move(values));
  return {s.count, s.p50_s, s.p99_s};
}

json to_json(const spread& s) {
  return s.count == 0 ? json(nullptr) : json{{"count", s.count}, {"p50", s.p50}, {"p99", s.p99}};
}

/// Of the signed errors, the middle one.
double bias_m(std::vector<double> errors_m) {
  if (errors_m.empty()) return 0.0;
  const auto middle = errors_m.begin() + static_cast<std::ptrdiff_t>(errors_m.size() / 2);
  std::nth_element(errors_m.begin(), middle, errors_m.end());
  return *middle;
}

std::string pair_text(const spread& s) {
  if (s.count == 0) return "none";
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%s, %s", brief(s.p50).c_str(), brief(s.p99).c_str());
  return text.data();
}

json to_json(const outcome& o, double quickest_of_ours_s) {
  json out{{"name", o.name}, {"ours", o.ours}};
  if (!o.fault.empty()) {
    out["fault"] = o.fault;
    return out;
  }
  const time_summary time = summarise(o.seconds);
  out["seconds"] = command::to_json(time);
  out["ratio_to_planes"] = quickest_of_ours_s > 0.0 ? json(time.p50_s / quickest_of_ours_s) : json(nullptr);
  out["memory_bytes"] = o.memory_bytes;
  out["made_seconds"] = o.made_s;
  out["contacts"] = o.contacts;
  out["missed"] = o.missed;
  out["depth_error_m"] = to_json(spread_of(o.depth_error_m));
  out["depth_bias_m"] = bias_m(o.depth_error_m);
  out["outside_m"] = to_json(spread_of(o.outside_m));
  out["direction_error_rad"] = to_json(spread_of(o.turned_rad));
  return out;
}

result<rivals::body_pair> load_pair(experiment::model_shelf& shelf, models::benchmark probe, models::benchmark fixed) {
  const result<model_ptr> a = shelf.benchmark(probe);
  if (!a) return a.error();
  const result<model_ptr> b = shelf.benchmark(fixed);
  if (!b) return b.error();
  return rivals::body_pair{std::string(models::to_string(probe)) + " on " + std::string(models::to_string(fixed)),
                           models::make_full(probe), models::make_full(fixed), scene{*a, {*b}}};
}

}  // namespace

answer report(std::span<const race> races, const rivals::race_settings& settings) {
  answer out;
  out.document = {{"seed", settings.seed},
                  {"machine", experiment::machine_text()},
                  {"time_is", "cpu"},
                  {"races", json::array()},
                  {"units", "SI"}};
  out.text = experiment::machine_text() + "; processor time of one thread, every contender in this process\n";
  for (const race& r : races) {
    const auto planes = std::find_if(r.outcomes.begin(), r.outcomes.end(),
                                     [](const outcome& o) { return o.ours && !o.seconds.empty(); });
    const double planes_s = planes == r.outcomes.end() ? 0.0 : summarise(planes->seconds).p50_s;
    std::vector<double> depths_m, brackets;
    std::size_t directed = 0;
    for (const rivals::judged_pose& j : r.judged) {
      depths_m.push_back(j.truth.depth_m);
      if (j.truth.depth_m > 0.0) brackets.push_back(j.truth.at_least_m / j.truth.depth_m);
      if (j.has_direction()) ++directed;
    }
    json contenders = json::array();
    out.text += r.pair + ": " + std::to_string(r.probe_triangles) + " against " + std::to_string(r.fixed_triangles) +
                " triangles, " + std::to_string(r.poses) + " poses, " + std::to_string(r.judged.size()) + " judged, " +
                std::to_string(directed) + " with a direction\n";
    std::array<char, 200> line{};
    std::snprintf(line.data(), line.size(), "  %-26s %18s %9s %9s %9s %6s %18s %18s %16s\n", "contender",
                  "ms: p50, p99", "x planes", "MB", "contacts", "missed", "depth um: p50, p99", "outside: p50, p99",
                  "deg: p50, p99");
    out.text += line.data();
    for (const outcome& o : r.outcomes) {
      contenders.push_back(to_json(o, planes_s));
      if (!o.fault.empty()) {
        out.text += "  " + printable(o.name) + ": " + printable(o.fault) + '\n';
        continue;
      }
      const spread ms = spread_of(o.seconds, 1e3);
      std::snprintf(line.data(), line.size(), "  %-26s %18s %9s %9s %9s %6zu %18s %18s %16s\n", o.name.c_str(),
                    pair_text(ms).c_str(), brief(planes_s > 0.0 ? 1e-3 * ms.p50 / planes_s : 0.0).c_str(),
                    brief(1e-6 * static_cast<double>(o.memory_bytes)).c_str(), brief(o.contacts).c_str(), o.missed,
                    pair_text(spread_of(o.depth_error_m, 1e6)).c_str(), pair_text(spread_of(o.outside_m, 1e6)).c_str(),
                    pair_text(spread_of(o.turned_rad, degrees)).c_str());
      out.text += line.data();
    }
    out.document["races"].push_back({{"pair", r.pair},
                                     {"probe_triangles", r.probe_triangles},
                                     {"fixed_triangles", r.fixed_triangles},
                                     {"poses", r.poses},
                                     {"judged", r.judged.size()},
                                     {"with_direction", directed},
                                     {"depth_m", to_json(spread_of(depths_m))},
                                     {"at_least_share", to_json(spread_of(brackets))},
                                     {"contenders", std::move(contenders)}});
  }
  return out;
}

plot_page picture(std::span<const race> races) {
  plot_page page;
  page.title =
      "What a pose costs and how wrong its depth is: asperity's renderers and other libraries at full resolution";
  page.caption =
      "Each dot is one pose: processor time across, |reported depth - shortest translation that parts the originals| "
      "up. " +
      experiment::machine_text() + ". `asperity bench --rivals`";
  page.x_label = "processor time of a pose, ms";
  for (const race& r : races) {
    plot_panel panel;
    panel.y_label = r.pair + ": depth error, um";
    panel.x_label = page.x_label;
    panel.log_x = panel.log_y = true;
    panel.x = {1.0};  // every line has its own
    for (const outcome& o : r.outcomes) {
      plot_line line;
      line.label = o.name;
      line.style = plot_style::points;
      std::vector<std::size_t> order(o.judged_s.size());
      std::iota(order.begin(), order.end(), std::size_t{0});
      std::sort(order.begin(), order.end(),
                [&](std::size_t a, std::size_t b) { return o.judged_s[a] < o.judged_s[b]; });
      for (const std::size_t i : order) {
        line.x.push_back(1e3 * o.judged_s[i]);
        // What is right to a nanometre is drawn at a nanometre: a logarithm has no zero.
        line.y.push_back(std::max(1e-3, 1e6 * std::fabs(o.depth_error_m[i])));
      }
      if (!line.x.empty()) panel.lines.push_back(std::move(line));
    }
    page.panels.push_back(std::move(panel));
  }
  return page;
}

result<answer> race_rivals(const rival_bench& wanted, progress_line& progress) {
  std::optional<output_file> plot;
  if (!wanted.plot.empty()) {
    result<output_file> opened = output_file::create(wanted.plot);
    if (!opened) return opened.error();
    plot.emplace(std::move(opened).value());
  }
  const auto told = [&](std::string_view what, double done) {
    progress.show(what, done);
    return !interrupted();
  };
  experiment::model_shelf shelf(wanted.models, told);
  std::vector<rivals::entry> contenders = rivals::our_entries();
  for (rivals::entry& e : rivals::rival_entries()) contenders.push_back(std::move(e));

  using models::benchmark;
  constexpr std::array<std::pair<benchmark, benchmark>, 3> pairs{{{benchmark::file, benchmark::cad_part},
                                                                  {benchmark::block, benchmark::gear},
                                                                  {benchmark::hammer, benchmark::torus}}};
  std::vector<race> races;
  for (const auto& [probe, fixed] : pairs) {
    const result<rivals::body_pair> bodies = load_pair(shelf, probe, fixed);
    if (!bodies) return bodies.error();
    result<race> run = run_race(*bodies, contenders, wanted.settings, told);
    if (!run) return run.error();
    races.push_back(std::move(run).value());
  }
  if (plot) {
    const plot_format format = extension_error(wanted.plot, {".svg"}).empty() ? plot_format::svg : plot_format::png;
    if (const result<void> drawn = draw(picture(races), format, *plot); !drawn) return drawn.error();
    if (const result<void> kept = plot->commit(); !kept) return kept.error();
  }
  return report(races, wanted.settings);
}

}  // namespace asperity::command
