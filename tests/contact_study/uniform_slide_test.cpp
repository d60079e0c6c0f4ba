// What is felt of a uniform slide, and at rest: the surfaces, and nothing of the machinery.
#include "contact_study/uniform_slide.hpp"

#include <cstring>
#include <gtest/gtest.h>

#include "contact_study/study.hpp"

namespace asperity::contact_study {
namespace {

pair_of_renderers& renderers() {
  static pair_of_renderers made = pair_of_renderers::make(uniform_slide::bodies()).value();
  return made;
}

const std::vector<double>& exact_spectrum() {
  static const std::vector<double> made =
      amplitude_spectrum(exact_on_slide(renderers().shared().force().settings().stiffness_n_per_m));
  return made;
}

/// The strongest line where the exact depth has none, as a part of the mean force. The textures and their harmonics end
/// below 100 Hz; above, all that the exact force shows is the side lobes of the window.
double strongest_foreign_line(const std::vector<double>& force_n) {
  constexpr double first_hz = 110.0;
  const std::vector<double> felt = amplitude_spectrum(force_n), &exact = exact_spectrum();
  double mean_n = 0.0, worst_n = 0.0;
  for (const double f : force_n) mean_n += f / static_cast<double>(force_n.size());
  const auto first = static_cast<std::size_t>(first_hz / uniform_slide::rate_hz * uniform_slide::ticks);
  for (std::size_t i = first; i < felt.size(); ++i) worst_n = std::max(worst_n, felt[i] - exact[i]);
  return worst_n / mean_n;
}

constexpr double line_limit = 1e-6;

TEST(UniformSlide, HasNoLineThatTheExactDepthDoesNotHave) {
  const std::vector<double> force_n = felt_on_slide(feel_with(renderers().shared()));
  EXPECT_LT(strongest_foreign_line(force_n), line_limit);
}

// The paper's window carries its samples along; what they pass over comes through as a line and its harmonics.
TEST(UniformSlide, ThePapersWindowHasLines) {
  const std::vector<double> force_n = felt_on_slide(feel_with(renderers().paper()));
  EXPECT_GT(strongest_foreign_line(force_n), 2.0 * line_limit);
}

// The exact depth is the measure of the above: it has to be one.
TEST(UniformSlide, IsFeltAsDeepAsItIs) {
  const shared_settings& s = renderers().shared().force().settings();
  const feel_function feel = feel_with(renderers().shared());
  for (std::size_t i = 0; i < uniform_slide::ticks; i += 256) {
    const pose T = uniform_slide::at(i);
    const double felt_m = feel(T).on_probe_w.force.z / s.stiffness_n_per_m, exact_m = uniform_slide::exact_depth_m(T);
    EXPECT_LT(felt_m, exact_m + 1e-6);
    EXPECT_GT(felt_m, exact_m - 2.0 * s.tau_m - 1e-6);
  }
}

TEST(Rest, FeelsTheSameBitsWhateverWasBefore) {
  const feel_function feel = feel_with(renderers().shared());
  const pose here = uniform_slide::at(1000);
  const wrench first = feel(here).on_probe_w;
  EXPECT_GT(first.force.z, 0.1);
  for (std::size_t i = 0; i < 200; ++i) {
    // Now resting, now coming back from elsewhere.
    if (i % 3 == 0) static_cast<void>(feel(uniform_slide::at(20 * i)));
    const wrench again = feel(here).on_probe_w;
    EXPECT_EQ(std::memcmp(&again, &first, sizeof first), 0) << "tick " << i;
  }
}

/// A finder's or a filter's memory, as small as it may be: the force of the last pose stays in by a billionth.
TEST(Rest, AForceThatRemembersIsFound) {
  const feel_function feel = feel_with(renderers().shared());
  wrench last{};
  const auto remembering = [&](const pose& T) {
    const wrench now = feel(T).on_probe_w;
    wrench out = now;
    out.force += 1e-9 * (last.force - now.force);
    last = now;
    return out;
  };
  const pose here = uniform_slide::at(1000);
  static_cast<void>(remembering(here));
  const wrench first = remembering(here);
  static_cast<void>(remembering(uniform_slide::at(2000)));
  const wrench again = remembering(here);
  EXPECT_NE(std::memcmp(&again, &first, sizeof first), 0);
}

}  // namespace
}  // namespace asperity::contact_study
