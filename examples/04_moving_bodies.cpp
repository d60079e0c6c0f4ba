// A loop of your own: a tool held over three copies of a body, of which one turns, one comes and goes, and one stands.
#include <array>
#include <cmath>
#include <cstdio>

#include <asperity/asperity.hpp>
#include <asperity/io/textured_model_file.hpp>

namespace {

constexpr double period_s = 1e-3;

// What a physics engine or a robot would tell: where a body is, and how fast it goes.
struct scene_clock {
  double side_m = 0.0;  // how far the bodies are apart

  asperity::body_motion turntable(double t_s) const {
    const double rate = 2.0;  // rad/s
    return {0, {asperity::exp_rotation({0.0, 0.0, rate * t_s}), {0.0, 0.0, 0.0}}, {{}, {0.0, 0.0, rate}}};
  }
  asperity::body_motion lift(double t_s) const {
    const double way_m = 0.002, w = 12.0;
    return {1,
            {asperity::quat(1.0, 0.0, 0.0, 0.0), {side_m, 0.0, way_m * std::sin(w * t_s)}},
            {{0.0, 0.0, way_m * w * std::cos(w * t_s)}, {}}};
  }
  asperity::pose standing() const { return {asperity::quat(1.0, 0.0, 0.0, 0.0), {-side_m, 0.0, 0.0}}; }
};

struct felt {
  double force_n = 0.0, torque_n_m = 0.0, low_n = 1e9, high_n = 0.0;
  double on_body_n = 0.0;  // what the body under the tool felt downwards, mean
  double from_bodies_j = 0.0;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return std::puts("usage: 04_moving_bodies PROBE.glb FIXED.glb"), 2;
  auto probe = asperity::io::load_textured_model(argv[1]);
  auto fixed = asperity::io::load_textured_model(argv[2]);
  if (!probe || !fixed) return std::puts((probe ? fixed : probe).error().message.c_str()), 1;
  const auto a = std::make_shared<const asperity::textured_model>(std::move(*probe));
  const auto b = std::make_shared<const asperity::textured_model>(std::move(*fixed));
  // One model three times: its depth field is made once.
  auto renderer = asperity::make_plane_renderer({a, {b, b, b}}, {.reach_m = asperity::reach_for(period_s)});
  if (!renderer) return std::puts(renderer.error().message.c_str()), 1;

  const scene_clock scene{1.5 * (b->box.high.x - b->box.low.x)};
  const double touch_z_m = b->box.high.z - a->box.low.z;
  std::puts("over the body that    force           torque       it felt    it gave");
  const std::array<const char*, 3> names{"turns", "comes and goes", "stands"};
  for (std::size_t over = 0; over < 3; ++over) {
    asperity::virtual_tool tool({.probe = asperity::solid_probe(a->mass),
                                 .friction = {.static_coefficient = 0.4, .dynamic_coefficient = 0.4},
                                 .centre_of_mass_a = a->mass.centre_of_mass});
    const std::array<double, 3> x_m{0.0, scene.side_m, -scene.side_m};
    const asperity::quat upright(1.0, 0.0, 0.0, 0.0);
    tool.place({upright, {x_m[over], 0.0, touch_z_m + 0.004}});
    felt out;
    asperity::tick found;
    for (int i = 0; i < 1000; ++i) {
      const double t_s = i * period_s;
      // The tick is rendered with the bodies where they are now; the tool then follows them through the period.
      const std::array<asperity::body_motion, 2> moving{scene.turntable(t_s), scene.lift(t_s)};
      const std::array<asperity::pose, 3> T_wb{moving[0].T_wb, moving[1].T_wb, scene.standing()};
      const asperity::status s = renderer->step({tool.T_wa(), T_wb}, found);
      // The handle goes down by 8 mm in half a second and stays.
      const asperity::pose T_wh{upright, {x_m[over], 0.0, touch_z_m + 0.004 - 0.016 * std::fmin(t_s, 0.5)}};
      const asperity::wrench w = tool.follow(T_wh, period_s, found, s, moving);
      if (i < 600) continue;
      const double n = glm::length(w.force);
      out.force_n += n / 400.0;
      out.low_n = std::fmin(out.low_n, n);
      out.high_n = std::fmax(out.high_n, n);
      out.torque_n_m += w.torque.z / 400.0;
      out.on_body_n -= tool.motion().felt().on(static_cast<std::uint32_t>(over)).force.z / 400.0;
    }
    out.from_bodies_j = tool.motion().probe().energy().from_bodies_j;
    std::printf("%-15s %5.2f N (%.2f to %.2f) %6.1f mN m   %5.2f N   %5.1f mJ\n", names[over], out.force_n, out.low_n,
                out.high_n, 1e3 * out.torque_n_m, out.on_body_n, 1e3 * out.from_bodies_j);
  }
  return 0;
}
