// One body in four materials, side by side: what a hand feels that presses on it and then slides along.
#include <cmath>
#include <cstdio>
#include <optional>

#include <asperity/asperity.hpp>
#include <asperity/io/textured_model_file.hpp>

struct felt {
  double press_n = 0.0, slide_n = 0.0;  // against the press, and against the slide
  double height_m = 0.0;                // of the probe's body frame under the press
};

// The handle goes down by 6 mm in 0.3 s, rests until 0.5 s, and then slides along x at 10 mm/s for 0.3 s.
felt press_and_slide(asperity::plane_renderer& renderer, asperity::virtual_tool& tool, double start_z_m) {
  constexpr double period_s = 1e-3;
  const asperity::pose T_wb;
  felt out;
  asperity::tick found;
  tool.place({asperity::quat(1.0, 0.0, 0.0, 0.0), {0.0, 0.0, start_z_m}});
  for (int i = 1; i <= 800; ++i) {
    const double t = i * period_s;
    const asperity::vec3 handle{0.01 * std::fmax(0.0, t - 0.5), 0.0, start_z_m - 0.02 * std::fmin(t, 0.3)};
    const asperity::status s = renderer.step({tool.T_wa(), {&T_wb, 1}}, found);
    const asperity::wrench w = tool.follow({asperity::quat(1.0, 0.0, 0.0, 0.0), handle}, period_s, found, s);
    if (i == 500) out.press_n = w.force.z, out.height_m = tool.T_wa().position.z;
    if (i > 600) out.slide_n -= w.force.x / 200.0;  // the mean over the last 0.2 s
  }
  return out;
}

int main(int argc, char** argv) {
  if (argc != 3) return std::puts("usage: 05_materials PROBE.glb FIXED.glb"), 2;
  auto probe = asperity::io::load_textured_model(argv[1]);
  auto fixed = asperity::io::load_textured_model(argv[2]);
  if (!probe || !fixed) return std::puts((probe ? fixed : probe).error().message.c_str()), 1;
  const auto a = std::make_shared<const asperity::textured_model>(std::move(*probe));
  const auto b = std::make_shared<const asperity::textured_model>(std::move(*fixed));
  auto renderer = asperity::make_plane_renderer({a, {b}}, {.reach_m = asperity::reach_for(0.001)});
  if (!renderer) return std::puts(renderer.error().message.c_str()), 1;

  const double start_z_m = b->box.high.z - a->box.low.z + 0.003;
  std::optional<double> steel_height_m;
  std::puts("material   N/mm of a point   under a press          in a slide");
  for (const asperity::material& m : asperity::material_presets()) {
    // A program whose models say what they are made of takes asperity::surfaces_of(scene) instead.
    asperity::virtual_tool tool({.probe = asperity::solid_probe(a->mass),
                                 .surfaces = {asperity::combined(a->surface, std::optional(m))},
                                 .centre_of_mass_a = a->mass.centre_of_mass});
    const felt f = press_and_slide(*renderer, tool, start_z_m);
    if (!steel_height_m) steel_height_m = f.height_m;
    std::printf("%-10s %8.1f          %.2f N, %3.0f um deeper   %.2f N\n", m.name.c_str(), 1e-3 * m.stiffness_n_per_m,
                f.press_n, 1e6 * (*steel_height_m - f.height_m), f.slide_n);
  }
  return 0;
}
