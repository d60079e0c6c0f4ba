#include "session/simulation/scenes.hpp"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "support/height_models.hpp"
#include "support/kept_bodies.hpp"
#include "support/small_models.hpp"

namespace asperity::simulation {
namespace {

using test_support::build_renderer;
using test_support::make_flat_box;
using test_support::make_plate;
using test_support::make_textured_box;
using test_support::ridges;

struct textured_bodies {
  model_ptr probe;
  model_ptr fixed;
  double touch_height_m;
};

model_ptr share(textured_model model) { return std::make_shared<const textured_model>(std::move(model)); }

// A plate whose frame lies in its top face: z = 0 is where the coarse surface is touched.
model_ptr plate(const test_support::height_function& height) {
  test_support::plate_spec spec;
  spec.half_x = 0.03;
  spec.half_y = 0.03;
  spec.texels = 128;
  spec.height = height;
  return make_plate(spec);
}

const std::array<textured_bodies, textured_scene_count>& all_bodies() {
  static const std::array<textured_bodies, textured_scene_count> bodies{{
      {share(make_textured_box({0.004, 0.004, 0.004}, 48, ridges(0.0001, 0.002))),
       plate([](double x, double) { return 0.0002 * std::sin(6.283185307179586 * x / 0.003); }), 0.004},
      {share(make_flat_box({0.006, 0.003, 0.002}, 48)),
       plate([](double x, double y) { return 0.0003 * std::sin(1500.0 * x) * std::sin(1100.0 * y); }), 0.002},
      {share(make_textured_box({0.003, 0.003, 0.006}, 48, ridges(0.0002, 0.0015))), plate({}), 0.006},
  }};
  return bodies;
}

class rendered_scene final : public touched_scene {
 public:
  explicit rendered_scene(least_motion_renderer r) : renderer_(std::move(r)) {}
  [[nodiscard]] status step(const scene_pose& at, tick& out) noexcept override { return renderer_.step(at, out); }

 private:
  least_motion_renderer renderer_;
};

}  // namespace

double touch_height_m(std::size_t i) { return all_bodies()[i].touch_height_m; }

std::unique_ptr<touched_scene> make_textured_scene(std::size_t i, double stiffness_n_per_m) {
  const textured_bodies& bodies = all_bodies()[i];
  least_motion_renderer_settings settings;
  settings.force.stiffness_n_per_m = stiffness_n_per_m;
  settings.force.most_readings = 20'000;  // thousands of sessions: a tick that takes more says so, and is felt as it is
  result<least_motion_renderer> made = build_renderer({bodies.probe, {bodies.fixed}}, settings);
  if (!made) {
    std::fprintf(stderr, "simulation: %s\n", made.error().message.c_str());
    std::abort();
  }
  return std::make_unique<rendered_scene>(std::move(made).value());
}

}  // namespace asperity::simulation
