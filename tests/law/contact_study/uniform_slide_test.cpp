// What is felt of a uniform slide beyond the surfaces themselves, and that nothing at all is remembered at rest.
#include "law/contact_study/uniform_slide.hpp"

#include <cstdio>
#include <cstring>
#include <gtest/gtest.h>

#include "law/contact_study/study.hpp"
#include "support/extent.hpp"

namespace asperity::contact_study {
namespace {

pair_of_renderers& renderers() {
  static pair_of_renderers made = pair_of_renderers::make(uniform_slide::bodies()).value();
  return made;
}

const std::vector<double>& exact_spectrum() {
  static const std::vector<double> made =
      amplitude_spectrum(exact_on_slide(renderers().least_motion().force().settings().stiffness_n_per_m));
  return made;
}

/// What a force has more of than the exact depth, largest amplitude as a part of the mean force.
struct excess {
  double textures = 0.0;  ///< 20 to 110 Hz: harmonics of the textures, changed by softness and samples
  double above = 0.0;     ///< over 110 Hz, where the exact force has only the side lobes of the window
};

excess excess_of(const std::vector<double>& force_n) {
  const std::vector<double> felt = amplitude_spectrum(force_n), &exact = exact_spectrum();
  double mean_n = 0.0;
  for (const double f : force_n) mean_n += f / static_cast<double>(force_n.size());
  excess out;
  for (std::size_t i = 0; i < felt.size(); ++i) {
    const double hz = uniform_slide::rate_hz / uniform_slide::ticks * static_cast<double>(i);
    const double more = (felt[i] - exact[i]) / mean_n;
    if (hz >= 110.0) {
      out.above = std::max(out.above, more);
    } else if (hz >= 20.0) {
      out.textures = std::max(out.textures, more);
    }
  }
  return out;
}

// The samples are not inaudible: what touches is points. These bounds hold on both lattices.
constexpr double textures_limit = 1e-4, above_limit = 3e-5;

TEST(UniformSlide, AddsLittleToTheSpectrumOfTheExactDepth) {
  for (const std::uint32_t box_texture : {384U, 768U}) {
    if (box_texture == 768U && !test_support::at_length()) continue;
    least_motion_renderer made = build_renderer(uniform_slide::bodies(box_texture)).value();
    const excess more = excess_of(felt_on_slide(feel_with(made)));
    std::printf("box of %u texels: %.2g in the textures' band, %.2g above\n", box_texture, more.textures, more.above);
    EXPECT_LT(more.textures, textures_limit) << box_texture;
    EXPECT_LT(more.above, above_limit) << box_texture;
  }
}

// What keeps the samples quiet is how many there are: an eighth of them in either direction rings.
TEST(UniformSlide, FewSamplesRing) {
  least_motion_renderer_settings settings;
  settings.bodies.sample_pitch_m = 8.0 * 0.003 * uniform_slide::bodies(384).probe->box.diagonal();
  least_motion_renderer coarse = build_renderer(uniform_slide::bodies(384), settings).value();
  const excess more = excess_of(felt_on_slide(feel_with(coarse)));
  std::printf("few samples: %.2g in the textures' band, %.2g above\n", more.textures, more.above);
  EXPECT_GT(more.textures, 2.0 * textures_limit);
}

// The exact depth is the measure of the above: it has to be one.
TEST(UniformSlide, IsFeltAsDeepAsItIs) {
  const least_motion_settings& s = renderers().least_motion().force().settings();
  const feel_function feel = feel_with(renderers().least_motion());
  for (std::size_t i = 0; i < uniform_slide::ticks; i += 256) {
    const pose T = uniform_slide::at(i);
    const double felt_m = feel(T).on_probe_w.force.z / s.stiffness_n_per_m, exact_m = uniform_slide::exact_depth_m(T);
    EXPECT_LT(felt_m, exact_m + 2e-6);
    EXPECT_GT(felt_m, exact_m - 2.0 * s.softness_m - 2e-6);
  }
}

// Depth by place is what a force pushes against: its direction is the slope of the exact depth.
TEST(UniformSlide, IsFeltAlongTheSlopeOfTheExactDepth) {
  const feel_function feel = feel_with(renderers().least_motion());
  double worst_rad = 0.0, leaning_rad = 0.0;
  for (std::size_t i = 0; i < uniform_slide::ticks; i += 64) {
    const pose T = uniform_slide::at(i);
    const auto slope = [&](const vec3& along) {
      constexpr double step_m = 1e-6;
      const auto moved = [&](double by) { return uniform_slide::exact_depth_m({T.rotation, T.position + by * along}); };
      return (moved(step_m) - moved(-step_m)) / (2.0 * step_m);
    };
    const vec3 exact = glm::normalize(-vec3(slope({1, 0, 0}), slope({0, 1, 0}), slope({0, 0, 1})));
    const vec3 felt = glm::normalize(feel(T).on_probe_w.force);
    worst_rad = std::max(worst_rad, glm::length(glm::cross(felt, exact)));
    leaning_rad = std::max(leaning_rad, glm::length(vec2(exact)));
  }
  std::printf("direction: %.2g rad from the exact one, which leans by up to %.2g rad\n", worst_rad, leaning_rad);
  EXPECT_LT(worst_rad, 0.05 * leaning_rad);
  EXPECT_GT(leaning_rad, 1e-2);
}

TEST(Rest, FeelsTheSameBitsWhateverWasBefore) {
  const feel_function feel = feel_with(renderers().least_motion());
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
  const feel_function feel = feel_with(renderers().least_motion());
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
