// The benchmark models as they are baked: the zero of the field lies on the fine surface, and its sign is right.
#include <filesystem>
#include <gtest/gtest.h>
#include <random>

#include "asperity/io/textured_model_file.hpp"
#include "support/fresh_seed.hpp"
#include "unit/field/field_measures.hpp"

namespace asperity {
namespace {

using namespace test_support;

class BodyFieldModels : public testing::TestWithParam<const char*> {};

TEST_P(BodyFieldModels, ZeroSignAndDistance) {
  const std::string name = GetParam();
  const textured_model model =
      io::load_textured_model(std::filesystem::path(ASPERITY_TEST_MODELS_DIR) / (name + ".glb")).value();
  const std::uint64_t seed = fresh_seed(name, "100000 surface points, 400 points of space");
  const body_field f = built_field(model).value();
  const zero_errors e = measure_zero(f, model, 100000, seed);
  std::printf("  %s\n", to_text(name, f, e).c_str());
  EXPECT_LE(e.median, 3e-5);
  EXPECT_LE(e.p99, 3e-4);
  EXPECT_LE(e.p99_off_edges, 6e-5);
  EXPECT_LE(e.p99_at_edges, 8e-4);

  const double pitch = f.smooth.pitch_m;
  const brute_surface surface(model, 1.5 * pitch);
  std::mt19937_64 random(seed_of(seed, name));
  std::uniform_real_distribution<double> unit(-0.55, 0.55);
  int signs = 0, inner = 0;
  double largest = 0.0;
  for (int i = 0; i < 400; ++i) {
    const vec3 p = 0.5 * (model.box.low + model.box.high) +
                   vec3(unit(random), unit(random), unit(random)) * (model.box.high - model.box.low);
    const double distance = surface.distance(p);
    const field_reading d = f.read(p);
    if (distance < 0.3 * pitch) continue;
    ++signs;
    EXPECT_EQ(d.value_m > 0.0, surface.winding(p) > 0.5) << p.x << ' ' << p.y << ' ' << p.z << " off " << distance;
    const coarse_reading s = f.coarse(p);
    if (s.value_m > pitch && glm::length(s.slope) > 0.96) {
      ++inner;
      largest = std::max(largest, std::fabs(s.value_m - distance));
    }
  }
  std::printf("  %s: %d signs, %d distances inside, largest error %.3f pitches\n", name.c_str(), signs, inner,
              largest / pitch);
  EXPECT_GT(signs, 100);
  EXPECT_LE(largest, 0.25 * pitch);
}

INSTANTIATE_TEST_SUITE_P(Benchmark, BodyFieldModels,
                         testing::Values("block", "gear", "torus", "hammer", "file", "cad_part"));

}  // namespace
}  // namespace asperity
