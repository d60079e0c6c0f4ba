#include "law/contact_study/pictures.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "law/contact_study/uniform_slide.hpp"
#include "plot.hpp"

namespace asperity::contact_study {
namespace {

result<void> save(const command::plot_page& page, const std::filesystem::path& file) {
  result<command::output_file> out = command::output_file::create(file);
  if (!out) return out.error();
  if (const result<void> drawn = command::draw(page, command::plot_format::png, *out); !drawn) return drawn.error();
  return out->commit();
}

std::vector<double> force_along(const feel_function& feel, const touching_pose& start, std::size_t ticks,
                                double step_m) {
  std::vector<double> out;
  for (std::size_t i = 0; i <= ticks; ++i) {
    out.push_back(glm::length(feel(along(start, motion::slide, step_m * static_cast<double>(i))).on_probe_w.force));
  }
  return out;
}

}  // namespace

trace trace_slide(const std::string& pair, pair_of_renderers& renderers, std::uint64_t seed) {
  constexpr std::size_t candidates = 9, ticks = 600;
  constexpr double rate_hz = 1e4, step_m = 0.05 / rate_hz;
  struct candidate {
    double jump;
    std::uint64_t index;
    touching_pose start;
  };
  const double k = renderers.least_motion().force().settings().stiffness_n_per_m;
  const feel_function feel_least_motion = feel_with(renderers.least_motion()),
                      feel_window = feel_with(renderers.window());
  std::vector<candidate> seen;
  for (std::uint64_t index = 0; seen.size() < candidates; ++index) {
    const std::optional<touching_pose> start = find_touching_pose(renderers.least_motion(), seed, index);
    if (!start) continue;
    seen.push_back({measure_jump(feel_window, *start, motion::slide, rate_hz, k).force, index, *start});
  }
  const auto middle = seen.begin() + candidates / 2;
  std::nth_element(seen.begin(), middle, seen.end(),
                   [](const candidate& a, const candidate& b) { return a.jump < b.jump; });
  trace out;
  out.pair = pair;
  out.pose = middle->index;
  for (std::size_t i = 0; i <= ticks; ++i) out.way_mm.push_back(1e3 * step_m * static_cast<double>(i));
  out.least_motion_n = force_along(feel_least_motion, middle->start, ticks, step_m);
  out.window_n = force_along(feel_window, middle->start, ticks, step_m);
  return out;
}

result<void> draw_traces(const std::vector<trace>& traces, const std::filesystem::path& file) {
  if (traces.empty()) return {};
  command::plot_page page;
  page.title = "One potential per body pair does not jump; the paper's clusters do";
  page.caption =
      "Force on a probe that slides 3 mm at 50 mm/s, 10 kHz. Per pair the slide at which the paper's jump is the "
      "median "
      "of nine seeded ones.";
  page.x_label = "way, mm";
  page.x = traces.front().way_mm;
  for (const trace& t : traces) {
    page.panels.push_back(
        {"|F|, N", {{t.pair + ": the default", t.least_motion_n}, {"the paper's clusters", t.window_n}}});
  }
  return save(page, file);
}

result<void> draw_spectra(const std::filesystem::path& file) {
  result<pair_of_renderers> renderers = pair_of_renderers::make(uniform_slide::bodies());
  if (!renderers) return renderers.error();
  const double k = renderers->least_motion().force().settings().stiffness_n_per_m;
  const auto decades = [](const std::vector<double>& force_n) {
    std::vector<double> out = amplitude_spectrum(force_n);
    for (double& x : out) x = std::log10(std::max(x, 1e-10));
    return out;
  };
  command::plot_page page;
  page.title = "A uniform slide: what sampling adds to the spectrum of the exact depth";
  page.caption =
      "Rough, crowned box on a rough plate, 50 mm/s, 8192 ticks a second, force 0.8 N. One pair of texel pitches; "
      "others "
      "move and scale the lines.";
  page.x_label = "frequency, Hz";
  page.panels.resize(2);
  page.panels[0].y_label = page.panels[1].y_label = "log10(amplitude / N)";
  const std::vector<double> exact = decades(exact_on_slide(k));
  page.panels[0].lines = {{"the default", decades(felt_on_slide(feel_with(renderers->least_motion())))},
                          {"spring on the exact depth", exact}};
  page.panels[1].lines = {{"the paper's clusters", decades(felt_on_slide(feel_with(renderers->window())))},
                          {"spring on the exact depth", exact}};
  for (std::size_t i = 0; i < exact.size(); ++i) {
    page.x.push_back(uniform_slide::rate_hz / static_cast<double>(uniform_slide::ticks) * static_cast<double>(i));
  }
  return save(page, file);
}

}  // namespace asperity::contact_study
