// Push a block over a table: a tool behind a handle, blocks that are free, a table that stands, in one loop of your own.
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <utility>

#include <asperity/asperity.hpp>
#include <asperity/bodies/free_bodies.hpp>
#include <asperity/io/textured_model_file.hpp>

int main(int argc, char** argv) {
  if (argc != 3) return std::puts("usage: 06_free_bodies PROBE.glb BLOCK.glb"), 2;
  auto probe = asperity::io::load_textured_model(argv[1]);
  auto block = asperity::io::load_textured_model(argv[2]);
  if (!probe || !block) return std::puts((probe ? block : probe).error().message.c_str()), 1;
  const auto a = std::make_shared<const asperity::textured_model>(std::move(*probe));
  const auto b = std::make_shared<const asperity::textured_model>(std::move(*block));

  // The same body lies on itself: the lower one stands, the upper one is free.
  const double height_m = b->box.high.z - b->box.low.z;
  const asperity::quat upright(1.0, 0.0, 0.0, 0.0);
  constexpr double mass_kg = 0.2, coefficient = 0.3, period_s = 2e-3;
  asperity::free_bodies_settings settings;
  settings.period_s = period_s;
  settings.friction.static_coefficient = settings.friction.dynamic_coefficient = coefficient;
  auto made = asperity::free_bodies::make(
      {.probe = a,
       .standing = {{b, {}}},
       .free = {{.model = b, .T_wb = {upright, {0.0, 0.0, height_m + 2e-4}}, .mass_kg = mass_kg}}},
      settings);
  if (!made) return std::puts(made.error().message.c_str()), 1;
  asperity::free_bodies bodies = std::move(made).value();

  // From its left side, at half its height, the handle goes 1 mm to the block and 14 mm on, at 10 mm/s.
  const double side_x_m = b->box.low.x - a->box.high.x;
  const double middle_z_m = height_m + 0.5 * (b->box.high.z + b->box.low.z) - 0.5 * (a->box.high.z + a->box.low.z);
  asperity::pose T_wh{upright, {side_x_m - 1e-3, 0.0, middle_z_m}};
  bodies.place(T_wh);
  std::puts("time     hand      block has gone   the lower one feels");
  for (int i = 0; i < 750; ++i) {
    T_wh.position.x += 0.01 * period_s;
    const asperity::wrench felt = bodies.follow(T_wh, period_s);
    if (i % 150 != 149) continue;
    const asperity::vec3 on_table = bodies.on_standing(0).force;
    std::printf("%.1f s   %5.2f N   %5.1f mm         %5.2f N along, %5.2f N down\n", (i + 1) * period_s, -felt.force.x,
                1e3 * bodies.T_wb(0).position.x, on_table.x, -on_table.z);
  }
  std::printf("friction times weight: %.2f N\n", coefficient * mass_kg * 9.81);
  return 0;
}
