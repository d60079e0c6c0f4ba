// A fine texture survives: stripes keep their height, at the surface and above and below it.
#include <gtest/gtest.h>
#include <numbers>

#include "support/small_models.hpp"
#include "unit/field/field_measures.hpp"

namespace asperity {
namespace {

using namespace test_support;

// Amplitude of a sine of a wavelength along x in f, by its Fourier component over whole waves.
template <class Function>
double amplitude(double wavelength_m, Function&& f) {
  double s = 0.0, c = 0.0;
  const int waves = 16, per_wave = 40;
  for (int i = 0; i < waves * per_wave; ++i) {
    const double x = (static_cast<double>(i) / per_wave - 0.5 * waves) * wavelength_m;
    const double phase = 2.0 * std::numbers::pi * x / wavelength_m;
    s += f(x) * std::sin(phase);
    c += f(x) * std::cos(phase);
  }
  return 2.0 * std::hypot(s, c) / (waves * per_wave);
}

TEST(BodyFieldStripes, KeepTheirAmplitude) {
  for (const double wavelength : {0.5e-3, 1e-3, 2e-3}) {
    const textured_model box = make_textured_box({0.025, 0.025, 0.025}, 1024, ridges(20e-6, wavelength));
    const body_field f = built_field(box).value();
    // What the texture holds of them: bilinear between texels, it has lost some.
    const auto& top = box.mesh.triangles[8];  // of two; its corners are (-x, -y), (x, -y), (x, y)
    const double held = amplitude(wavelength, [&](double x) {
      const double u = x / 0.05 + 0.5, v = 0.3;
      return box.texture.sample(top.uv[0] + u * (top.uv[1] - top.uv[0]) + v * (top.uv[2] - top.uv[1])).z;
    });
    // Bilinear between texels loses a tenth at eight texels a wave, and a quarter at four: the bake's, not the field's.
    EXPECT_NEAR(held, 20e-6, wavelength > 0.9e-3 ? 2e-6 : 6e-6);
    for (const double y : {0.0, 1.234e-3, -7.7e-3}) {
      // Height of the zero over the face: by Newton from the plane.
      const double at_zero = amplitude(wavelength, [&](double x) {
        vec3 p(x, y, 0.025);
        for (int i = 0; i < 5; ++i) {
          const field_reading d = f.read(p);
          p.z -= d.value_m / d.slope.z;
        }
        return p.z;
      });
      std::printf("  wavelength %.2f mm (%.1f relief pitches): texture holds %.2f um, the field %.1f %% of it\n",
                  1e3 * wavelength, wavelength / f.fine.pitch_m, 1e6 * held, 100.0 * at_zero / held);
      EXPECT_NEAR(at_zero, held, 0.012 * held) << wavelength;
      // What is frozen in a deep press: the relief that a point meets under and over the surface, with what is left of
      // the stripes in the smooth part.
      for (const double depth : {-0.3e-3, 0.5e-3, 2e-3}) {
        const double deep = amplitude(wavelength, [&](double x) { return f.read({x, y, 0.025 - depth}).value_m; });
        EXPECT_NEAR(deep, held, 0.2 * held) << wavelength << " at " << depth;
      }
    }
  }
}

}  // namespace
}  // namespace asperity
